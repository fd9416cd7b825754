#include "pliant/body/surface_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace pliant {
namespace {

// Of the diagonal: how far inside a node may be and not touch, and how near it lies on a solid.
constexpr double slack = 1e-9;
constexpr double lying = 1e-6;
// Those that a solid pushed are so close to it, if it does not slide below them.
constexpr double resting = 1e-10;

double diagonal_of(const Transform& transform, const Field& nodes) {
  const Field world = to_world(transform, nodes);
  if (world.rows() == 0) return 0;
  return length_of(world.colwise().maxCoeff() - world.colwise().minCoeff());
}

// How far from the origin of its frame a solid reaches with its offset.
double reach_of(const PlacedCollider& collider) {
  return reach(collider.kept.solid) + collider.kept.offset;
}

}  // namespace

ContactPlaces::ContactPlaces(const BodyInputs& inputs, const Field& rest, int step_count)
    : inputs_(&inputs), rest_(&rest), diagonal_(diagonal_of(inputs.transform, rest)) {
  const std::optional<BodyMotion>& motion = inputs.motion;
  for (int step = 0; step <= step_count; ++step) {
    const double a = double(step) / step_count;
    std::vector<PlacedCollider>& all = colliders_.emplace_back();
    for (const SampledCollider& collider : inputs.colliders) {
      const bool is_later = has_moving_mesh(collider);
      all.push_back(is_later ? PlacedCollider() : placed(collider, a));
      if (is_later && step == 0) moving_meshes_.push_back(all.size() - 1);
    }
    const bool moves = motion && step > 0 && !(motion->first == motion->last);
    transforms_.push_back(moves ? make_transform(between(motion->first, motion->last, a))
                                : inputs.transform);
  }
}

Vector3d ContactPlaces::rest(int step, int node) const {
  Vector3d now = rest_->row(node).transpose();
  if (!inputs_->motion || !inputs_->motion->next_shape || step == 0) return now;
  const Vector3d next = inputs_->motion->next_shape->row(node).transpose();
  const double a = double(step) / step_count();
  return (1 - a) * now + a * next;
}

// A frame may have many steps: only the last ones are kept.
void ContactPlaces::pose(int step) {
  constexpr std::size_t most_posed = 8;
  if (moving_meshes_.empty()) return;
  for (const int at : {step, step + 1}) {
    if (at > step_count() || std::ranges::find(posed_, at) != posed_.end()) continue;
    if (posed_.size() == most_posed) {
      for (const std::size_t k : moving_meshes_) colliders_[posed_.front()][k] = {};
      posed_.erase(posed_.begin());
    }
    for (const std::size_t k : moving_meshes_)
      colliders_[at][k] = placed(inputs_->colliders[k], double(at) / step_count());
    posed_.push_back(at);
  }
}

std::vector<double> ContactPlaces::depths(std::size_t collider, const Field& displacement) const {
  const SampledCollider& sampled = inputs_->colliders[collider];
  const bool is_later = has_moving_mesh(sampled);
  const auto count = static_cast<std::size_t>(displacement.rows());
  std::vector<double> depths(count, -std::numeric_limits<double>::infinity());
  std::vector<NearMesh> near_meshes(std::holds_alternative<MeshSolid>(sampled.first.shape) ? count
                                                                                           : 0);
  for (int step = 0; step <= step_count(); ++step) {
    const PlacedCollider one =
        is_later ? placed(sampled, double(step) / step_count()) : colliders_[step][collider];
    for (std::size_t k = 0; k < count; ++k) {
      const Vector3d w = displacement.row(static_cast<Eigen::Index>(k)).transpose();
      const Vector3d x =
          one.to_frame(to_world(transforms_[step], Vector3d(rest(step, static_cast<int>(k)) + w)));
      NearMesh* const near = near_meshes.empty() ? nullptr : &near_meshes[k];
      const double nearest = sampled.deformation_radius - depths[k];
      if (near && is_known_to_be_farther(one, x, nearest + one.kept.offset, *near)) continue;
      const double distance =
          near ? distance_to_mesh(one, x, *near) - one.kept.offset : nearness(one.kept, x).distance;
      depths[k] = std::max(depths[k], sampled.deformation_radius - std::max(0.0, distance));
    }
  }
  return depths;
}

