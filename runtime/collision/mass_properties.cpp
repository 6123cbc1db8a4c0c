// SPDX-License-Identifier: MIT
#include "runtime/collision/mass_properties.hpp"

#include <numbers>

#include "runtime/collision/rigid_mesh.hpp"

namespace souple {
namespace {

using std::numbers::pi;

MassProperties of_diagonal(double volume, const Vec3& inertia) {
  return {volume, Vec3::Zero(), Mat3(inertia.asDiagonal())};
}

MassProperties of_sphere(double r) {
  const double volume = 4.0 / 3 * pi * r * r * r;
  return of_diagonal(volume, Vec3::Constant(0.4 * volume * r * r));
}

MassProperties of_box(const Vec3& half) {
  const double volume = 8 * half.prod();
  const Vec3 squares = half.cwiseAbs2();
  return of_diagonal(volume, volume / 3 * (squares.sum() - squares.array()).matrix());
}

// A cylinder and two half spheres, whose centres are 3/8 r beyond its ends.
MassProperties of_capsule(double r, double half) {
  const double cylinder = 2 * half * pi * r * r, ball = 4.0 / 3 * pi * r * r * r;
  const double along = 0.5 * cylinder * r * r + 0.4 * ball * r * r;
  const double across =
      cylinder * (r * r / 4 + half * half / 3) + ball * (0.4 * r * r + half * half + 0.75 * half * r);
  return of_diagonal(cylinder + ball, {across, across, along});
}

}  // namespace

MassProperties mass_properties(const RigidShape& shape) {
  switch (shape.kind) {
    case RigidShapeKind::plane:
      return {};
    case RigidShapeKind::sphere:
      return of_sphere(shape.radius_m);
    case RigidShapeKind::box:
      return of_box(as_vec3(shape.half_extents_m));
    case RigidShapeKind::capsule:
      return of_capsule(shape.radius_m, shape.half_length_m);
    case RigidShapeKind::mesh:
      return shape.mesh ? shape.mesh->mass() : MassProperties{};
  }
  return {};
}

MassProperties mass_properties(std::span<const Point> vertices, std::span<const Triangle> triangles) {
  if (triangles.empty()) return {};
  const Vec3 origin = as_vec3(vertices[triangles[0][0]]);
  double volume6 = 0;
  Vec3 first = Vec3::Zero();   // 24 times the integral of x
  Mat3 second = Mat3::Zero();  // 120 times the integral of x x^T
  for (const Triangle& t : triangles) {
    const Vec3 a = as_vec3(vertices[t[0]]) - origin, b = as_vec3(vertices[t[1]]) - origin,
               c = as_vec3(vertices[t[2]]) - origin;
    const double determinant = a.dot(b.cross(c));
    const Vec3 sum = a + b + c;
    volume6 += determinant;
    first += determinant * sum;
    second += determinant *
              (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  MassProperties mass;
  mass.volume = volume6 / 6;
  if (!(volume6 != 0)) return mass;
  const Vec3 centre = first / (4 * volume6);
  const Mat3 about_centre = second / 120 - mass.volume * centre * centre.transpose();
  mass.centre = origin + centre;
  mass.inertia = about_centre.trace() * Mat3::Identity() - about_centre;
  return mass;
}

}  // namespace souple
