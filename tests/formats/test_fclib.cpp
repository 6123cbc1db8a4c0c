// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "fclib_sample.hpp"
#include "formats/fclib/read_fclib.hpp"
#include "formats/fclib/write_fclib.hpp"
#include "runtime/contact/contact_judgement.hpp"
#include "runtime/contact/solve_contact_problem.hpp"

namespace souple {
namespace {

using test::RawFclib;
using test::sample_fclib;

Result<FclibProblem> read(const RawFclib& raw) { return read_fclib_memory(raw.bytes(), "sample"); }

void expect_refused(const RawFclib& raw, IssueCode code, const std::string& why) {
  const auto result = read(raw);
  ASSERT_FALSE(result.ok()) << why;
  EXPECT_EQ(result.issue().code, code) << why << ": " << result.issue().what;
  EXPECT_NE(result.issue().where.find("sample"), std::string::npos);
}

constexpr auto damaged = IssueCode::contact_file_damaged;
constexpr auto invalid = IssueCode::contact_problem_invalid;
constexpr auto too_large = IssueCode::contact_problem_too_large;
const std::string w = "fclib_local/W/";

// The dense matrix of a problem, row r column c at 6 r + c.
std::vector<double> dense(const BlockColumns& blocks) {
  const std::size_t height = 3 * blocks.size();
  std::vector<double> m(height * height);
  for (std::size_t j = 0; j < blocks.size(); ++j)
    for (std::size_t b = blocks.begin[j]; b < blocks.begin[j + 1]; ++b)
      for (std::size_t k = 0; k < 9; ++k)
        m[(3 * blocks.row[b] + k % 3) * height + 3 * j + k / 3] = blocks.value[9 * b + k];
  return m;
}

// The sample in compressed columns (-1) or rows (-2).
RawFclib compressed(int storage) {
  RawFclib raw = sample_fclib();
  const auto rows = raw.integers[w + "p"], columns = raw.integers[w + "i"];
  const auto values = raw.reals[w + "x"];
  const auto& line = storage == -1 ? columns : rows;
  const auto& across = storage == -1 ? rows : columns;
  std::vector<int> pointer{0}, index;
  std::vector<double> value;
  for (int l = 0; l < 6; ++l) {
    for (std::size_t k = 0; k < line.size(); ++k) {
      if (line[k] != l) continue;
      index.push_back(across[k]);
      value.push_back(values[k]);
    }
    pointer.push_back(static_cast<int>(index.size()));
  }
  raw.integers[w + "nz"] = {storage};
  raw.integers[w + "p"] = pointer;
  raw.integers[w + "i"] = index;
  raw.reals[w + "x"] = value;
  return raw;
}

TEST(Fclib, AllThreeStoragesAreTheSameProblem) {
  const RawFclib raw = sample_fclib();
  std::vector<double> expected(36);
  for (std::size_t k = 0; k < raw.reals.at(w + "x").size(); ++k)
    expected[std::size_t(6 * raw.integers.at(w + "p")[k] + raw.integers.at(w + "i")[k])] =
        raw.reals.at(w + "x")[k];
  for (const RawFclib& file : {raw, compressed(-1), compressed(-2)}) {
    const auto result = read(file);
    ASSERT_TRUE(result.ok()) << result.issue().what;
    EXPECT_EQ(dense(result->problem.w), expected);
    EXPECT_EQ(result->problem.q, raw.reals.at("fclib_local/vectors/q"));
    EXPECT_EQ(result->problem.mu, raw.reals.at("fclib_local/vectors/mu"));
    EXPECT_EQ(result->problem.title, "two contacts");
    EXPECT_EQ(result->problem.description, "of the tests");
    EXPECT_EQ(result->problem.math_info, "unsymmetric");
  }
}

TEST(Fclib, EntriesOfOnePlaceAddUp) {
  RawFclib raw = sample_fclib();
  raw.integers[w + "p"].push_back(0);
  raw.integers[w + "i"].push_back(0);
  raw.reals[w + "x"].push_back(0.125);
  raw.integers[w + "nz"][0] += 1;
  raw.integers[w + "nzmax"][0] += 1;
  const auto result = read(raw);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(dense(result->problem.w)[0], 2.125);
}

TEST(Fclib, WhatIsWrittenIsReadBackToTheBit) {
  auto first = read(sample_fclib());
  ASSERT_TRUE(first.ok());
  const ContactState guess{{1, 2, 3, 4, 5, 6}, {0, 0, 0, 1e-3, 0, 0}}, solution{guess.r, guess.u};
  first->guesses = {guess, solution};
  first->solution = solution;
  const auto bytes = write_fclib_memory(*first);
  ASSERT_TRUE(bytes.ok()) << bytes.issue().what;
  const auto second = read_fclib_memory(*bytes, "written");
  ASSERT_TRUE(second.ok()) << second.issue().what;
  EXPECT_EQ(second->problem.w.begin, first->problem.w.begin);
  EXPECT_EQ(second->problem.w.row, first->problem.w.row);
  EXPECT_EQ(second->problem.w.value, first->problem.w.value);
  EXPECT_EQ(second->problem.q, first->problem.q);
  EXPECT_EQ(second->problem.mu, first->problem.mu);
  EXPECT_EQ(second->problem.title, "two contacts");
  ASSERT_EQ(second->guesses.size(), 2U);
  EXPECT_EQ(second->guesses[0].r, guess.r);
  EXPECT_EQ(second->guesses[1].u, guess.r);
  ASSERT_TRUE(second->solution.has_value());
  EXPECT_EQ(second->solution->r, guess.u);
  const auto again = write_fclib_memory(*second);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(*again, *bytes) << "the same problem gives the same bytes";
}

TEST(Fclib, TheWriterRefusesWhatItWouldNotRead) {
  auto file = read(sample_fclib());
  ASSERT_TRUE(file.ok());
  FclibProblem wrong = *file;
  wrong.problem.q[2] = std::nan("");
  EXPECT_EQ(write_fclib_memory(wrong).issue().code, invalid);
  wrong = *file;
  wrong.solution = ContactState{{1, 2}, {3, 4}};
  EXPECT_EQ(write_fclib_memory(wrong).issue().code, invalid);
  wrong = *file;
  wrong.problem.w.row[0] = 7;
  EXPECT_EQ(write_fclib_memory(wrong).issue().code, invalid);
  EXPECT_EQ(write_fclib(*file, "/no such folder/p.hdf5").issue().code, IssueCode::io_cannot_write);
}

TEST(Fclib, BlocksOfADenseMatrixLeaveZerosOut) {
  std::vector<double> matrix(36);
  for (std::size_t k = 0; k < 6; ++k) matrix[7 * k] = 1;
  matrix[6 * 0 + 4] = 3;  // column 0, row 4
  const BlockColumns blocks = block_columns_of_dense(matrix, 2);
  EXPECT_EQ(blocks.begin, (std::vector<std::size_t>{0, 2, 3}));
  EXPECT_EQ(dense(blocks)[6 * 4 + 0], 3);
}

TEST(Fclib, MissingPartsAreNamed) {
  const RawFclib sample = sample_fclib();
  for (const auto& [path, values] : sample.integers) {
    RawFclib raw = sample;
    raw.integers.erase(path);
    expect_refused(raw, damaged, path);
  }
  for (const auto& [path, values] : sample.reals) {
    RawFclib raw = sample;
    raw.reals.erase(path);
    expect_refused(raw, damaged, path);
  }
  RawFclib plain = sample;
  plain.texts.clear();
  EXPECT_TRUE(read(plain).ok()) << "texts are optional";
  expect_refused({}, damaged, "an empty file");
}

TEST(Fclib, ListsOfAnotherTypeOrLengthAreRefused) {
  for (const char* name : {"p", "i"}) {
    RawFclib raw = sample_fclib();
    raw.integers[w + name].pop_back();
    expect_refused(raw, damaged, name);
    raw.integers[w + name].clear();
    expect_refused(raw, damaged, name);
  }
  RawFclib raw = sample_fclib();
  raw.reals[w + "x"].pop_back();
  expect_refused(raw, damaged, "x");
  raw = sample_fclib();
  raw.integers.erase(w + "m");
  raw.reals[w + "m"] = {6};
  expect_refused(raw, damaged, "m is real");
  raw = sample_fclib();
  raw.integers[w + "n"] = {6, 6};
  expect_refused(raw, damaged, "n has two values");
  raw = sample_fclib();
  raw.reals["fclib_local/vectors/q"].push_back(0);
  expect_refused(raw, invalid, "q");
  raw = sample_fclib();
  raw.reals["fclib_local/vectors/mu"].clear();
  expect_refused(raw, invalid, "no mu");
}

TEST(Fclib, IndicesAndPointersOutsideAreRefused) {
  for (const int bad : {-1, 6, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    for (const char* name : {"p", "i"}) {
      RawFclib raw = sample_fclib();
      raw.integers[w + name][3] = bad;
      expect_refused(raw, invalid, name);
    }
    for (const int storage : {-1, -2}) {
      RawFclib raw = compressed(storage);
      raw.integers[w + "i"][2] = bad;
      expect_refused(raw, invalid, "index");
      raw = compressed(storage);
      raw.integers[w + "p"][3] = bad == 6 ? 13 : bad;
      expect_refused(raw, damaged, "pointer");
      raw = compressed(storage);
      raw.integers[w + "p"].back() = bad == 6 ? 13 : bad;
      expect_refused(raw, damaged, "last pointer");
    }
  }
  for (const int nz : {-3, 1000, std::numeric_limits<int>::max()}) {
    RawFclib raw = sample_fclib();
    raw.integers[w + "nz"] = {nz};
    expect_refused(raw, damaged, "nz " + std::to_string(nz));
  }
}

TEST(Fclib, SizesThatCannotBeAreRefusedBeforeMemoryIsTaken) {
  for (const int size : {0, -6, 5, 7, std::numeric_limits<int>::max()}) {
    RawFclib raw = sample_fclib();
    raw.integers[w + "m"] = raw.integers[w + "n"] = {size};
    const auto result = read(raw);
    ASSERT_FALSE(result.ok());
  }
  RawFclib raw = sample_fclib();
  raw.integers[w + "m"] = raw.integers[w + "n"] = {2'147'483'643};
  expect_refused(raw, too_large, "huge");
  raw = sample_fclib();
  raw.integers[w + "m"] = {3};
  expect_refused(raw, invalid, "not square");
  raw = sample_fclib();
  raw.integers[w + "m"] = raw.integers[w + "n"] = {9};
  expect_refused(raw, invalid, "W larger than q");
}

TEST(Fclib, ValuesThatAreNoNumbersAreRefused) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), infinity, -infinity, 1e200}) {
    for (const std::string& path :
         {w + "x", std::string("fclib_local/vectors/q"), std::string("fclib_local/vectors/mu")}) {
      RawFclib raw = sample_fclib();
      raw.reals[path][1] = bad;
      expect_refused(raw, invalid, path);
    }
  }
  RawFclib raw = sample_fclib();
  raw.reals["fclib_local/vectors/mu"][0] = -0.1;
  expect_refused(raw, invalid, "negative mu");
}

