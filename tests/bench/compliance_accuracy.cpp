// SPDX-License-Identifier: GPL-3.0-or-later
// What the error of a compressed compliance does to contact: forces and shapes of the drop and the grip
// scene against the uncompressed one, from tolerance 1e-1 to 1e-6. Writes the curve of bytes against
// error as compliance_accuracy.csv and .svg into the folder that it is given.
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "formats/write/asset_writer.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "tests/bench/accuracy_plot.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"
#include "tests/bench/shape_error.hpp"
#include "tools/compliance/precompute.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr int step_count = 60;
constexpr std::array<double, 6> tolerances{1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};

std::string name_of(double tolerance) {
  char text[16];
  std::snprintf(text, sizeof text, "%.0e", tolerance);
  return text;
}

// Adds the compliance at each tolerance to an asset that holds the uncompressed one. Those that single
// precision cannot resolve are refused and left out.
std::vector<AccuracyPoint> add_compliances(Asset& asset) {
  std::vector<AccuracyPoint> held;
  for (const double tolerance : tolerances) {
    CompliancePrecomputeOptions options;
    options.name = name_of(tolerance);
    options.tolerance = tolerance;
    auto variant =
        precompute_compliance(asset.levels.back(), nullptr, asset.material, nullptr, options, {});
    if (!variant && variant.issue().code == IssueCode::compliance_tolerance_missed) {
      std::fprintf(stderr, "%s\n", format_issue(variant.issue()).c_str());
      continue;
    }
    asset.compliances.push_back(value_or_exit(std::move(variant)));
    held.push_back({tolerance, double(asset.compliances.back().payload.size()), {}, {}});
  }
  return held;
}

// Two boxes close on the narrow side of the body, hold it and lift it.
DropScene make_grip(std::shared_ptr<const SoftBodyAsset> liver, const WorldSettings& settings) {
  DropScene scene{value_or_exit(World::create(settings)), {}};
  Eigen::AlignedBox3d box;
  for (const Point& p : liver->model().rest_positions()) box.extend(Vec3(as_vec3(p)));
  Eigen::Index axis = 0;
  box.sizes().minCoeff(&axis);
  SoftBodyDescription body;
  body.name = "liver";
  scene.body = value_or_exit(scene.world.add_soft_body(std::move(liver), body));
  const double squeeze = 0.1 * box.sizes()[axis], thickness = 0.02;
  for (const int side : {-1, 1}) {
    RigidBodyDescription jaw;
    jaw.name = side < 0 ? "left jaw" : "right jaw";
    jaw.shape.kind = RigidShapeKind::box;
    jaw.shape.half_extents_m = {0.04, 0.04, 0.04};
    jaw.shape.half_extents_m[std::size_t(axis)] = thickness;
    Vec3 open = box.center();
    open[axis] += side * (0.5 * box.sizes()[axis] + thickness + 1e-4);
    Vec3 closed = open;
    closed[axis] -= side * squeeze;
    const Vec3 lifted = closed + Vec3(0, 0, 0.02);
    jaw.path = {{0, Pose{{1, 0, 0, 0}, as_point(open)}},
                {0.2, Pose{{1, 0, 0, 0}, as_point(closed)}},
                {0.3, Pose{{1, 0, 0, 0}, as_point(closed)}},
                {0.6, Pose{{1, 0, 0, 0}, as_point(lifted)}}};
    value_or_exit(scene.world.add_rigid_body(jaw));
  }
  return scene;
}

using MakeScene = DropScene (*)(std::shared_ptr<const SoftBodyAsset>, const WorldSettings&);

// Forces by node of the body, world coordinates, N.
std::map<Index, Vec3> node_forces(const World& world) {
  std::map<Index, Vec3> forces;
  const auto problem = world.contact_problem();
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const Vec3 f = problem.contacts[i].frame * Eigen::Map<const Vec3>(problem.force.data() + 3 * i);
    auto [entry, added] = forces.try_emplace(problem.contacts[i].key.feature_a, Vec3::Zero());
    entry->second += f;
  }
  return forces;
}

struct ForceDifference {
  double difference2 = 0, reference2 = 0;
  void add(const std::map<Index, Vec3>& forces, const std::map<Index, Vec3>& reference) {
    for (const auto& [node, f] : reference) {
      const auto own = forces.find(node);
      difference2 += (own == forces.end() ? f : Vec3(own->second - f)).squaredNorm();
      reference2 += f.squaredNorm();
    }
    for (const auto& [node, f] : forces)
      if (!reference.contains(node)) difference2 += f.squaredNorm();
  }
  double relative() const { return reference2 > 0 ? std::sqrt(difference2 / reference2) : 0; }
};

// Forces from the same state at every step; the shape by the scene's own history.
SceneError compare(MakeScene make, const std::shared_ptr<const SoftBodyAsset>& liver,
                   const std::shared_ptr<const SoftBodyAsset>& exact) {
  DropScene reference = make(exact, {}), same_history = make(liver, {}), own_history = make(liver, {});
  const Points rest = as_matrix(exact->model().rest_positions());
  ForceDifference forces;
  SceneError error;
  double largest = 0;
  for (int k = 0; k < step_count; ++k) {
    if (auto status = same_history.world.copy_state(reference.world); !status)
      exit_with(status.issue());
    const StepReport report = value_or_exit(reference.world.step());
    value_or_exit(same_history.world.step());
    value_or_exit(own_history.world.step());
    forces.add(node_forces(same_history.world), node_forces(reference.world));
    if (report.elastic_energy_j <= largest) continue;
    largest = report.elastic_energy_j;
    error.shape = shape_error(as_matrix(own_history.world.positions(own_history.body)),
                              as_matrix(reference.world.positions(reference.body)), rest);
  }
  error.force = forces.relative();
  return error;
}

}  // namespace

int main(int count, char** arguments) {
  Recipe recipe = liver_recipe(10000, 1);
  recipe.compliances = {{}};
  recipe.compliances[0].name = "exact";
  recipe.compliances[0].tolerance = 0;
  Asset asset = bake_or_exit(recipe).asset;
  std::vector<AccuracyPoint> curve = add_compliances(asset);
  const auto bytes = value_or_exit(write_asset_memory(asset));
  const auto load = [&](const std::string& name) {
    LoadOptions options;
    options.compliances = {name};
    return value_or_exit(load_soft_body(value_or_exit(AssetReader::open_memory(bytes)), options));
  };
  const auto exact = load("exact");
  ResultHash hash;
  for (AccuracyPoint& point : curve) {
    const auto liver = load(name_of(point.tolerance));
    point.drop = compare(make_drop, liver, exact);
    point.grip = compare(make_grip, liver, exact);
    hash.add(
        std::vector<double>{point.drop.force, point.drop.shape, point.grip.force, point.grip.shape});
    const std::string at = "." + name_of(point.tolerance);
    print_row("accuracy.bytes" + at, "MB", point.bytes / 1e6, hash);
    print_row("accuracy.drop_force" + at, "%", 100 * point.drop.force, hash);
    print_row("accuracy.drop_shape" + at, "%", 100 * point.drop.shape, hash);
    print_row("accuracy.grip_force" + at, "%", 100 * point.grip.force, hash);
    print_row("accuracy.grip_shape" + at, "%", 100 * point.grip.shape, hash);
  }
  if (count > 1) write_accuracy(curve, arguments[1]);
  return 0;
}
