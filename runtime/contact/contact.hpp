// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/contact/local_law.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// What stays the same of a contact from step to step: a feature of one body (a node, an edge, a corner
/// of a shape) against a feature of another; -1: whatever is there.
struct ContactKey {
  std::uint32_t body_a = 0;
  Index feature_a = 0;
  std::uint32_t body_b = 0;
  Index feature_b = -1;
  friend auto operator<=>(const ContactKey&, const ContactKey&) = default;
};

/// The point of one body in a contact: barycentric over nodes, or, with no nodes, a rigid body's point.
struct ContactSide {
  std::uint32_t body = no_body;
  int count = 0;
  std::array<Index, 3> node{};
  std::array<double, 3> weight{};
  Vec3 arm = Vec3::Zero();  ///< of a free rigid body: from its centre of mass, world axes, m

  static constexpr std::uint32_t no_body = ~std::uint32_t{0};  ///< the world: moved by the application
};

/// One pair of close points (METHOD 4): frame columns n, t, s in world coordinates, n from B to A. Of a
/// joint: one pair of points to be held together.
struct Contact {
  ContactKey key;
  ContactSide a, b;
  Mat3 frame = Mat3::Identity();
  Vec3 point = Vec3::Zero();  ///< on body B at the start of the step, m
  double gap = 0;             ///< at the start of the step, m; < 0 penetrates
  ConstraintLaw law;
  double restitution = 0;
  /// Of a joint: the tangential separation of its points at the start, m. Of contacts 0: a slip is that
  /// of the step.
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  Vec3 driven_motion = Vec3::Zero();  ///< of B's point less A's in this step, where driven, m
};

/// An orthonormal frame whose first column is the unit vector `normal`.
Mat3 contact_frame(const Vec3& normal);

/// The contact problem of a step as it was solved. Contact i has rows 3i (normal), 3i+1, 3i+2
/// (tangential) in its frame: gap_after = W force + free_gap, where free_gap is the gap and slip that
/// no contact force at all would leave.
struct StepContactProblem {
  std::vector<Contact> contacts;
  std::vector<double> delassus;  ///< W, row-major (3m) x (3m), m/N
  std::vector<double> free_gap;  ///< 3m, m
  std::vector<ConstraintLaw> laws;
  std::vector<double> force;  ///< 3m, N
};

}  // namespace souple
