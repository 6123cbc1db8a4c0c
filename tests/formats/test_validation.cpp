// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>

#include "formats/core/names.hpp"
#include "formats/read/validate.hpp"
#include "sample_asset.hpp"

namespace souple::test {
namespace {

using Change = std::function<void(Asset&)>;

/// One way to spoil an asset and the code that has to answer.
struct Fault {
  const char* name;
  IssueCode code;
  Change spoil;
};

void PrintTo(const Fault& fault, std::ostream* stream) { *stream << fault.name; }

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

template <class Scalar>
void set_scalar(ComplianceVariant& variant, std::size_t index, Scalar value) {
  std::memcpy(variant.payload.data() + index * sizeof value, &value, sizeof value);
}

MeshLevel& finest(Asset& a) { return a.levels.back(); }
ComplianceHeader& header(Asset& a) { return a.compliances[0].header; }

const Fault mesh_faults[] = {
    {"NaN", IssueCode::asset_not_finite, [](Asset& a) { finest(a).mesh.nodes[5][2] = nan; }},
    {"Infinity", IssueCode::asset_not_finite, [](Asset& a) { finest(a).mesh.nodes[5][2] = -infinity; }},
    {"HugeCoordinate", IssueCode::asset_not_finite, [](Asset& a) { finest(a).mesh.nodes[5][0] = 2e7; }},
    {"TetIndexTooLarge", IssueCode::asset_index_out_of_range,
     [](Asset& a) { finest(a).mesh.tets[3][1] = static_cast<Index>(finest(a).mesh.nodes.size()); }},
    {"NegativeTetIndex", IssueCode::asset_index_out_of_range,
     [](Asset& a) { finest(a).mesh.tets[3][1] = -1; }},
    {"BoundaryIndex", IssueCode::asset_index_out_of_range,
     [](Asset& a) { finest(a).boundary[0][0] = 1 << 30; }},
    {"InvertedTet", IssueCode::asset_tet_inverted,
     [](Asset& a) { std::swap(finest(a).mesh.tets[7][0], finest(a).mesh.tets[7][1]); }},
    {"FlatTet", IssueCode::asset_tet_inverted,
     [](Asset& a) { finest(a).mesh.tets[7][0] = finest(a).mesh.tets[7][1]; }},
    {"MissingBoundaryTriangle", IssueCode::asset_mesh_inconsistent,
     [](Asset& a) { finest(a).boundary.pop_back(); }},
    {"TurnedBoundaryTriangle", IssueCode::asset_mesh_inconsistent,
     [](Asset& a) { std::swap(finest(a).boundary[0][0], finest(a).boundary[0][1]); }},
    {"UnusedNode", IssueCode::asset_mesh_inconsistent,
     [](Asset& a) {
       a.levels.resize(1), a.levels[0].mesh.nodes.push_back({0, 0, 1});
     }},
    {"NoLevels", IssueCode::asset_mesh_inconsistent, [](Asset& a) { a.levels.clear(); }},
    {"TooManyLevels", IssueCode::asset_mesh_inconsistent, [](Asset& a) { a.levels.resize(17); }},
    {"EmptyLevel", IssueCode::asset_mesh_inconsistent, [](Asset& a) { a.levels[0].mesh = {}; }},
    {"ParentsOutOfRange", IssueCode::asset_index_out_of_range,
     [](Asset& a) {
       finest(a).parents[4] = {0, static_cast<Index>(a.levels[0].mesh.nodes.size())};
     }},
    {"ParentsMissing", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) { finest(a).parents.pop_back(); }},
    {"ParentsAtLevel0", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) {
       a.levels[0].parents.assign(a.levels[0].mesh.nodes.size(), {0, 0});
     }},
    {"ParentsThatAreNoEdge", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) {
       finest(a).parents[1] = {1, 2};
     }},
    {"ParentsTwice", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) { finest(a).parents[1] = finest(a).parents[3]; }},
};

