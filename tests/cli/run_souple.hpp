// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the real command as people do, and looks at what it leaves behind.
#pragma once
#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace souple::test {

struct RunOptions {
  std::filesystem::path folder;       ///< to run in; empty: the present one
  std::uint64_t file_size_limit = 0;  ///< bytes (RLIMIT_FSIZE); 0: none
  double signal_after_s = 0;          ///< > 0: send the signal then
  std::string signal_when;            ///< not empty: send it as soon as stderr holds this text
  int signal = SIGINT;
  std::string standard_output;  ///< file for stdout, e.g. /dev/full; empty: captured
};

struct RunResult {
  int exit_code = -1;  ///< -1 if a signal ended it
  int signal = 0;
  std::string out, err;
  nlohmann::json json() const { return nlohmann::json::parse(out, nullptr, false); }
};

RunResult run_souple(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// A folder of its own for every test, removed afterwards.
class SoupleCommand : public testing::Test {
 protected:
  SoupleCommand();
  ~SoupleCommand() override;
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;
  /// Names in the folder, sorted; hidden ones too.
  std::vector<std::string> names() const;
  std::filesystem::path folder_;
};

/// assets/surfaces of the repository.
std::filesystem::path surface(const std::string& name);
/// The liver at about 1000 tets, 0.2 m, h = 0.01 s: "free", compressed, and "held" by the set "low",
/// dense; baked once
/// for a given executable and kept in the build folder.
std::filesystem::path baked_liver();
std::string read_file(const std::filesystem::path& file);

/// The run failed with this exit code and its stderr names the issue; with --json stdout holds the
/// same.
void expect_issue(const RunResult& result, int exit_code, const std::string& code);

}  // namespace souple::test
