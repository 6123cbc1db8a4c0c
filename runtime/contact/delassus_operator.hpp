// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>

#include "runtime/fem/linear_algebra.hpp"

namespace souple {

/// One node of a body in one contact: an entry of the contact Jacobian H.
struct Touch {
  Index contact = 0;
  Index node = 0;     ///< counted among the body's contact nodes
  double weight = 0;  ///< barycentric; negative on side B
};

/// C_ab <- r_a C_ab r_b^T in place: from the rest frame to the world (METHOD 4.2). `compliance` is
/// (3c) x (3c), row-major; one rotation per contact node.
void warp_compliance(std::span<const Mat3> rotations, std::span<double> compliance);

/// Adds H C H^T of one body to the lower block triangle of the Delassus operator W (3m x 3m,
/// row-major). `touches` ascend by contact; `frames` holds the frame of every contact, columns n, t, s;
/// `compliance` is C on the body's contact nodes in world coordinates; `row_work` has 9c entries.
void add_to_delassus(std::span<const Touch> touches, std::span<const Mat3> frames,
                     std::span<const double> compliance, std::size_t contact_count,
                     std::span<double> delassus, std::span<double> row_work);

/// Copies the lower triangle to the upper one.
void mirror_delassus(std::size_t contact_count, std::span<double> delassus);

}  // namespace souple
