// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/process/child_process.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <vector>

namespace souple {
namespace {

constexpr ChildLimits usual{10, std::size_t{64} << 20};

std::ptrdiff_t open_descriptors() {
  return std::ranges::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                               std::filesystem::directory_iterator{});
}

bool has_children() { return ::waitpid(-1, nullptr, WNOHANG) >= 0; }

IssueCode code_of(const std::function<std::string()>& work, const ChildLimits& limits = usual) {
  const auto result = run_in_child(work, limits);
  EXPECT_FALSE(result.ok());
  return result.ok() ? IssueCode{} : result.issue().code;
}

TEST(ChildProcess, HandsBackWhatTheWorkAnswered) {
  const std::string long_answer(5'000'000, 'a');
  const auto result = run_in_child([&] { return long_answer; }, usual);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(*result, long_answer);
}

TEST(ChildProcess, TurnsASegmentationFaultIntoAnIssue) {
  EXPECT_EQ(code_of([]() -> std::string {
              std::raise(SIGSEGV);
              return {};
            }),
            IssueCode::surface_reader_crashed);
}

TEST(ChildProcess, TurnsAnExceptionIntoAnIssue) {
  EXPECT_EQ(code_of([]() -> std::string { throw std::runtime_error("x"); }),
            IssueCode::surface_reader_crashed);
}

TEST(ChildProcess, KillsWorkThatNeverEnds) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(code_of(
                []() -> std::string {
                  while (true) ::pause();
                },
                {0.2, 1 << 20}),
            IssueCode::surface_reader_timeout);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(ChildProcess, StopsWorkThatDevoursMemory) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "address sanitizers reserve terabytes; no limit is set";
#endif
  EXPECT_EQ(code_of([]() -> std::string {
              std::vector<std::string> hoard;
              while (true) hoard.emplace_back(1 << 20, 'x');
            }),
            IssueCode::surface_reader_memory);
}

TEST(ChildProcess, StopsAnAnswerBeyondTheMemoryLimit) {
  EXPECT_EQ(code_of([] { return std::string(2 << 20, 'x'); }, {10, 1 << 20}),
            IssueCode::surface_reader_memory);
}

TEST(ChildProcess, LeavesNoZombieAndNoDescriptor) {
  const auto before = open_descriptors();
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(run_in_child([] { return std::string("x"); }, usual).ok());
    EXPECT_FALSE(run_in_child([]() -> std::string { std::abort(); }, usual).ok());
  }
  EXPECT_EQ(open_descriptors(), before);
  EXPECT_FALSE(has_children());
}

TEST(ChildProcess, SilencesTheConsoleOfTheWork) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  EXPECT_TRUE(run_in_child(
                  [] {
                    std::cout << "loud" << std::endl;
                    std::cerr << "louder" << std::endl;
                    return std::string();
                  },
                  usual)
                  .ok());
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(ChildProcess, GivesTheWorkNoFileOfTheParent) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  const int fd = ::fileno(file);
  const auto result =
      run_in_child([&] { return std::string(::write(fd, "x", 1) == 1 ? "wrote" : "closed"); }, usual);
  std::fclose(file);
  ASSERT_TRUE(result.ok());
  // The answer's own pipe sits at descriptor 3; any other one is closed.
  if (fd != 3) {
    EXPECT_EQ(*result, "closed");
  }
}

}  // namespace
}  // namespace souple
