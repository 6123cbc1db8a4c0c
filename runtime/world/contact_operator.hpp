// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/contact/contact.hpp"
#include "runtime/contact/delassus_block.hpp"
#include "runtime/world/contact_space.hpp"
#include "runtime/world/rigid_body.hpp"

namespace souple {

/// The contacts of a step as one free rigid body sees them: its part of W in six numbers instead of a
/// matrix.
class RigidContacts {
 public:
  void collect(std::uint32_t index, const RigidBody& body, std::span<const Contact> contacts,
               std::span<const std::uint32_t> own);
  std::span<const std::uint32_t> contacts() const { return contacts_; }

  /// Gap per shift and per rotation vector of the body.
  Mat3 jacobian_of_shift(std::size_t local) const { return levers_[local].frame.transpose(); }
  Mat3 jacobian_of_turn(std::size_t local) const { return jacobian_of_turn(levers_[local]); }
  double shift_compliance() const { return shift_compliance_; }     ///< m/N
  const Mat3& turn_compliance() const { return turn_compliance_; }  ///< rad/(N m)

  Mat3 diagonal_block(std::size_t local) const;
  void clear_gap();
  Vec3 gap(std::size_t local) const;
  void add_influence(std::size_t local, const Vec3& change);
  void add_to_base(std::size_t local, const Vec3& force) { add_influence(local, force); }

 private:
  struct Lever {
    Mat3 frame;  ///< signed
    Vec3 arm;
  };
  Mat3 jacobian_of_turn(const Lever& lever) const;

  std::vector<std::uint32_t> contacts_;
  std::vector<Lever> levers_;
  double shift_compliance_ = 0;
  Mat3 turn_compliance_ = Mat3::Zero();
  Vec3 shift_ = Vec3::Zero(), turn_ = Vec3::Zero();  ///< that the forces cause
};

/// The Delassus operator of a step: W = sum over the bodies of H C H^T, kept as what every body adds
/// over its own contacts. Two contacts meet in it only through a body that both move.
class StepContactOperator {
  struct Link {
    DelassusBlock* soft = nullptr;
    RigidContacts* rigid = nullptr;
    std::size_t local = 0;
    std::uint32_t body = 0;  ///< in the order of add()
  };

 public:
  /// Memory of gather; nothing is allocated once it has grown.
  class GatherWork {
    friend class StepContactOperator;
    struct Member {
      Link link;
      std::uint32_t place = 0;
    };
    std::vector<Member> members;
    std::vector<float> motion, influence;  ///< of a rigid body: 6 rows of J^T, and of C J^T
  };

  void begin(std::size_t contact_count);
  void add(BodyContacts& body);
  void add(RigidContacts& body);

  std::size_t size() const { return links_.size(); }
  Mat3 diagonal_block(std::size_t i) const;
  void clear_gap(std::size_t i);  ///< of all contacts that share a body with this one
  Vec3 gap(std::size_t i) const;  ///< W f of the forces added
  void add_influence(std::size_t i, const Vec3& change);
  /// The same in full precision.
  void add_to_base(std::size_t i, const Vec3& force);
  /// Rows of gaps that add_influence(i) touches, of soft bodies.
  std::size_t rows_touched(std::size_t i) const;
  /// W between these contacts, in their order, added to `to`, which has 3 rows and columns for each.
  void gather(std::span<const std::uint32_t> contacts, PaddedColumns& to, GatherWork& work) const;

 private:
  using Members = std::span<const GatherWork::Member>;
  static void gather_soft(Members members, PaddedColumns& to);
  static void gather_rigid(Members members, PaddedColumns& to, GatherWork& work);
  using Links = std::array<Link, 2>;  ///< of the sides; a body that is on both sides is there once
  void link(std::size_t contact, const Link& link);
  template <class Visit>
  void for_links(std::size_t i, Visit&& visit) const {
    for (const Link& link : links_[i]) {
      if (link.soft) visit(*link.soft, link.local);
      if (link.rigid) visit(*link.rigid, link.local);
    }
  }

  std::vector<Links> links_;
  std::uint32_t bodies_ = 0;
};

/// The rows of some contacts of a step, none of which shares a movable body with any other: what the
/// solvers of runtime/contact take (ContactOperator).
class IslandOperator {
 public:
  /// `free_gap`: 3 per contact of the step.
  IslandOperator(StepContactOperator& all, std::span<const std::uint32_t> contacts,
                 std::span<const double> free_gap)
      : all_(all), contacts_(contacts), free_gap_(free_gap) {}

  std::size_t size() const { return contacts_.size(); }
  Mat3 diagonal_block(std::size_t i) const { return all_.diagonal_block(contacts_[i]); }
  void start(std::span<const double> force);
  void refresh(std::span<const double> force) { start(force); }
  Vec3 gap(std::size_t i) const {
    const std::size_t row = 3 * std::size_t(contacts_[i]);
    return all_.gap(contacts_[i]) + Vec3(free_gap_[row], free_gap_[row + 1], free_gap_[row + 2]);
  }
  void add_influence(std::size_t i, const Vec3& change) { all_.add_influence(contacts_[i], change); }
  const StepContactOperator& step() const { return all_; }
  std::uint32_t contact(std::size_t i) const { return contacts_[i]; }  ///< of the step

 private:
  StepContactOperator& all_;
  std::span<const std::uint32_t> contacts_;
  std::span<const double> free_gap_;
};

}  // namespace souple