Embedding& row(Asset& a) { return finest(a).embedding[13]; }
Embedding& visual_row(Asset& a) { return a.visual.embedding[13]; }

const Fault embedding_faults[] = {
    {"NeitherParentsNorEmbedding", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) {
       finest(a).parents.clear(), finest(a).embedding.clear(), finest(a).rigid_motion_error = {};
     }},
    {"RowMissing", IssueCode::asset_embedding_invalid,
     [](Asset& a) { finest(a).embedding.pop_back(); }},
    {"RowsAtLevel0", IssueCode::asset_embedding_invalid,
     [](Asset& a) { a.levels[0].embedding.resize(a.levels[0].mesh.nodes.size()); }},
    {"TetOfTheFinerLevel", IssueCode::asset_index_out_of_range,
     [](Asset& a) { row(a).tet = static_cast<Index>(a.levels[0].mesh.tets.size()); }},
    {"NegativeTet", IssueCode::asset_index_out_of_range, [](Asset& a) { row(a).tet = -1; }},
    {"WeightNaN", IssueCode::asset_embedding_invalid, [](Asset& a) { row(a).weights[3] = nan; }},
    {"WeightInfinite", IssueCode::asset_embedding_invalid,
     [](Asset& a) { row(a).weights[0] = infinity; }},
    {"WeightHuge", IssueCode::asset_embedding_invalid,
     [](Asset& a) {
       row(a).weights = {1001, -1000, 0, 0};
     }},
    {"WeightsOfSumZero", IssueCode::asset_embedding_invalid,
     [](Asset& a) {
       row(a).weights = {0, 0, 0, 0};
     }},
    {"WeightsOfSumAlmostOne", IssueCode::asset_embedding_invalid,
     [](Asset& a) { row(a).weights[1] += 2e-6; }},
    {"Displaced", IssueCode::asset_embedding_displaced,
     [](Asset& a) { row(a).weights[1] += 4e-6, row(a).weights[2] -= 4e-6; }},
    {"OtherTet", IssueCode::asset_embedding_displaced, [](Asset& a) { row(a).tet ^= 1; }},
    {"ErrorNaN", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) { finest(a).rigid_motion_error.embedding = nan; }},
    {"ErrorNegative", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) { finest(a).rigid_motion_error.parents = -0.5; }},
    {"ErrorOfMissingParents", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) { finest(a).parents.clear(); }},
    {"ErrorAtLevel0", IssueCode::asset_hierarchy_invalid,
     [](Asset& a) { a.levels[0].rigid_motion_error.embedding = 0; }},
    {"VisualWithoutTriangles", IssueCode::asset_visual_invalid,
     [](Asset& a) { a.visual.surface.triangles.clear(); }},
    {"VisualWithoutVertices", IssueCode::asset_visual_invalid,
     [](Asset& a) { a.visual.surface.vertices.clear(); }},
    {"VisualWithoutEmbedding", IssueCode::asset_embedding_invalid,
     [](Asset& a) { a.visual.embedding.clear(); }},
    {"EmbeddingWithoutVisual", IssueCode::asset_visual_invalid,
     [](Asset& a) { a.visual.surface = {}; }},
    {"VisualVertexNaN", IssueCode::asset_not_finite,
     [](Asset& a) { a.visual.surface.vertices[3][1] = nan; }},
    {"VisualTriangle", IssueCode::asset_index_out_of_range,
     [](Asset& a) {
       a.visual.surface.triangles[3][1] = static_cast<Index>(a.visual.surface.vertices.size());
     }},
    {"VisualTet", IssueCode::asset_index_out_of_range,
     [](Asset& a) { visual_row(a).tet = static_cast<Index>(finest(a).mesh.tets.size()); }},
    {"VisualWeight", IssueCode::asset_embedding_invalid,
     [](Asset& a) { visual_row(a).weights[0] = -infinity; }},
    {"VisualDisplaced", IssueCode::asset_embedding_displaced,
     [](Asset& a) { a.visual.surface.vertices[13][0] += 3e-7; }},
};