const Field* ContactPlaces::next_rest() const {
  return inputs_->motion ? inputs_->motion->next_shape.get() : nullptr;
}

void SurfaceContact::begin_frame(ContactPlaces places,
                                 const std::vector<SampledCollider>& colliders, double share,
                                 const std::vector<ContactFacts>& before) {
  places_ = std::move(places);
  sampled_ = colliders;
  share_ = share;
  facts_.clear();
  is_new_.clear();
  for (const SampledCollider& collider : colliders) {
    facts_.emplace_back().collider = collider.index;
    is_new_.push_back(std::ranges::find(before, collider.index, &ContactFacts::collider) ==
                      before.end());
  }
  moves_.assign(static_cast<std::size_t>(places_.first_rest().rows()), 0);
  pushes_.clear();
  keep_near_meshes();
}

// What is known of a mesh holds in the next frame too, if that begins with it as this one ended.
void SurfaceContact::keep_near_meshes() {
  if (sampled_.empty()) return;  // a frame without contact, or that has not begun
  const auto count = static_cast<std::size_t>(places_.first_rest().rows());
  const bool has_mesh = std::ranges::any_of(sampled_, [](const SampledCollider& one) {
    return std::holds_alternative<MeshSolid>(one.first.shape);
  });
  if (!has_mesh || count == 0) {
    near_meshes_.clear();
    last_meshes_.clear();
    return;
  }
  if (near_meshes_.size() != sampled_.size() * count) {
    near_meshes_.assign(sampled_.size() * count, {});
    last_meshes_.assign(sampled_.size(), {});
  }
  for (std::size_t c = 0; c < sampled_.size(); ++c) {
    const ColliderPose &first = sampled_[c].first, &last = sampled_[c].last;
    const auto* const mesh = std::get_if<MeshSolid>(&first.shape);
    LastMesh& before = last_meshes_[c];
    const bool goes_on =
        mesh && before.posed == mesh->posed && before.scale == first.placement.scale;
    const std::span<NearMesh> known(&near_meshes_[c * count], count);
    for (NearMesh& one : known) {
      if (!goes_on) one = {};
      one.mesh_way -= before.way;
    }
    before = {};
    if (!mesh) continue;
    before = {std::get<MeshSolid>(last.shape).posed, last.placement.scale,
              mesh_way_of(sampled_[c])};
  }
}

void SurfaceContact::begin_patch(std::span<const RowRun> moved) {
  nodes_.clear();
  for (const RowRun& run : moved) {
    for (int k = 0; k < run.count; ++k) nodes_.push_back(run.node + k);
    std::fill_n(moves_.begin() + run.node, run.count, std::uint8_t{1});
  }
  const auto gather = [&](const Field& nodes, Field& own) {
    own.resize(static_cast<Eigen::Index>(nodes_.size()), 3);
    Eigen::Index first = 0;
    for (const RowRun& run : moved) {
      for (int k = 0; k < 3; ++k)
        own.col(k).segment(first, run.count) = nodes.col(k).segment(run.node, run.count);
      first += run.count;
    }
  };
  gather(places_.first_rest(), rest_);
  next_rest_.resize(0, 3);
  if (const Field* const next = places_.next_rest()) gather(*next, next_rest_);
  pushes_.clear();
  thrown_.assign(sampled_.size(), {});
}

