// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/strict_toml.hpp"

#include <gtest/gtest.h>

#include <array>

namespace souple {
namespace {

TomlTable parsed(const std::string& text) {
  auto table = TomlTable::parse(text, "file.toml");
  EXPECT_TRUE(table.ok());
  return *table;
}

TEST(StrictToml, NamesLineAndColumnOfASyntaxError) {
  const auto table = TomlTable::parse("a = 1\nb = = 2\n", "file.toml");
  ASSERT_FALSE(table.ok());
  EXPECT_EQ(table.issue().code, IssueCode::config_syntax);
  EXPECT_TRUE(table.issue().where.starts_with("file.toml:2:")) << table.issue().where;
}

TEST(StrictToml, SuggestsTheNearestKnownKeyForAnUnknownOne) {
  TomlTable root = parsed("[mesh]\ntest = 5\n");
  TomlTable mesh = root.table("mesh");
  mesh.integer("tets", 1, 10);
  mesh.integer("levels", 1, 10);
  const Status status = root.finish();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.issue().code, IssueCode::config_unknown_key);
  EXPECT_NE(status.issue().mend.find("\"tets\""), std::string::npos) << status.issue().mend;
  EXPECT_EQ(status.issue().where, "file.toml:2: [mesh] test");
}

TEST(StrictToml, ReportsTheUnknownKeyRatherThanTheMissingOneItWasMeantToBe) {
  TomlTable root = parsed("nmae = \"x\"\n");
  root.require("name", "what it is called");
  root.text("name");
  EXPECT_EQ(root.finish().issue().code, IssueCode::config_unknown_key);
}

TEST(StrictToml, ReportsTheFirstUnknownKeyInTheFile) {
  TomlTable root = parsed("zebra = 1\napple = 2\n");
  EXPECT_NE(root.finish().issue().what.find("zebra"), std::string::npos);
}

TEST(StrictToml, RefusesNumbersThatAreNotFiniteOrOutOfRange) {
  for (const char* text : {"x = nan", "x = inf", "x = -inf", "x = -1.0", "x = 11", "x = 1e300"}) {
    TomlTable root = parsed(text);
    EXPECT_FALSE(root.number("x", {0, 10}).has_value()) << text;
    EXPECT_EQ(root.status().issue().code, IssueCode::config_bad_value) << text;
  }
}

TEST(StrictToml, RefusesValuesOfAnotherKind) {
  const NumberRange any;
  for (const char* text : {"x = \"1\"", "x = true", "x = [1]", "x = {a = 1}", "x = 1979-05-27"}) {
    TomlTable root = parsed(text);
    EXPECT_FALSE(root.number("x", any).has_value()) << text;
    EXPECT_EQ(root.status().issue().code, IssueCode::config_bad_value) << text;
  }
  TomlTable root = parsed("x = 1.5");
  EXPECT_FALSE(root.integer("x", 0, 10).has_value());
}

TEST(StrictToml, RefusesArraysOfAnotherLengthOrWithHolesInThem) {
  for (const char* text : {"x = [1, 2]", "x = [1, 2, 3, 4]", "x = [1, 2, nan]", "x = [1, \"2\", 3]"}) {
    TomlTable root = parsed(text);
    EXPECT_FALSE(root.point("x", {-10, 10}).has_value()) << text;
    EXPECT_FALSE(root.status().ok()) << text;
  }
}

TEST(StrictToml, ReadsAnAbsentTableAsEmpty) {
  TomlTable root = parsed("");
  EXPECT_FALSE(root.table("mesh").number("x", {}).has_value());
  EXPECT_TRUE(root.tables("body").empty());
  EXPECT_TRUE(root.finish().ok());
}

TEST(StrictToml, RefusesATableInPlaceOfAnArrayOfTables) {
  TomlTable root = parsed("[body]\nx = 1\n");
  root.tables("body");
  EXPECT_EQ(root.finish().issue().code, IssueCode::config_bad_value);
}

TEST(StrictToml, RefusesTextsWithControlCharactersAndEmptyOnes) {
  for (const char* text : {"x = \"\"", "x = \"a\\u0000b\"", "x = \"a\\nb\""}) {
    TomlTable root = parsed(text);
    EXPECT_FALSE(root.text("x").has_value()) << text;
  }
}

TEST(StrictToml, SurvivesDeepNesting) {
  const std::string deep(100000, '[');
  EXPECT_FALSE(TomlTable::parse("x = " + deep, "file.toml").ok());
}

TEST(StrictToml, SurvivesEveryTruncationOfADocument) {
  const std::string text =
      "[world]\ntime_step_s = 0.01\n[[body]]\nname = \"liver\" # é\np = [1, 2.5e-3, 3]\n";
  for (std::size_t length = 0; length <= text.size(); ++length) {
    auto table = TomlTable::parse(text.substr(0, length), "file.toml");
    if (table.ok())
      table->finish().ok();
    else
      EXPECT_EQ(table.issue().code, IssueCode::config_syntax);
  }
}

TEST(StrictToml, RefusesAFileThatIsADirectoryOrMissing) {
  EXPECT_EQ(TomlTable::parse_file("/").issue().code, IssueCode::io_cannot_read);
  EXPECT_EQ(TomlTable::parse_file("/nowhere/x.toml").issue().code, IssueCode::io_file_missing);
}

}  // namespace
}  // namespace souple