const Fault part_faults[] = {
    {"NoRegion", IssueCode::material_out_of_range, [](Asset& a) { a.material.regions.clear(); }},
    {"ZeroYoung", IssueCode::material_out_of_range,
     [](Asset& a) { a.material.regions[0].young_pa = 0; }},
    {"NaNYoung", IssueCode::material_out_of_range,
     [](Asset& a) { a.material.regions[0].young_pa = nan; }},
    {"Incompressible", IssueCode::material_out_of_range,
     [](Asset& a) { a.material.regions[1].poisson = 0.5; }},
    {"PoissonMinusOne", IssueCode::material_out_of_range,
     [](Asset& a) { a.material.regions[1].poisson = -1; }},
    {"NegativeDensity", IssueCode::material_out_of_range,
     [](Asset& a) { a.material.regions[1].density_kg_m3 = -1; }},
    {"NegativeDamping", IssueCode::material_out_of_range,
     [](Asset& a) { a.material.rayleigh_mass_per_s = -1; }},
    {"UnknownRegion", IssueCode::asset_index_out_of_range,
     [](Asset& a) { a.material.tet_region[9] = 2; }},
    {"TooFewRegions", IssueCode::asset_index_out_of_range,
     [](Asset& a) { a.material.tet_region.pop_back(); }},
    {"RegionNameTwice", IssueCode::asset_bad_name,
     [](Asset& a) { a.material.regions[1].name = a.material.regions[0].name; }},
    {"EmptySet", IssueCode::fixed_set_invalid, [](Asset& a) { a.fixed_sets[1].nodes.clear(); }},
    {"UnsortedSet", IssueCode::fixed_set_invalid,
     [](Asset& a) {
       a.fixed_sets[1].nodes = {3, 2};
     }},
    {"NodeTwiceInSet", IssueCode::fixed_set_invalid,
     [](Asset& a) {
       a.fixed_sets[1].nodes = {2, 2};
     }},
    {"SetOutOfRange", IssueCode::fixed_set_invalid, [](Asset& a) { a.fixed_sets[1].nodes = {27}; }},
    {"NegativeInSet", IssueCode::fixed_set_invalid,
     [](Asset& a) {
       a.fixed_sets[1].nodes = {-1, 4};
     }},
    {"SetOfAllNodes", IssueCode::fixed_set_invalid,
     [](Asset& a) {
       a.fixed_sets[1].nodes.clear();
       for (Index i = 0; i < 27; ++i) a.fixed_sets[1].nodes.push_back(i);
     }},
    {"SetNameTwice", IssueCode::asset_bad_name, [](Asset& a) { a.fixed_sets[1].name = "bottom"; }},
    {"SetNameWithSlash", IssueCode::asset_bad_name, [](Asset& a) { a.fixed_sets[1].name = "a/b"; }},
    {"EmptyVariantName", IssueCode::asset_bad_name, [](Asset& a) { header(a).name.clear(); }},
    {"TooManySets", IssueCode::asset_limit_exceeded,
     [](Asset& a) {
       for (int i = 0; i < 300; ++i) a.fixed_sets.push_back({"x" + std::to_string(i), {1}});
     }},
    {"RecipeIsNoText", IssueCode::asset_bad_name, [](Asset& a) { a.provenance.recipe = "\xff\xfe"; }},
    {"NulInGenerator", IssueCode::asset_bad_name,
     [](Asset& a) { a.provenance.generator = std::string("a\0b", 3); }},
};

