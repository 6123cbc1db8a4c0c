// SPDX-License-Identifier: MIT
// What a step leaves for a hand that wants forces between steps (METHOD 5): the contact problem of what
// the tool touches, in plain memory of a fixed size.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/collision/rigid_distance.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/contact/padded_columns.hpp"

namespace souple {

/// Two jaws are the most a tool has.
constexpr std::size_t most_jaws = 2;

/// A point of a jaw in a contact.
struct ToolTouch {
  std::int32_t jaw = -1;      ///< -1: this side of the contact is not of the tool
  Vec3 local = Vec3::Zero();  ///< in the frame of the jaw's shape, m
};

struct ToolContact {
  ContactKey key;
  Mat3 frame = Mat3::Identity();  ///< columns n, t, s in world coordinates, n from B to A
  ToolTouch a, b;                 ///< sides A (force f) and B (force -f)
  ConstraintLaw law;
};

/// Contacts in descending order of load, those that bear none in ascending order of their gap: what
/// matters to a solver lies together at the front. Rows 3i (normal), 3i+1, 3i+2 (tangential) in the
/// frame of contact i: gap = W force + free_gap.
struct ToolProblem {
  std::vector<ToolContact> contacts;
  PaddedColumns delassus;       ///< W, m/N, single precision, the tool's couplings included
  std::vector<float> free_gap;  ///< that no contact force would leave with the tool at `jaw_pose`, m
  std::vector<float> force;     ///< of the step, N
  std::vector<float> gap;       ///< W force + free_gap, m
  /// Of the shape of every jaw where no force acts on it: what the step aimed at.
  std::array<RigidPlacement, most_jaws> jaw_pose;
  std::array<std::uint32_t, most_jaws> jaw_body{};
  std::size_t jaw_count = 0;
  std::size_t left_out = 0;  ///< contacts beyond the capacity
  double world_time_s = 0;   ///< at the end of the step
  double time_step_s = 0;
  std::uint64_t sequence = 0;  ///< of the publication; 0: none

  /// Memory for so many contacts; nothing is allocated after that.
  void reserve(std::size_t contact_capacity);
  std::size_t capacity() const { return capacity_; }

 private:
  std::size_t capacity_ = 0;
};

}  // namespace souple
