// SPDX-License-Identifier: MIT
#include "runtime/contact/contact.hpp"

namespace souple {

Mat3 contact_frame(const Vec3& normal) {
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  Mat3 frame;
  frame.col(0) = normal;
  frame.col(1) = normal.cross(Vec3::Unit(least)).normalized();
  frame.col(2) = normal.cross(frame.col(1));
  return frame;
}

}  // namespace souple
