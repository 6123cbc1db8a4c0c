// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// What stays the same of a contact from step to step: a node of one body against another body.
struct ContactKey {
  std::uint32_t body_a = 0;
  Index node = 0;
  std::uint32_t body_b = 0;
  friend auto operator<=>(const ContactKey&, const ContactKey&) = default;
};

/// The point of one body in a contact: barycentric over nodes, or, with no nodes, a rigid body's point.
struct ContactSide {
  std::uint32_t body = 0;
  int count = 0;
  std::array<Index, 3> node{};
  std::array<double, 3> weight{};
};

/// One pair of close points (METHOD 4): frame columns n, t, s in world coordinates, n from B to A.
struct Contact {
  ContactKey key;
  ContactSide a, b;
  Mat3 frame = Mat3::Identity();
  Vec3 point = Vec3::Zero();  ///< on body B at the start of the step, m
  double gap = 0;             ///< at the start of the step, m; < 0 penetrates
  double friction = 0;
  Vec3 driven_motion = Vec3::Zero();  ///< of B's point in this step, if B is rigid, m
};

/// An orthonormal frame whose first column is the unit vector `normal`.
Mat3 contact_frame(const Vec3& normal);

/// The contact problem of a step as it was solved; valid until the next step. Contact i has rows 3i
/// (normal), 3i+1, 3i+2 (tangential) in its frame: gap_after = W force + free_gap, where free_gap is
/// the gap and slip that no contact force at all would leave.
struct ContactProblemView {
  std::span<const Contact> contacts;
  std::span<const double> delassus;  ///< W, row-major (3m) x (3m), m/N
  std::span<const double> free_gap;  ///< 3m, m
  std::span<const double> friction;  ///< m
  std::span<const double> force;     ///< 3m, N
};

}  // namespace souple
