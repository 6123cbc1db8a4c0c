// SPDX-License-Identifier: MIT
// The free motion of a body: what the step would be without new contact forces (METHOD 2, Alg. 11).
#include <algorithm>

#include "runtime/world/bodies.hpp"
#include "runtime/world/integrator.hpp"
#include "runtime/world/predicted_shape.hpp"

namespace souple {

void SoftBody::prescribe_motion(const StepRule& rule) {
  if (driven.empty()) return;
  for (const DrivenNodes& part : driven) {
    part.place(rule.time_s + rule.time_step_s, asset->model().rest_positions(), prescribed);
    for (const Index node : part.nodes) node_entry(prescribed, node) -= node_entry(x, node);
  }
}

void SoftBody::prepare_free_motion(const StepRule& rule) {
  const CorotationalModel& model = asset->model();
  inverse = nullptr;
  const SystemFactors factors = system_factors(
      rule.integrator, rule.time_step_s, model.rayleigh_mass_per_s(), model.rayleigh_stiffness_s());
  const Eigen::VectorXd& shape = shape_of_rotations(rule);
  model.evaluate_elements(shape, rule.rotation_method, element_rotations, gradients, corner_forces);
  model.node_rotations(element_rotations, node_rotations);
  model.assemble(factors.mass, factors.stiffness, gradients, tangent);
  for (Index node = 0; node < model.node_count(); ++node)
    node_entry(load, node) = model.masses()[node] * rule.gravity;
  if (!loads.empty()) add_loads(rule, shape);
  const Eigen::VectorXd& damped = damped_shape(rule);
  if (&damped == &shape && &shape == &x)
    model.add_corner_forces(corner_forces, load);
  else
    model.add_elastic_forces(damped, element_rotations, corner_forces, load);
  hold_fixed_nodes();
  solver->set_system({&tangent, node_rotations});
}

// With the rotations given, elastic forces are linear in the positions: moved by beta times a velocity
// they hold the damping by the stiffness as well. What A does not hold of it belongs to the past.
const Eigen::VectorXd& SoftBody::damped_shape(const StepRule& rule) {
  const double beta = asset->model().rayleigh_stiffness_s();
  if (rule.integrator == Integrator::explicit_euler)
    rest_frame = x + beta * v;
  else if (rule.integrator == Integrator::bdf2 && history.valid)
    rest_frame = x - (beta / (2 * rule.time_step_s)) * history.motion;
  else
    return x;
  return rest_frame;
}

const Eigen::VectorXd& SoftBody::shape_of_rotations(const StepRule& rule) {
  if (rule.integrator != Integrator::implicit_euler && rule.integrator != Integrator::bdf2) return x;
  predict_shape(asset->model(), x, v, rule.time_step_s, free_nodes.size() == is_fixed.size(),
                rule.integrator == Integrator::bdf2, rest_frame);
  return rest_frame;
}

// At the end of the step, where the implicit equations hold.
void SoftBody::add_loads(const StepRule& rule, const Eigen::VectorXd& shape) {
  const bool explicitly = rule.integrator == Integrator::explicit_euler;
  const double time_s = rule.time_s + (explicitly ? 0 : rule.time_step_s);
  applied_load_.setZero(load.size());
  for (const AppliedLoad& one : loads) one.add_to(applied_load_, time_s, shape, node_rotations);
  load += applied_load_;
}

// Fixed nodes keep an identity row, so that the solver needs no other pattern.
void SoftBody::hold_fixed_nodes() {
  if (free_nodes.size() == is_fixed.size()) return;
  if (!driven.empty()) multiply(tangent, prescribed, driven_pull_);
  asset->model().hold_nodes(is_fixed, tangent);
}

// Fixed nodes move by this share of what is prescribed; what their motion does to the others goes to
// the right side.
void SoftBody::prescribe_load(double share) {
  if (free_nodes.size() == is_fixed.size()) return;
  if (!driven.empty()) load -= share * driven_pull_;
  for (Index node = 0; node < asset->model().node_count(); ++node) {
    if (!is_fixed[node]) continue;
    if (driven.empty())
      node_entry(load, node).setZero();
    else
      node_entry(load, node) = share * node_entry(prescribed, node);
  }
}

void SoftBody::add_inertia(const StepRule& rule) {
  const CorotationalModel& model = asset->model();
  const double h = rule.time_step_s;
  switch (rule.integrator) {
    case Integrator::implicit_euler:
      for (Index node = 0; node < model.node_count(); ++node)
        node_entry(load, node) += model.masses()[node] / h * node_entry(v, node);
      break;
    case Integrator::bdf2:
      add_history(rule);
      break;
    case Integrator::quasi_static:
      break;
    case Integrator::explicit_euler:
      for (Index node = 0; node < model.node_count(); ++node)
        node_entry(load, node) +=
            model.masses()[node] * (1 / h - model.rayleigh_mass_per_s()) * node_entry(v, node);
      break;
  }
  prescribe_load(1);
}

Eigen::VectorXd& SoftBody::begin_history() {
  history.load = load;
  return history.load;
}

// The history that a body at x with velocity v and acceleration a would have: x - h v + h^2 a / 2 and
// v - h a. The acceleration is that of an implicit Euler step of 2 h / 3, which has the matrix at hand;
// it differs from a at the start by O(h), so that the order stays two, and is bounded for stiff modes.
void SoftBody::start_history(const StepRule& rule, const FreeMotionSettings& settings) {
  const CorotationalModel& model = asset->model();
  const double h = rule.time_step_s, k = euler_step_of_bdf2(h);
  load.swap(history.load);
  for (Index node = 0; node < model.node_count(); ++node)
    node_entry(load, node) += model.masses()[node] / k * node_entry(v, node);
  prescribe_load(k / h);
  motion = k * v;
  for (Index node = 0; node < model.node_count(); ++node)
    if (is_fixed[node]) node_entry(motion, node) = node_entry(load, node);
  (void)solve_from_motion(h, settings);
  load.swap(history.load);
  history.velocity = motion / k - v;  // k a
  for (Index node = 0; node < model.node_count(); ++node)
    if (is_fixed[node]) node_entry(history.velocity, node).setZero();
  history.motion = h * v - (h * h / (2 * k)) * history.velocity;
  history.velocity = v - (h / k) * history.velocity;
  history.valid = history.begun = true;
  // The damping that prepare_free_motion could not know yet: forces of damped_shape less those of x.
  model.add_elastic_forces(damped_shape(rule), element_rotations, corner_forces, load);
  rest_frame.setZero();
  model.add_elastic_forces(x, element_rotations, corner_forces, rest_frame);
  load -= rest_frame;
}

// A dx = f + M (3 dx_n / (4 h^2) + (4 v_n - v_n-1) / (2 h)) + B dx_n / (2 h), from
// v_n+1 = (3 dx - dx_n) / (2 h) and M (3 v_n+1 - 4 v_n + v_n-1) / (2 h) = f - K dx - B v_n+1. The part
// of K in B is in the elastic forces already, see damped_shape.
void SoftBody::add_history(const StepRule& rule) {
  const CorotationalModel& model = asset->model();
  const double h = rule.time_step_s, alpha = model.rayleigh_mass_per_s();
  const double of_motion = 3 / (4 * h * h) + alpha / (2 * h);
  for (Index node = 0; node < model.node_count(); ++node)
    node_entry(load, node) +=
        model.masses()[node] *
        (of_motion * node_entry(history.motion, node) +
         (4 * node_entry(v, node) - node_entry(history.velocity, node)) / (2 * h));
}

SolveReport SoftBody::solve_free_motion(const StepRule& rule, const FreeMotionSettings& settings) {
  if (rule.integrator == Integrator::quasi_static)
    motion.setZero();
  else
    motion = rule.time_step_s * v;
  if (!driven.empty())
    for (const DrivenNodes& part : driven)
      for (const Index node : part.nodes) node_entry(motion, node) = node_entry(prescribed, node);
  const auto report = solve_from_motion(rule.time_step_s, settings);
  if (rule.integrator == Integrator::bdf2) history.free_motion = motion;
  return report;
}

bool SoftBody::make_inverse() {
  if (inverse) return true;
  if (!factor)
    inverse = solver->current_factor();
  else if (factor->factorize(tangent))
    inverse = &*factor;
  ++inverse_number;
  return inverse != nullptr;
}

SolveReport SoftBody::solve_from_motion(double h, const FreeMotionSettings& settings) {
  // At rest the load vanishes by cancellation; its size is then judged against the inertia that one
  // micrometre-per-second would have, so that the solver does not chase round-off.
  const double floor = mass_norm_ * 1e-6 / h;
  return solver->solve(
      load, {settings.tolerance, std::max(load.norm(), floor), settings.max_iterations}, motion);
}

void SoftBody::take_motion(const StepRule& rule, bool struck) {
  const double h = rule.time_step_s;
  if (rule.integrator == Integrator::bdf2)
    take_bdf2_velocity(h, struck);
  else
    v = motion / h;
  history.begun = false;
  x += motion;
  for (const DrivenNodes& part : driven)
    part.place(rule.time_s + h, asset->model().rest_positions(), x);
}

// An impulse changes the velocity by its motion over h, where BDF2 would take 3/2 of it and remember
// the velocity from before: the body would be thrown back. So the past is given the same jump: what the
// body did before it was struck looks as if it had always moved as it does now. Where even that speeds
// the body up, the acceleration of the free motion, which the contact has ended, is left out as well.
void SoftBody::take_bdf2_velocity(double h, bool struck) {
  rest_frame = v;
  const double before = struck ? kinetic_energy() : 0;
  v = (3 * motion - history.motion) / (2 * h);
  if (struck) {
    v -= (motion - history.free_motion) / (2 * h);
    rest_frame += (motion - history.free_motion) / h;
    if (kinetic_energy() > before) rest_frame = v = motion / h;
  }
  history.velocity = rest_frame;
  history.motion = motion;
}

}  // namespace souple
