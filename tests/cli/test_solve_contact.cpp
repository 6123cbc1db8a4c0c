// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "formats/fclib/read_fclib.hpp"
#include "formats/fclib/write_fclib.hpp"
#include "runtime/contact/contact_judgement.hpp"
#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {

/// Three contacts in a row that press one another: regular, coupled; one opens, one sticks, one slips.
FclibProblem three_contacts() {
  FclibProblem file;
  std::vector<double> w(81);
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t j = 0; j < 9; ++j)
      w[9 * j + i] = i == j ? 2 : i % 3 == j % 3 ? 0.5 : i / 3 == j / 3 ? 0.1 : 0;
  file.problem.title = "three contacts";
  file.problem.w = block_columns_of_dense(w, 3);
  file.problem.q = {-4, 3, 2, -4, 0.1, 0, 5, 1, 1};
  file.problem.mu = {0.3, 0.8, 0.5};
  return file;
}

class SolveContact : public SoupleCommand {
 protected:
  std::string problem(const FclibProblem& file = three_contacts()) const {
    const auto where = path("p.hdf5");
    EXPECT_TRUE(write_fclib(file, where).ok());
    return where.string();
  }
};

TEST_F(SolveContact, ReportsAsItsSchemaSays) {
  const auto result = run_souple({"solve-contact", problem(), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("solve-contact")), "");
  EXPECT_LE(json["residual"].get<double>(), 1e-8);
  EXPECT_EQ(json["stick"], 1);
  EXPECT_EQ(json["slip"], 1);
  EXPECT_EQ(json["open"], 1);
  EXPECT_GT(json["iterations"].get<int>(), 0);
  EXPECT_EQ(json["converged"], true);
  EXPECT_EQ(json["title"], "three contacts");
  EXPECT_LT(json["penetration"].get<double>(), 1e-7);
  const auto people = run_souple({"solve-contact", problem()});
  EXPECT_NE(people.out.find("stick 1, slip 1, open 1"), std::string::npos) << people.out;
  EXPECT_TRUE(run_souple({"solve-contact", problem(), "--quiet"}).out.empty());
}

TEST_F(SolveContact, WhatItWritesIsTheProblemAndASolutionAsGoodAsItSaid) {
  const std::string out = path("out.hdf5").string();
  const auto result = run_souple({"solve-contact", problem(), "-o", out, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto before = read_fclib(problem()), after = read_fclib(out);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_EQ(after->problem.w.value, before->problem.w.value);
  EXPECT_EQ(after->problem.q, before->problem.q);
  EXPECT_EQ(after->problem.mu, before->problem.mu);
  EXPECT_EQ(after->problem.title, before->problem.title);
  ASSERT_TRUE(after->solution.has_value());
  const auto judgement = judge_contacts(after->problem, after->solution->r);
  EXPECT_EQ(judgement.residual, result.json()["residual"].get<double>());
  EXPECT_EQ(after->solution->u, gap_of(after->problem, after->solution->r));
  EXPECT_EQ(names(), (std::vector<std::string>{"out.hdf5", "p.hdf5"})) << "nothing else is left";
}

TEST_F(SolveContact, EverySolverAgrees) {
  for (const char* solver : {"auto", "accelerated", "gauss-seidel"}) {
    const auto json =
        run_souple({"solve-contact", problem(), "--solver", solver, "--tolerance", "1e-12", "--json"})
            .json();
    EXPECT_EQ(json["stick"], 1) << solver;
    EXPECT_LE(json["residual"].get<double>(), 1e-12) << solver;
  }
  double last = 1;
  for (const char* facets : {"4", "64", "1024"}) {
    const auto result =
        run_souple({"solve-contact", problem(), "--solver", "faceted", "--facets", facets, "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const double residual = result.json()["residual"].get<double>();
    EXPECT_LE(residual, last) << "more facets, closer to the cone";
    last = residual;
  }
  EXPECT_LT(last, 1e-2);
}

TEST_F(SolveContact, AGuessThatSolvesTheProblemIsKept) {
  FclibProblem file = three_contacts();
  const std::string out = path("out.hdf5").string();
  ASSERT_EQ(run_souple({"solve-contact", problem(file), "-o", out}).exit_code, 0);
  file.guesses = {{std::vector<double>(9), std::vector<double>(9)}, *read_fclib(out)->solution};
  const auto json = run_souple({"solve-contact", problem(file), "--json"}).json();
  EXPECT_EQ(json["start"], 2);
  EXPECT_EQ(json["iterations"], 0);
}

TEST_F(SolveContact, AMissedToleranceEndsWithItsCodeAndWhatWasReached) {
  const std::string out = path("out.hdf5").string();
  const auto result = run_souple({"solve-contact", problem(), "--max-iterations", "1", "--tolerance",
                                  "1e-15", "--json", "-o", out});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_NE(result.err.find("S4202"), std::string::npos) << result.err;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("solve-contact")), "");
  EXPECT_EQ(json["issue"]["code"], "S4202");
  EXPECT_EQ(json["converged"], false);
  EXPECT_EQ(json["iterations"], 1);
  EXPECT_TRUE(read_fclib(out).ok()) << "the best is written all the same";
}

TEST_F(SolveContact, DamagedAndUnsupportedFilesAreRefusedByCode) {
  const std::string whole = read_file(problem());
  expect_issue(run_souple({"solve-contact", write("e.hdf5", "").string(), "--json"}), 3, "S3306");
  expect_issue(run_souple({"solve-contact", write("t.hdf5", "hello").string(), "--json"}), 3, "S3306");
  expect_issue(run_souple({"solve-contact", path("no.hdf5").string(), "--json"}), 2, "S2001");
  for (const double part : {0.1, 0.5, 0.9})
    EXPECT_EQ(
        run_souple(
            {"solve-contact",
             write("cut.hdf5", whole.substr(0, std::size_t(part * double(whole.size())))).string()})
            .exit_code,
        3);
}

TEST_F(SolveContact, BitsTurnedAnywhereNeverCrashIt) {
  const std::string whole = read_file(problem());
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 60) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x41);
    const auto result =
        run_souple({"solve-contact", write("b.hdf5", bytes).string(), "--max-seconds", "1"});
    EXPECT_EQ(result.signal, 0) << at;
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 3 || result.exit_code == 4 ||
                result.exit_code == 5)
        << at << ": " << result.exit_code;
  }
}

TEST_F(SolveContact, OptionsOutOfRangeAreUsage) {
  for (const auto& [option, value] :
       {std::pair{"--tolerance", "0"}, std::pair{"--tolerance", "x"}, std::pair{"--max-seconds", "0"},
        std::pair{"--max-seconds", "nan"}, std::pair{"--max-iterations", "0"},
        std::pair{"--facets", "2"}, std::pair{"--solver", "newton"}})
    expect_issue(run_souple({"solve-contact", problem(), option, value, "--json"}), 1, "S1002");
  expect_issue(run_souple({"solve-contact", problem(), "-o", "/no such/f.hdf5", "--json"}), 2, "S2003");
}

}  // namespace
}  // namespace souple::test