const Fault compliance_faults[] = {
    {"TimeStepZero", IssueCode::asset_compliance_invalid, [](Asset& a) { header(a).time_step_s = 0; }},
    {"TimeStepNaN", IssueCode::asset_compliance_invalid, [](Asset& a) { header(a).time_step_s = nan; }},
    {"OtherTimeStep", IssueCode::asset_compliance_invalid,
     [](Asset& a) { header(a).time_step_s = 0.02; }},
    {"OtherDamping", IssueCode::asset_compliance_invalid,
     [](Asset& a) { a.material.rayleigh_stiffness_s = 0.011; }},
    {"StaticWithTimeStep", IssueCode::asset_compliance_invalid,
     [](Asset& a) { a.compliances[2].header.time_step_s = 0.01; }},
    {"StaticWithoutSet", IssueCode::asset_compliance_invalid,
     [](Asset& a) { a.compliances[2].header.fixed_set.clear(); }},
    {"UnknownSet", IssueCode::asset_compliance_invalid,
     [](Asset& a) { a.compliances[1].header.fixed_set = "top"; }},
    {"FixedNodeWithRow", IssueCode::asset_compliance_invalid,
     [](Asset& a) { header(a).fixed_set = "bottom"; }},
    {"NegativeError", IssueCode::asset_compliance_invalid,
     [](Asset& a) { header(a).error.frobenius = -1; }},
    {"InfiniteError", IssueCode::asset_compliance_invalid,
     [](Asset& a) { header(a).error.solve_residual = infinity; }},
    {"NodeCount", IssueCode::asset_compliance_invalid, [](Asset& a) { ++header(a).node_count; }},
    {"HugeCounts", IssueCode::asset_compliance_invalid,
     [](Asset& a) {
       header(a).node_count = header(a).block_count = std::numeric_limits<std::int64_t>::max();
     }},
    {"ZeroTile", IssueCode::asset_compliance_invalid, [](Asset& a) { header(a).tile_nodes = 0; }},
    {"BlockCount", IssueCode::asset_compliance_invalid, [](Asset& a) { --header(a).block_count; }},
    {"ShortPayload", IssueCode::asset_compliance_invalid,
     [](Asset& a) { a.compliances[0].payload.pop_back(); }},
    {"OtherScalar", IssueCode::asset_compliance_invalid,
     [](Asset& a) { header(a).scalar = ScalarType::float64; }},
    {"NodesNotAscending", IssueCode::asset_compliance_invalid,
     [](Asset& a) { std::swap(a.compliances[0].nodes[0], a.compliances[0].nodes[1]); }},
    {"NodeOutOfRange", IssueCode::asset_compliance_invalid,
     [](Asset& a) { a.compliances[0].nodes.back() = 27; }},
    {"PayloadNaN", IssueCode::asset_compliance_invalid,
     [](Asset& a) { set_scalar(a.compliances[0], 700, static_cast<float>(nan)); }},
    {"PayloadInfinity", IssueCode::asset_compliance_invalid,
     [](Asset& a) { set_scalar(a.compliances[2], 700, -infinity); }},
    {"NegativeDiagonal", IssueCode::asset_compliance_invalid,
     [](Asset& a) { set_scalar(a.compliances[0], 0, -1e-3f); }},
    {"PaddingNotZero", IssueCode::asset_compliance_invalid,
     [](Asset& a) { set_scalar(a.compliances[0], a.compliances[0].payload.size() / 4 - 1, 1.0f); }},
};

ComplianceVariant& compressed(Asset& a) { return a.compliances[3]; }
ComplianceVariant& coarse(Asset& a) { return a.compliances[4]; }
HierarchicalIndex& index(Asset& a) { return compressed(a).hierarchy; }

constexpr IssueCode invalid = IssueCode::asset_compliance_invalid;

