// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/cli/run_souple.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

namespace souple::test {
namespace fs = std::filesystem;
namespace {

constexpr double time_limit_s = 120;

void redirect(int descriptor, const std::string& file) {
  const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (opened < 0 || ::dup2(opened, descriptor) < 0) ::_exit(126);
}

[[noreturn]] void become_souple(const std::vector<std::string>& arguments, const RunOptions& options,
                                const std::string& out, const std::string& err) {
  redirect(STDOUT_FILENO, out);
  redirect(STDERR_FILENO, err);
  if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(126);
  if (options.file_size_limit > 0) {
    const rlimit limit{options.file_size_limit, options.file_size_limit};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(126);
  }
  std::vector<char*> words{const_cast<char*>(SOUPLE_EXECUTABLE)};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execv(SOUPLE_EXECUTABLE, words.data());
  ::_exit(127);
}

/// Waits; interrupts and, at the time limit, ends the child.
int wait_for(pid_t child, const RunOptions& options, const std::string& err) {
  using clock = std::chrono::steady_clock;
  const auto begin = clock::now();
  bool interrupted = false;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    const double elapsed = std::chrono::duration<double>(clock::now() - begin).count();
    const bool late = options.signal_after_s > 0 && elapsed > options.signal_after_s;
    const bool said = !interrupted && !options.signal_when.empty() &&
                      read_file(err).find(options.signal_when) != std::string::npos;
    if ((late || said) && !interrupted) {
      ::kill(child, options.signal);
      interrupted = true;
    }
    if (elapsed > time_limit_s) ::kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return status;
}

fs::path new_folder() {
  std::string name = (fs::path(testing::TempDir()) / "souple-cli-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) std::abort();
  return name;
}

}  // namespace

RunResult run_souple(const std::vector<std::string>& arguments, const RunOptions& options) {
  const fs::path talk = new_folder();
  const std::string out =
      options.standard_output.empty() ? (talk / "out").string() : options.standard_output;
  const std::string err = (talk / "err").string();
  const pid_t child = ::fork();
  if (child == 0) become_souple(arguments, options, out, err);
  const int status = wait_for(child, options, err);
  RunResult result;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (options.standard_output.empty()) result.out = read_file(out);
  result.err = read_file(err);
  fs::remove_all(talk);
  return result;
}

SoupleCommand::SoupleCommand() : folder_(new_folder()) {}
SoupleCommand::~SoupleCommand() { fs::remove_all(folder_); }

fs::path SoupleCommand::write(const std::string& name, const std::string& text) const {
  std::ofstream(path(name), std::ios::binary) << text;
  return path(name);
}

std::vector<std::string> SoupleCommand::names() const {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder_))
    found.push_back(entry.path().filename().string());
  std::ranges::sort(found);
  return found;
}

fs::path surface(const std::string& name) {
  return fs::path(SOUPLE_SOURCE_DIR) / "assets" / "surfaces" / name;
}

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

fs::path baked_liver() {
  const auto stamp = fs::last_write_time(SOUPLE_EXECUTABLE).time_since_epoch().count();
  const fs::path folder = fs::path(SOUPLE_EXECUTABLE).parent_path() / "test_assets";
  const fs::path asset = folder / ("liver-" + std::to_string(stamp) + ".souple");
  if (fs::exists(asset)) return asset;
  fs::create_directories(folder);
  const fs::path recipe = folder / ("liver-" + std::to_string(::getpid()) + ".toml");
  std::ofstream(recipe) << "[surface]\nfile = \"" << surface("liver-smooth.obj").string()
                        << "\"\nsize_m = 0.2\n[mesh]\ntets = 1000\nlevels = 2\n"
                           "[[fixed]]\nname = \"low\"\nplane = {point=[0,0,-0.03], normal=[0,0,1]}\n"
                           "[[fixed]]\nname = \"unused\"\nnearest = {point=[0,0,0], count=4}\n"
                           "[[compliance]]\nname = \"free\"\n"
                           "[[compliance]]\nname = \"held\"\nfixed = \"low\"\ntolerance = 0\n";
  const RunResult result = run_souple({"bake", "--recipe", recipe.string(), "-o", asset.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  fs::remove(recipe);
  return asset;
}

void expect_issue(const RunResult& result, int exit_code, const std::string& code) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_NE(result.err.find("error " + code + ": "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("mend: "), std::string::npos) << result.err;
  if (!result.out.starts_with('{')) return;  // no --json
  const auto json = result.json();
  ASSERT_TRUE(json.is_object()) << result.out;
  EXPECT_EQ(json.at("issue").at("code"), code);
  EXPECT_EQ(json.at("issue").at("exit_code"), exit_code);
}

}  // namespace souple::test
