// SPDX-License-Identifier: MIT
// Whatever a function of the C interface is given, it answers with a code and leaves the world as it
// was.
#pragma once
#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "c_scene.hpp"

namespace souple::test {

using namespace test;

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr souple_body none = 77;
inline constexpr souple_pose identity{{1, 0, 0, 0}, {0, 0, 0}};
inline constexpr souple_pose not_a_rotation{{0, 0, 0, 0}, {0, 0, 0}};
inline constexpr souple_pose nan_pose{{1, 0, 0, 0}, {nan, 0, 0}};

struct Refusal {
  std::string function;
  std::string why;
  souple_status expected;
  std::function<souple_status()> call;
};

class CRefusals : public testing::Test {
 protected:
  CRefusals() {
    soft = add_c_soft(world, asset, 0);
    rigid = add_c_rigid(world, SOUPLE_SHAPE_PLANE, 0);
    step_c(world, 3);
    snapshot = snapshot_of(world);
    vectors.resize(64);
  }

  /// Every call is refused with its code and a text, and the world is the same.
  void check(const std::vector<Refusal>& refusals) {
    const auto state = snapshot_of(world);
    const std::size_t body_count = souple_world_body_count(world);
    for (const Refusal& refusal : refusals) {
      SCOPED_TRACE(refusal.function + ": " + refusal.why);
      EXPECT_EQ(refusal.call(), refusal.expected) << souple_last_error_what();
      EXPECT_EQ(souple_last_error_code(), refusal.expected);
      EXPECT_STRNE(souple_last_error_what(), "");
      EXPECT_STRNE(souple_last_error_mend(), "");
    }
    EXPECT_TRUE(snapshot_of(world) == state);
    EXPECT_EQ(souple_world_body_count(world), body_count);
    step_c(world, 1);
  }

  template <class T>
  Refusal described(const char* function, const char* why, souple_status expected,
                    souple_status (*init)(T*, std::size_t), std::function<void(T&)> spoil,
                    std::function<souple_status(const T*)> call) {
    return {function, why, expected, [=] {
              T description = initialised(init);
              spoil(description);
              return call(&description);
            }};
  }

  AssetHandle asset_handle = open_asset();
  WorldHandle world_handle = make_c_world();
  souple_asset* asset = asset_handle.get();
  souple_world* world = world_handle.get();
  souple_body soft = 0, rigid = 0;
  std::vector<std::byte> snapshot;
  std::vector<souple_vec3> vectors;
  // Where results would go.
  souple_asset* asset_out = nullptr;
  souple_world* world_out = nullptr;
  souple_rigid_mesh* mesh_out = nullptr;
  souple_body body_out = 0;
  std::size_t needed = 0;
  float xyz[3] = {};
  std::int32_t number = 0;
};

inline constexpr souple_status missing = SOUPLE_API_ARGUMENT_MISSING,
                               invalid = SOUPLE_API_ARGUMENT_INVALID,
                               too_small = SOUPLE_API_BUFFER_TOO_SMALL,
                               no_object = SOUPLE_API_NO_SUCH_OBJECT,
                               bad_size = SOUPLE_API_STRUCT_SIZE_INVALID,
                               out_of_range = SOUPLE_WORLD_PARAMETER_INVALID;

}  // namespace souple::test