const Fault hierarchy_faults[] = {
    {"DepthNegative", invalid, [](Asset& a) { index(a).depth = -1; }},
    {"DepthOfOtherLeaves", invalid, [](Asset& a) { index(a).depth = 3; }},
    {"DepthHuge", invalid, [](Asset& a) { index(a).depth = std::numeric_limits<std::int64_t>::max(); }},
    {"LeafCount", invalid, [](Asset& a) { ++compressed(a).header.block_count; }},
    {"MoreLeavesThanNodes", invalid, [](Asset& a) { compressed(a).header.block_count = 27; }},
    {"TileNodes", invalid, [](Asset& a) { compressed(a).header.tile_nodes = 8; }},
    {"BlockScalars", invalid, [](Asset& a) { compressed(a).header.block_scalars = 1; }},
    {"RowTwiceInOrder", invalid, [](Asset& a) { index(a).order[1] = index(a).order[0]; }},
    {"RowOutOfRange", invalid, [](Asset& a) { index(a).order[1] = 26; }},
    {"OrderShort", invalid, [](Asset& a) { index(a).order.pop_back(); }},
    {"ScaleNaN", invalid, [](Asset& a) { index(a).scale[1][4] = static_cast<float>(nan); }},
    {"ScaleNotPositive", invalid, [](Asset& a) { index(a).scale[1][0] = 0; }},
    {"ScaleShort", invalid, [](Asset& a) { index(a).scale.pop_back(); }},
    {"LeafStepInfinite", invalid,
     [](Asset& a) { index(a).leaf_step[1] = static_cast<float>(infinity); }},
    {"LeafPlanes", invalid, [](Asset& a) { index(a).leaf_planes[1] = 5; }},
    {"RankNegative", invalid, [](Asset& a) { index(a).rank[1] = -1; }},
    {"RankHuge", invalid, [](Asset& a) { index(a).rank[1] = std::numeric_limits<Index>::max(); }},
    {"RankOfOtherTerms", invalid, [](Asset& a) { --index(a).rank[2]; }},
    {"StepZero", invalid, [](Asset& a) { index(a).step[0] = 0; }},
    {"SingularNegative", invalid, [](Asset& a) { index(a).singular[2] = -1; }},
    {"PlanesZero", invalid, [](Asset& a) { index(a).planes[2] = 0; }},
    {"PlanesFive", invalid, [](Asset& a) { index(a).planes[2] = 5; }},
    {"RecordTooLong", invalid,
     [](Asset& a) {
       compressed(a).payload.resize(1 << 20);
       index(a).record_begin.back() = 1 << 20;
     }},
    {"RecordNegative", invalid, [](Asset& a) { index(a).record_begin[1] = -1; }},
    {"RecordsNotAscending", invalid,
     [](Asset& a) { std::swap(index(a).record_begin[1], index(a).record_begin[2]); }},
    {"RecordsHuge", invalid,
     [](Asset& a) { index(a).record_begin.back() = std::numeric_limits<std::int64_t>::max(); }},
    {"PayloadShort", invalid, [](Asset& a) { compressed(a).payload.pop_back(); }},
    {"PayloadLong", invalid, [](Asset& a) { compressed(a).payload.push_back({}); }},
    {"ShiftNaN", invalid, [](Asset& a) { compressed(a).header.shift = nan; }},
    {"ShiftNegative", invalid, [](Asset& a) { compressed(a).header.shift = -1e-9; }},
    {"ShiftOfADenseCompliance", invalid, [](Asset& a) { header(a).shift = 1e-3; }},
    {"ProlongationWithoutCoarsening", invalid, [](Asset& a) { coarse(a).header.coarsening = 0; }},
    {"CoarseningWithoutProlongation", invalid, [](Asset& a) { compressed(a).header.coarsening = 1; }},
    {"CoarseningOfTwoLevels", invalid, [](Asset& a) { coarse(a).header.coarsening = 2; }},
    {"CoarseningNegative", invalid, [](Asset& a) { coarse(a).header.coarsening = -1; }},
    {"ProlongationShort", invalid, [](Asset& a) { coarse(a).prolongation.pop_back(); }},
    {"ProlongationOutOfRange", invalid, [](Asset& a) { coarse(a).prolongation[5].row[3] = 8; }},
    {"ProlongationNegative", invalid, [](Asset& a) { coarse(a).prolongation[5].row[3] = -1; }},
    {"ProlongationNaN", invalid, [](Asset& a) { coarse(a).prolongation[5].weight[3] = nan; }},
    {"ProlongationOfSumAlmostOne", invalid,
     [](Asset& a) { coarse(a).prolongation[5].weight[0] += 2e-6; }},
    {"CoarseNodeOutOfRange", invalid, [](Asset& a) { coarse(a).nodes.back() = 27; }},
    {"CoarseNodesMissing", invalid,
     [](Asset& a) { coarse(a).nodes.clear(), coarse(a).prolongation.clear(); }},
};

