// SPDX-License-Identifier: MIT
#include "runtime/world/rigid_body.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/collision/mass_properties.hpp"
#include "runtime/collision/shape_minima.hpp"
#include "runtime/fem/cross_matrix.hpp"
#include "runtime/world/rigid_path.hpp"

namespace souple {
namespace {

Eigen::Quaterniond rotation_by(const Vec3& vector) {
  const double angle = vector.norm();
  if (!(angle > 0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

Vec3 rotation_vector(const Mat3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Status refuse(const std::string& what, const std::string& where) {
  return make_issue(IssueCode::world_parameter_invalid, what, where);
}

double longest_side_of(const RigidShape& shape) {
  if (shape.kind == RigidShapeKind::plane) return 0;
  if (shape.kind != RigidShapeKind::mesh) return shape_bounds(shape, {}).sizes().maxCoeff();
  Eigen::AlignedBox3d box;
  for (const Point& p : shape.mesh->vertices()) box.extend(Vec3(as_vec3(p)));
  return box.sizes().maxCoeff();
}

Result<FreeRigidState> make_free_state(const RigidBodyDescription& d) {
  const FreeRigidMotion& motion = *d.free;
  if (d.shape.kind == RigidShapeKind::plane)
    return refuse("a plane has no mass: it cannot move freely", d.name).issue();
  const MassProperties unit = mass_properties(d.shape);  // of 1 kg/m3
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(unit.inertia);
  Mat3 axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  FreeRigidState state;
  const double density = motion.mass_kg > 0 ? motion.mass_kg / unit.volume : motion.density_kg_m3;
  state.mass = density * unit.volume;
  state.inertia = density * principal.eigenvalues();
  if (!(state.mass > 0) || !std::isfinite(state.mass) || !(state.inertia.minCoeff() > 0) ||
      !state.inertia.allFinite())
    return refuse("a mass of " + std::to_string(state.mass) + " kg cannot be moved", d.name).issue();
  state.body_frame = {axes, unit.centre};
  const RigidPlacement at = placement(d.path.front().pose);
  state.orientation = Eigen::Quaterniond(at.rotation * axes);
  state.position = at.rotation * unit.centre + at.translation;
  state.velocity = as_vec3(motion.velocity_m_s);
  state.spin = as_vec3(motion.angular_velocity_rad_s);
  return state;
}

FreeRigidState make_held_state(const HandleCoupling& coupling, const RigidPlacement& at) {
  FreeRigidState state;
  state.body_frame.translation = as_vec3(coupling.centre_m);
  state.orientation = Eigen::Quaterniond(at.rotation);
  state.position = at.rotation * state.body_frame.translation + at.translation;
  return state;
}

}  // namespace

RigidPlacement FreeRigidState::shape_placement() const {
  RigidPlacement at;
  at.rotation = orientation.toRotationMatrix() * body_frame.rotation.transpose();
  at.translation = position - at.rotation * body_frame.translation;
  return at;
}

Mat3 FreeRigidState::world_inertia() const {
  const Mat3 r = orientation.toRotationMatrix();
  return r * inertia.asDiagonal() * r.transpose();
}

Result<RigidBody> RigidBody::create(const RigidBodyDescription& d, double time_s) {
  RigidBody body;
  body.name = d.name;
  body.shape = d.shape;
  body.path = d.path;
  body.filter = d.filter;
  body.size = longest_side_of(d.shape);
  if (d.free) {
    auto state = make_free_state(d);
    if (!state) return state.issue();
    body.free = *state;
  }
  if (d.handle) {
    const RigidPlacement at = placement(d.path.front().pose);
    body.held = HeldState{*d.handle, at, at};
    body.free = make_held_state(*d.handle, at);
  }
  if (d.shape.mesh) body.placed = std::make_unique<PlacedMesh>(*d.shape.mesh);
  body.begin_step(time_s, 0);
  return body;
}

RigidPlacement RigidBody::placement_at(double time_s) const {
  return free ? free->shape_placement() : placement(pose_at(path, time_s));
}

void RigidBody::begin_step(double time_s, double time_step_s) {
  start = placement_at(time_s);
  end = free ? start : placement_at(time_s + time_step_s);
  if (placed) placed->move_to(start);
}

RigidPlacement RigidBody::free_end() const {
  if (!free) return end;
  FreeRigidState moved = *free;
  moved.position += moved.shift;
  moved.orientation = rotation_by(moved.turn) * moved.orientation;
  return moved.shape_placement();
}

Vec3 RigidBody::driven_motion_of(const Vec3& point) const {
  return end.rotation * (start.rotation.transpose() * (point - start.translation)) + end.translation -
         point;
}

// The gyroscopic moment is taken implicitly, by one Newton step in the body frame, which cannot gain
// energy (Catto, Numerical Methods, GDC 2015).
void RigidBody::move_freely(double h, const Vec3& gravity) {
  FreeRigidState& s = *free;
  const Mat3 r = s.orientation.toRotationMatrix();
  Vec3 spin = r.transpose() * s.spin;
  const Vec3 momentum = s.inertia.cwiseProduct(spin);
  const Vec3 residual = h * spin.cross(momentum);
  const Mat3 jacobian = Mat3(s.inertia.asDiagonal()) +
                        h * (cross_matrix(spin) * s.inertia.asDiagonal() - cross_matrix(momentum));
  spin -= jacobian.partialPivLu().solve(residual);
  s.shift = h * (s.velocity + h * gravity);
  s.turn = h * (r * spin);
  s.shift_compliance = h * h / s.mass;
  s.turn_compliance = h * h * (r * s.inertia.cwiseInverse().asDiagonal() * r.transpose());
}

void RigidBody::push(const Vec3& force, const Vec3& arm) {
  free->shift += free->shift_compliance * force;
  free->turn += free->turn_compliance * arm.cross(force);
}

// K e+ + B (e+ - e) / h = f, e the place of the body less that of the hand, in the same way for
// rotation vectors: C = (K + B / h)^-1.
void RigidBody::follow_hand(double h) {
  FreeRigidState& s = *free;
  const HandleCoupling& c = held->coupling;
  const Vec3& centre = s.body_frame.translation;
  const double line = c.stiffness_n_m + c.damping_n_s_m / h;
  const double turning = c.turn_stiffness_nm_rad + c.turn_damping_nm_s_rad / h;
  const Vec3 behind = s.position - (held->now.rotation * centre + held->now.translation);
  const Vec3 target = held->next.rotation * centre + held->next.translation;
  s.shift = target + (c.damping_n_s_m / h / line) * behind - s.position;
  const Mat3 r = s.orientation.toRotationMatrix();
  const Vec3 turned_behind = rotation_vector(r * held->now.rotation.transpose());
  const Vec3 kept = (c.turn_damping_nm_s_rad / h / turning) * turned_behind;
  const Mat3 turned = rotation_by(kept).toRotationMatrix() * held->next.rotation * r.transpose();
  s.turn = rotation_vector(turned);
  s.bend = turned - Mat3::Identity() - cross_matrix(s.turn);
  s.shift_compliance = 1 / line;
  s.turn_compliance = (1 / turning) * Mat3::Identity();
}

void RigidBody::take_motion(double h) {
  FreeRigidState& s = *free;
  s.position += s.shift;
  s.orientation = (rotation_by(s.turn) * s.orientation).normalized();
  s.velocity = s.shift / h;
  s.spin = s.turn / h;
  end = s.shape_placement();
  if (held) held->now = held->next;
}

void RigidBody::stop() {
  free->velocity.setZero();
  free->spin.setZero();
}

Eigen::AlignedBox3d RigidBody::bounds() const {
  return placed ? placed->surface().bounds() : shape_bounds(shape, start);
}

BodyMotion RigidBody::motion_in(const Eigen::AlignedBox3d& region, double h) const {
  if (held) {
    const Vec3& centre = free->body_frame.translation;
    const Vec3 shift = held->next.rotation * centre + held->next.translation - free->position;
    const Eigen::Quaterniond turned =
        Eigen::Quaterniond(held->next.rotation) * free->orientation.conjugate();
    const double angle = Eigen::AngleAxisd(turned).angle();
    return {shift / h, angle / h * (std::sqrt(3.0) * size + centre.norm())};
  }
  // No point is farther from the centre of mass than the diagonal of the box.
  if (free) return {free->velocity, free->spin.norm() * std::sqrt(3.0) * size};
  BodyMotion motion;
  if (path.size() < 2) return motion;
  motion.velocity = driven_motion_of(region.center()) / h;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner = region.corner(Eigen::AlignedBox3d::CornerType(k));
    motion.deviation =
        std::max(motion.deviation, (driven_motion_of(corner) / h - motion.velocity).norm());
  }
  return motion;
}

double RigidBody::kinetic_energy() const {
  return 0.5 * free->mass * free->velocity.squaredNorm() +
         0.5 * free->spin.dot(free->world_inertia() * free->spin);
}

}  // namespace souple
