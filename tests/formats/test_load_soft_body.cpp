// SPDX-License-Identifier: MIT
// What of an asset file reaches the runtime.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "formats/read/asset_reader.hpp"
#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "runtime/multigrid/galerkin_plan.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "sample_asset.hpp"

namespace souple::test {
namespace {

using Loaded = std::shared_ptr<const SoftBodyAsset>;

const MaterialRegion soft{"soft", 1e4, 0.4, 1000};
const MaterialRegion hard{"hard", 8e4, 0.25, 2500};

/// The sample without compliances: they were made up.
Asset plain_asset(Ties ties) {
  Asset asset = make_sample_asset({.cells = 2, .regions = 1, .fixed_bottom = false, .ties = ties});
  asset.compliances.clear();
  return asset;
}

double mean_height(const TetMesh& mesh, const Tet& tet) {
  double sum = 0;
  for (const Index node : tet) sum += mesh.nodes[static_cast<std::size_t>(node)][2];
  return sum / 4;
}

/// The box with these regions, the second in its upper half.
Asset asset_of(const std::vector<MaterialRegion>& regions) {
  Asset asset = plain_asset(Ties::parents);  // whose middle plane is one of nodes
  asset.material.regions = regions;
  if (regions.size() < 2) return asset;
  const TetMesh& mesh = asset.levels.back().mesh;
  for (const Tet& tet : mesh.tets)
    asset.material.tet_region.push_back(mean_height(mesh, tet) > 0.1 ? 1 : 0);
  return asset;
}

/// Through the bytes of a file; nullptr if anything refuses it.
Loaded through_a_file(const Asset& asset, const LoadOptions& options = {}) {
  const Result<std::vector<std::byte>> bytes = write_asset_memory(asset);
  EXPECT_TRUE(bytes.ok()) << (bytes ? "" : format_issue(bytes.issue()));
  if (!bytes) return nullptr;
  EXPECT_TRUE(validate_asset_memory(*bytes).issues.empty());
  Result<AssetReader> reader = AssetReader::open_memory(*bytes);
  if (!reader) return nullptr;
  const Result<Loaded> body = load_soft_body(*reader, options);
  EXPECT_TRUE(body.ok()) << (body ? "" : format_issue(body.issue()));
  return body ? *body : nullptr;
}

BlockMatrix stiffness_of(const SoftBodyAsset& body) {
  BlockMatrix stiffness(body.model().pattern());
  body.model().assemble_rest(0, 1, stiffness);
  return stiffness;
}

class TwoMaterials : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(both_ && soft_ && hard_); }

  Asset asset_ = asset_of({soft, hard});
  Loaded both_ = through_a_file(asset_);
  Loaded soft_ = through_a_file(asset_of({soft}));
  Loaded hard_ = through_a_file(asset_of({hard}));
};

TEST_F(TwoMaterials, KeepTheirRegionsThroughAFile) {
  const Result<std::vector<std::byte>> bytes = write_asset_memory(asset_);
  ASSERT_TRUE(bytes.ok());
  Result<AssetReader> reader = AssetReader::open_memory(*bytes);
  ASSERT_TRUE(reader.ok());
  const Result<Material> material = reader->read_material();
  ASSERT_TRUE(material.ok());
  EXPECT_EQ(material->tet_region, asset_.material.tet_region);
  ASSERT_EQ(material->regions.size(), 2u);
  EXPECT_EQ(material->regions[1].name, "hard");
  EXPECT_EQ(material->regions[1].young_pa, 8e4);
  EXPECT_EQ(material->regions[1].poisson, 0.25);
  EXPECT_EQ(material->regions[1].density_kg_m3, 2500);
}

TEST_F(TwoMaterials, GiveEveryNodeTheMassOfItsTets) {
  const auto& mesh = asset_.levels.back().mesh;
  const auto both = both_->model().masses(), light = soft_->model().masses(),
             heavy = hard_->model().masses();
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const double z = mesh.nodes[i][2];
    if (z < 0.1 - 1e-9)
      EXPECT_EQ(both[i], light[i]) << i;
    else if (z > 0.1 + 1e-9)
      EXPECT_EQ(both[i], heavy[i]) << i;
    else
      EXPECT_TRUE(both[i] > light[i] && both[i] < heavy[i]) << i;
  }
  const double mean = (soft_->model().total_mass() + hard_->model().total_mass()) / 2;
  EXPECT_NEAR(both_->model().total_mass(), mean, 1e-12 * mean);
}

