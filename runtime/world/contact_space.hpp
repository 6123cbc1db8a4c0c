// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "runtime/compliance/contact_blocks.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/contact/delassus_block.hpp"
#include "runtime/contact/delassus_operator.hpp"
#include "runtime/world/bodies.hpp"

namespace souple {

/// The contacts of a step as one soft body sees them: which of its nodes touch, with what weight, the
/// compliance between them, and what it adds to W. Keeps its memory from step to step.
class BodyContacts {
 public:
  /// Collects the movable nodes of body `index` from those of its `contacts` that `own` counts,
  /// ascending.
  void collect(std::uint32_t index, const SoftBody& body, std::span<const Contact> contacts,
               std::span<const std::uint32_t> own);
  bool empty() const { return touches_.empty(); }
  /// Of the problem, those that move this body.
  std::span<const std::uint32_t> contacts() const { return contacts_; }
  DelassusBlock& block() { return block_; }
  const DelassusBlock& block() const { return block_; }

  /// Whether the compliance blocks that these nodes and the correction need are in memory; asks for
  /// them if not.
  bool ready(const SoftBody& body) const;
  /// C on the contact nodes in the rest frame; blocks between nodes that touched before are kept ...
  void evaluate_warped(const SoftBody& body);
  /// ... or in world coordinates, columns of the inverse of the present tangent, which has been
  /// factorised (eq. 4.16).
  void evaluate_exact(const SoftBody& body);
  /// The block is then H C H^T, warped to the world (METHOD 4.2): all but the rigid motions of a free
  /// body times `relaxation`.
  void build_warped(const SoftBody& body, double relaxation);
  void build_exact();

  /// load += H^T f, f in contact frames (3 per contact of the problem).
  void add_forces(std::span<const double> force, Eigen::VectorXd& load) const;
  /// gap += H dx, 3 per contact of the problem.
  void add_motion(const Eigen::VectorXd& motion, std::span<double> gap) const;
  /// motion += C H^T f with the same compliance that W was built from, on all nodes.
  void correct_warped(SoftBody& body, double relaxation, std::span<const double> force);
  void correct_exact(SoftBody& body, std::span<const double> force) const;

 private:
  Vec3 world_force(const Touch& touch, std::span<const double> force) const;
  bool collect_rest_forces(const SoftBody& body, std::span<const double> force);
  void relax_motion(SoftBody& body, double relaxation) const;

  std::vector<std::uint32_t> contacts_;
  std::vector<Mat3> frames_;    ///< of contacts_
  std::vector<Touch> touches_;  ///< their contacts are places in contacts_
  DelassusBlock block_;
  std::vector<Index> nodes_, rows_, identity_;
  std::vector<Mat3> rotations_;
  ContactBlocks blocks_;            ///< warped
  std::vector<double> compliance_;  ///< exact: of these rows and of this inverse of the body
  std::vector<Index> evaluated_rows_;
  std::uint64_t evaluated_inverse_ = 0;
  InverseBlockWork inverse_work_;
  std::vector<Vec3> points_;  ///< rest positions of the nodes, m
  DelassusWork<float> warped_work_;
  DelassusWork<double> exact_work_;
  // Of the correction: the nodes that carry force.
  std::vector<Index> loaded_nodes_, loaded_rows_;
  std::vector<double> node_force_, rest_force_, rest_motion_;
  ComplianceWork compliance_work_;
};

}  // namespace souple