LevelTransition& transition(Asset& a) { return a.multigrid[0]; }
constexpr IssueCode no_plan = IssueCode::asset_multigrid_invalid;

const Fault multigrid_faults[] = {
    {"TransitionTooMany", no_plan, [](Asset& a) { a.multigrid.push_back(a.multigrid[0]); }},
    {"RowMissing", no_plan, [](Asset& a) { transition(a).row_begin.pop_back(); }},
    {"RowsEmpty", no_plan, [](Asset& a) { transition(a).row_begin.clear(); }},
    {"RowsDescend", no_plan, [](Asset& a) { transition(a).row_begin[4] = 1 << 30; }},
    {"RowsNegative", no_plan, [](Asset& a) { transition(a).row_begin[4] = -1; }},
    {"RowsPastTheEnd", no_plan, [](Asset& a) { ++transition(a).row_begin.back(); }},
    {"RowWithoutEntries", no_plan,
     [](Asset& a) { transition(a).row_begin[4] = transition(a).row_begin[3]; }},
    {"ColumnOutOfRange", no_plan, [](Asset& a) { transition(a).column[0] = 8; }},
    {"ColumnNegative", no_plan, [](Asset& a) { transition(a).column[0] = -1; }},
    {"WeightMissing", no_plan, [](Asset& a) { transition(a).weight.pop_back(); }},
    {"WeightNaN", no_plan, [](Asset& a) { transition(a).weight[3] = nan; }},
    {"WeightOfSumAlmostOne", no_plan, [](Asset& a) { transition(a).weight[3] += 2e-6; }},
    {"PatternShort", no_plan, [](Asset& a) { transition(a).pattern_begin.pop_back(); }},
    {"PatternColumn", no_plan, [](Asset& a) { transition(a).pattern_column[1] = 1 << 30; }},
    {"PatternWithoutDiagonal", no_plan,
     [](Asset& a) {
       LevelTransition& t = transition(a);
       t.pattern_column.erase(t.pattern_column.begin());
       for (Index& begin : t.pattern_begin) begin -= begin > 0 ? 1 : 0;
     }},
    {"PieceMissing", no_plan, [](Asset& a) { transition(a).pieces.pop_back(); }},
    {"PieceOfNoNode", no_plan, [](Asset& a) { transition(a).pieces[2][0] = 27; }},
    {"PieceNegative", no_plan, [](Asset& a) { transition(a).pieces[2][1] = -5; }},
    {"PieceWithoutBlocks", no_plan, [](Asset& a) { transition(a).pieces[2][2] = 0; }},
    {"PieceTooLong", no_plan, [](Asset& a) { transition(a).pieces[2][2] = 256; }},
    {"PieceOfTooManySlots", no_plan, [](Asset& a) { transition(a).pieces[2][3] = 257; }},
    {"SlotOutOfRange", no_plan, [](Asset& a) { transition(a).slots[3][2] = 255; }},
    {"SlotsShort", no_plan, [](Asset& a) { transition(a).slots.pop_back(); }},
    {"SlotsLeftOver", no_plan, [](Asset& a) { transition(a).slots.push_back({}); }},
    {"TargetOutOfRange", no_plan, [](Asset& a) { transition(a).targets[3][2] = 1 << 30; }},
    {"TargetNegative", no_plan, [](Asset& a) { transition(a).targets[3][2] = -1; }},
    {"TargetsShort", no_plan, [](Asset& a) { transition(a).targets.pop_back(); }},
};

