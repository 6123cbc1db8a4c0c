// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "formats/read/asset_reader.hpp"
#include "formats/read/content_hash.hpp"
#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"
#include "sample_asset.hpp"
#include "sample_hierarchy.hpp"

namespace souple::test {
namespace {

std::vector<std::byte> written(const Asset& asset, int zstd_level = 3) {
  Result<std::vector<std::byte>> bytes = write_asset_memory(asset, {zstd_level});
  EXPECT_TRUE(bytes.ok()) << (bytes.ok() ? "" : format_issue(bytes.issue()));
  return bytes.ok() ? std::move(bytes).value() : std::vector<std::byte>{};
}

Asset read_back(std::span<const std::byte> bytes) {
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  EXPECT_TRUE(reader.ok()) << (reader.ok() ? "" : format_issue(reader.issue()));
  if (!reader) return {};
  Result<Asset> asset = read_asset(*reader);
  EXPECT_TRUE(asset.ok()) << (asset.ok() ? "" : format_issue(asset.issue()));
  return asset ? std::move(asset).value() : Asset{};
}

TEST(AssetRoundTrip, KeepsEverything) {
  const Asset asset = make_sample_asset();
  const std::vector<std::byte> bytes = written(asset);
  EXPECT_TRUE(same_content(asset, read_back(bytes)));
  EXPECT_TRUE(validate_asset_memory(bytes).valid());
  std::cout << "small asset: " << bytes.size() << " bytes\n";
}

TEST(AssetRoundTrip, KeepsEveryKindOfHierarchyWithAndWithoutAVisualSurface) {
  for (const Ties ties : {Ties::parents, Ties::embedding, Ties::both})
    for (const int visual_cells : {0, 1, 4}) {
      const Asset asset = make_sample_asset({.levels = 3,
                                             .fixed_bottom = false,
                                             .static_variant = false,
                                             .ties = ties,
                                             .visual_cells = visual_cells});
      const std::vector<std::byte> bytes = written(asset);
      EXPECT_TRUE(same_content(asset, read_back(bytes)));
      const ValidationReport report = validate_asset_memory(bytes);
      EXPECT_TRUE(report.issues.empty()) << format_issue(report.issues.front());
      Result<AssetReader> reader = AssetReader::open_memory(bytes);
      ASSERT_TRUE(reader.ok());
      EXPECT_EQ(reader->has_visual(), visual_cells > 0);
      EXPECT_EQ(reader->content_hash(), content_hash(asset));
    }
}

TEST(AssetRoundTrip, WorksThroughAFile) {
  const ScratchFolder scratch;
  const Asset asset = make_sample_asset({.cells = 2});
  const std::string file = scratch.path("körper.souple");
  ASSERT_TRUE(write_asset(asset, file).ok());
  EXPECT_EQ(scratch.entry_count(), 1u);
  EXPECT_EQ(read_bytes(file), written(asset));
  Result<AssetReader> reader = AssetReader::open(file);
  ASSERT_TRUE(reader.ok()) << format_issue(reader.issue());
  EXPECT_EQ(reader->version_major(), asset_version_major);
  EXPECT_EQ(reader->version_minor(), asset_version_minor);
  EXPECT_EQ(reader->level_count(), 2u);
  EXPECT_EQ(reader->fixed_set_names(), (std::vector<std::string>{"bottom", "ecke"}));
  EXPECT_EQ(reader->compliance_names(),
            (std::vector<std::string>{"clamped", "clamped-static", "coarse", "compressed", "default"}));
  EXPECT_EQ(reader->content_hash(), content_hash(asset));
  const Result<Asset> again = read_asset(*reader);
  ASSERT_TRUE(again.ok());
  EXPECT_TRUE(same_content(asset, *again));
}

TEST(AssetRoundTrip, KeepsAnAssetWithoutConstraintsAndCompliance) {
  Asset asset = make_sample_asset({.levels = 1, .regions = 1, .fixed_bottom = false});
  asset.compliances.clear();
  asset.provenance = {};
  const std::vector<std::byte> bytes = written(asset);
  EXPECT_TRUE(same_content(asset, read_back(bytes)));
  EXPECT_TRUE(validate_asset_memory(bytes).valid());
}

TEST(AssetRoundTrip, KeepsTilesThatAreLargerThanAChunk) {
  // (3 x 180)^2 floats: 1.17 MB a block, cut into two chunks.
  const Asset asset = make_sample_asset({.cells = 2, .fixed_bottom = false, .tile_nodes = 180});
  const std::vector<std::byte> bytes = written(asset);
  EXPECT_TRUE(same_content(asset, read_back(bytes)));
}

TEST(AssetRoundTrip, KeepsHierarchicalCompliancesOfEveryDepth) {
  for (const int depth : {0, 1, 3, 4})
    for (const Index rank : {0, 1, 1000}) {
      Asset asset = make_sample_asset({.fixed_bottom = false, .hierarchical = false});
      asset.compliances = {make_hierarchical_variant(asset, depth, rank)};
      const std::vector<std::byte> bytes = written(asset);
      EXPECT_TRUE(same_content(asset, read_back(bytes))) << depth << ", " << rank;
      const ValidationReport report = validate_asset_memory(bytes);
      EXPECT_TRUE(report.issues.empty()) << format_issue(report.issues.front());
    }
}

TEST(AssetRoundTrip, KeepsADenseComplianceWithAProlongation) {
  Asset asset = make_sample_asset();
  ComplianceVariant coarse = make_coarse_variant(asset);
  ComplianceVariant& dense = asset.compliances[0];
  dense.header.coarsening = 1;
  dense.prolongation = coarse.prolongation;
  EXPECT_TRUE(same_content(asset, read_back(written(asset))));
}

TEST(AssetRoundTrip, KeepsTheDefaultSolverOrThatThereIsNone) {
  Asset asset = make_sample_asset();
  const std::string hash = content_hash(asset);
  for (const auto& known : solver_names) {
    asset.default_solver = known.kind;
    const std::vector<std::byte> bytes = written(asset);
    EXPECT_EQ(read_back(bytes).default_solver, known.kind);
    EXPECT_TRUE(validate_asset_memory(bytes).valid());
    EXPECT_EQ(content_hash(asset) == hash, known.kind == SolverKind::automatic);
  }
}

TEST(AssetReader, RefusesASolverThatIsNotThere) {
  Asset asset = make_sample_asset();
  asset.default_solver = SolverKind::jacobi_pcg;
  std::vector<std::byte> bytes = written(asset);
  const std::string_view name = "jacobi_pcg";
  const auto found =
      std::ranges::search(bytes, name, [](std::byte a, char b) { return a == std::byte(b); });
  ASSERT_FALSE(found.empty());
  found.front() = std::byte('g');
  EXPECT_FALSE(validate_asset_memory(bytes).valid());
}

TEST(AssetRoundTrip, KeepsTextsOfTheLargestLength) {
  Asset asset = make_sample_asset();
  asset.provenance.recipe.assign(60000, 'x');
  EXPECT_TRUE(same_content(asset, read_back(written(asset))));
  asset.provenance.recipe += 'x';
  const auto refused = write_asset_memory(asset);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().code, IssueCode::asset_limit_exceeded);
}

TEST(AssetRoundTrip, KeepsManyFixedSets) {
  Asset asset = make_sample_asset();
  asset.fixed_sets.resize(2);
  for (int i = 2; i < 256; ++i) asset.fixed_sets.push_back({"set " + std::to_string(i), {i % 27}});
  EXPECT_TRUE(same_content(asset, read_back(written(asset))));
}

TEST(AssetBytes, AreTheSameForTwoWrites) {
  const Asset asset = make_sample_asset({.cells = 2});
  const std::vector<std::byte> first = written(asset);
  // Object times in seconds would differ after this.
  ::sleep(2);
  EXPECT_EQ(first, written(make_sample_asset({.cells = 2})));
}

TEST(AssetBytes, AreTheSameInAnotherProcess) {
  const ScratchFolder scratch;
  const std::string file = scratch.path("child.souple");
  const std::vector<std::byte> here = written(make_sample_asset({.cells = 2}));
  const pid_t child = ::fork();
  if (child == 0) {
    ::setenv("TZ", "Asia/Tokyo", 1);
    ::tzset();
    // Other addresses, and memory that is not zero where it is taken again.
    for (std::size_t size = 64; size < (1u << 20); size *= 2) {
      auto* used = static_cast<unsigned char*>(std::malloc(size));
      std::fill_n(used, size, static_cast<unsigned char>(0xA5));
      std::free(used);
    }
    ::_exit(write_asset(make_sample_asset({.cells = 2}), file).ok() ? 0 : 1);
  }
  int status = 1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  EXPECT_EQ(here, read_bytes(file));
}

TEST(AssetBytes, DoNotDependOnTheOrderOfNamedParts) {
  const Asset asset = make_sample_asset();
  Asset turned = asset;
  std::ranges::reverse(turned.fixed_sets);
  std::ranges::reverse(turned.compliances);
  EXPECT_EQ(content_hash(asset), content_hash(turned));
  EXPECT_EQ(written(asset), written(turned));
}

TEST(ContentHash, IsIndependentOfCompressionAndProvenance) {
  Asset asset = make_sample_asset();
  const std::vector<std::byte> fast = written(asset, 1), small = written(asset, 19);
  EXPECT_NE(fast, small);
  Result<AssetReader> a = AssetReader::open_memory(fast);
  Result<AssetReader> b = AssetReader::open_memory(small);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->content_hash(), b->content_hash());
  EXPECT_EQ(a->content_hash().size(), 32u);
  asset.provenance.recipe = "other";
  EXPECT_EQ(content_hash(asset), a->content_hash());
}

