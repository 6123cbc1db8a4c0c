// SPDX-License-Identifier: MIT
#pragma once
#include <variant>
#include <vector>

#include "runtime/collision/local_minima.hpp"
#include "runtime/collision/swept_pairs.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/world/bodies.hpp"
#include "runtime/world/rigid_body.hpp"

namespace souple {

using WorldBody = std::variant<SoftBody, RigidBody>;

/// Two bodies that may touch in a step, or one that may touch itself, and what is near of theirs.
struct PairContacts {
  std::uint32_t a = 0, b = 0;
  double alarm_distance_m = 0;
  std::vector<Contact> contacts;  ///< ascending by key; frames, gaps and sides, no law yet

  ProximityWork work;
  std::vector<LocalMinimum> minima;
  std::vector<SweptPair> swept;
  Eigen::VectorXd end_a, end_b;  ///< positions
};

/// The pairs of a step; those of the last one leave their memory.
class PairList {
 public:
  void clear() { count_ = 0; }
  PairContacts& add() {
    if (count_ == pairs_.size()) pairs_.emplace_back();
    return pairs_[count_++];
  }
  std::size_t size() const { return count_; }
  PairContacts& operator[](std::size_t k) { return pairs_[k]; }

 private:
  std::vector<PairContacts> pairs_;
  std::size_t count_ = 0;
};

/// Local minimal distances below the alarm distance between the two bodies (METHOD 4), of soft bodies
/// and meshes as they were refitted last.
void find_near(const WorldBody& a, const WorldBody& b, PairContacts& pair);

/// Whether it is a surface of triangles: soft bodies and rigid meshes.
bool has_surface(const WorldBody& body);

/// Pairs that the motion so far would let through each other though they are farther apart than the
/// alarm distance, and leave more than `least_depth` (m) past each other: appended.
void find_swept(const WorldBody& a, const WorldBody& b, double least_depth, PairContacts& pair);

/// How deep the deformed surface of `soft` enters a rigid body at `at`, m, >= 0: at its nodes, and as
/// true depth of its surface: exact for planes and spheres, sampled on a grid of 10 divisions of each
/// triangle for boxes and capsules, at its nodes for meshes.
struct Depths {
  double node = 0, surface = 0;
};
Depths depths_in(const SoftBody& soft, const RigidBody& body, const RigidPlacement& at);

}  // namespace souple
