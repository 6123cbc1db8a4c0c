// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/simulation.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include <atomic>

#include "runtime/world/soft_body_asset.hpp"
#include "tests/support/box_mesh.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/scene/job_pool.hpp"
#include "tools/scene/scene_loads.hpp"

namespace souple {
namespace {
namespace fs = std::filesystem;

/// One soft box in free fall, solved with the exact method so that no compliance is needed.
class Simulation : public testing::Test {
 protected:
  Simulation()
      : folder_(fs::path(testing::TempDir()) / ("souple_simulation_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    scene_.world.contact_method = ContactMethod::exact;
    SceneSoftBody body;
    body.description.name = "box";
    scene_.bodies.push_back(body);
  }
  ~Simulation() override { fs::remove_all(folder_); }

  SceneWorld build() const {
    SoftBodyContent content;
    content.level = test::level_of(test::box_mesh({2, 2, 2}, {0, 0, 0}, {0.1, 0.1, 0.1}));
    content.material.regions.push_back({"all", 1e4, 0.4, 1000});
    auto asset = SoftBodyAsset::create(std::move(content));
    auto world = World::create(scene_.world);
    EXPECT_TRUE(asset.ok() && world.ok());
    SceneWorld built{std::move(*world), {}, {}};
    auto id = built.world.add_soft_body(*asset, std::get<SceneSoftBody>(scene_.bodies[0]).description);
    EXPECT_TRUE(id.ok());
    built.bodies.push_back(*id);
    return built;
  }
  bool has(const std::string& name) const { return fs::exists(folder_ / name); }

  fs::path folder_;
  Scene scene_;
};

TEST_F(Simulation, WritesTheFirstStateAndEveryNthStep) {
  scene_.output.frames_every = 4;
  SceneWorld built = build();
  const auto report = run_simulation(scene_, built, {10, folder_, {}, {}});
  EXPECT_FALSE(report.failure.has_value());
  EXPECT_EQ(report.steps_done, 10);
  EXPECT_EQ(report.frame_count, 3u);
  EXPECT_TRUE(has("frames/box_000002.vtu"));
  EXPECT_FALSE(has("frames/box_000003.vtu"));
}

TEST_F(Simulation, KeepsFramesAndSaysWhyWhenAStepCannotBeComputed) {
  SceneWorld built = build();
  std::vector<Point> positions(built.world.positions(built.bodies[0]).begin(),
                               built.world.positions(built.bodies[0]).end());
  const std::vector<Point> velocities(positions.size(), Point{1e308, 0, 0});
  const SimulationOptions options{10,
                                  folder_,
                                  [&](std::int64_t done) {
                                    if (done != 3) return;
                                    const BodyId box = built.bodies[0];
                                    ASSERT_TRUE(built.world.set_state(box, positions, velocities).ok());
                                  },
                                  {}};
  const auto report = run_simulation(scene_, built, options);
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, IssueCode::step_not_finite);
  EXPECT_EQ(report.steps_done, 3);
  EXPECT_EQ(report.frame_count, 4u);
  EXPECT_TRUE(has("frames/box_000003.vtu"));
  const auto collection = read_text_file(folder_ / "scene.pvd", 100000);
  ASSERT_TRUE(collection.ok());
  EXPECT_NE(collection->find("box_000003.vtu"), std::string::npos);
}

TEST_F(Simulation, AnInterruptEndsItBetweenSteps) {
  SceneWorld built = build();
  int asked = 0;
  const auto report = run_simulation(scene_, built, {10, folder_, {}, [&] { return ++asked > 5; }});
  EXPECT_TRUE(report.interrupted);
  EXPECT_FALSE(report.failure.has_value());
  EXPECT_EQ(report.steps_done, 5);
}

TEST_F(Simulation, WritesNoFramesWhenTheSceneWantsNone) {
  scene_.output.vtu = false;
  SceneWorld built = build();
  EXPECT_EQ(run_simulation(scene_, built, {3, folder_, {}, {}}).frame_count, 0u);
  EXPECT_FALSE(has("scene.pvd"));
}

TEST_F(Simulation, BoundsItsSamplesHoweverManyStepsItRuns) {
  scene_.output.vtu = false;
  SceneWorld built = build();
  const auto report = run_simulation(scene_, built, {4001, folder_, {}, {}});
  EXPECT_EQ(report.sample_stride, 3);
  EXPECT_EQ(report.samples.size(), 1333u);
  EXPECT_EQ(report.samples.back().step, 3999);
}

TEST(JobPool, RunsEveryJobOnceForAnyNumberOfThreadsAndOfJobs) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    JobPool pool(threads);
    for (std::size_t count = 0; count < 200; ++count) {
      std::vector<std::atomic<int>> runs(count);
      pool.run(count, [&](std::size_t k) { ++runs[k]; });
      for (const auto& times : runs) ASSERT_EQ(times.load(), 1);
    }
  }
}

TEST_F(Simulation, LoadsFindTheirNodesAndTriangles) {
  SceneWorld built = build();
  const SoftBodyAsset& box = built.world.asset(built.bodies[0]);
  SceneLoad load;
  load.load.kind = LoadKind::traction;
  load.place.box = {{-1, -1, 0.0999}, {1, 1, 1}};
  const auto top = place_load(load, box, "box");
  ASSERT_TRUE(top.ok());
  EXPECT_EQ(top->triangles.size(), 8u) << "two for each of the 2 x 2 cells of the top";
  load.load.kind = LoadKind::node_force;
  const auto nodes = place_load(load, box, "box");
  ASSERT_TRUE(nodes.ok());
  EXPECT_EQ(nodes->nodes.size(), 9u);
  load.place.box.reset();
  load.place.point = Point{0.02, 0.03, 0.5};
  load.load.kind = LoadKind::point_force;
  const auto point = place_load(load, box, "box");
  ASSERT_TRUE(point.ok());
  Vec3 found = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    found += point->weight[k] *
             as_vec3(box.model().rest_positions()[static_cast<std::size_t>(
                 box.surface().triangles()[static_cast<std::size_t>(point->triangle)][k])]);
  EXPECT_LT((found - Vec3(0.02, 0.03, 0.1)).norm(), 1e-12);
  load.place = {};
  load.load.kind = LoadKind::pressure;
  load.place.box = {{5, 5, 5}, {6, 6, 6}};
  EXPECT_EQ(place_load(load, box, "box").issue().code, IssueCode::load_invalid);
  load.place = {};
  load.place.set = "nowhere";
  EXPECT_EQ(place_load(load, box, "box").issue().code, IssueCode::load_invalid);
}

}  // namespace
}  // namespace souple
