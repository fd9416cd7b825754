#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/contact/contact_matrix.hpp"
#include "pliant/plate/contact/step_contact.hpp"

namespace pliant {

/// The forces of rows on a plate. Those without friction are >= 0, and those of which the force is
/// not 0 just hold: the one solution of a linear complementarity problem. Friction resists the slip
/// of a row by a force across its normal up to a bound, and what sticks is held by any force.
/// docs/model.md, "Contact". Internal to plate. Sources: Judice & Pires, "An algorithm for a class
/// of large-scale complementarity problems" (1994); Murty, "Note on a Bard-type scheme for solving
/// the complementarity problem" (1974).
class Complementarity {
 public:
  Complementarity(InverseColumns& columns, const RunContext& context)
      : matrix_(columns, context), context_(context) {}

  /// The plate's matrix is another one.
  void forget() { matrix_.forget(); }

  /// A step begins: no solve of it is before the next one.
  void begin_step();

  /// The force of each row, world. `bounds`: of the friction of each row, >= 0; empty: there is
  /// none. Errors: those of the plate's solves; SolverFailed if it does not settle;
  /// Interrupted.
  Result<std::vector<Vector3d>> solve(const std::vector<ContactRow>& rows,
                                      const std::vector<double>& bounds, double tolerance,
                                      const SolvedMatrix& plate);

  /// More of the forces that the last `solve` found, where columns were rough: `moved` is what its
  /// forces move each row's unknown, world. Empty: none lacks more than the tolerance.
  Result<std::vector<Vector3d>> answer_to(const std::vector<ContactRow>& rows,
                                          const std::vector<Vector3d>& moved, double tolerance,
                                          const SolvedMatrix& plate);

 private:
  // What friction does at a row.
  struct Friction {
    double bound = 0;  // 0: there is none
    bool slips = false;
    Vector3d along = {0, 0, 0};  // the slip, of length 1
    double length = 0;           // of the slip
  };
  // A force that is solved for: its row, and whether it is along the normal.
  struct Part {
    std::size_t row;
    bool is_normal;
  };

  bool is_rough() const { return is_rough_ && !matrix_.is_dense(); }
  bool is_left_out(std::size_t row) const { return !depths_.empty() && depths_[row] > depth_; }
  std::size_t pushing() const;
  bool begin_with_few(const std::vector<ContactRow>& rows, std::size_t few);
  bool add_rows(const std::vector<ContactRow>& rows, double tolerance,
                std::vector<std::size_t>& wrong);
  bool begin(const std::vector<ContactRow>& rows, const std::vector<double>& bounds);
  void keep(const std::vector<ContactRow>& rows);
  void list_parts(const std::vector<ContactRow>& rows);
  double lift_of(const std::vector<ContactRow>& rows, std::size_t part) const;
  Result<void> turn(const std::vector<ContactRow>& rows, const SolvedMatrix& plate);
  Result<std::vector<Vector3d>> ways(const std::vector<ContactRow>& rows,
                                     const SolvedMatrix& plate) const;
  std::vector<std::size_t> wrong_rows(const std::vector<ContactRow>& rows, double tolerance) const;
  bool update_friction(const std::vector<ContactRow>& rows, double tolerance);
  void smooth(const std::vector<ContactRow>& rows, bool goes_on);

  ContactMatrix matrix_;
  RunContext context_;
  std::vector<bool> pushes_;  // of each row
  // While only some rows are solved for, the depth of each, and that down to which they are; empty:
  // all are.
  std::vector<int> depths_;
  int depth_ = 0;
  bool is_smooth_ = false;          // friction is that of springs
  bool is_rough_ = true;            // solves are: the sets are not right yet
  std::vector<Friction> friction_;  // of each row
  // Of those that pushed in the solve before, by unknown and collider.
  std::map<std::pair<int, int>, Friction> before_;
  std::vector<Part> parts_;
  std::vector<ContactForce> along_;  // of the parts
  std::vector<double> sizes_;        // of the parts
  std::vector<Vector3d> forces_;     // of the rows, world
  std::vector<Vector3d> ways_;       // on which these move the rows' unknowns
};

}  // namespace pliant
