#include "pliant/sweep/measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/hash_stream.hpp"
#include "pliant/files/raw_bytes.hpp"
#include "pliant/files/row_order.hpp"

namespace pliant {
namespace {

// Squares of the distances between the rows of two fields.
struct Distances {
  double sum = 0;
  double most = 0;
};

void add_distances(const Field& a, const Field& b, Distances& squares) {
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    const double x = a(row, 0) - b(row, 0);
    const double y = a(row, 1) - b(row, 1);
    const double z = a(row, 2) - b(row, 2);
    const double square = x * x + y * y + z * z;
    squares.sum += square;
    squares.most = std::max(squares.most, square);
  }
}

}  // namespace

class Measurer::Totals {
 public:
  explicit Totals(const Simulation& simulation)
      : simulation_(simulation), last_(simulation.rest_shapes().size()) {
    for (const RestShape& shape : simulation.rest_shapes())
      vertex_count_ += static_cast<double>(shape.mesh.vertex_count());
  }

  void add(const Frame& frame) {
    PLIANT_EXPECTS(frame_count_ == 0 || frame.number() == last_frame_ + 1);
    Distances from_rest, moved;
    for (std::size_t k = 0; k < last_.size(); ++k) {
      const SurfaceFrame& surface = frame.surfaces()[k];
      const Field& positions = surface.object_positions();
      const bool is_animated = surface.object_rest().rows() != 0;
      const Field& rest =
          is_animated ? surface.object_rest() : simulation_.rest_shapes()[k].mesh.positions;
      add_distances(positions, rest, from_rest);
      if (frame_count_ > 0) add_distances(positions, last_[k], moved);
      last_[k] = positions;
      add_to_hash(surface);
    }
    if (frame_count_ == 0) first_frame_ = frame.number();
    ++frame_count_;
    last_frame_ = frame.number();
    sum_ += from_rest.sum;
    final_ = from_rest.most;
    if (frame_count_ == 1 || from_rest.most > peak_) {
      peak_ = from_rest.most;
      peak_frame_ = last_frame_;
    }
    most_moved_ = std::max(most_moved_, moved.most);
    most_energy_ = std::max(most_energy_, moved.sum);
    moved_.push_back(std::sqrt(moved.most));
  }

  Measures measures() const {
    PLIANT_EXPECTS(frame_count_ > 0);
    const double fps = simulation_.scene().fps;
    const double length = 1 / fps;
    Measures measures;
    measures.peak = std::sqrt(peak_);
    measures.peak_frame = peak_frame_;
    measures.final = std::sqrt(final_);
    measures.rms = std::sqrt(sum_ / (static_cast<double>(frame_count_) * vertex_count_));
    measures.speed = std::sqrt(most_moved_) / length;
    measures.energy = most_energy_ / (2 * vertex_count_ * length * length);
    measures.settle = first_frame_;
    for (std::size_t k = moved_.size(); peak_ > 0 && k-- > 1;) {
      if (moved_[k] <= measures.peak / 1000) continue;
      measures.settle = first_frame_ + static_cast<int>(k);
      break;
    }
    measures.hash = stream_.hash();
    return measures;
  }

 private:
  void add_to_hash(const SurfaceFrame& surface) {
    world_ = surface.positions(std::move(world_));
    for (Eigen::Index first = 0; first < world_.rows(); first += rows_at_a_time) {
      const Eigen::Index count = std::min(rows_at_a_time, world_.rows() - first);
      rows_.resize(static_cast<std::size_t>(count) * 3);
      to_row_order(world_, first, std::span(rows_));
      stream_.add(bytes_of(std::span<const double>(rows_)));
    }
  }

  const Simulation& simulation_;
  double vertex_count_ = 0;
  std::vector<Field> last_;  // one a surface
  Field world_;
  std::vector<double> rows_;
  HashStream stream_;
  int frame_count_ = 0;
  int first_frame_ = 0, last_frame_ = 0, peak_frame_ = 0;
  double peak_ = 0, final_ = 0, sum_ = 0;    // squares
  double most_moved_ = 0, most_energy_ = 0;  // squares
  std::vector<double> moved_;                // the largest step to each frame
};

Measurer::Measurer(const Simulation& simulation) : totals_(std::make_unique<Totals>(simulation)) {}
Measurer::Measurer(Measurer&&) noexcept = default;
Measurer::~Measurer() = default;

void Measurer::add(const Frame& frame) { totals_->add(frame); }

Result<Measures> Measurer::measures() const {
  const Measures measures = totals_->measures();
  const std::pair<const char*, double> all[] = {{"peak", measures.peak},
                                                {"final", measures.final},
                                                {"rms", measures.rms},
                                                {"speed", measures.speed},
                                                {"energy", measures.energy}};
  for (const auto& [name, value] : all) {
    if (!std::isfinite(value))
      return fail(ErrorCode::NotFinite, fmt::format("{} is too large for a number", name));
  }
  return measures;
}

}  // namespace pliant
