// SPDX-License-Identifier: MIT
// Bodies stepped as jobs of the application: the same bits whatever runs them, in whatever order.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

RunJobs on_threads(std::size_t thread_count) {
  return [=](std::size_t count, const std::function<void(std::size_t)>& job) {
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < thread_count; ++t)
      threads.emplace_back([&] {
        for (std::size_t k = next++; k < count; k = next++) job(k);
      });
    for (auto& thread : threads) thread.join();
  };
}

// A heap of boxes that fall on each other, a ball and a plane; all of one asset.
struct Heap {
  explicit Heap(const WorldSettings& settings) : world(make_world(settings)) {
    const auto asset =
        make_body(irregular_box_mesh({2, 2, 2}, {-0.05, -0.05, -0.05}, {0.1, 0.1, 0.1}, 0.5),
                  material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01);
    for (int k = 0; k < 6; ++k)
      bodies.push_back(add_soft(world, asset, {0.02 * (k % 2), 0.015 * (k % 3), 0.11 + 0.14 * k},
                                turned(11 * k, {0.2, 0.1, 2})));
    add_plane(world);
    add_sphere(world, 0.04, {0.05, 0, 0.02});
  }
  World world;
  std::vector<BodyId> bodies;
};

struct Outcome {
  std::vector<Point> state;
  std::size_t most_contacts = 0;
  std::vector<double> figures;
  bool operator==(const Outcome&) const = default;
};

Outcome run(const WorldSettings& settings, RunJobs jobs) {
  Heap heap(settings);
  heap.world.run_jobs_with(std::move(jobs));
  Outcome outcome;
  for (int k = 0; k < 50; ++k) {
    const StepReport r = step(heap.world);
    outcome.most_contacts = std::max(outcome.most_contacts, r.active_count);
    outcome.figures.insert(outcome.figures.end(),
                           {r.kinetic_energy_j, r.elastic_energy_j, r.contact_residual,
                            r.angular_momentum_kg_m2_s[0], double(r.free_motion_iterations)});
  }
  for (const BodyId body : heap.bodies)
    for (const auto points : {heap.world.positions(body), heap.world.velocities(body)})
      outcome.state.insert(outcome.state.end(), points.begin(), points.end());
  return outcome;
}

TEST(ParallelStep, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (const ContactMethod method : {ContactMethod::warped, ContactMethod::exact}) {
    WorldSettings settings;
    settings.contact_method = method;
    settings.contact_passes = 2;
    const Outcome alone = run(settings, {});
    EXPECT_GT(alone.most_contacts, 20u);
    for (const std::size_t threads : {1, 2, 5})
      EXPECT_EQ(run(settings, on_threads(threads)), alone) << threads << " threads";
  }
}

TEST(ParallelStep, GivesTheSameBitsInTheOppositeOrder) {
  const auto backwards = [](std::size_t count, const std::function<void(std::size_t)>& job) {
    while (count > 0) job(--count);
  };
  EXPECT_EQ(run(WorldSettings{}, backwards), run(WorldSettings{}, {}));
}

TEST(ParallelStep, HandsJobsOverWithoutAllocating) {
  Heap heap(WorldSettings{});
  heap.world.run_jobs_with([](std::size_t count, const std::function<void(std::size_t)>& job) {
    for (std::size_t k = 0; k < count; ++k) job(k);
  });
  for (int k = 0; k < 60; ++k) step(heap.world);
  // New counts of contacts may still allocate; the jobs of every step would each time.
  std::size_t fewest = 1000;
  for (int k = 0; k < 20; ++k) {
    const std::size_t before = allocation_count();
    ASSERT_TRUE(heap.world.step().ok());
    fewest = std::min(fewest, allocation_count() - before);
  }
  EXPECT_EQ(fewest, 0u);
}

}  // namespace
}  // namespace souple
