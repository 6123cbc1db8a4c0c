// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "runtime/solve/preconditioner.hpp"

namespace souple {

/// When to stop.
struct SolveLimits {
  double tolerance = 1e-8;  ///< of ||b - A x||, relative to `reference`
  double reference = 1;     ///< of the unit of b; usually ||b||
  int max_iterations = 1000;
};

struct SolveReport {
  int iterations = 0;  ///< uses of the preconditioner
  /// ||b - A x|| / reference of the x that was left, in double from A, b and x themselves: not what a
  /// recurrence believes. Not finite if A, b or x was not.
  double relative_residual = 0;
  bool converged = false;
};

enum class Iteration : std::uint8_t {
  conjugate_gradient,
  /// x += s M^-1 (b - A x), s the step to the least energy of the error: an M^-1 that overshoots, where
  /// s = 1 would diverge, still converges.
  descent,
};

/// Solves A x = b with any preconditioner. The residual and when to stop are judged here, in the same
/// way for all. Owns its work vectors: solve allocates nothing.
class StepSolver {
 public:
  StepSolver(Iteration iteration, std::unique_ptr<Preconditioner> preconditioner, Index node_count);

  /// A second preconditioner for systems where the first one does badly: it is tried when a system took
  /// the first one many iterations, and used for as long as its work is less. What counts is work
  /// units, so that the choice is the same on every machine.
  void add_spare(std::unique_ptr<Preconditioner> spare);

  /// The A of the solves to come; it must stay while they last. The preconditioner takes it over only
  /// when a solve has something to do.
  void set_system(const StepSystem& system);
  /// From the x given to ||b - A x|| <= tolerance * reference. Where that is not reached, x is the
  /// iterate of least residual that was seen.
  SolveReport solve(const Eigen::VectorXd& b, const SolveLimits& limits, Eigen::VectorXd& x);

  /// The factor of A if it is solved with one, or nothing; current_factor also brings it up to date,
  /// and gives nothing where A is not positive definite.
  const SparseFactor* factor() const { return active().preconditioner->factor(); }
  const SparseFactor* current_factor();

  /// What the choice between the preconditioners has been made from; the next systems depend on it.
  struct Memory {
    std::array<double, 2> work{-1, -1};
    double present_work = 0;
    std::uint32_t active = 0;
    std::int32_t systems_with_spare = 0;
  };
  Memory memory() const;
  bool may_recall(const Memory& memory) const;
  void recall(const Memory& memory);

  /// Of one iteration, in products with A.
  double work_units() const { return active().preconditioner->work_units() + 1; }
  bool uses_spare() const { return active_ == 1; }
  std::size_t bytes() const;

 private:
  /// Leaves b - A x in residual_; its norm.
  double measure(const Eigen::VectorXd& b, const Eigen::VectorXd& x);
  /// Keeps the x before the last step if that was the best so far and the present one is worse.
  void note(double norm, double step, const Eigen::VectorXd& direction, const Eigen::VectorXd& x);
  void descend(double target, int iteration_limit, int& iterations, Eigen::VectorXd& x);

  Iteration iteration_;
  struct Choice {
    std::unique_ptr<Preconditioner> preconditioner;
    double work = -1;  ///< units that the last system solved with it took; < 0: not known
  };
  const Choice& active() const { return choices_[active_]; }
  void choose();

  std::array<Choice, 2> choices_;  ///< the second one may be empty
  std::size_t active_ = 0;
  int systems_with_spare_ = 0;  ///< in a row
  double work_ = 0;             ///< units spent on the present system
  StepSystem system_;
  bool is_current_ = false;  ///< the active preconditioner knows the system
  Eigen::VectorXd residual_, direction_, product_, preconditioned_;
  Eigen::VectorXd best_;       ///< x of least residual, if it is kept
  double best_norm_ = 0;       ///< of its residual
  bool best_is_kept_ = false;  ///< else the present x is the best
};

}  // namespace souple
