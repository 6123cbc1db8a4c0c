// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/surface/guarded_step.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <stdexcept>

#include "tests/tools/surface/small_meshes.hpp"

namespace souple {
namespace {

constexpr ChildLimits tight{0.5, std::size_t{256} << 20};

Issue failure(const std::function<MendStep()>& step) {
  const auto done = run_guarded(step, tight);
  EXPECT_FALSE(done.ok());
  return done ? Issue{} : done.issue();
}

TEST(GuardedStep, HandsOnWhatTheStepMade) {
  const auto done = run_guarded([] { return MendStep{cube(1), 7}; });
  ASSERT_TRUE(done.ok());
  EXPECT_EQ(done->mesh.vertices, cube(1).vertices);
  EXPECT_EQ(done->mesh.triangles, cube(1).triangles);
  EXPECT_EQ(done->count, 7u);
}

TEST(GuardedStep, SaysHowAStepFailed) {
  const Issue crash = failure([]() -> MendStep {
    std::raise(SIGSEGV);
    return {};
  });
  EXPECT_EQ(crash.code, IssueCode::surface_mend_failed);
  EXPECT_EQ(crash.what, "it crashed (ended by signal 11)");
  const Issue thrown = failure([]() -> MendStep { throw std::logic_error("precondition"); });
  EXPECT_EQ(thrown.code, IssueCode::surface_mend_failed);
  EXPECT_EQ(thrown.what.substr(0, 10), "it crashed");
  const Issue endless = failure([]() -> MendStep {
    while (true) ::raise(0);
  });
  EXPECT_EQ(endless.code, IssueCode::surface_mend_failed);
  EXPECT_EQ(endless.what.substr(0, 16), "it took too long");
}

TEST(GuardedStep, TrustsNoMeshOfAStep) {
  TriangleMesh bad = cube(1);
  bad.triangles[3][1] = 99;
  EXPECT_EQ(failure([&] { return MendStep{bad, 0}; }).code, IssueCode::surface_mend_failed);
}

}  // namespace
}  // namespace souple
