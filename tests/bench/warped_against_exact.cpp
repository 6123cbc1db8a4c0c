// SPDX-License-Identifier: GPL-3.0-or-later
// Warped against exact compliance: the shape error of the drop scene, and W and forces of a turned
// body.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/contact/contact.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"
#include "tests/bench/shape_error.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

double shape_error(const DropScene& scene, const DropScene& reference, const Points& rest) {
  return bench::shape_error(as_matrix(scene.world.positions(scene.body)),
                            as_matrix(reference.world.positions(reference.body)), rest);
}

struct Variant {
  int passes = 1;
  double shape_error = 0;       ///< at the largest deformation of the reference
  std::vector<double> step_ms;  ///< of the steps in contact
};

struct ImpactResult {
  std::vector<Variant> variants{{1, 0, {}}, {2, 0, {}}, {4, 0, {}}};
  std::vector<double> warped_ms, exact_ms;  ///< compliance phase of the steps in contact
};

WorldSettings settings_with(ContactMethod method, int passes = 1) {
  WorldSettings settings;
  settings.contact_method = method;
  settings.contact_passes = passes;
  return settings;
}

// All from the same start to the deepest point of the first impact, when the elastic energy is largest.
ImpactResult compare_impact(const std::shared_ptr<const SoftBodyAsset>& liver) {
  const Points rest = as_matrix(liver->model().rest_positions());
  ImpactResult result;
  DropScene exact = make_drop(liver, settings_with(ContactMethod::exact));
  std::vector<DropScene> warped;
  for (const Variant& v : result.variants)
    warped.push_back(make_drop(liver, settings_with(ContactMethod::warped, v.passes)));
  double largest = 0;
  for (int k = 0; k < 40; ++k) {
    const StepReport e = value_or_exit(exact.world.step());
    if (e.contact_count > 0) result.exact_ms.push_back(1e3 * e.times.compliance_s);
    const bool deepest_yet = e.elastic_energy_j > largest;
    largest = std::max(largest, e.elastic_energy_j);
    for (std::size_t v = 0; v < warped.size(); ++v) {
      const StepReport w = value_or_exit(warped[v].world.step());
      if (w.contact_count > 0) result.variants[v].step_ms.push_back(1e3 * w.times.total_s);
      if (w.contact_count > 0 && v == 0) result.warped_ms.push_back(1e3 * w.times.compliance_s);
      if (deepest_yet) result.variants[v].shape_error = shape_error(warped[v], exact, rest);
    }
  }
  return result;
}

// The same contact history for both: the exact method until the body lies there, then each goes on by
// itself until all motion has died. What is left is the error of the equilibrium that warping finds.
double compare_rest(const std::shared_ptr<const SoftBodyAsset>& liver, int shared_steps) {
  DropScene exact = make_drop(liver, settings_with(ContactMethod::exact));
  for (int k = 0; k < shared_steps; ++k) value_or_exit(exact.world.step());
  DropScene warped = make_drop(liver, settings_with(ContactMethod::warped));
  if (auto status = warped.world.copy_state(exact.world); !status) exit_with(status.issue());
  for (int k = shared_steps; k < 1000; ++k) {
    value_or_exit(exact.world.step());
    value_or_exit(warped.world.step());
  }
  return shape_error(warped, exact, as_matrix(liver->model().rest_positions()));
}

struct TurnedError {
  double delassus = 0, force = 0;
};

// One step of the turned rest shape pressed 2 mm into the floor, both ways.
TurnedError compare_turned(const std::shared_ptr<const SoftBodyAsset>& liver, double degrees,
                           const Vec3& axis) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
  double lowest = INFINITY;
  for (const Point& p : liver->model().rest_positions())
    lowest = std::min(lowest, (turn * as_vec3(p)).z());
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

void print_turned(const std::string& part, const std::shared_ptr<const SoftBodyAsset>& liver,
                  const ResultHash& hash) {
  for (const double degrees : {60.0, 180.0}) {
    TurnedError worst;
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(1, 2, 3)}) {
      const TurnedError turned = compare_turned(liver, degrees, axis);
      worst = {std::max(worst.delassus, turned.delassus), std::max(worst.force, turned.force)};
    }
    const std::string name = part + std::to_string(int(degrees));
    print_row(name + ".delassus_error", "1", worst.delassus, hash);
    print_row(name + ".force_error", "1", worst.force, hash);
  }
}

}  // namespace

int main() {
  const auto liver = baked_liver(1300, 1);
  const ImpactResult impact = compare_impact(liver);
  const double rest_error = compare_rest(liver, 400), early_error = compare_rest(liver, 100);
  ResultHash hash;
  hash.add(std::vector<double>{impact.variants[0].shape_error, rest_error});
  for (const Variant& v : impact.variants) {
    const std::string passes = ".passes_" + std::to_string(v.passes);
    print_row("exact.shape_error_largest" + passes, "%", 100 * v.shape_error, hash);
    print_row("exact.step" + passes, "ms", v.step_ms, hash);
  }
  print_row("exact.shape_error_rest", "%", 100 * rest_error, hash);
  print_row("exact.shape_error_rest.own_bounces", "%", 100 * early_error, hash);
  print_row("exact.compliance_warped", "ms", impact.warped_ms, hash);
  print_row("exact.compliance_exact", "ms", impact.exact_ms, hash);
  // Plain scalars show what warping loses, the stored default what compression adds.
  print_turned("turned.", baked_liver(1300, 1, 0), hash);
  print_turned("turned_compressed.", liver, hash);
  return 0;
}
