// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include "formats/write/asset_writer.hpp"
#include "formats/write/replace_file.hpp"
#include "sample_asset.hpp"

namespace souple::test {
namespace {

IssueCode code_of(const Status& status) { return status ? IssueCode{} : status.issue().code; }

TEST(AssetWriter, LeavesNothingBehindOnAFullDisk) {
  const ScratchFolder scratch;
  const std::string file = scratch.path("a.souple");
  const std::string old = "the old content";
  write_bytes(file, std::as_bytes(std::span(old)));
  const std::vector<std::byte> before = read_bytes(file);
  // A limit on the size of files makes write(2) fail as a full disk does; in a child, for it is for
  // good.
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{8192, 8192};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::_exit(code_of(write_asset(make_sample_asset(), file)) == IssueCode::io_cannot_write ? 0 : 1);
  }
  int status = 1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(scratch.entry_count(), 1u);
  EXPECT_EQ(read_bytes(file), before);
}

TEST(AssetWriter, RefusesAFolderInThePlace) {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("a.souple");
  std::filesystem::create_directory(folder);
  EXPECT_EQ(code_of(write_asset(make_sample_asset(), folder)), IssueCode::io_cannot_write);
  EXPECT_EQ(code_of(write_asset(make_sample_asset(), folder + "/")), IssueCode::io_cannot_write);
  EXPECT_EQ(scratch.entry_count(), 1u);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(AssetWriter, RefusesAFolderThatIsNotThere) {
  const ScratchFolder scratch;
  EXPECT_EQ(code_of(write_asset(make_sample_asset(), scratch.path("none/a.souple"))),
            IssueCode::io_cannot_write);
  EXPECT_EQ(code_of(write_asset(make_sample_asset(), "")), IssueCode::io_cannot_write);
  EXPECT_EQ(code_of(write_asset(make_sample_asset(), "/proc/a.souple")), IssueCode::io_cannot_write);
  EXPECT_EQ(scratch.entry_count(), 0u);
}

TEST(AssetWriter, RefusesAReadOnlyFolder) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const ScratchFolder scratch;
  ASSERT_EQ(::chmod(scratch.folder().c_str(), 0555), 0);
  EXPECT_EQ(code_of(write_asset(make_sample_asset(), scratch.path("a.souple"))),
            IssueCode::io_cannot_write);
  EXPECT_EQ(::chmod(scratch.folder().c_str(), 0755), 0);
  EXPECT_EQ(scratch.entry_count(), 0u);
}

TEST(AssetWriter, NeverReplacesADevice) {
  for (const char* device : {"/dev/full", "/dev/null"}) {
    EXPECT_EQ(code_of(write_asset(make_sample_asset(), device)), IssueCode::io_cannot_write);
    EXPECT_TRUE(std::filesystem::is_character_file(device));
  }
}

TEST(AssetWriter, WritesToWhatALinkPointsTo) {
  const ScratchFolder scratch;
  write_bytes(scratch.path("real.souple"), {});
  std::filesystem::create_symlink("real.souple", scratch.path("link.souple"));
  ASSERT_TRUE(write_asset(make_sample_asset(), scratch.path("link.souple")).ok());
  EXPECT_TRUE(std::filesystem::is_symlink(scratch.path("link.souple")));
  EXPECT_GT(std::filesystem::file_size(scratch.path("real.souple")), 0u);
  EXPECT_EQ(scratch.entry_count(), 2u);
}

TEST(AssetWriter, TriesAnotherNameWhenTheTemporaryOneIsTaken) {
  const ScratchFolder scratch;
  for (int i = 0; i < 64; ++i)
    write_bytes(
        scratch.path(".souple-" + std::to_string(::getpid()) + "-" + std::to_string(i) + ".tmp"), {});
  EXPECT_TRUE(write_asset(make_sample_asset(), scratch.path("a.souple")).ok());
  EXPECT_EQ(scratch.entry_count(), 65u);
}

TEST(AssetWriter, RefusesAnUnknownLevelOfCompression) {
  for (const int level : {-1, 0, 20, 1000})
    EXPECT_EQ(write_asset_memory(make_sample_asset(), {level}).issue().code,
              IssueCode::usage_bad_value);
}

TEST(AssetWriter, RefusesContentThatValidationRefuses) {
  const ScratchFolder scratch;
  Asset asset = make_sample_asset();
  asset.levels[0].mesh.nodes[2][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code_of(write_asset(asset, scratch.path("a.souple"))), IssueCode::asset_not_finite);
  EXPECT_EQ(code_of(write_asset({}, scratch.path("a.souple"))), IssueCode::asset_mesh_inconsistent);
  EXPECT_EQ(scratch.entry_count(), 0u);
}

}  // namespace
}  // namespace souple::test