TEST(ContentHash, ChangesWithEveryPart) {
  const Asset asset = make_sample_asset();
  const std::string hash = content_hash(asset);
  const auto differs = [&](auto change) {
    Asset other = asset;
    change(other);
    return content_hash(other) != hash;
  };
  EXPECT_TRUE(differs([](Asset& a) { a.levels[0].mesh.nodes[3][1] += 1e-15; }));
  EXPECT_TRUE(differs([](Asset& a) { std::swap(a.levels[1].mesh.tets[0], a.levels[1].mesh.tets[1]); }));
  EXPECT_TRUE(differs([](Asset& a) { a.levels[1].embedding[20].weights[2] += 1e-15; }));
  EXPECT_TRUE(differs([](Asset& a) { a.levels[1].embedding[20].tet ^= 1; }));
  EXPECT_TRUE(differs([](Asset& a) { a.levels[1].embedding.clear(); }));
  EXPECT_TRUE(differs([](Asset& a) { a.levels[1].rigid_motion_error.parents += 1e-9; }));
  EXPECT_TRUE(differs([](Asset& a) { a.visual.surface.vertices[0][0] += 1e-15; }));
  EXPECT_TRUE(differs([](Asset& a) { a.visual.surface.triangles.pop_back(); }));
  EXPECT_TRUE(differs([](Asset& a) { a.visual.embedding[7].tet ^= 1; }));
  EXPECT_TRUE(differs([](Asset& a) { a.visual = {}; }));
  EXPECT_TRUE(differs([](Asset& a) { a.material.tet_region[5] ^= 1; }));
  EXPECT_TRUE(differs([](Asset& a) { a.material.regions[1].name = "y"; }));
  EXPECT_TRUE(differs([](Asset& a) { a.fixed_sets[0].nodes.pop_back(); }));
  EXPECT_TRUE(differs([](Asset& a) { a.compliances[0].header.error.frobenius *= 2; }));
  EXPECT_TRUE(differs([](Asset& a) { a.compliances[1].payload[100] ^= std::byte{1}; }));
}

