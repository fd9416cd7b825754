#pragma once

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "pliant/plate/contact/step_contact.hpp"

namespace pliant::testing {

/// Ground below a plate, which each unknown may have at another height: y >= height(unknown). All
/// that is below it at the end of a step touches.
class Ground final : public StepContact {
 public:
  explicit Ground(std::function<double(int)> height) : height_(std::move(height)) {}

  bool begin(int, const Field& from, const Field& to) override {
    rows_.clear();
    free_ = to;
    from_ = from;
    return add(to);
  }
  bool join(const Field& to) override { return add(to); }
  void end_freely_at(const Field& to) override {
    free_ = to;
    for (ContactRow& row : rows_) row.lift = height_(row.unknown) - free_(row.unknown, 1);
  }
  const std::vector<ContactRow>& rows() const override { return rows_; }
  void end(const std::vector<Vector3d>& forces) override {
    forces_.assign(static_cast<std::size_t>(free_.rows()), 0.0);
    for (std::size_t k = 0; k < forces.size(); ++k)
      forces_[static_cast<std::size_t>(rows_[k].unknown)] = forces[k].y();
  }
  double tolerance() const override { return 1e-14; }

  /// Of the last step, of each unknown.
  const std::vector<double>& forces() const { return forces_; }

 private:
  bool add(const Field& to) {
    bool joins = false;
    std::vector<ContactRow> rows;
    std::size_t place = 0;
    for (int k = 0; k < to.rows(); ++k) {
      if (place < rows_.size() && rows_[place].unknown == k) {
        rows.push_back(rows_[place++]);
        continue;
      }
      const double height = height_(k);
      if (!(to(k, 1) < height - 1e-13)) continue;
      ContactRow& row = rows.emplace_back();
      row.unknown = k;
      row.lift = height - free_(k, 1);
      row.lies = std::abs(from_(k, 1) - height) < 1e-9;
      joins = true;
    }
    rows_ = std::move(rows);
    return joins;
  }

  std::function<double(int)> height_;
  Field from_, free_;
  std::vector<ContactRow> rows_;
  std::vector<double> forces_;
};

}  // namespace pliant::testing
