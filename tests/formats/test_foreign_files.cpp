// SPDX-License-Identifier: MIT
// Files that HDF5 itself made: sound HDF5, but not what an asset may hold.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>

#include "foreign_file.hpp"
#include "formats/read/asset_reader.hpp"
#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"

namespace souple::test {
namespace {

std::size_t peak_memory_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) << 10;
}

TEST_F(ForeignFile, OfANewerMajorVersionIsRefused) {
  change([](hid_t file) { set_integer(file, "/", "version_major", 2); });
  EXPECT_EQ(code(), number(IssueCode::unsupported_version));
}

TEST_F(ForeignFile, OfANewerMinorVersionIsReadWithoutItsNewGroups) {
  change([](hid_t file) {
    set_integer(file, "/", "version_minor", 7);
    H5Gclose(H5Gcreate2(file, "future", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Dclose(
        replace_dataset(file, "/mesh/levels/0/colours", {.extent = {4}, .chunk = {}, .filters = {}}));
    H5Gclose(H5Gcreate2(file, "mesh/future", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  });
  Result<AssetReader> reader = AssetReader::open(file_);
  ASSERT_TRUE(reader.ok()) << format_issue(reader.issue());
  EXPECT_EQ(reader->version_minor(), 7);
  EXPECT_TRUE(reader->group_costs().ok());
  const Result<Asset> read = read_asset(*reader);
  ASSERT_TRUE(read.ok());
  EXPECT_TRUE(same_content(asset_, *read));
  EXPECT_EQ(code(), 0);
}

TEST_F(ForeignFile, OfAnImpossibleVersionIsRefused) {
  for (const std::int64_t version :
       {std::int64_t{-1}, std::int64_t{0}, std::numeric_limits<std::int64_t>::max()}) {
    change([&](hid_t file) { set_integer(file, "/", "version_major", version); });
    EXPECT_EQ(code(), number(IssueCode::asset_corrupt));
  }
}

TEST_F(ForeignFile, OfAnotherFormatIsRefused) {
  change([](hid_t file) { set_text(file, "/", "format", "soup"); });
  EXPECT_EQ(code(), number(IssueCode::asset_not_an_asset));
}

TEST_F(ForeignFile, WithAnotherContentHashIsRefused) {
  change([](hid_t file) { set_text(file, "/", "content_hash", std::string(32, '0')); });
  EXPECT_EQ(code(), number(IssueCode::asset_hash_mismatch));
}

TEST_F(ForeignFile, WithAnUnknownRepresentationKeepsItsMesh) {
  change([](hid_t file) { set_text(file, "/compliance/default", "representation", "hodlr"); });
  EXPECT_EQ(code(), number(IssueCode::unsupported_representation));
  Result<AssetReader> reader = AssetReader::open(file_);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(reader->read_level(1).ok());
  EXPECT_TRUE(reader->read_compliance("clamped").ok());
}

TEST_F(ForeignFile, ThatDeclaresHugeSizesIsRefusedWithoutAllocation) {
  constexpr hsize_t exa = hsize_t{1} << 58;
  const std::size_t before = peak_memory_bytes();
  for (const hsize_t rows : {exa, hsize_t{1} << 33, hsize_t{1} << 28}) {
    change([&](hid_t file) {
      H5Dclose(
          replace_dataset(file, "/mesh/levels/0/tets", {.extent = {rows, 4}, .chunk = {65536, 4}}));
    });
    EXPECT_NE(code(), 0) << rows;
  }
  EXPECT_LT(peak_memory_bytes() - before, std::size_t{64} << 20);
}

TEST_F(ForeignFile, WithMissingChunksIsRefused) {
  change([](hid_t file) {
    const hid_t tets =
        replace_dataset(file, "/mesh/levels/0/tets", {.extent = {1 << 28, 4}, .chunk = {65536, 4}});
    const hsize_t start[2] = {0, 0}, count[2] = {65536, 4};
    const hid_t where = H5Dget_space(tets), memory = H5Screate_simple(2, count, nullptr);
    H5Sselect_hyperslab(where, H5S_SELECT_SET, start, nullptr, count, nullptr);
    const std::vector<Index> zeros(4 * 65536);
    ASSERT_GE(H5Dwrite(tets, H5T_NATIVE_INT, memory, where, H5P_DEFAULT, zeros.data()), 0);
    H5Sclose(where), H5Sclose(memory), H5Dclose(tets);
  });
  EXPECT_EQ(code(), number(IssueCode::asset_corrupt));
}

TEST_F(ForeignFile, ThatUnpacksToFarMoreThanItStoresIsRefused) {
  constexpr hsize_t rows = 1 << 23;  // 128 MB of zeros
  const std::vector<Index> zeros(4 * rows);
  change([&](hid_t file) {
    const hid_t tets =
        replace_dataset(file, "/mesh/levels/0/tets", {.extent = {rows, 4}, .chunk = {65536, 4}});
    ASSERT_GE(H5Dwrite(tets, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data()), 0);
    H5Dclose(tets);
  });
  // The zeros are still alive: another copy of them would raise the peak.
  const std::size_t before = peak_memory_bytes();
  EXPECT_EQ(code(), number(IssueCode::asset_limit_exceeded));
  EXPECT_LT(peak_memory_bytes() - before, std::size_t{64} << 20);
}

TEST_F(ForeignFile, WithOtherDatasetsThanOursIsRefused) {
  constexpr auto shuffle = H5Z_FILTER_SHUFFLE, sum = H5Z_FILTER_FLETCHER32;
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, H5T_VARIABLE);
  const std::vector<std::pair<const char*, DatasetShape>> shapes{
      {"not chunked", {.extent = {6, 4}, .chunk = {}, .filters = {}}},
      {"no filters", {.extent = {6, 4}, .chunk = {6, 4}, .filters = {}}},
      {"no checksum", {.extent = {6, 4}, .chunk = {6, 4}, .filters = {shuffle, zstd}}},
      {"other order", {.extent = {6, 4}, .chunk = {6, 4}, .filters = {zstd, shuffle, sum}}},
      {"deflate", {.extent = {6, 4}, .chunk = {6, 4}, .filters = {shuffle, H5Z_FILTER_DEFLATE, sum}}},
      {"int64", {.extent = {6, 4}, .chunk = {6, 4}, .type = H5T_STD_I64LE}},
      {"big endian", {.extent = {6, 4}, .chunk = {6, 4}, .type = H5T_STD_I32BE}},
      {"float", {.extent = {6, 4}, .chunk = {6, 4}, .type = H5T_IEEE_F32LE}},
      {"variable length", {.extent = {6}, .chunk = {6}, .type = text, .filters = {}}},
      {"rank 1", {.extent = {24}, .chunk = {24}}},
      {"rank 3", {.extent = {6, 4, 1}, .chunk = {6, 4, 1}}},
      {"width 3", {.extent = {8, 3}, .chunk = {8, 3}}},
      {"growing", {.extent = {6, 4}, .chunk = {6, 4}, .growing = true}},
      {"large chunks", {.extent = {1 << 20, 4}, .chunk = {1 << 20, 4}}},
      {"empty", {.extent = {0, 4}, .chunk = {6, 4}}},
  };
  for (const auto& [name, shape] : shapes) {
    change([&](hid_t file) { H5Dclose(replace_dataset(file, "/mesh/levels/0/tets", shape)); });
    EXPECT_EQ(code(), number(IssueCode::asset_corrupt)) << name;
  }
  H5Tclose(text);
}

TEST_F(ForeignFile, WithOtherDatasetsOfAHierarchicalComplianceIsRefused) {
  constexpr auto shuffle = H5Z_FILTER_SHUFFLE, sum = H5Z_FILTER_FLETCHER32;
  const hsize_t size = asset_.compliances[3].payload.size();
  struct Replacement {
    const char* name;
    const char* path;
    DatasetShape shape;
  };
  const std::vector<Replacement> replacements{
      {"no checksum",
       "payload",
       {.extent = {size}, .chunk = {64}, .type = H5T_STD_U8LE, .filters = {zstd}}},
      {"no zstd", "payload", {.extent = {size}, .chunk = {64}, .type = H5T_STD_U8LE, .filters = {sum}}},
      {"other order",
       "payload",
       {.extent = {size}, .chunk = {64}, .type = H5T_STD_U8LE, .filters = {sum, zstd}}},
      {"deflate",
       "payload",
       {.extent = {size}, .chunk = {64}, .type = H5T_STD_U8LE, .filters = {H5Z_FILTER_DEFLATE, sum}}},
      {"signed", "payload", {.extent = {size}, .chunk = {64}, .type = H5T_STD_I8LE}},
      {"rank 2", "payload", {.extent = {size, 1}, .chunk = {64, 1}, .type = H5T_STD_U8LE}},
      {"long", "payload", {.extent = {size + 1}, .chunk = {64}, .type = H5T_STD_U8LE}},
      {"huge", "payload", {.extent = {hsize_t{1} << 39}, .chunk = {1 << 20}, .type = H5T_STD_U8LE}},
      {"unshuffled order", "order", {.extent = {26}, .chunk = {26}, .filters = {zstd, sum}}},
      {"wide planes", "planes", {.extent = {12}, .chunk = {12}, .type = H5T_STD_I32LE}},
      {"double scale", "scale", {.extent = {26, 6}, .chunk = {26, 6}, .type = H5T_IEEE_F64LE}},
      {"huge scale",
       "scale",
       {.extent = {hsize_t{1} << 33, 6}, .chunk = {32768, 6}, .type = H5T_IEEE_F32LE}},
      {"int32 begins",
       "record_begin",
       {.extent = {5}, .chunk = {5}, .type = H5T_STD_I32LE, .filters = {shuffle, zstd, sum}}},
  };
  for (const Replacement& replacement : replacements) {
    SetUp();
    change([&](hid_t file) {
      const std::string path = std::string("/compliance/compressed/") + replacement.path;
      H5Dclose(replace_dataset(file, path.c_str(), replacement.shape));
    });
    EXPECT_NE(code(), 0) << replacement.name;
    EXPECT_NE(code(), number(IssueCode::io_out_of_memory)) << replacement.name;
  }
}

TEST_F(ForeignFile, WithoutAPartOfAHierarchicalComplianceIsRefused) {
  for (const char* name : {"nodes", "order", "scale", "leaf_step", "leaf_planes", "rank", "step",
                           "singular", "planes", "record_begin", "payload"}) {
    SetUp();
    change([&](hid_t file) {
      ASSERT_GE(H5Ldelete(file, (std::string("/compliance/compressed/") + name).c_str(), H5P_DEFAULT),
                0);
    });
    EXPECT_NE(code(), 0) << name;
  }
  for (const char* name : {"prolongation_rows", "prolongation_weights"}) {
    SetUp();
    change([&](hid_t file) {
      ASSERT_GE(H5Ldelete(file, (std::string("/compliance/coarse/") + name).c_str(), H5P_DEFAULT), 0);
    });
    EXPECT_EQ(code(), number(IssueCode::asset_corrupt)) << name;
  }
}

TEST_F(ForeignFile, WithoutTheAttributesOfVersion1_2TakesTheirDefaults) {
  change([&](hid_t file) {
    for (const char* name : {"error_norm", "shift", "coarsening"})
      ASSERT_GE(H5Adelete_by_name(file, "/compliance/default", name, H5P_DEFAULT), 0);
  });
  EXPECT_EQ(code(), 0);
  change([&](hid_t file) {
    ASSERT_GE(H5Adelete_by_name(file, "/compliance/compressed", "depth", H5P_DEFAULT), 0);
  });
  EXPECT_EQ(code(), number(IssueCode::asset_corrupt));
}

TEST_F(ForeignFile, WithAnUnknownErrorNormKeepsItsOtherVariants) {
  change([](hid_t file) { set_text(file, "/compliance/default", "error_norm", "nuclear"); });
  EXPECT_EQ(code(), number(IssueCode::unsupported_representation));
  Result<AssetReader> reader = AssetReader::open(file_);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(reader->read_compliance("compressed").ok());
}

TEST_F(ForeignFile, WithAnImpossibleDepthIsRefused) {
  for (const std::int64_t depth : {std::int64_t{-1}, std::int64_t{3}, std::int64_t{64},
                                   std::numeric_limits<std::int64_t>::max()}) {
    change([&](hid_t file) { set_integer(file, "/compliance/compressed", "depth", depth); });
    EXPECT_EQ(code(), number(IssueCode::asset_compliance_invalid)) << depth;
  }
}

TEST_F(ForeignFile, WithAVirtualDatasetIsRefused) {
  change([&](hid_t file) {
    H5Ldelete(file, "/mesh/levels/0/tets", H5P_DEFAULT);
    const hsize_t extent[2] = {6, 4};
    const hid_t space = H5Screate_simple(2, extent, nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    ASSERT_GE(H5Pset_virtual(creation, space, "/etc/passwd", "tets", space), 0);
    H5Dclose(H5Dcreate2(file, "/mesh/levels/0/tets", H5T_STD_I32LE, space, H5P_DEFAULT, creation,
                        H5P_DEFAULT));
    H5Pclose(creation), H5Sclose(space);
  });
  EXPECT_EQ(code(), number(IssueCode::asset_corrupt));
}

TEST_F(ForeignFile, WithDataInAnotherFileIsRefused) {
  change([&](hid_t file) {
    H5Ldelete(file, "/mesh/levels/0/tets", H5P_DEFAULT);
    const hsize_t extent[2] = {6, 4};
    const hid_t space = H5Screate_simple(2, extent, nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    ASSERT_GE(H5Pset_external(creation, "/etc/passwd", 0, 96), 0);
    H5Dclose(H5Dcreate2(file, "/mesh/levels/0/tets", H5T_STD_I32LE, space, H5P_DEFAULT, creation,
                        H5P_DEFAULT));
    H5Pclose(creation), H5Sclose(space);
  });
  EXPECT_EQ(code(), number(IssueCode::asset_corrupt));
}

TEST_F(ForeignFile, WithLinksToElsewhereIsRefused) {
  for (const char* place :
       {"/material", "/mesh/levels", "/mesh/levels/0/nodes", "/constraints/bottom"}) {
    SetUp();
    const std::string other = scratch_.path("other.souple");
    std::filesystem::copy_file(file_, other, std::filesystem::copy_options::overwrite_existing);
    change([&](hid_t file) {
      H5Ldelete(file, place, H5P_DEFAULT);
      ASSERT_GE(H5Lcreate_external(other.c_str(), place, file, place, H5P_DEFAULT, H5P_DEFAULT), 0);
    });
    EXPECT_EQ(code(), number(IssueCode::asset_corrupt)) << "external " << place;
    SetUp();
    change([&](hid_t file) {
      ASSERT_GE(H5Lmove(file, place, file, "/kept", H5P_DEFAULT, H5P_DEFAULT), 0);
      ASSERT_GE(H5Lcreate_soft("/kept", file, place, H5P_DEFAULT, H5P_DEFAULT), 0);
    });
    EXPECT_EQ(code(), number(IssueCode::asset_corrupt)) << "soft " << place;
  }
}

TEST_F(ForeignFile, WithARingOfLinksIsRefused) {
  change([](hid_t file) {
    H5Ldelete(file, "/mesh/levels/1", H5P_DEFAULT);
    ASSERT_GE(H5Lcreate_hard(file, "/mesh", file, "/mesh/levels/1", H5P_DEFAULT, H5P_DEFAULT), 0);
  });
  EXPECT_NE(code(), 0);
}

// HDF5 1.10 does not compare the decoded size of a chunk with the size it must have.
TEST_F(ForeignFile, WithChunksThatAreTooShortOrUnfilteredIsRefused) {
  for (const std::uint32_t mask : {0u, 7u})
    for (const std::size_t size : {1u, 13u, 40u}) {
      SetUp();
      change([&](hid_t file) {
        const hid_t tets = H5Dopen2(file, "/mesh/levels/0/tets", H5P_DEFAULT);
        const std::vector<std::byte> bytes(size);
        const hsize_t offset[2] = {0, 0};
        ASSERT_GE(H5Dwrite_chunk(tets, H5P_DEFAULT, mask, offset, size, bytes.data()), 0);
        H5Dclose(tets);
      });
      EXPECT_EQ(code(), number(IssueCode::asset_corrupt)) << mask << ", " << size;
    }
}

TEST_F(ForeignFile, WithAChunkThatDecodesToLessIsRefused) {
  change([&](hid_t file) {
    // The sound chunk of a shorter dataset, with its checksum, in the place of a longer one.
    const hid_t donor = replace_dataset(file, "/donor", {.extent = {2, 4}, .chunk = {2, 4}});
    const std::vector<Index> tets(8, 1);
    ASSERT_GE(H5Dwrite(donor, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, tets.data()), 0);
    ASSERT_GE(H5Dflush(donor), 0);
    const hsize_t offset[2] = {0, 0};
    hsize_t size = 0;
    ASSERT_GE(H5Dget_chunk_storage_size(donor, offset, &size), 0);
    std::vector<std::byte> chunk(size);
    std::uint32_t mask = 0;
    ASSERT_GE(H5Dread_chunk(donor, H5P_DEFAULT, offset, &mask, chunk.data()), 0);
    const hid_t target = H5Dopen2(file, "/mesh/levels/0/tets", H5P_DEFAULT);
    ASSERT_GE(H5Dwrite_chunk(target, H5P_DEFAULT, 0, offset, size, chunk.data()), 0);
    H5Dclose(donor), H5Dclose(target);
  });
  EXPECT_EQ(code(), number(IssueCode::asset_corrupt));
}

TEST(OtherHdf5, MadeWithDefaultsIsNoAsset) {
  const ScratchFolder scratch;
  const std::string file = scratch.path("default.h5");
  H5Fclose(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_EQ(AssetReader::open(file).issue().code, IssueCode::asset_not_an_asset);
}

TEST(OtherHdf5, FrictionContactProblemsAreNoAssets) {
  const char* chosen = std::getenv("SOUPLE_DATA_DIR");
  const std::filesystem::path folder =
      std::filesystem::path(chosen != nullptr ? chosen : SOUPLE_DEFAULT_DATA_DIR) / "contact";
  if (!std::filesystem::is_directory(folder)) {
    if (std::getenv("CI") != nullptr) FAIL() << "no data at " << folder;
    GTEST_SKIP() << "no data at " << folder;
  }
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const Result<AssetReader> reader = AssetReader::open(entry.path());
    ASSERT_FALSE(reader.ok()) << entry.path();
    EXPECT_EQ(reader.issue().code, IssueCode::asset_not_an_asset) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 10);
}

}  // namespace
}  // namespace souple::test