TEST(ContentHash, ChangesWithEveryPartOfATransition) {
  const Asset asset = make_sample_asset();
  const auto differs = [&](auto change) {
    Asset other = asset;
    change(other.multigrid[0]);
    return content_hash(other) != content_hash(asset);
  };
  using Transition = LevelTransition;
  EXPECT_TRUE(differs([](Transition& t) { ++t.row_begin[3]; }));
  EXPECT_TRUE(differs([](Transition& t) { t.column[5] ^= 1; }));
  EXPECT_TRUE(differs([](Transition& t) { t.weight[5] *= 1 + 1e-15; }));
  EXPECT_TRUE(differs([](Transition& t) { ++t.pattern_begin[3]; }));
  EXPECT_TRUE(differs([](Transition& t) { t.pattern_column[5] ^= 1; }));
  EXPECT_TRUE(differs([](Transition& t) { t.pieces[3][1] ^= 1; }));
  EXPECT_TRUE(differs([](Transition& t) { t.slots[3][1] ^= 1; }));
  EXPECT_TRUE(differs([](Transition& t) { t.targets[3][1] ^= 1; }));
  Asset without = asset;
  without.multigrid.clear();
  EXPECT_NE(content_hash(without), content_hash(asset));
}

TEST(ContentHash, ChangesWithEveryPartOfAHierarchicalCompliance) {
  const Asset asset = make_sample_asset();
  const std::string hash = content_hash(asset);
  const auto differs = [&](auto change) {
    Asset other = asset;
    change(other.compliances[4]);
    return content_hash(other) != hash;
  };
  ASSERT_EQ(asset.compliances[4].header.name, "coarse");
  using Variant = ComplianceVariant;
  EXPECT_TRUE(differs([](Variant& v) { v.header.shift *= 2; }));
  EXPECT_TRUE(differs([](Variant& v) { v.header.error_norm = ErrorNorm::scaled_spectral; }));
  EXPECT_TRUE(differs([](Variant& v) { v.header.coarsening = 0; }));
  EXPECT_TRUE(differs([](Variant& v) { v.prolongation[3].row[2] ^= 1; }));
  EXPECT_TRUE(differs([](Variant& v) { v.prolongation[3].weight[2] += 1e-15; }));
  EXPECT_TRUE(differs([](Variant& v) { ++v.hierarchy.depth; }));
  EXPECT_TRUE(differs([](Variant& v) { std::swap(v.hierarchy.order[0], v.hierarchy.order[1]); }));
  EXPECT_TRUE(differs([](Variant& v) { v.hierarchy.scale[1][5] *= 1.0001F; }));
  EXPECT_TRUE(differs([](Variant& v) { v.hierarchy.leaf_step[1] *= 1.0001F; }));
  EXPECT_TRUE(differs([](Variant& v) { v.hierarchy.leaf_planes[1] ^= 1; }));
  EXPECT_TRUE(differs([](Variant& v) { ++v.hierarchy.rank[0]; }));
  EXPECT_TRUE(differs([](Variant& v) { v.hierarchy.step[0] *= 1.0001F; }));
  EXPECT_TRUE(differs([](Variant& v) { v.hierarchy.singular[1] *= 1.0001F; }));
  EXPECT_TRUE(differs([](Variant& v) { v.hierarchy.planes[1] ^= 1; }));
  EXPECT_TRUE(differs([](Variant& v) { ++v.hierarchy.record_begin[1]; }));
  EXPECT_TRUE(differs([](Variant& v) { v.payload[10] ^= std::byte{1}; }));
}