TEST(Fclib, OtherKindsOfProblemsAreRefusedAsUnsupported) {
  RawFclib raw = sample_fclib();
  raw.integers["fclib_local/spacedim"] = {2};
  expect_refused(raw, IssueCode::unsupported_feature, "two dimensions");
  raw = sample_fclib();
  raw.integers["fclib_local/V/m"] = {6};
  expect_refused(raw, IssueCode::unsupported_feature, "V");
  raw = sample_fclib();
  raw.reals["fclib_local/vectors/s"] = {1};
  expect_refused(raw, IssueCode::unsupported_feature, "s");
  for (const char* name : {"fclib_global", "fclib_global_rolling"}) {
    RawFclib global;
    global.integers[std::string(name) + "/spacedim"] = {3};
    expect_refused(global, IssueCode::unsupported_feature, name);
  }
}

TEST(Fclib, GuessesThatDoNotFitAreLeftOut) {
  RawFclib raw = sample_fclib();
  raw.integers["guesses/number_of_guesses"] = {3};
  raw.reals["guesses/1/u"] = raw.reals["guesses/1/r"] = {1, 2, 3};
  raw.reals["guesses/2/u"] = raw.reals["guesses/2/r"] = {1, 2, 3, 4, 5, std::nan("")};
  raw.reals["guesses/3/u"] = raw.reals["guesses/3/r"] = {1, 2, 3, 4, 5, 6};
  const auto result = read(raw);
  ASSERT_TRUE(result.ok());
  ASSERT_EQ(result->guesses.size(), 1U);
  EXPECT_EQ(result->guesses[0].r[5], 6);
  raw.integers["guesses/number_of_guesses"] = {std::numeric_limits<int>::max()};
  EXPECT_TRUE(read(raw).ok());
}