// The unknowns in the world as a step begins.
void SurfaceContact::place(int step, const Field& displacement, Field& world) {
  const double a = double(step) / places_.step_count();
  shape_ = displacement;
  for (int k = 0; k < 3; ++k) {
    if (next_rest_.rows() == 0 || step == 0) {
      shape_.col(k) += rest_.col(k);
    } else {
      shape_.col(k) += (1 - a) * rest_.col(k) + a * next_rest_.col(k);
    }
  }
  world = pliant::to_world(places_.transform(step), shape_, std::move(world));
}

bool SurfaceContact::begin(int step, const Field& from, const Field& to) {
  step_ = step;
  places_.pose(step);
  place(step, from, before_);
  place(step + 1, to, free_);
  after_ = free_;
  joined_.assign(sampled_.size() * nodes_.size(), 0);
  found_.clear();
  rows_.clear();
  pushes_.assign(sampled_.size(), {});
  // A step may be tried more than once.
  if (step == 0) thrown_.assign(sampled_.size(), {});
  return find(true);
}

bool SurfaceContact::join(const Field& to) {
  place(step_ + 1, to, after_);
  return find(false);
}

void SurfaceContact::end_freely_at(const Field& to) {
  place(step_ + 1, to, free_);
  list_rows();
}

// Unknowns whose way may come near a collider, by unknown and collider.
std::vector<SurfaceContact::Pair> SurfaceContact::near_pairs() const {
  const auto count = static_cast<Eigen::Index>(nodes_.size());
  double longest = 0;  // way of an unknown, squared
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::RowVector3d way = after_.row(k) - before_.row(k);
    longest = std::max(longest, way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
  }
  longest = std::sqrt(longest);
  std::vector<Pair> pairs;
  for (std::size_t c = 0; c < sampled_.size(); ++c) {
    const PlacedCollider& from = places_.colliders(step_)[c];
    const PlacedCollider& to = places_.colliders(step_ + 1)[c];
    const Eigen::RowVector3d middle = from.translation.transpose();
    const double way = length_of(to.translation - from.translation);
    const double most = (std::max(reach_of(from), reach_of(to)) + way + longest) * (1 + 1e-9);
    // In a frame that turns, what stands still goes straight too, nearer to the origin than it is.
    const double turn = (to.rotation - from.rotation).norm();
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::RowVector3d x = before_.row(k) - middle;
      const double distance = length_of(x);
      const bool is_near = distance - turn * distance <= most;
      if (is_near) pairs.push_back({static_cast<int>(k), static_cast<int>(c)});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::unknown);
  return pairs;
}

// Lets pairs join that touch on their way, and at first those that lie on what sticks; whether any
// does.
bool SurfaceContact::find(bool is_first) {
  bool joins = false;
  for (const auto& [unknown, collider] : near_pairs()) {
    const std::size_t pair =
        static_cast<std::size_t>(collider) * nodes_.size() + static_cast<std::size_t>(unknown);
    std::uint8_t& joined = joined_[pair];
    if (joined) continue;
    const SampledCollider& sampled = sampled_[static_cast<std::size_t>(collider)];
    const PlacedCollider& from = places_.colliders(step_)[static_cast<std::size_t>(collider)];
    const PlacedCollider& to = places_.colliders(step_ + 1)[static_cast<std::size_t>(collider)];
    const Vector3d before = before_.row(unknown).transpose(),
                   after = after_.row(unknown).transpose();
    if (is_first && step_ == 0 && is_new_[static_cast<std::size_t>(collider)]) {
      const double distance = nearness(from.kept, from.to_frame(before)).distance;
      if (distance < -lying * places_.diagonal())
        thrown_[static_cast<std::size_t>(collider)].add(-distance);
    }
    std::optional<NodeRow> row;
    if (is_first && sampled.sticks)
      row = lying_row_of(from, to, before, lying * places_.diagonal());
    NearMesh* const near_mesh =
        near_meshes_.empty()
            ? nullptr
            : &near_meshes_[static_cast<std::size_t>(collider * places_.first_rest().rows() +
                                                     nodes_[static_cast<std::size_t>(unknown)])];
    if (!row) row = row_of(from, to, before, after, slack * places_.diagonal(), near_mesh);
    if (!row) continue;
    joined = 1;
    joins = true;
    row->node = unknown;
    row->collider = collider;
    row->sticks = sampled.sticks;
    if (found_.add(*row, after) == NodeRows::Offer::Squeezed)
      note_squeeze(collider, found_.squeezer_of(*row)->collider);
  }
  if (joins) list_rows();
  return joins;
}

