// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <random>

#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/base64.hpp"
#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/numbers.hpp"

namespace souple {
namespace {
namespace fs = std::filesystem;

TEST(NearestName, FindsSlipsOfTheFingers) {
  const std::vector<std::string> names{"--tets", "--levels", "--edge-length-m", "--young-pa"};
  EXPECT_EQ(nearest_name("--test", names), "--tets");
  EXPECT_EQ(nearest_name("--level", names), "--levels");
  EXPECT_EQ(nearest_name("--edge-lenght-m", names), "--edge-length-m");
  EXPECT_EQ(nearest_name("--young", names), "--young-pa");
  EXPECT_EQ(nearest_name("--colour-of-the-sky", names), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), names), "");
}

TEST(PlainName, AllowsOnlyWhatMayStandInAFileName) {
  for (const char* name : {"liver", "a", "A-1_b.c"}) EXPECT_TRUE(is_plain_name(name)) << name;
  for (const char* name : {"", ".", "..", ".hidden", "a/b", "a b", "é", "a\nb"})
    EXPECT_FALSE(is_plain_name(name)) << name;
  EXPECT_TRUE(is_plain_name(std::string(64, 'a')));
  EXPECT_FALSE(is_plain_name(std::string(65, 'a')));
}

TEST(Numbers, AcceptsOnlyWholeFiniteTexts) {
  EXPECT_EQ(parse_number("0.25"), 0.25);
  EXPECT_EQ(parse_number("+1e-3"), 1e-3);
  EXPECT_EQ(parse_number("-2"), -2.0);
  for (const char* text :
       {"", " 1", "1 ", "1,5", "nan", "inf", "-inf", "1e999", "0x10", "+-1", "1.2.3"})
    EXPECT_FALSE(parse_number(text).has_value()) << text;
  EXPECT_EQ(parse_integer("12"), 12);
  for (const char* text : {"", "1.0", "1e3", "99999999999999999999", "ten"})
    EXPECT_FALSE(parse_integer(text).has_value()) << text;
}

TEST(Numbers, ExactTextReadsBackAsTheSameDouble) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const double value =
        std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 200) - 150);
    EXPECT_EQ(parse_number(exact_text(value)), value);
  }
  EXPECT_EQ(exact_text(1), "1.0");
  EXPECT_EQ(exact_text(0.2), "0.2");
}

TEST(NumberRange, HonoursOpenEndsAndNeverHoldsNan) {
  const NumberRange half_open{0, 1, true, false};
  EXPECT_FALSE(half_open.contains(0));
  EXPECT_TRUE(half_open.contains(1));
  EXPECT_FALSE(half_open.contains(std::nan("")));
  EXPECT_EQ(half_open.text(), "(0, 1]");
}

TEST(Base64, MatchesTheVectorsOfRfc4648) {
  const std::array<std::pair<std::string, std::string>, 7> vectors{{{"", ""},
                                                                    {"f", "Zg=="},
                                                                    {"fo", "Zm8="},
                                                                    {"foo", "Zm9v"},
                                                                    {"foob", "Zm9vYg=="},
                                                                    {"fooba", "Zm9vYmE="},
                                                                    {"foobar", "Zm9vYmFy"}}};
  for (const auto& [plain, encoded] : vectors) {
    std::string text;
    append_base64(text, std::as_bytes(std::span(plain)));
    EXPECT_EQ(text, encoded);
  }
}

class AtomicFile : public testing::Test {
 protected:
  AtomicFile()
      : folder_(fs::path(testing::TempDir()) / ("souple_atomic_file_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~AtomicFile() override { fs::remove_all(folder_); }
  std::size_t entry_count() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

TEST_F(AtomicFile, ReplacesAFileAndLeavesNothingElse) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a.txt", "one").ok());
  ASSERT_TRUE(write_file_atomically(folder_ / "a.txt", "two").ok());
  EXPECT_EQ(*read_text_file(folder_ / "a.txt", 100), "two");
  EXPECT_EQ(entry_count(), 1u);
}

TEST_F(AtomicFile, RefusesADirectoryAndAMissingFolder) {
  EXPECT_EQ(write_file_atomically(folder_, "x").issue().code, IssueCode::io_cannot_write);
  EXPECT_EQ(write_file_atomically(folder_ / "no" / "a.txt", "x").issue().code,
            IssueCode::io_cannot_write);
  EXPECT_EQ(write_file_atomically(folder_ / "", "x").issue().code, IssueCode::io_cannot_write);
  EXPECT_EQ(entry_count(), 0u);
}

TEST_F(AtomicFile, RefusesFilesThatAreTooLargeOrNotRegular) {
  ASSERT_TRUE(write_file_atomically(folder_ / "a.txt", "four").ok());
  EXPECT_EQ(read_text_file(folder_ / "a.txt", 3).issue().code, IssueCode::io_file_too_large);
  EXPECT_EQ(read_text_file(folder_, 3).issue().code, IssueCode::io_cannot_read);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(read_text_file(folder_ / "pipe", 3).issue().code, IssueCode::io_cannot_read);
}

}  // namespace
}  // namespace souple
