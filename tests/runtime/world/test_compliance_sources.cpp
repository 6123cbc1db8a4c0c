// SPDX-License-Identifier: MIT
// What a step does with a compliance that is not all there: blocks that a streaming source has not read
// yet, nodes outside the region that it is limited to, a coarse one that is prolonged.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/allocation_count.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/dense_compliance.hpp"
#include "tests/support/scenes.hpp"

namespace souple {
namespace {

using namespace test;

SoftBodyContent box_content() {
  return make_content(box_mesh({3, 3, 3}, {-0.05, -0.05, -0.05}, {0.1, 0.1, 0.1}),
                      material_of(1e4, 0.4, 1000, 0.1, 0.01), 0.01);
}

std::shared_ptr<const SoftBodyAsset> body_of(SoftBodyContent content) {
  auto body = SoftBodyAsset::create(std::move(content));
  EXPECT_TRUE(body.ok()) << (body.ok() ? "" : format_issue(body.issue()));
  return *body;
}

// Blocks that can be absent, and a list of those that were asked for.
struct Shelf {
  bool is_open = true;
  std::set<std::size_t> requested;
};

class ShelfSource final : public BlockSource {
 public:
  ShelfSource(std::unique_ptr<BlockSource> blocks, Shelf& shelf)
      : blocks_(std::move(blocks)), shelf_(shelf) {}
  bool ready(std::size_t) const override { return shelf_.is_open; }
  std::span<const std::byte> block(std::size_t index) const override { return blocks_->block(index); }
  void request(std::size_t index) override { shelf_.requested.insert(index); }
  std::size_t resident_bytes() const override { return 0; }

 private:
  std::unique_ptr<BlockSource> blocks_;
  Shelf& shelf_;
};

std::vector<Point> positions(const World& world, BodyId body) {
  return {world.positions(body).begin(), world.positions(body).end()};
}

TEST(StreamedCompliance, AStepWithoutItsBlocksChangesNothingAndSucceedsOnceTheyAreThere) {
  Shelf shelf;
  SoftBodyContent content = box_content();
  content.compliances[0].source =
      std::make_unique<ShelfSource>(std::move(content.compliances[0].source), shelf);
  World streamed = make_world(WorldSettings{}), whole = make_world(WorldSettings{});
  const BodyId body = add_soft(streamed, body_of(std::move(content)), Vec3(0, 0, 0.0505));
  add_soft(whole, body_of(box_content()), Vec3(0, 0, 0.0505));
  add_plane(streamed);
  add_plane(whole);
  for (int k = 0; k < 20; ++k) {
    if (k % 5 == 4) {
      const auto before = positions(streamed, body);
      const double time = streamed.time_s();
      shelf.is_open = false;
      const auto refused = streamed.step();
      ASSERT_FALSE(refused.ok()) << "step " << k;
      EXPECT_EQ(refused.issue().code, IssueCode::compliance_not_loaded);
      EXPECT_EQ(positions(streamed, body), before);
      EXPECT_EQ(streamed.time_s(), time);
      EXPECT_TRUE(streamed.contacts().empty());
      EXPECT_FALSE(shelf.requested.empty()) << "what is missing has been asked for";
      shelf.is_open = true;
    }
    step(streamed);
    step(whole);
    ASSERT_EQ(positions(streamed, body), positions(whole, body))
        << "as if the refused steps had never been tried, step " << k;
  }
}

TEST(StreamedCompliance, AStepWithoutContactsNeedsNoBlocks) {
  Shelf shelf;
  shelf.is_open = false;
  SoftBodyContent content = box_content();
  content.compliances[0].source =
      std::make_unique<ShelfSource>(std::move(content.compliances[0].source), shelf);
  World world = make_world(WorldSettings{});
  add_soft(world, body_of(std::move(content)), Vec3(0, 0, 1));
  add_plane(world);
  EXPECT_EQ(step(world).contact_count, 0u);
}

// Leaves only the nodes below the middle in the compliance.
void limit_to_lower_half(SoftBodyContent& content) {
  auto& variant = content.compliances[0];
  std::vector<RowProlongation> rows;
  std::vector<Index> nodes;
  for (std::size_t k = 0; k < variant.nodes.size(); ++k)
    if (content.level.mesh.nodes[std::size_t(variant.nodes[k])][2] < 0) {
      nodes.push_back(variant.nodes[k]);
      RowProlongation row;
      row.row.fill(Index(k));
      row.weight[0] = 1;
      rows.push_back(row);
    }
  variant.nodes = nodes;
  variant.prolongation = rows;
  variant.header.coarsening = 1;
}

TEST(LimitedCompliance, GivesTheSameMotionAsTheWholeOneWhereItIsTouched) {
  SoftBodyContent content = box_content();
  limit_to_lower_half(content);
  World limited = make_world(WorldSettings{}), whole = make_world(WorldSettings{});
  const BodyId body = add_soft(limited, body_of(std::move(content)), Vec3(0, 0, 0.0505));
  add_soft(whole, body_of(box_content()), Vec3(0, 0, 0.0505));
  add_plane(limited);
  add_plane(whole);
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(step(limited).uncovered_count, 0u);
    step(whole);
  }
  EXPECT_GT(limited.contacts().size(), 0u);
  for (std::size_t k = 0; k < limited.positions(body).size(); ++k)
    EXPECT_LT((as_vec3(limited.positions(body)[k]) - as_vec3(whole.positions(body)[k])).norm(), 1e-5)
        << "nodes outside the region follow by the extension, to its precision";
}

TEST(LimitedCompliance, LeavesOutAndCountsContactsOutsideItsRegion) {
  SoftBodyContent content = box_content();
  limit_to_lower_half(content);
  World world = make_world(WorldSettings{});
  add_soft(world, body_of(std::move(content)), Vec3(0, 0, 0.0505), turned(180, {1, 0, 0}));
  add_plane(world);
  const StepReport report = step(world);
  EXPECT_EQ(report.contact_count, 0u);
  EXPECT_GT(report.uncovered_count, 0u);
}

// Throws the body about, so that contacts come and go; returns how often their number changed.
std::size_t tumble(World& world, BodyId body) {
  std::size_t changes = 0, last = 0;
  for (const Vec3& velocity : {Vec3(0.1, 0, -0.2), Vec3(0.3, 0.1, 0.3), Vec3(-0.4, 0, 0.2)}) {
    set_velocity(world, body, velocity);
    for (int k = 0; k < 15; ++k) {
      const std::size_t count = world.step()->contact_count;
      changes += count != last;
      last = count;
    }
  }
  return changes;
}

TEST(ContactStep, AllocatesNothingOnceWarmWithContactsThatComeAndGo) {
  WorldSettings settings;
  settings.measure_laws = false;
  World world = make_world(settings);
  const BodyId body = add_soft(world, body_of(box_content()), Vec3(0, 0, 0.055), turned(5, {1, 2, 0}));
  add_plane(world);
  const auto x = positions(world, body);
  const auto rest = std::vector<Point>(world.velocities(body).begin(), world.velocities(body).end());
  tumble(world, body);
  ASSERT_TRUE(world.set_state(body, x, rest).ok());
  // set_velocity copies the state: what it allocates is not the step's.
  const std::size_t per_copy = [&] {
    const std::size_t before = allocation_count();
    set_velocity(world, body, Vec3::Zero());
    return allocation_count() - before;
  }();
  const std::size_t before = allocation_count();
  const std::size_t changes = tumble(world, body);
  EXPECT_EQ(allocation_count() - before, 3 * per_copy);
  EXPECT_GT(changes, 5u);
}

}  // namespace
}  // namespace souple
