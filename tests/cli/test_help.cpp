// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <map>
#include <regex>

#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"
#include "tools/cli/exit_codes.hpp"

namespace souple::test {
namespace {

/// Number and meaning of every line under "Exit codes:".
std::map<int, std::string> exit_codes_in(const std::string& help) {
  std::map<int, std::string> codes;
  const std::size_t begin = help.find("Exit codes:");
  EXPECT_NE(begin, std::string::npos);
  const std::string text = help.substr(begin);
  const std::regex line(R"(\n  (\d)  ([^\n]+))");
  for (std::sregex_iterator it(text.begin(), text.end(), line), end; it != end; ++it)
    codes[std::stoi((*it)[1])] = (*it)[2];
  return codes;
}

std::map<int, std::string> exit_codes_of_the_program() {
  std::map<int, std::string> codes;
  for (const auto& entry : exit_code_table) codes[static_cast<int>(entry.code)] = entry.meaning;
  return codes;
}

TEST(Help, StatesTheExitCodesThatTheProgramUses) {
  const auto help = run_souple({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(exit_codes_in(help.out), exit_codes_of_the_program());
  for (const char* verb : {"bake", "repair", "decimate", "tetrahedralize", "hierarchy", "precompute",
                           "inspect", "validate", "export", "simulate", "solve-contact", "explain"}) {
    EXPECT_NE(help.out.find(std::string("\n  ") + verb + " "), std::string::npos);
    const auto verb_help = run_souple({verb, "--help"});
    EXPECT_EQ(verb_help.exit_code, 0) << verb;
    EXPECT_EQ(exit_codes_in(verb_help.out), exit_codes_of_the_program()) << verb;
    EXPECT_NE(verb_help.out.find("--json"), std::string::npos) << verb;
  }
}

TEST(Help, VersionNamesProgramAndFormat) {
  const auto version = run_souple({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_TRUE(std::regex_match(version.out,
                               std::regex("souple \\d+\\.\\d+\\.\\d+ \\(asset format 1\\.\\d+\\)\n")))
      << version.out;
}

TEST(Explain, ListsEveryCodeWithAnExitCodeOfTheTable) {
  const auto all = run_souple({"explain", "--json"});
  ASSERT_EQ(all.exit_code, 0);
  const auto json = all.json();
  EXPECT_EQ(schema_violation(json, load_schema("explain")), "");
  EXPECT_EQ(json["codes"].size(), issue_catalogue().size());
  const auto known = exit_codes_of_the_program();
  for (const auto& code : json["codes"]) EXPECT_TRUE(known.contains(code["exit_code"].get<int>()));
}

TEST(Explain, FindsACodeByNumberAndByName) {
  for (const char* asked : {"S2001", "2001", "io_file_missing"}) {
    const auto one = run_souple({"explain", asked});
    EXPECT_EQ(one.exit_code, 0) << asked;
    EXPECT_NE(one.out.find("S2001 io_file_missing"), std::string::npos) << one.out;
    EXPECT_NE(one.out.find("Mend: "), std::string::npos);
  }
  expect_issue(run_souple({"explain", "S9999"}), 1, "S1002");
  expect_issue(run_souple({"explain", ""}), 1, "S1002");
}

TEST(Usage, UnknownVerbsAndOptionsAreRefusedWithASuggestion) {
  const auto verb = run_souple({"bkae"});
  expect_issue(verb, 1, "S1001");
  EXPECT_NE(verb.err.find("Did you mean bake?"), std::string::npos) << verb.err;
  const auto option = run_souple({"bake", "a.obj", "-o", "b.souple", "--test", "5"});
  expect_issue(option, 1, "S1001");
  EXPECT_NE(option.err.find("Did you mean --tets?"), std::string::npos) << option.err;
  expect_issue(run_souple({"bake", "--levls=3"}), 1, "S1001");
  expect_issue(run_souple({"inspect", "a", "b"}), 1, "S1001");
}

TEST(Usage, MissingArgumentsAreNamed) {
  expect_issue(run_souple({}), 1, "S1003");
  expect_issue(run_souple({"inspect"}), 1, "S1003");
  expect_issue(run_souple({"bake", "a.obj"}), 1, "S1003");
  expect_issue(run_souple({"bake", "-o", "a.souple"}), 1, "S1003");
  expect_issue(run_souple({"simulate", "s.toml", "-o", "out"}), 1, "S1003");
  expect_issue(run_souple({"bake", "a.obj", "-o"}), 1, "S1002");
  expect_issue(run_souple({"inspect", "a", "-q", "-v"}), 1, "S1004");
}

TEST(Usage, JsonIssuesMeetTheirSchema) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"bkae", "--json"},
                                                {"bake", "--json"},
                                                {"inspect", "/nowhere", "--json"},
                                                {"inspect", "--jsn", "--json"},
                                                {"explain", "x\xff\n", "--json"}}) {
    const auto result = run_souple(words);
    EXPECT_NE(result.exit_code, 0);
    EXPECT_EQ(schema_violation(result.json(), load_schema("issue")), "") << result.out;
  }
}

TEST(Usage, AFullDiskBehindStdoutIsAnError) {
  RunOptions options;
  options.standard_output = "/dev/full";
  expect_issue(run_souple({"explain"}, options), 2, "S2003");
}

}  // namespace
}  // namespace souple::test
