// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "runtime/compliance/rigid_modes.hpp"
#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// One node of a body in one contact: an entry of the contact Jacobian H.
struct Touch {
  Index contact = 0;
  Index node = 0;     ///< counted among the body's contact nodes
  double weight = 0;  ///< barycentric; negative on side B
};

/// C between the contact nodes of a body: block (a, b) is row-major at values + 3 slot[a] stride +
/// 3 slot[b]. It is symmetric: only blocks with slot[b] <= slot[a] are read.
template <class Scalar>
struct NodeCompliance {
  const Scalar* values = nullptr;
  std::size_t stride = 0;
  std::span<const Index> slot;  ///< of every contact node, 0 <= slot < their count
};

/// The contacts of one body. `frames` holds the frame of every contact, columns n, t, s.
struct ContactGeometry {
  std::span<const Touch> touches;   ///< ascend by contact
  std::span<const Mat3> frames;     ///< of every contact of the problem
  std::span<const Mat3> rotations;  ///< of every contact node: R in C = R C0 R^T
};

/// Where W is written: row-major, symmetric.
template <class Target>
struct DelassusTarget {
  Target* values = nullptr;
  std::size_t stride = 0;  ///< between rows
};

/// Scratch memory; nothing is allocated once it has grown.
template <class Scalar>
struct DelassusWork {
  std::vector<Scalar> jacobian;    ///< weight frame^T rotation of every touch, padded
  std::vector<Scalar> rows;        ///< three rows of G C0
  std::vector<std::size_t> slot;   ///< first row of the node of every touch
  std::vector<std::size_t> group;  ///< first touch of every contact that has any, and their count
};

/// Adds factor H R C0 R^T H^T of one body to the lower block triangle of the Delassus operator W
/// (3m x 3m): compliance warping (METHOD 4.2) in one pass over half of C0. With C0 = L +
/// L^T, L its lower half with half of the diagonal blocks, it adds X + X^T, X = factor G L G^T, G = H
/// R. W is symmetric to the bit after mirror_delassus.
template <class Scalar, class Target>
void add_to_delassus(const ContactGeometry& body, const NodeCompliance<Scalar>& compliance,
                     double factor, const DelassusTarget<Target>& delassus, DelassusWork<Scalar>& work);

/// Adds factor H R C_rigid R^T H^T, C_rigid the rigid motions' part between contact nodes at the rest
/// positions `points`, to the same triangle.
template <class Target>
void add_rigid_to_delassus(const ContactGeometry& body, const RigidModes& modes,
                           std::span<const Vec3> points, double factor,
                           const DelassusTarget<Target>& delassus, DelassusWork<double>& work);

/// Copies the lower triangle to the upper one.
template <class Target>
void mirror_delassus(std::size_t contact_count, const DelassusTarget<Target>& delassus);

}  // namespace souple
