#include "pliant/mesh/written/opensubdiv_refiner.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

namespace pliant {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;
using Level = OpenSubdiv::Vtr::internal::Level;

// The cage in OpenSubdiv's terms: its points are the nodes of faces, its values the UVs.
struct Cage {
  std::vector<int> point_nodes;    // #points, ascending
  std::vector<int> face_sizes;     // #faces
  std::vector<int> corner_points;  // #corners
  std::vector<int> corner_values;  // #corners; empty: no corner has a UV
  std::vector<int> mesh_faces;     // #faces: the mesh's
};

// NOLINTBEGIN(readability-identifier-naming): OpenSubdiv calls Clear and AddWithWeight.

// A UV that OpenSubdiv averages; unknown if one of its sources is.
struct UvValue {
  double u = 0;
  double v = 0;
  bool is_known = true;

  void Clear() { *this = {}; }
  void AddWithWeight(const UvValue& from, double weight) {
    u += weight * from.u;
    v += weight * from.v;
    is_known = is_known && from.is_known;
  }
};

// Values that OpenSubdiv computes one after another, which asks meanwhile.
struct AskedValues {
  std::vector<UvValue>& values;
  StopPoll& poll;

  UvValue& operator[](int value) {
    poll.after(16);
    return values[value];
  }
};

// The points of a level as weighted sums of nodes, which OpenSubdiv fills a row at a time and
// refines like positions. Once it is stopped, rows remain empty: OpenSubdiv cannot be ended.
class WeightRows {
 public:
  WeightRows(const std::vector<int>& point_nodes, StopPoll& poll)
      : poll_(&poll),
        ends_(point_nodes.size()),
        begins_(point_nodes.size()),
        nodes_(point_nodes),
        weights_(point_nodes.size(), 1) {
    std::iota(begins_.begin(), begins_.end(), 0);
    std::iota(ends_.begin(), ends_.end(), 1);
  }
  WeightRows(int rows, int node_count, StopPoll& poll)
      : poll_(&poll),
        ends_(static_cast<std::size_t>(rows), 0),
        begins_(static_cast<std::size_t>(rows), 0),
        sums_(static_cast<std::size_t>(node_count), 0),
        is_in_sum_(static_cast<std::size_t>(node_count), false) {}

  struct ConstRow {
    const WeightRows& rows;
    int row;
  };
  struct Row {
    WeightRows& rows;
    int row;

    void Clear() { rows.begin(row); }
    void AddWithWeight(const ConstRow& from, double weight) {
      rows.add(from.rows, from.row, weight);
    }
    void AddWithWeight(const Row& from, double weight) { rows.add(from.rows, from.row, weight); }
  };

  ConstRow operator[](int row) const { return {*this, row}; }
  Row operator[](int row) { return {*this, row}; }

  // Stores the row that was begun last.
  void finish() {
    if (row_ < 0) return;
    std::ranges::sort(in_sum_);
    begins_[row_] = nodes_.size();
    for (const int node : in_sum_) {
      if (sums_[node] != 0) {
        nodes_.push_back(node);
        weights_.push_back(sums_[node]);
      }
      sums_[node] = 0;
      is_in_sum_[node] = false;
    }
    ends_[row_] = nodes_.size();
    in_sum_.clear();
    row_ = -1;
  }

  VertexWeights in_order() const {
    VertexWeights ordered;
    ordered.starts.reserve(begins_.size() + 1);
    ordered.nodes.reserve(nodes_.size());
    ordered.weights.reserve(nodes_.size());
    for (std::size_t row = 0; row < begins_.size(); ++row) {
      if (poll_->after(ends_[row] - begins_[row])) break;
      for (std::size_t entry = begins_[row]; entry < ends_[row]; ++entry) {
        ordered.nodes.push_back(nodes_[entry]);
        ordered.weights.push_back(weights_[entry]);
      }
      ordered.starts.push_back(ordered.nodes.size());
    }
    return ordered;
  }

 private:
  void begin(int row) {
    finish();
    row_ = row;
    poll_->after(64);
  }

