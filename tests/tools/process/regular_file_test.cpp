// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/process/regular_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tools/process/length_unit.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

class RegularFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "souple_regular_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    std::ofstream(folder_ / "five") << "12345";
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(RegularFile, GivesItsBytesUpToTheLimit) {
  EXPECT_EQ(*read_regular_file(folder_ / "five", 5), "12345");
  EXPECT_EQ(read_regular_file(folder_ / "five", 4).issue().code, IssueCode::io_file_too_large);
  EXPECT_EQ(read_regular_file(folder_ / "five", 4, IssueCode::surface_too_large).issue().code,
            IssueCode::surface_too_large);
}

TEST_F(RegularFile, RefusesWhatIsNoneWithoutWaiting) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(read_regular_file(folder_ / "pipe", 9).issue().code, IssueCode::io_cannot_read);
  EXPECT_EQ(read_regular_file(folder_, 9).issue().code, IssueCode::io_cannot_read);
  EXPECT_EQ(read_regular_file("/dev/zero", 9).issue().code, IssueCode::io_cannot_read);
  EXPECT_EQ(read_regular_file(folder_ / "none", 9).issue().code, IssueCode::io_file_missing);
  EXPECT_EQ(read_regular_file(folder_ / "five" / "none", 9).issue().code, IssueCode::io_file_missing);
}

TEST(HashText, IsTheCanonicalXxh3) { EXPECT_EQ(hash_text(""), "99aa06d3014798d86001c324468d497f"); }

TEST(LengthUnit, KnowsItsNamesAndNoOthers) {
  EXPECT_EQ(metres_per_unit("in"), 0.0254);
  EXPECT_FALSE(metres_per_unit("").has_value());
  EXPECT_FALSE(metres_per_unit("furlong").has_value());
}

}  // namespace
}  // namespace souple