void SurfaceContact::list_rows() {
  rows_.clear();
  for (const NodeRow& row : found_.all()) {
    const auto collider = static_cast<std::size_t>(row.collider);
    const PlacedCollider& from = places_.colliders(step_)[collider];
    const Vector3d before = before_.row(row.node).transpose(),
                   free = free_.row(row.node).transpose();
    const Nearness near = nearness(from.kept, from.to_frame(before));
    ContactRow& own = rows_.emplace_back();
    own.unknown = row.node;
    own.normal = row.normal;
    own.lift = row.lack(free);
    own.lies = std::abs(near.distance) <= lying * places_.diagonal();
    own.rests = std::abs(near.distance) <= resting * places_.diagonal();
    own.sticks = row.sticks;
    own.friction = sampled_[collider].friction;
    own.slip = free - row.place;
    own.place = row.place;
    own.collider = row.collider;
  }
}

// What one solid presses against another, which came first and stays.
void SurfaceContact::note_squeeze(int collider, int squeezer) {
  std::vector<int>& squeezed = facts_[static_cast<std::size_t>(collider)].squeezed;
  const int index = sampled_[static_cast<std::size_t>(squeezer)].index;
  const auto place = std::ranges::lower_bound(squeezed, index);
  if (place == squeezed.end() || *place != index) squeezed.insert(place, index);
}

void SurfaceContact::end(const std::vector<Vector3d>& forces) {
  pushes_.assign(sampled_.size(), {});
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const ContactRow& row = rows_[k];
    if (forces[k].isZero(0)) continue;
    const auto collider = static_cast<std::size_t>(row.collider);
    auto& [nodes, force] = pushes_[collider];
    force += share_ * forces[k];
    const int node = nodes_[static_cast<std::size_t>(row.unknown)];
    if (nodes.empty() || nodes.back() != node) nodes.push_back(node);
    facts_[collider].touched = true;
  }
}

void SurfaceContact::end_patch() {
  for (std::size_t c = 0; c < pushes_.size(); ++c) {
    facts_[c].nodes.insert(facts_[c].nodes.end(), pushes_[c].nodes.begin(), pushes_[c].nodes.end());
    facts_[c].force += pushes_[c].force;
    facts_[c].thrown.add(thrown_[c]);
  }
  pushes_.clear();
}

void SurfaceContact::end_frame(const std::function<Vector3d(int node)>& displacement) {
  const int end = places_.step_count();
  for (std::size_t c = 0; c < sampled_.size(); ++c) {
    const PlacedCollider& solid = places_.colliders(end)[c];
    for (int node = 0; node < static_cast<int>(moves_.size()); ++node) {
      if (moves_[static_cast<std::size_t>(node)]) continue;
      const Vector3d object = places_.rest(end, node) + displacement(node);
      const Vector3d world = pliant::to_world(places_.transform(end), object);
      if (!(length_of(world - solid.translation) <= reach_of(solid))) continue;
      const double distance = nearness(solid.kept, solid.to_frame(world)).distance;
      if (distance < -lying * places_.diagonal()) facts_[c].held.add(-distance);
    }
    std::ranges::sort(facts_[c].nodes);
  }
}

double SurfaceContact::tolerance() const {
  // What rounding leaves of a place in the world is no lack.
  constexpr double part = 1e-12, rounding = 1e-15;
  const double farthest = free_.rows() == 0 ? 0 : free_.cwiseAbs().maxCoeff();
  return part * places_.diagonal() + rounding * farthest;
}

}  // namespace pliant
