// SPDX-License-Identifier: MIT
// The contact problem of a tool, solved again for every tick (METHOD Alg. 15).
#pragma once
#include <array>
#include <chrono>
#include <span>
#include <vector>

#include "runtime/world/tool_problem.hpp"

namespace souple {

/// A law with the constants of its block of W, in single precision: see LocalLaw.
struct SingleLaw {
  enum class Kind : std::uint8_t { immovable, frictional, bilateral };
  Kind kind = Kind::immovable;
  float friction = 0, rho = 0;
  float inverse_normal = 0, inverse_tangential = 0;
  float softness = 0;               ///< of a bilateral one, m/N
  std::array<float, 2> coupling{};  ///< w_tn of both tangents
  std::array<float, 9> inverse{};   ///< of a bilateral one, row-major
};

/// A problem and what a solver wants to know of it, made by the physics thread.
struct PreparedProblem {
  struct Reach {  ///< of the contact points of a jaw: a ball, in the frame of its shape
    Vec3 centre = Vec3::Zero();
    double radius = 0;
    bool touches = false;
  };
  ToolProblem problem;
  std::vector<SingleLaw> laws;
  std::array<Reach, most_jaws> reach;
  std::uint64_t recoveries = 0;  ///< of the device, that its tool has followed

  void reserve(std::size_t contact_capacity);
  void prepare();
};

using JawPoses = std::array<RigidPlacement, most_jaws>;

struct TickSolve {
  int sweeps = 0;
  double residual = 0;  ///< natural map over the norm of the forces, of the forces that stand
  bool in_time = true;  ///< the deadline did not end it
};

/// Keeps forces and gaps from tick to tick. W is touched only where a force changes, and only in the
/// rows of the contacts that may bear one: they are at the front of the problem; the others are brought
/// up to date once a tick.
class ToolSolver {
 public:
  using Clock = std::chrono::steady_clock;

  void reserve(std::size_t contact_capacity);
  /// From the forces of the physics. `problem` has to stay until the next call.
  void begin(const PreparedProblem& problem);
  /// The tool to these poses; no contact point farther than `reach` from where physics had it. False:
  /// they were farther, and the motion was cut there.
  bool move_to(const JawPoses& poses, double reach_m);
  /// Until the residual of the laws is within the goal, the sweeps are used up, or it is `deadline`.
  TickSolve solve(double residual_goal, int max_sweeps, Clock::time_point deadline);

  bool empty() const { return count_ == 0; }
  std::span<const float> force() const { return {force_.data(), 3 * count_}; }
  const PreparedProblem* problem() const { return problem_; }
  std::size_t active_count() const;

 private:
  struct Sums {
    double residual2 = 0, force2 = 0;
    double residual() const;
  };
  bool sweep(Sums& sums, Clock::time_point deadline);
  void add_column(std::size_t contact, const float* change, std::size_t first, std::size_t last);
  void synchronise();
  void shrink();
  bool take_up_closed();
  double residual(std::size_t contacts) const;
  void extrapolate();
  float* gap() { return gap_.data() + gap_offset_; }
  const float* gap() const { return gap_.data() + gap_offset_; }

  const PreparedProblem* problem_ = nullptr;
  std::size_t count_ = 0;                    ///< contacts
  std::size_t front_ = 0;                    ///< of them at the front, in the sweeps
  std::size_t edge_ = 0;                     ///< rows that sweeps keep up to date, padded
  std::vector<float> force_, synchronised_;  ///< forces now, and those that all gaps hold
  std::vector<float> gap_;
  std::size_t gap_offset_ = 0;
  std::vector<float> shift_;  ///< of the gaps by the motion of the tool
  // Of the tick before, on the same problem; `last_response_` is its W f + q.
  std::vector<float> last_force_, last_response_;
  int ticks_ = 0;  ///< on this problem
  /// How long it takes to bring all gaps up to date, of late; again, and the first time on a problem.
  std::array<Clock::duration, 2> closing_{};
};

}  // namespace souple