TEST(AssetReader, ListsWhatGroupsCostWithoutReadingThem) {
  const Asset asset = make_sample_asset({.cells = 3});
  const std::vector<std::byte> bytes = written(asset);
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  const Result<std::vector<GroupCost>> costs = reader->group_costs();
  ASSERT_TRUE(costs.ok()) << format_issue(costs.issue());
  const Result<LevelSizes> sizes = reader->read_level_sizes(1);
  ASSERT_TRUE(sizes.ok());
  EXPECT_EQ(sizes->node_count, asset.levels[1].mesh.nodes.size());
  EXPECT_EQ(sizes->tet_count, asset.levels[1].mesh.tets.size());
  EXPECT_EQ(sizes->boundary_triangle_count, asset.levels[1].boundary.size());
  EXPECT_TRUE(sizes->has_parents && sizes->has_embedding);
  EXPECT_EQ(sizes->rigid_motion_error.parents, asset.levels[1].rigid_motion_error.parents);
  EXPECT_EQ(sizes->rigid_motion_error.embedding, asset.levels[1].rigid_motion_error.embedding);
  const Result<VisualSizes> visual = reader->read_visual_sizes();
  ASSERT_TRUE(visual.ok());
  EXPECT_EQ(visual->vertex_count, asset.visual.surface.vertices.size());
  EXPECT_EQ(visual->triangle_count, asset.visual.surface.triangles.size());
  EXPECT_LT(reader->bytes_read(), bytes.size() / 4);
  ASSERT_EQ(costs->size(), 2u + 1u + 1u + 1u + 2u + 5u);
  const auto cost = [&](const std::string& path) {
    return *std::ranges::find(*costs, path, &GroupCost::path);
  };
  const MeshLevel& coarse = asset.levels[0];
  EXPECT_EQ(cost("mesh/levels/0").raw_bytes,
            24 * coarse.mesh.nodes.size() + 16 * coarse.mesh.tets.size() + 12 * coarse.boundary.size());
  EXPECT_EQ(cost("mesh/levels/1").raw_bytes, (24 + 8 + 4 + 32) * sizes->node_count +
                                                 16 * sizes->tet_count +
                                                 12 * sizes->boundary_triangle_count);
  EXPECT_EQ(cost("mesh/visual").raw_bytes,
            (24 + 4 + 32) * visual->vertex_count + 12 * visual->triangle_count);
  EXPECT_EQ(cost("compliance/default").raw_bytes,
            asset.compliances[0].payload.size() + 4 * asset.compliances[0].nodes.size());
  const LevelTransition& transition = asset.multigrid[0];
  EXPECT_EQ(
      cost("multigrid/1").raw_bytes,
      4 * (transition.row_begin.size() + 3 * transition.column.size() +
           transition.pattern_begin.size() + transition.pattern_column.size() +
           transition.slots.size() + 4 * transition.pieces.size() + 4 * transition.targets.size()));
  std::uint64_t stored = 0;
  for (const GroupCost& group : *costs) stored += group.stored_bytes;
  EXPECT_LT(stored, bytes.size());
  EXPECT_GT(stored, bytes.size() / 2);
}