class Validation : public ::testing::TestWithParam<Fault> {};

TEST_P(Validation, FindsTheFault) {
  Asset asset = make_sample_asset();
  GetParam().spoil(asset);
  const ValidationReport report = validate_asset_content(asset);
  EXPECT_FALSE(report.valid());
  EXPECT_TRUE(std::ranges::any_of(report.issues, [](const Issue& i) {
    return i.code == GetParam().code;
  })) << (report.issues.empty() ? "no issue" : format_issue(report.issues.front()));
}

const auto fault_name = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(Mesh, Validation, ::testing::ValuesIn(mesh_faults), fault_name);
INSTANTIATE_TEST_SUITE_P(Embedding, Validation, ::testing::ValuesIn(embedding_faults), fault_name);
INSTANTIATE_TEST_SUITE_P(Multigrid, Validation, ::testing::ValuesIn(multigrid_faults), fault_name);
INSTANTIATE_TEST_SUITE_P(Parts, Validation, ::testing::ValuesIn(part_faults), fault_name);
INSTANTIATE_TEST_SUITE_P(Compliance, Validation, ::testing::ValuesIn(compliance_faults), fault_name);
INSTANTIATE_TEST_SUITE_P(Hierarchy, Validation, ::testing::ValuesIn(hierarchy_faults), fault_name);

TEST(ValidationReport, IsCapped) {
  Asset asset = make_sample_asset({.cells = 3});
  for (Point& node : asset.levels[1].mesh.nodes) node[0] = nan;
  const ValidationReport report = validate_asset_content(asset, {5});
  EXPECT_EQ(report.issues.size(), 5u);
  EXPECT_EQ(report.suppressed_count, asset.levels[1].mesh.nodes.size() - 5);
  EXPECT_FALSE(report.valid());
}

// Judged by the size of the body, wherever it stands and whatever the unit of its file was.
TEST(ValidationReport, OfAnEmbeddingFarFromTheOriginOrOfAnySizeIsEmpty) {
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double shift : {0.0, 5.0}) {
      Asset asset = make_sample_asset();
      const auto move = [&](std::vector<Point>& points) {
        for (Point& point : points)
          for (double& x : point) x = scale * (x + shift);
      };
      for (MeshLevel& level : asset.levels) move(level.mesh.nodes);
      move(asset.visual.surface.vertices);
      const ValidationReport report = validate_asset_content(asset);
      EXPECT_TRUE(report.issues.empty()) << scale << " " << format_issue(report.issues.front());
    }
}

TEST(ValidationReport, OfASoundAssetIsEmpty) {
  const ValidationReport report = validate_asset_content(make_sample_asset({.cells = 2}));
  EXPECT_TRUE(report.issues.empty()) << format_issue(report.issues.front());
  EXPECT_TRUE(report.valid());
}

TEST(Names, AreValidUtf8WithoutSlash) {
  for (const char* good : {"a", "left hand", "größe", "\xf0\x9f\x8d\x8b", "...", "\xef\xbf\xbd"})
    EXPECT_TRUE(is_valid_name(good)) << good;
  for (const char* bad : {"", ".", "..", "a/b", "/", "a\n", "\x7f", "\xff", "\xc0\xaf", "\xe0\x80\xaf",
                          "\xed\xa0\x80", "\xf4\x90\x80\x80", "a\xc3", "\x80"})
    EXPECT_FALSE(is_valid_name(bad)) << bad;
  EXPECT_TRUE(is_valid_name(std::string(128, 'x')));
  EXPECT_FALSE(is_valid_name(std::string(129, 'x')));
}

}  // namespace
}  // namespace souple::test