  void add(const WeightRows& from, int row, double weight) {
    if (poll_->after(from.ends_[row] - from.begins_[row])) return;
    for (std::size_t entry = from.begins_[row]; entry < from.ends_[row]; ++entry) {
      const int node = from.nodes_[entry];
      if (!is_in_sum_[node]) in_sum_.push_back(node);
      is_in_sum_[node] = true;
      sums_[node] += weight * from.weights_[entry];
    }
  }

  StopPoll* poll_;
  std::vector<std::size_t> ends_, begins_;  // #rows: the entries of each
  std::vector<int> nodes_;
  std::vector<double> weights_;

  // The row that is being summed.
  int row_ = -1;
  std::vector<double> sums_;     // #nodes
  std::vector<bool> is_in_sum_;  // #nodes
  std::vector<int> in_sum_;
};

// NOLINTEND(readability-identifier-naming)

Cage cage_of(const Mesh& mesh, const TriangleSurface& surface) {
  Cage cage;
  std::vector<int> points(static_cast<std::size_t>(surface.node_count()), -1);
  for (const int node : surface.corner_nodes) points[node] = 0;
  for (int node = 0; node < surface.node_count(); ++node) {
    if (points[node] < 0) continue;  // only in faces that take no part
    points[node] = static_cast<int>(cage.point_nodes.size());
    cage.point_nodes.push_back(node);
  }
  for (const int node : surface.corner_nodes) cage.corner_points.push_back(points[node]);
  int mesh_face = 0, mesh_end = mesh.face_sizes[0];
  for (int face = 0; face < surface.face_count(); ++face) {
    cage.face_sizes.push_back(surface.size_of(face));
    while (mesh_end <= surface.mesh_corners[surface.face_starts[face]])
      mesh_end += mesh.face_sizes[++mesh_face];
    cage.mesh_faces.push_back(mesh_face);
  }
  return cage;
}

// Numbers the UVs of the cage's corners: one for each that a node has.
std::vector<UvValue> take_uvs(const Mesh& mesh, const TriangleSurface& surface, Cage& cage,
                              StopPoll& poll) {
  std::vector<UvValue> values;
  std::map<std::tuple<int, bool, double, double>, int> numbers;
  bool is_any = false;
  for (std::size_t corner = 0; corner < cage.corner_points.size(); ++corner) {
    if (poll.after(100)) return {};
    const int uv = mesh.corner_uvs[surface.mesh_corners[corner]];
    UvValue value{.is_known = uv >= 0};
    if (uv >= 0) value = {mesh.uvs[uv][0], mesh.uvs[uv][1], true};
    is_any = is_any || value.is_known;
    const auto [place, is_new] =
        numbers.try_emplace({cage.corner_points[corner], value.is_known, value.u, value.v},
                            static_cast<int>(values.size()));
    if (is_new) values.push_back(value);
    cage.corner_values.push_back(place->second);
  }
  if (!is_any) cage.corner_values.clear();
  return values;
}

Result<std::unique_ptr<Far::TopologyRefiner>> refiner_of(const Cage& cage, std::size_t value_count,
                                                         const Subdivision& subdivision) {
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(cage.point_nodes.size());
  descriptor.numFaces = static_cast<int>(cage.face_sizes.size());
  descriptor.numVertsPerFace = cage.face_sizes.data();
  descriptor.vertIndicesPerFace = cage.corner_points.data();
  Far::TopologyDescriptor::FVarChannel uvs;
  if (!cage.corner_values.empty()) {
    uvs.numValues = static_cast<int>(value_count);
    uvs.valueIndices = cage.corner_values.data();
    descriptor.numFVarChannels = 1;
    descriptor.fvarChannels = &uvs;
  }
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1);
  const bool is_loop = subdivision.scheme == SubdivisionScheme::Loop;
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(descriptor, {is_loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK, options}));
  // The factory would print what it finds, or hand it to one function of the whole process.
  std::string complaint = "it gives no reason";
  struct Report {
    std::string& complaint;
  };
  const Report report{complaint};
  const auto listen = [](Level::TopologyError, const char* message, const void* to) {
    static_cast<const Report*>(to)->complaint = message;
  };
  if (!refiner || !refiner->getLevel(0).validateTopology(listen, &report)) {
    return invalid(fmt::format("OpenSubdiv refuses the cage: {}", printable(complaint)));
  }
  if (subdivision.levels > 0) refiner->RefineUniform({subdivision.levels});
  return refiner;
}

