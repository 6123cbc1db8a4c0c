// SPDX-License-Identifier: MIT
// Files that earlier versions wrote are read for ever, and to the same content.
#include <gtest/gtest.h>

#include "formats/read/asset_reader.hpp"
#include "formats/read/content_hash.hpp"
#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"
#include "runtime/multigrid/level_transitions.hpp"
#include "sample_asset.hpp"

namespace souple::test {
namespace {

struct Golden {
  const char* name;  ///< of the file
  const char* test_name;
  int version_minor;
  const char* content_hash;
  bool has_parents, has_embedding, has_visual;
  std::size_t compliance_count;
};

void PrintTo(const Golden& golden, std::ostream* stream) { *stream << golden.name; }

const Golden goldens[] = {
    {"asset-1.0.souple", "Version1_0", 0, "9c739107fa9598a7800d41e09d1b0c04", true, false, false, 3},
    {"asset-1.1.souple", "Version1_1", 1, "d3d0ade01f11135cd1cf131b65db7fe4", true, true, true, 3},
    {"asset-1.1-embedded.souple", "Version1_1Embedded", 1, "6c0720c06cc1a4409bffda392a9909ca", false,
     true, true, 1},
    {"asset-1.2.souple", "Version1_2", 2, "4a6170479860c45a80e6bd260b98513a", true, true, true, 5},
    {"asset-1.3.souple", "Version1_3", 3, "8afa86d2d10399ad91452eefafe44fd0", true, true, true, 5},
};

class GoldenAsset : public ::testing::TestWithParam<Golden> {
 protected:
  void SetUp() override {
    Result<AssetReader> reader = AssetReader::open(file_);
    ASSERT_TRUE(reader.ok()) << format_issue(reader.issue());
    EXPECT_EQ(reader->version_major(), 1);
    EXPECT_EQ(reader->version_minor(), GetParam().version_minor);
    EXPECT_EQ(reader->content_hash(), GetParam().content_hash);
    Result<Asset> asset = read_asset(*reader);
    ASSERT_TRUE(asset.ok()) << format_issue(asset.issue());
    asset_ = std::move(asset).value();
  }

  const std::string file_ = std::string(SOUPLE_GOLDEN_DIR "/") + GetParam().name;
  Asset asset_;
};

TEST_P(GoldenAsset, KeepsItsContentHash) {
  EXPECT_EQ(content_hash(asset_), GetParam().content_hash);
  const ValidationReport report = validate_asset_file(file_);
  EXPECT_TRUE(report.issues.empty()) << format_issue(report.issues.front());
}

TEST_P(GoldenAsset, KeepsItsParts) {
  ASSERT_EQ(asset_.levels.size(), 2u);
  EXPECT_EQ(asset_.levels[0].mesh.tets.size(), 6u);
  const MeshLevel& finest = asset_.levels[1];
  EXPECT_EQ(finest.mesh.tets.size(), 48u);
  EXPECT_EQ(finest.mesh.nodes[26], (Point{0.2, 0.2, 0.2}));
  EXPECT_EQ(finest.boundary.size(), 48u);
  EXPECT_EQ(finest.parents.size(), GetParam().has_parents ? 27u : 0u);
  EXPECT_EQ(finest.embedding.size(), GetParam().has_embedding ? 27u : 0u);
  EXPECT_EQ(finest.rigid_motion_error.embedding, GetParam().has_embedding ? 3e-16 : -1);
  EXPECT_EQ(asset_.visual.surface.vertices.size(), GetParam().has_visual ? 56u : 0u);
  EXPECT_EQ(asset_.material.regions[1].name, "härter");
  EXPECT_EQ(asset_.material.tet_region.size(), 48u);
  EXPECT_EQ(asset_.compliances.size(), GetParam().compliance_count);
  EXPECT_EQ(asset_.compliances.back().header.name, "default");
  EXPECT_EQ(asset_.provenance.input_name, "box.obj");
}

// Of the variants that 1.2 brought; older files have none and what 1.2 added to headers at its
// defaults.
TEST_P(GoldenAsset, KeepsItsHierarchicalCompliances) {
  std::size_t count = 0;
  for (const ComplianceVariant& variant : asset_.compliances) {
    const ComplianceHeader& header = variant.header;
    if (header.representation == ComplianceRepresentation::dense_tiled) {
      EXPECT_EQ(header.error_norm, ErrorNorm::scaled_spectral);
      EXPECT_EQ(header.shift, 0);
      EXPECT_EQ(header.coarsening, 0);
      EXPECT_TRUE(variant.hierarchy.order.empty() && variant.prolongation.empty());
      continue;
    }
    ++count;
    const bool coarse = header.name == "coarse";
    EXPECT_EQ(header.error_norm, coarse ? ErrorNorm::worst_column : ErrorNorm::frobenius);
    EXPECT_EQ(header.shift, 4.5e-4);
    EXPECT_EQ(header.coarsening, coarse ? 1 : 0);
    EXPECT_EQ(variant.nodes.size(), 26u);
    EXPECT_EQ(variant.prolongation.size(), coarse ? 26u : 0u);
    EXPECT_EQ(variant.hierarchy.depth, coarse ? 1 : 2);
    EXPECT_EQ(variant.hierarchy.order.size(), coarse ? 8u : 26u);
    EXPECT_EQ(variant.hierarchy.rank, (coarse ? std::vector<Index>{3} : std::vector<Index>{4, 4, 4}));
  }
  EXPECT_EQ(count, GetParam().version_minor >= 2 ? 2u : 0u);
}

// Of the part that 1.3 brought; older files have none.
TEST_P(GoldenAsset, KeepsItsTransitions) {
  if (GetParam().version_minor < 3) {
    EXPECT_TRUE(asset_.multigrid.empty());
    return;
  }
  ASSERT_EQ(asset_.multigrid.size(), 1u);
  const LevelTransition& transition = asset_.multigrid[0];
  EXPECT_EQ(transition.row_begin.size(), 28u);
  EXPECT_EQ(transition.pattern_begin.size(), 9u);
  EXPECT_EQ(asset_.multigrid, store_transitions(asset_.levels).value());
}

// What the present writer makes of old content has the hash that the old file has.
TEST_P(GoldenAsset, IsWrittenAgainWithTheSameHash) {
  const Result<std::vector<std::byte>> bytes = write_asset_memory(asset_);
  ASSERT_TRUE(bytes.ok());
  Result<AssetReader> reader = AssetReader::open_memory(*bytes);
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ(reader->content_hash(), GetParam().content_hash);
  EXPECT_EQ(reader->version_minor(), asset_version_minor);
  EXPECT_TRUE(validate_asset_memory(*bytes).issues.empty());
}

const auto golden_name = [](const auto& golden) { return std::string(golden.param.test_name); };
INSTANTIATE_TEST_SUITE_P(Of, GoldenAsset, ::testing::ValuesIn(goldens), golden_name);

}  // namespace
}  // namespace souple::test