TEST(AssetRoundTrip, KeepsTransitionsOfEveryLevelOrNone) {
  for (const Ties ties : {Ties::parents, Ties::embedding, Ties::both}) {
    const Asset asset = make_sample_asset({.levels = 3, .ties = ties});
    ASSERT_EQ(asset.multigrid.size(), 2u);
    const std::vector<std::byte> bytes = written(asset);
    Result<AssetReader> reader = AssetReader::open_memory(bytes);
    ASSERT_TRUE(reader.ok());
    EXPECT_TRUE(reader->has_multigrid());
    for (std::size_t l = 1; l < 3; ++l) {
      const Result<LevelTransition> transition = reader->read_transition(l);
      ASSERT_TRUE(transition.ok()) << format_issue(transition.issue());
      EXPECT_EQ(*transition, asset.multigrid[l - 1]);
    }
    for (const std::size_t level : {std::size_t{0}, std::size_t{3}, ~std::size_t{0}})
      EXPECT_EQ(reader->read_transition(level).issue().code, IssueCode::asset_missing_part);
  }
  const std::vector<std::byte> bytes = written(make_sample_asset({.multigrid = false}));
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  EXPECT_FALSE(reader->has_multigrid());
  EXPECT_EQ(reader->read_transition(1).issue().code, IssueCode::asset_missing_part);
}

TEST(AssetReader, SaysWhichPartIsMissing) {
  const std::vector<std::byte> bytes = written(make_sample_asset());
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  for (const char* name : {"", ".", "..", "default/nodes", "no such", "../clamped", "/"}) {
    const auto variant = reader->read_compliance(name);
    ASSERT_FALSE(variant.ok()) << name;
    EXPECT_EQ(variant.issue().code, IssueCode::asset_missing_part) << name;
    EXPECT_FALSE(reader->read_fixed_set(name).ok()) << name;
  }
  EXPECT_EQ(reader->read_level(2).issue().code, IssueCode::asset_missing_part);
  EXPECT_EQ(reader->read_level_mesh(2).issue().code, IssueCode::asset_missing_part);
}

TEST(AssetReader, SaysThatThereIsNoVisualSurface) {
  const std::vector<std::byte> bytes = written(make_sample_asset({.visual_cells = 0}));
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  EXPECT_FALSE(reader->has_visual());
  EXPECT_EQ(reader->read_visual().issue().code, IssueCode::asset_missing_part);
  const Result<VisualSizes> sizes = reader->read_visual_sizes();
  ASSERT_TRUE(sizes.ok());
  EXPECT_EQ(sizes->vertex_count + sizes->triangle_count, 0u);
}