TEST_F(TwoMaterials, GiveEveryTetTheStiffnessOfItsRegion) {
  const auto& mesh = asset_.levels.back().mesh;
  const BlockMatrix both = stiffness_of(*both_), low = stiffness_of(*soft_),
                    high = stiffness_of(*hard_);
  const BlockPattern& pattern = both_->model().pattern();
  const auto height = [&](Index node) { return mesh.nodes[static_cast<std::size_t>(node)][2] - 0.1; };
  constexpr double rounding =
      1e-14;  // what a body of one material is spared: sums differ in the last bit
  int below = 0, above = 0, between = 0;
  for (Index row = 0; row < pattern.node_count(); ++row)
    for (Index b = pattern.row_begin[static_cast<std::size_t>(row)];
         b < pattern.row_begin[static_cast<std::size_t>(row) + 1]; ++b) {
      // A tet that holds either node lies on that node's side.
      const double z = height(row), other = height(pattern.column[static_cast<std::size_t>(b)]);
      if (std::min(z, other) < -1e-9) {
        EXPECT_TRUE(both.block(b).isApprox(low.block(b), rounding));
        ++below;
      } else if (std::max(z, other) > 1e-9) {
        EXPECT_TRUE(both.block(b).isApprox(high.block(b), rounding));
        ++above;
      } else if (b == pattern.diagonal[static_cast<std::size_t>(row)]) {
        EXPECT_GT(both.block(b).trace(), low.block(b).trace());
        EXPECT_LT(both.block(b).trace(), high.block(b).trace());
        ++between;
      }
    }
  EXPECT_TRUE(below > 100 && above > 100 && between == 25) << below << " " << above << " " << between;
}

TEST(LoadSoftBody, TakesTheSolverThatTheAssetRecords) {
  Asset asset = plain_asset(Ties::both);
  asset.default_solver = SolverKind::gauss_seidel_pcg;
  const Loaded recorded = through_a_file(asset);
  ASSERT_TRUE(recorded);
  EXPECT_EQ(recorded->default_solver(), SolverKind::gauss_seidel_pcg);
  asset.default_solver = SolverKind::automatic;
  const Loaded left_open = through_a_file(asset);
  ASSERT_TRUE(left_open);
  EXPECT_EQ(left_open->default_solver(), SolverKind::warped_pcg) << "a small body";
}

TEST(LoadSoftBody, GivesTheVisualSurfaceOnlyIfAskedFor) {
  const Asset asset = plain_asset(Ties::both);
  const Loaded without = through_a_file(asset), with = through_a_file(asset, {.visual = true});
  ASSERT_TRUE(without && with);
  EXPECT_EQ(without->visual(), nullptr);
  ASSERT_NE(with->visual(), nullptr);
  EXPECT_GT(with->resident_bytes(), without->resident_bytes());
  const auto triangles = with->visual()->triangles();
  EXPECT_TRUE(std::ranges::equal(triangles, asset.visual.surface.triangles));
  std::vector<Point> vertices(with->visual()->vertex_count());
  ASSERT_TRUE(with->visual()->positions(with->model().rest_positions(), vertices));
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(vertices[v][axis], asset.visual.surface.vertices[v][axis], 1e-15) << v;
}

TEST(LoadSoftBody, DoesWithoutAVisualSurface) {
  Asset asset = plain_asset(Ties::both);
  asset.visual = {};
  const Loaded body = through_a_file(asset, {.visual = true});
  ASSERT_NE(body, nullptr);
  EXPECT_EQ(body->visual(), nullptr);
}

TEST(LoadSoftBody, GivesTheTransitionsBetweenLevelsOnlyIfAskedFor) {
  const Asset asset = make_sample_asset({.levels = 3});
  const Result<std::vector<std::byte>> bytes = write_asset_memory(asset);
  ASSERT_TRUE(bytes.ok());
  for (const bool asked : {false, true}) {
    Result<AssetReader> reader = AssetReader::open_memory(*bytes);
    ASSERT_TRUE(reader.ok());
    const auto body = load_soft_body(*reader, {.no_compliances = true, .multigrid = asked});
    ASSERT_TRUE(body.ok()) << format_issue(body.issue());
    const SoftBodyAsset& loaded = **body;
    ASSERT_EQ(loaded.multigrid().size(), asked ? 2u : 0u);
    EXPECT_EQ(loaded.coarsest_nodes().size(), asked ? asset.levels[0].mesh.nodes.size() : 0u);
    if (!asked) continue;
    const auto upper = GalerkinPlan::open(loaded.model().pattern(), loaded.multigrid()[1], {});
    ASSERT_TRUE(upper.ok()) << format_issue(upper.issue());
    EXPECT_TRUE(GalerkinPlan::open(upper->coarse_pattern(), loaded.multigrid()[0], {}).ok());
    EXPECT_FALSE(GalerkinPlan::open(loaded.model().pattern(), loaded.multigrid()[0], {}).ok());
  }
}

TEST(LoadSoftBody, LoadsEmbeddedLevels) {
  const Asset asset = plain_asset(Ties::embedding);
  const Loaded body = through_a_file(asset);
  ASSERT_NE(body, nullptr);
  EXPECT_EQ(static_cast<std::size_t>(body->model().node_count()), asset.levels[1].mesh.nodes.size());
}

