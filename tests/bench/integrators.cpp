// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the integrators: order, damping and cost of BDF2 beside implicit Euler on one liver that
// swings from a clamped end, and four livers stepped as jobs on two threads.
#include <cmath>
#include <cstring>

#include "formats/write/asset_writer.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"
#include "tools/scene/job_pool.hpp"

namespace souple::bench {
namespace {

using LoadedBody = std::shared_ptr<const SoftBodyAsset>;

constexpr double swing_s = 0.32;

WorldSettings settings_of(Integrator integrator, double h) {
  WorldSettings settings;
  settings.integrator = integrator;
  settings.time_step_s = h;
  settings.contact_method = ContactMethod::exact;  // nothing touches: no compliance is needed
  settings.free_motion.tolerance = 1e-10;
  return settings;
}

struct Run {
  std::vector<Point> end;
  double seconds_per_step = 0;
};

Run swing(const LoadedBody& asset, Integrator integrator, int steps) {
  World world = value_or_exit(World::create(settings_of(integrator, swing_s / steps)));
  SoftBodyDescription description;
  description.fixed_set = "held";
  const BodyId body = value_or_exit(world.add_soft_body(asset, description));
  Run run;
  run.seconds_per_step = seconds_of([&] {
                           for (int k = 0; k < steps; ++k) (void)value_or_exit(world.step());
                         }) /
                         steps;
  run.end.assign(world.positions(body).begin(), world.positions(body).end());
  return run;
}

double distance(const std::vector<Point>& a, const std::vector<Point>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) sum += std::pow(a[k][axis] - b[k][axis], 2);
  return std::sqrt(sum / double(a.size()));
}

void print_order(const LoadedBody& asset) {
  const Run reference = swing(asset, Integrator::bdf2, 512);
  ResultHash hash;
  hash.add(reference.end);
  for (const auto& [integrator, name] :
       {std::pair(Integrator::implicit_euler, "euler"), std::pair(Integrator::bdf2, "bdf2")}) {
    const std::string prefix = std::string("integrators.") + name;
    double last = 0;
    for (const int steps : {32, 64}) {
      const Run run = swing(asset, integrator, steps);
      const double error = 1e3 * distance(run.end, reference.end);
      print_row(prefix + ".error_" + std::to_string(steps), "mm", error, hash);
      if (last > 0) print_row(prefix + ".order", "1", std::log2(last / error), hash);
      last = error;
    }
  }
}

// Both in turn, so that what else the machine does falls on both.
void print_cost(const LoadedBody& asset) {
  std::vector<double> ratio;
  for (int k = 0; k < 5; ++k) {
    const double euler = swing(asset, Integrator::implicit_euler, 32).seconds_per_step;
    ratio.push_back(swing(asset, Integrator::bdf2, 32).seconds_per_step / euler);
  }
  print_row("integrators.bdf2.cost", "1", ratio, {});
}

struct Livers {
  explicit Livers(const LoadedBody& asset) : world(value_or_exit(World::create({}))) {
    for (int k = 0; k < 4; ++k) {
      SoftBodyDescription description;
      description.name = "liver" + std::to_string(k);
      description.pose.translation = {0.4 * k, 0, 0.12};
      bodies.push_back(value_or_exit(world.add_soft_body(asset, description)));
    }
    RigidBodyDescription floor;
    floor.name = "floor";
    floor.path = {{0, {}}};
    (void)value_or_exit(world.add_rigid_body(floor));
  }
  double seconds() {
    return seconds_of([&] {
      for (int k = 0; k < 10; ++k) (void)value_or_exit(world.step());
    });
  }
  World world;
  std::vector<BodyId> bodies;
};

void print_parallel(const LoadedBody& asset) {
  JobPool pool(2);
  Livers alone(asset), together(asset);
  together.world.run_jobs_with(pool.runner());
  std::vector<double> speedup;
  for (int k = 0; k < 6; ++k) {
    const double one = alone.seconds();
    speedup.push_back(one / together.seconds());
  }
  double different = 0;
  ResultHash hash;
  for (const BodyId body : alone.bodies) {
    const auto a = alone.world.positions(body), b = together.world.positions(body);
    different += std::memcmp(a.data(), b.data(), a.size_bytes()) != 0;
    hash.add(std::span<const Point>(a));
  }
  print_row("integrators.parallel.speedup", "1", speedup, hash);
  print_row("integrators.parallel.different_bodies", "1", different, hash);
}

}  // namespace
}  // namespace souple::bench

int main() {
  using namespace souple;
  using namespace souple::bench;
  Recipe recipe = liver_recipe(3000, 1);
  recipe.fixed.push_back({"held", NearestSelection{{10, 0, 0}, 40}});  // its end towards +x
  const auto bytes = value_or_exit(write_asset_memory(bake_or_exit(recipe).asset));
  auto reader = value_or_exit(AssetReader::open_memory(bytes));
  const LoadedBody liver = value_or_exit(load_soft_body(reader));
  print_order(liver);
  print_cost(liver);
  print_parallel(liver);
  return 0;
}