TEST(AssetReader, GivesTheMeshOfALevelWithoutItsTies) {
  const Asset asset = make_sample_asset();
  const std::vector<std::byte> bytes = written(asset);
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  const Result<MeshLevel> level = reader->read_level_mesh(1);
  ASSERT_TRUE(level.ok());
  EXPECT_EQ(level->mesh.nodes, asset.levels[1].mesh.nodes);
  EXPECT_EQ(level->mesh.tets, asset.levels[1].mesh.tets);
  EXPECT_EQ(level->boundary, asset.levels[1].boundary);
  EXPECT_TRUE(level->parents.empty() && level->embedding.empty());
}

TEST(AssetReader, GivesTheIndexOfAVariantAndPartsOfItsPayload) {
  const Asset asset = make_sample_asset({.cells = 4});
  const std::vector<std::byte> bytes = written(asset);
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  for (const ComplianceVariant& variant : asset.compliances) {
    const std::string& name = variant.header.name;
    const Result<ComplianceVariant> index = reader->read_compliance_index(name);
    ASSERT_TRUE(index.ok()) << format_issue(index.issue());
    EXPECT_TRUE(index->payload.empty());
    EXPECT_EQ(index->nodes, variant.nodes);
    EXPECT_EQ(index->hierarchy.record_begin, variant.hierarchy.record_begin);
    EXPECT_EQ(index->prolongation.size(), variant.prolongation.size());
    const Result<GroupCost> cost = reader->read_compliance_cost(name);
    ASSERT_TRUE(cost.ok());
    EXPECT_EQ(cost->payload_raw_bytes, variant.payload.size());
    if (variant.hierarchy.record_begin.empty()) continue;
    for (std::size_t leaf = 0; leaf + 1 < variant.hierarchy.record_begin.size(); ++leaf) {
      const auto begin = static_cast<std::uint64_t>(variant.hierarchy.record_begin[leaf]);
      const auto end = static_cast<std::uint64_t>(variant.hierarchy.record_begin[leaf + 1]);
      std::vector<std::byte> record(end - begin);
      ASSERT_TRUE(reader->read_payload(name, begin, record).ok());
      EXPECT_TRUE(std::ranges::equal(record, std::span(variant.payload).subspan(begin, end - begin)));
    }
  }
}

TEST(AssetReader, RefusesPartsThatAPayloadDoesNotHave) {
  const Asset asset = make_sample_asset();
  const std::vector<std::byte> bytes = written(asset);
  Result<AssetReader> reader = AssetReader::open_memory(bytes);
  ASSERT_TRUE(reader.ok());
  const std::uint64_t size = asset.compliances[3].payload.size();
  std::vector<std::byte> part(2);
  const auto code_at = [&](const std::string& name, std::uint64_t begin) {
    const Status status = reader->read_payload(name, begin, part);
    return status ? IssueCode{} : status.issue().code;
  };
  EXPECT_EQ(code_at("compressed", size - 2), IssueCode{});
  for (const std::uint64_t begin : {size - 1, size, size + 1, ~std::uint64_t{0}})
    EXPECT_EQ(code_at("compressed", begin), IssueCode::asset_corrupt) << begin;
  EXPECT_EQ(code_at("default", 0), IssueCode::asset_corrupt);
  EXPECT_EQ(code_at("none", 0), IssueCode::asset_missing_part);
  part.clear();
  EXPECT_EQ(code_at("compressed", size), IssueCode{});
}

TEST(AssetReader, RefusesWhatIsNoFile) {
  const ScratchFolder scratch;
  EXPECT_EQ(AssetReader::open(scratch.path("none")).issue().code, IssueCode::io_file_missing);
  EXPECT_EQ(AssetReader::open(scratch.folder()).issue().code, IssueCode::io_cannot_read);
  EXPECT_EQ(AssetReader::open("/dev/null").issue().code, IssueCode::io_file_missing);
  EXPECT_EQ(AssetReader::open("").issue().code, IssueCode::io_file_missing);
}

}  // namespace
}  // namespace souple::test