TEST(Fclib, FilesThatAreNotHdf5OrCutOffAreRefused) {
  const std::vector<std::byte> whole = sample_fclib().bytes();
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 97) {
    const std::span<const std::byte> part(whole.data(), size);
    const auto result = read_fclib_memory(part, "cut");
    EXPECT_FALSE(result.ok()) << size;
  }
  EXPECT_EQ(read_fclib("/no such file").issue().code, IssueCode::io_file_missing);
  EXPECT_FALSE(read_fclib("/").ok());
}

TEST(Fclib, ListsStoredElsewhereAreRefused) {
  const std::vector<std::byte> bytes = sample_fclib().bytes();
  // A soft link in the place of the vectors leads HDF5 back into the file, but not the reader.
  const auto file = std::filesystem::temp_directory_path() /
                    ("souple_fclib_link_" + std::to_string(std::random_device{}()) + ".hdf5");
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(opened, 0);
  H5Lmove(opened, "fclib_local/vectors", opened, "elsewhere", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/elsewhere", opened, "fclib_local/vectors", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(opened);
  const auto result = read_fclib(file);
  std::filesystem::remove(file);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.issue().code, damaged);
}

std::filesystem::path contact_data() {
  const char* folder = std::getenv("SOUPLE_DATA_DIR");
  return std::filesystem::path(folder != nullptr ? folder : SOUPLE_DEFAULT_DATA_DIR) / "contact";
}

