// SPDX-License-Identifier: MIT
// The instances that a world steps. Internal to the world.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/collision/surface_tree.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "runtime/solve/step_solver.hpp"
#include "runtime/world/applied_load.hpp"
#include "runtime/world/driven_nodes.hpp"
#include "runtime/world/settings.hpp"
#include "runtime/world/soft_body_asset.hpp"

namespace souple {

/// What a step is, the same for all bodies.
struct StepRule {
  Integrator integrator = Integrator::implicit_euler;
  RotationMethod rotation_method = RotationMethod::polar;
  double time_step_s = 0.01;
  double time_s = 0;  ///< at the start of the step
  Vec3 gravity = Vec3::Zero();
};

/// What BDF2 knows of the step before.
struct StepHistory {
  bool valid = false;
  bool begun = false;                ///< in the step that is being computed
  Eigen::VectorXd motion, velocity;  ///< 3n: x_n - x_n-1, v_n-1
  Eigen::VectorXd free_motion;       ///< 3n: of this step, before the contacts
  Eigen::VectorXd load;              ///< of the solve that starts it
};

/// What keeps warped contact forces from growing near rest; see choose_relaxation.
struct Stabilisation {
  int growing_steps = 0;  ///< in a row in which the forces overshot more and more
  double relaxation = 1;  ///< >= 1: multiplies the warped compliance
};

/// The rigid motion that warped contact forces owe a body: m/s and rad/s.
struct OwedVelocity {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

/// State and work space of one soft body; everything is allocated when it is made.
struct SoftBody {
  SoftBody(std::shared_ptr<const SoftBodyAsset> shared, std::string name);

  void drive(std::vector<DrivenNodes> parts);
  /// How far the driven nodes move in this step, into `prescribed`.
  void prescribe_motion(const StepRule& rule);
  /// Rotations of elements and nodes, tangent A with identity rows for fixed nodes, and in `load` the
  /// forces of gravity, loads and elasticity. Contact forces are added to `load` afterwards.
  void prepare_free_motion(const StepRule& rule);
  /// Factorises the present A unless that was done; false if it is not positive definite.
  bool make_inverse();
  /// Whether BDF2 has no step before this one, or none that it may build on.
  bool lacks_history(const StepRule& rule) const {
    return rule.integrator == Integrator::bdf2 && !history.valid;
  }
  /// Makes a history from positions, velocities and an acceleration, which takes a solve: begin_history
  /// gives the forces of `load`, to which those of the contacts are added; then start_history.
  Eigen::VectorXd& begin_history();
  void start_history(const StepRule& rule, const FreeMotionSettings& settings);
  /// Completes `load` to the right side b with what inertia and damping remember (METHOD 2): for
  /// implicit Euler M v / h.
  void add_inertia(const StepRule& rule);
  /// Solves A dx = load into `motion`, from the motion of the last step.
  SolveReport solve_free_motion(const StepRule& rule, const FreeMotionSettings& settings);
  /// The same from the motion there is, after forces were added to `load`.
  SolveReport solve_from_motion(double time_step_s, const FreeMotionSettings& settings);
  /// Takes over `motion`. `struck`: contacts changed it from the free motion by an impulse.
  void take_motion(const StepRule& rule, bool struck);
  /// Of contact forces f in `rest_frame`: makes of them f + b - A dx, what warping leaves of the
  /// equations of `motion`. Uses `load` up.
  void find_warping_defect();
  /// Gives part of the momentum and the spin of the defects so far, that in `rest_frame` the last, to a
  /// body that nothing holds.
  void give_back_momentum(double time_step_s);
  void remove_kinetic_energy(double energy_j);
  void take_history(const SoftBody& other, bool same_step);
  /// Whether nothing but contacts can end its rest: no driven nodes, no load that changes in time.
  bool may_rest() const;
  void stop();  ///< without velocity
  void add_load(AppliedLoad added);
  double work_of_loads() const;  ///< in the step whose motion was taken, J
  double kinetic_energy() const;
  double elastic_energy();  ///< of the present positions
  double potential_energy(const Vec3& gravity) const;
  Vec3 linear_momentum() const;   ///< kg m/s
  Vec3 angular_momentum() const;  ///< about the origin, kg m^2/s
  double largest_speed() const;
  Vec3 mean_velocity() const;                            ///< of the surface nodes, m/s
  double largest_deviation(const Vec3& velocity) const;  ///< of a surface node's from it, m/s

  std::shared_ptr<const SoftBodyAsset> asset;
  std::string name;
  CollisionFilter filter;
  bool self_contact = false;
  const BodyCompliance* compliance = nullptr;  ///< warped contact
  double compliance_scale = 1;                 ///< stored C0 times this is A0^-1
  /// Exact contact: of the present A, where the solver has none of its own.
  std::optional<SparseFactor> factor;
  const SparseFactor* inverse = nullptr;  ///< exact contact: the factor of this step, once it is made
  std::uint64_t inverse_number = 0;
  std::vector<char> is_fixed;  ///< by node
  std::vector<Index> free_nodes;
  std::vector<DrivenNodes> driven;
  std::vector<AppliedLoad> loads;

  Eigen::VectorXd x, v;          ///< 3n, m and m/s
  Eigen::VectorXd motion, load;  ///< 3n: dx of this step, right side b
  Eigen::VectorXd prescribed;    ///< 3n: dx of driven nodes in this step, else 0; empty: none driven
  StepHistory history;           ///< sized for BDF2 only
  Stabilisation stabilisation;
  OwedVelocity owed;                  ///< see warping_defect.cpp
  Eigen::VectorXd rest_frame;         ///< 3n: scratch; of the correction in the rest frame
  Eigen::VectorXd work;               ///< exact contact
  std::vector<float> extension_work;  ///< warped contact
  std::vector<Mat3> element_rotations, node_rotations;
  CornerVectors gradients, corner_forces;  ///< of the elements, rotated; scratch of a step
  BlockMatrix tangent;
  std::optional<StepSolver> solver;                ///< made when the fixed nodes are known
  SolverKind solver_kind = SolverKind::automatic;  ///< that of `solver`
  DeformedSurface surface;

 private:
  const Eigen::VectorXd& shape_of_rotations(const StepRule& rule);
  void add_loads(const StepRule& rule, const Eigen::VectorXd& shape);
  const Eigen::VectorXd& damped_shape(const StepRule& rule);
  void hold_fixed_nodes();
  void prescribe_load(double share);
  void add_history(const StepRule& rule);
  void take_bdf2_velocity(double time_step_s, bool struck);

  double mass_norm_ = 0;          ///< root of the sum of squared nodal masses, kg
  Eigen::VectorXd applied_load_;  ///< 3n: of the loads alone, N; empty: no loads
  Eigen::VectorXd driven_pull_;   ///< 3n: A times `prescribed` before its columns were cleared
};

}  // namespace souple