TEST(LoadSoftBody, FetchesNothingThatItWasNotAskedFor) {
  Asset asset =
      make_sample_asset({.cells = 6, .regions = 1, .fixed_bottom = false, .visual_cells = 20});
  asset.compliances.clear();
  const Result<std::vector<std::byte>> bytes = write_asset_memory(asset);
  ASSERT_TRUE(bytes.ok());
  const auto fetched = [&](const LoadOptions& options) -> std::uint64_t {
    Result<AssetReader> reader = AssetReader::open_memory(*bytes);
    return reader && load_soft_body(*reader, options) ? reader->bytes_read() : 0;
  };
  Result<AssetReader> reader = AssetReader::open_memory(*bytes);
  ASSERT_TRUE(reader.ok());
  const Result<std::vector<GroupCost>> costs = reader->group_costs();
  ASSERT_TRUE(costs.ok());
  const std::uint64_t plain = fetched({}), with_visual = fetched({.visual = true});
  std::uint64_t visual = 0, finest = 0;
  for (const GroupCost& cost : *costs) {
    if (cost.path == "mesh/visual") visual = cost.stored_bytes;
    if (cost.path == "mesh/levels/1") finest = cost.stored_bytes;
  }
  constexpr std::uint64_t headers = 16384;
  EXPECT_GT(plain, 0u);
  EXPECT_LT(plain, finest + headers);
  EXPECT_GE(with_visual, plain + visual);
}

/// The sample with hierarchical compliances, as bytes of a file.
std::vector<std::byte> file_of_hierarchical_sample() {
  const auto bytes = write_asset_memory(make_sample_asset({.cells = 4, .fixed_bottom = false}));
  return bytes ? *bytes : std::vector<std::byte>{};
}

const BodyCompliance* find(const SoftBodyAsset& body, const std::string& name) {
  for (const BodyCompliance& compliance : body.compliances())
    if (compliance.header.name == name) return &compliance;
  return nullptr;
}

/// False if the blocks do not come within ten seconds.
bool becomes_ready(const RestCompliance& compliance, std::span<const Index> rows) {
  for (int tries = 0; tries < 10000; ++tries) {
    if (compliance.ready(rows)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST(LoadSoftBody, StreamsTheSameComplianceThatItLoads) {
  const auto bytes = file_of_hierarchical_sample();
  Result<AssetReader> reader = AssetReader::open_memory(bytes), other = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok() && other.ok());
  const Result<Loaded> whole = load_soft_body(*reader, {.table_bytes = 0});
  ASSERT_TRUE(whole.ok()) << format_issue(whole.issue());
  const Result<Loaded> streamed = load_soft_body(std::move(*other), {.streaming = true});
  ASSERT_TRUE(streamed.ok()) << format_issue(streamed.issue());
  for (const char* name : {"compressed", "coarse"}) {
    const BodyCompliance *loaded = find(**whole, name), *fetched = find(**streamed, name);
    ASSERT_TRUE(loaded && fetched);
    const std::vector<Index> rows{3, 4, 100, fetched->rest->row_count() - 1};
    EXPECT_TRUE(loaded->rest->ready(rows));
    EXPECT_FALSE(fetched->rest->ready(rows));
    ASSERT_TRUE(becomes_ready(*fetched->rest, rows)) << name;
    std::vector<double> expected(9 * rows.size() * rows.size()), found(expected.size());
    loaded->rest->gather(rows, expected);
    fetched->rest->gather(rows, found);
    EXPECT_EQ(found, expected) << name;
  }
}

TEST(LoadSoftBody, MakesTablesAsFarAsTheirBudgetGoes) {
  const auto bytes = file_of_hierarchical_sample();
  const auto tables = [&](const LoadOptions& options) {
    std::vector<std::size_t> found;
    Result<AssetReader> reader = AssetReader::open_memory(bytes);
    if (!reader) return found;
    const Result<Loaded> body = load_soft_body(std::move(*reader), options);
    if (!body) return found;
    for (const BodyCompliance& compliance : (*body)->compliances())
      found.push_back(compliance.rest->table_bytes());
    return found;
  };
  const std::vector<std::size_t> all = tables({}), none(all.size(), 0);
  std::size_t total = 0, first = 0;
  for (const std::size_t one : all) {
    if (first == 0) first = one;
    total += one;
  }
  ASSERT_GT(first, 0u);
  ASSERT_GT(total, first);
  EXPECT_EQ(tables({.table_bytes = total}), all);
  EXPECT_EQ(tables({.table_bytes = 0}), none);
  EXPECT_EQ(tables({.streaming = true}), none);
  std::size_t within = 0;
  for (const std::size_t one : tables({.table_bytes = total - 1})) within += one;
  EXPECT_GE(within, first);
  EXPECT_LT(within, total);
}

TEST(LoadSoftBody, DoesNotStreamFromAnAssetOfSomebodyElse) {
  const auto bytes = file_of_hierarchical_sample();
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  const Result<Loaded> body = load_soft_body(*reader, {.streaming = true});
  ASSERT_FALSE(body.ok());
  EXPECT_EQ(body.issue().code, IssueCode::unsupported_feature);
}

}  // namespace
}  // namespace souple::test
