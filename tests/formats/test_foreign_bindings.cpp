// SPDX-License-Identifier: MIT
// Embeddings and visual surfaces in files of unknown origin: what the reader itself refuses before
// anybody can use it.
#include <cmath>
#include <limits>

#include "foreign_file.hpp"
#include "formats/read/asset_reader.hpp"

namespace souple::test {
namespace {

constexpr const char* level_tets = "/mesh/levels/1/embedding_tets";
constexpr const char* level_weights = "/mesh/levels/1/embedding_weights";
constexpr const char* visual_tets = "/mesh/visual/embedding_tets";
constexpr const char* visual_weights = "/mesh/visual/embedding_weights";

class ForeignBindings : public ForeignFile {
 protected:
  int level_code() const {
    Result<AssetReader> reader = AssetReader::open(file_);
    const Result<MeshLevel> level = reader ? reader->read_level(1) : Result<MeshLevel>(reader.issue());
    return level ? 0 : number(level.issue().code);
  }
  int visual_code() const {
    Result<AssetReader> reader = AssetReader::open(file_);
    const Result<VisualMesh> visual =
        reader ? reader->read_visual() : Result<VisualMesh>(reader.issue());
    return visual ? 0 : number(visual.issue().code);
  }
  void set(const char* path, std::size_t scalar, double value) {
    change([&](hid_t file) { set_scalar(file, path, scalar, value); });
  }
};

TEST_F(ForeignBindings, OutsideTheMeshAreRefusedByTheReader) {
  for (const double tet : {-1.0, 6.0, 2147483647.0, -2147483648.0}) {
    set(level_tets, 5, tet);
    EXPECT_EQ(level_code(), number(IssueCode::asset_index_out_of_range)) << tet;
  }
  for (const double tet : {-1.0, 48.0, 2147483647.0}) {
    set(visual_tets, 5, tet);
    EXPECT_EQ(visual_code(), number(IssueCode::asset_index_out_of_range)) << tet;
  }
  set(visual_tets, 5, 0);
  set("/mesh/visual/triangles", 7, 56);
  EXPECT_EQ(visual_code(), number(IssueCode::asset_index_out_of_range));
}

TEST_F(ForeignBindings, WithUnusableNumbersAreRefusedByTheReader) {
  for (const double weight : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300, 2.0}) {
    set(level_weights, 9, weight);
    EXPECT_EQ(level_code(), number(IssueCode::asset_embedding_invalid)) << weight;
    set(visual_weights, 9, weight);
    EXPECT_EQ(visual_code(), number(IssueCode::asset_embedding_invalid)) << weight;
  }
  set("/mesh/visual/vertices", 4, 1e200);
  EXPECT_EQ(visual_code(), number(IssueCode::asset_not_finite));
}

TEST_F(ForeignBindings, OfOtherShapesAreRefused) {
  const std::vector<std::pair<const char*, DatasetShape>> shapes{
      {level_tets, {.extent = {26}, .chunk = {26}}},
      {level_tets, {.extent = {27, 1}, .chunk = {27, 1}}},
      {level_tets, {.extent = {27}, .chunk = {27}, .type = H5T_IEEE_F64LE}},
      {level_weights, {.extent = {27, 3}, .chunk = {27, 3}, .type = H5T_IEEE_F64LE}},
      {level_weights, {.extent = {27, 4}, .chunk = {27, 4}, .type = H5T_IEEE_F32LE}},
      {level_weights, {.extent = {108}, .chunk = {108}, .type = H5T_IEEE_F64LE}},
      {visual_weights, {.extent = {55, 4}, .chunk = {55, 4}, .type = H5T_IEEE_F64LE}},
      {"/mesh/visual/vertices", {.extent = {56, 3}, .chunk = {56, 3}}},
      {"/mesh/visual/triangles", {.extent = {81, 4}, .chunk = {81, 4}}},
  };
  for (const auto& [path, shape] : shapes) {
    ASSERT_NO_FATAL_FAILURE(SetUp());
    change([&](hid_t file) { H5Dclose(replace_dataset(file, path, shape)); });
    EXPECT_NE(level_code() + visual_code(), 0) << path;
  }
}

// Datasets whose chunks were never written have plausible shapes, and yet no data.
TEST_F(ForeignBindings, OfHugeSizesAreRefusedWithoutData) {
  for (const hsize_t rows : {hsize_t{27}, hsize_t{1} << 28, hsize_t{1} << 40}) {
    change([&](hid_t file) {
      H5Dclose(replace_dataset(file, level_weights,
                               {.extent = {rows, 4}, .chunk = {16, 4}, .type = H5T_IEEE_F64LE}));
      H5Dclose(replace_dataset(file, visual_tets, {.extent = {rows}, .chunk = {16}}));
    });
    EXPECT_NE(level_code(), 0) << rows;
    EXPECT_NE(visual_code(), 0) << rows;
  }
}

TEST_F(ForeignBindings, ThatLackAColumnAreRefused) {
  change([](hid_t file) {
    H5Ldelete(file, level_weights, H5P_DEFAULT);
    H5Ldelete(file, visual_tets, H5P_DEFAULT);
  });
  EXPECT_EQ(level_code(), number(IssueCode::asset_missing_part));
  EXPECT_EQ(visual_code(), number(IssueCode::asset_missing_part));
}

TEST_F(ForeignBindings, TakenAwayLeaveALevelThatHangsOnItsParents) {
  change([](hid_t file) {
    H5Ldelete(file, level_weights, H5P_DEFAULT);
    H5Ldelete(file, level_tets, H5P_DEFAULT);
  });
  EXPECT_EQ(level_code(), 0);
  EXPECT_EQ(code(), number(IssueCode::asset_hash_mismatch));
  change([](hid_t file) { H5Ldelete(file, "/mesh/levels/1/parents", H5P_DEFAULT); });
  EXPECT_EQ(level_code(), number(IssueCode::asset_hierarchy_invalid));
}

TEST_F(ForeignBindings, OfTransitionsAreRefusedByTheReader) {
  const auto transition_code = [&] {
    Result<AssetReader> reader = AssetReader::open(file_);
    const auto read = reader ? reader->read_transition(1) : Result<LevelTransition>(reader.issue());
    return read ? 0 : number(read.issue().code);
  };
  EXPECT_EQ(transition_code(), 0);
  const std::pair<const char*, double> values[] = {
      {"prolongation_begin", -1}, {"prolongation_column", 8},     {"prolongation_weight", std::nan("")},
      {"pattern_begin", 1e9},     {"pattern_column", -1},         {"plan_pieces", -1},
      {"plan_slots", 255},        {"plan_targets", -2147483648.0}};
  for (const auto& [name, value] : values) {
    const std::string path = std::string("/multigrid/1/") + name;
    ASSERT_NO_FATAL_FAILURE(SetUp());
    set(path.c_str(), 5, value);
    EXPECT_EQ(transition_code(), number(IssueCode::asset_multigrid_invalid)) << name;
    ASSERT_NO_FATAL_FAILURE(SetUp());
    change([&](hid_t file) {
      H5Dclose(
          replace_dataset(file, path.c_str(), {.extent = {hsize_t{1} << 30, 4}, .chunk = {16, 4}}));
    });
    EXPECT_NE(transition_code(), 0) << name;
    change([&](hid_t file) { H5Ldelete(file, path.c_str(), H5P_DEFAULT); });
    EXPECT_EQ(transition_code(), number(IssueCode::asset_missing_part)) << name;
  }
}

TEST_F(ForeignBindings, ThatAreNoGroupAreRefused) {
  change([](hid_t file) {
    H5Ldelete(file, "/mesh/visual", H5P_DEFAULT);
    H5Dclose(replace_dataset(file, "/mesh/visual", {.extent = {3}, .chunk = {3}}));
  });
  EXPECT_EQ(visual_code(), number(IssueCode::asset_corrupt));
  EXPECT_EQ(code(), number(IssueCode::asset_corrupt));
  change([](hid_t file) {
    H5Ldelete(file, "/mesh/visual", H5P_DEFAULT);
    H5Lcreate_external("other.souple", "/mesh/visual", file, "/mesh/visual", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_EQ(visual_code(), number(IssueCode::asset_corrupt));
}

TEST_F(ForeignBindings, WithAnErrorThatIsNoNumberAreRefused) {
  change([](hid_t file) {
    const double nan = std::nan("");
    const char* name = "rigid_motion_error_embedding";
    const hid_t level = H5Gopen2(file, "/mesh/levels/1", H5P_DEFAULT);
    ASSERT_GE(H5Adelete(level, name), 0);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(level, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &nan), 0);
    H5Aclose(attribute), H5Sclose(space), H5Gclose(level);
  });
  EXPECT_EQ(level_code(), number(IssueCode::asset_corrupt));
}

}  // namespace
}  // namespace souple::test
