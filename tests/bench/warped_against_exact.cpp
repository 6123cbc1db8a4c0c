// SPDX-License-Identifier: GPL-3.0-or-later
// Warped against exact compliance: the shape error of the drop scene, and W and forces of a turned body.
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/contact/contact.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

using Points = Eigen::Matrix3Xd;

Points as_matrix(std::span<const Point> points) {
  return Eigen::Map<const Points>(points.front().data(), 3, Eigen::Index(points.size()));
}

// The rest shape moved rigidly as near to `x` as possible (Kabsch).
Points best_rigid_fit(const Points& rest, const Points& x) {
  const Vec3 rest_mean = rest.rowwise().mean(), mean = x.rowwise().mean();
  const Mat3 covariance = (x.colwise() - mean) * (rest.colwise() - rest_mean).transpose();
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Mat3 rotation = svd.matrixU() * flip * svd.matrixV().transpose();
  return (rotation * (rest.colwise() - rest_mean)).colwise() + mean;
}

struct ShapeError {
  double at_largest_deformation = 0, at_rest = 0;
  double exact_ms = 0, warped_ms = 0;  ///< compliance phase, median over the steps in contact
};

// ||x - x_ref|| over ||x_ref - best rigid fit of the rest shape||.
double shape_error(const Points& x, const Points& reference, const Points& rest) {
  return (x - reference).norm() / (reference - best_rigid_fit(rest, reference)).norm();
}

ShapeError compare_drops(const std::shared_ptr<const SoftBodyAsset>& liver, double friction, int steps) {
  WorldSettings settings;
  settings.friction = friction;
  DropScene warped = make_drop(liver, settings);
  settings.contact_method = ContactMethod::exact;
  DropScene exact = make_drop(liver, settings);
  const Points rest = as_matrix(liver->model().rest_positions());
  ShapeError result;
  double largest = 0;
  std::vector<double> warped_ms, exact_ms;
  for (int k = 0; k < steps; ++k) {
    const StepReport w = value_or_exit(warped.world.step()), e = value_or_exit(exact.world.step());
    if (e.contact_count > 0) {
      warped_ms.push_back(1e3 * w.times.compliance_s);
      exact_ms.push_back(1e3 * e.times.compliance_s);
    }
    const Points x = as_matrix(warped.world.positions(warped.body));
    const Points reference = as_matrix(exact.world.positions(exact.body));
    result.at_rest = shape_error(x, reference, rest);
    if (e.elastic_energy_j < largest) continue;
    largest = e.elastic_energy_j;
    result.at_largest_deformation = result.at_rest;
  }
  result.warped_ms = median(warped_ms);
  result.exact_ms = median(exact_ms);
  return result;
}

struct TurnedError {
  double delassus = 0, force = 0;
};

// One step of the turned rest shape pressed 2 mm into the floor, both ways.
TurnedError compare_turned(const std::shared_ptr<const SoftBodyAsset>& liver, double degrees, const Vec3& axis) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
  double lowest = INFINITY;
  for (const Point& p : liver->model().rest_positions()) lowest = std::min(lowest, (turn * as_vec3(p)).z());
  std::vector<double> delassus[2], force[2];
  for (const auto method : {ContactMethod::warped, ContactMethod::exact}) {
    WorldSettings settings;
    settings.contact_method = method;
    World world = value_or_exit(World::create(settings));
    SoftBodyDescription body;
    body.pose.rotation = {turn.w(), turn.x(), turn.y(), turn.z()};
    body.pose.translation = {0, 0, -lowest - 0.002};
    body.velocity_m_s = {0.2, 0.1, -0.1};
    value_or_exit(world.add_soft_body(liver, body));
    RigidBodyDescription floor;
    floor.path = {{0, {}}};
    value_or_exit(world.add_rigid_body(floor));
    value_or_exit(world.step());
    const auto problem = world.contact_problem();
    delassus[std::size_t(method)].assign(problem.delassus.begin(), problem.delassus.end());
    force[std::size_t(method)].assign(problem.force.begin(), problem.force.end());
  }
  const auto relative = [](const std::vector<double>& a, const std::vector<double>& b) {
    double difference = 0, norm = 0;
    for (std::size_t k = 0; k < b.size(); ++k) {
      difference += (a[k] - b[k]) * (a[k] - b[k]);
      norm += b[k] * b[k];
    }
    return a.size() == b.size() && norm > 0 ? std::sqrt(difference / norm) : INFINITY;
  };
  return {relative(delassus[0], delassus[1]), relative(force[0], force[1])};
}

}  // namespace

int main() {
  const auto liver = baked_liver(2500, 2);
  ResultHash hash;
  const ShapeError error = compare_drops(liver, 0.4, 1200), smooth = compare_drops(liver, 0.0, 1200);
  hash.add(std::vector<double>{error.at_largest_deformation, error.at_rest, smooth.at_rest});
  print_row("exact.shape_error_largest", "%", 100 * error.at_largest_deformation, hash);
  print_row("exact.shape_error_rest", "%", 100 * error.at_rest, hash);
  print_row("exact.shape_error_largest_frictionless", "%", 100 * smooth.at_largest_deformation, hash);
  print_row("exact.shape_error_rest_frictionless", "%", 100 * smooth.at_rest, hash);
  print_row("exact.compliance_warped", "ms", error.warped_ms, hash);
  print_row("exact.compliance_exact", "ms", error.exact_ms, hash);
  for (const double degrees : {60.0, 180.0}) {
    TurnedError worst;
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(1, 2, 3)}) {
      const TurnedError turned = compare_turned(liver, degrees, axis);
      worst = {std::max(worst.delassus, turned.delassus), std::max(worst.force, turned.force)};
    }
    const std::string name = "turned." + std::to_string(int(degrees));
    print_row(name + ".delassus_error", "1", worst.delassus, hash);
    print_row(name + ".force_error", "1", worst.force, hash);
  }
  return 0;
}