FaceNames names_of(const FaceNames& names, const std::vector<int>& mesh_faces) {
  if (names.of_faces.empty()) return {};
  FaceNames inherited{.names = names.names, .of_faces = {}};
  inherited.of_faces.reserve(mesh_faces.size());
  for (const int face : mesh_faces) inherited.of_faces.push_back(names.of_faces[face]);
  return inherited;
}

// The faces of the last level, with the UVs that are known. Unfinished if it is stopped.
Mesh faces_of(const Far::TopologyLevel& level, const std::vector<UvValue>& values, bool has_uvs,
              StopPoll& poll) {
  Mesh mesh;
  std::vector<int> uv_numbers;
  if (has_uvs) {
    for (const UvValue& value : values) {
      uv_numbers.push_back(value.is_known ? static_cast<int>(mesh.uvs.size()) : -1);
      if (value.is_known) mesh.uvs.push_back({value.u, value.v});
    }
  }
  mesh.face_sizes.reserve(static_cast<std::size_t>(level.GetNumFaces()));
  mesh.corner_vertices.reserve(static_cast<std::size_t>(level.GetNumFaceVertices()));
  mesh.corner_uvs.reserve(static_cast<std::size_t>(level.GetNumFaceVertices()));
  for (int face = 0; face < level.GetNumFaces() && !poll.after(16); ++face) {
    const Far::ConstIndexArray vertices = level.GetFaceVertices(face);
    mesh.face_sizes.push_back(vertices.size());
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), vertices.begin(), vertices.end());
    for (int k = 0; k < vertices.size(); ++k)
      mesh.corner_uvs.push_back(has_uvs ? uv_numbers[level.GetFaceFVarValues(face)[k]] : -1);
  }
  return mesh;
}

}  // namespace

Result<SubdividedMesh> refined_by_opensubdiv(const Mesh& mesh, const TriangleSurface& surface,
                                             const Subdivision& subdivision,
                                             const StopRequest& should_stop) {
  StopPoll poll(should_stop);
  Cage cage = cage_of(mesh, surface);
  std::vector<UvValue> uvs = take_uvs(mesh, surface, cage, poll);
  if (poll.after(0)) return interrupted();
  const bool has_uvs = !cage.corner_values.empty();
  auto made = refiner_of(cage, uvs.size(), subdivision);
  if (!made) return fail(made.error());
  const Far::TopologyRefiner& refiner = **made;
  const Far::PrimvarRefinerReal<double> refine(refiner);
  WeightRows rows(cage.point_nodes, poll);
  std::vector<int> mesh_faces = std::move(cage.mesh_faces);
  for (int level = 1; level <= subdivision.levels; ++level) {
    const Far::TopologyLevel& topology = refiner.GetLevel(level);
    WeightRows finer(topology.GetNumVertices(), surface.node_count(), poll);
    refine.Interpolate(level, std::as_const(rows), finer);
    finer.finish();
    if (poll.after(0)) return interrupted();
    rows = std::move(finer);
    std::vector<int> finer_faces(static_cast<std::size_t>(topology.GetNumFaces()));
    refine.InterpolateFaceUniform(level, mesh_faces, finer_faces);
    mesh_faces = std::move(finer_faces);
    if (!has_uvs) continue;
    std::vector<UvValue> finer_uvs(static_cast<std::size_t>(topology.GetNumFVarValues()));
    AskedValues asked{finer_uvs, poll};
    refine.InterpolateFaceVarying(level, uvs, asked);
    if (poll.after(0)) return interrupted();
    uvs = std::move(finer_uvs);
  }
  SubdividedMesh result;
  result.mesh = faces_of(refiner.GetLevel(subdivision.levels), uvs, has_uvs, poll);
  result.weights = rows.in_order();
  if (poll.after(0)) return interrupted();
  auto positions = result.weights.apply(surface.rest, {}, should_stop);
  if (!positions) return fail(positions.error());
  result.mesh.positions = *std::move(positions);
  result.mesh.materials = names_of(mesh.materials, mesh_faces);
  result.mesh.groups = names_of(mesh.groups, mesh_faces);
  result.mesh.object = mesh.object;
  return result;
}

}  // namespace pliant