// 5.5: the published problems, most of them with a rank-deficient W.
TEST(Fclib, EveryPublishedProblemIsSolvedToATightTolerance) {
  if (!std::filesystem::exists(contact_data())) {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no data in " << contact_data();
    GTEST_SKIP() << "no data in " << contact_data();
  }
  int solved = 0, refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(contact_data())) {
    if (entry.path().extension() != ".hdf5") continue;
    const auto file = read_fclib(entry.path());
    if (!file) {
      EXPECT_EQ(file.issue().code, IssueCode::unsupported_feature) << entry.path();
      ++refused;
      continue;
    }
    std::vector<double> force(file->problem.q.size());
    ContactProblemSettings settings;
    settings.tolerance = 1e-9;
    const auto report = solve_contact_problem(file->problem, settings, force);
    EXPECT_TRUE(report.converged) << entry.path();
    const ContactJudgement judgement = judge_contacts(file->problem, force);
    EXPECT_LE(judgement.residual, 1e-9 * (1 + 1e-3)) << entry.path();
    EXPECT_EQ(judgement.stick + judgement.slip + judgement.open, file->problem.contact_count());
    ++solved;
  }
  EXPECT_EQ(solved, 16);
  EXPECT_EQ(refused, 3);
}

// The velocities that the file of the capsules publishes are genuine (its forces are zeros).
TEST(Fclib, GapsOfTheCapsulesAreThosePublished) {
  const auto path = contact_data() / "Capsules-i125-1213.hdf5";
  if (!std::filesystem::exists(path)) {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no " << path;
    GTEST_SKIP() << "no " << path;
  }
  const auto file = read_fclib(path);
  ASSERT_TRUE(file.ok());
  std::vector<double> force(file->problem.q.size());
  ContactProblemSettings settings;
  settings.tolerance = 1e-10;
  EXPECT_TRUE(solve_contact_problem(file->problem, settings, force).converged);
  double norm2 = 0;
  for (const double u : gap_of(file->problem, force)) norm2 += u * u;
  EXPECT_NEAR(std::sqrt(norm2), 7.1513742, 2e-7);
}

}  // namespace
}  // namespace souple
