// SPDX-License-Identifier: MIT
// Numbers of any bits at the C interface, and that every function of it is refused somewhere.
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>

#include "c_refusals.hpp"

namespace souple {
namespace {

using namespace test;

// Numbers of any bits: often a NaN, an infinity, a huge or a tiny one, sometimes one that is fine.
class RandomNumbers {
 public:
  void fill(std::int32_t& value) {
    value = pick(3) ? std::int32_t(pick(8)) - 2 : std::int32_t(random_());
  }
  void fill(std::uint32_t& value) { value = pick(2) ? ~0u : std::uint32_t(random_()); }
  void fill(double& value) {
    constexpr double some[] = {0, 1, -1, 0.01, 1e-300, 1e300, nan, infinity, -infinity, 0.4};
    value = pick(4) ? some[pick(10)] : std::bit_cast<double>(random_());
  }
  void fill(souple_vec3& v) { fill(v.x), fill(v.y), fill(v.z); }
  void fill(souple_pose& pose) {
    if (pick(2)) return;
    for (double& q : pose.rotation_wxyz) fill(q);
    fill(pose.translation_m);
  }
  /// Spoils about one field in twelve.
  template <class... Fields>
  void spoil(Fields&... fields) {
    ((pick(12) == 0 ? fill(fields) : void()), ...);
  }

 private:
  std::uint64_t pick(std::uint64_t count) { return random_() % count; }
  std::mt19937_64 random_{7};
};

TEST_F(CRefusals, NumbersOfAnyBitsAreRefusedOrSimulated) {
  RandomNumbers random;
  int refused = 0, made = 0;
  for (int k = 0; k < 2000; ++k) {
    auto s = initialised(souple_world_settings_init);
    random.spoil(s.integrator, s.time_step_s, s.gravity_m_s2, s.friction, s.alarm_distance_m,
                 s.contact_method, s.rotation_method, s.feed_forward_forces, s.contact_passes,
                 s.penalty_stiffness_n_m, s.sleep_after_s, s.sleep_speed_sides_s, s.contact_tolerance,
                 s.contact_max_sweeps, s.solver, s.free_motion_tolerance, s.free_motion_max_iterations,
                 s.unconverged, s.measure_laws, s.contact_penetration_m);
    souple_world* tried = nullptr;
    souple_world_create(&s, &tried);
    const WorldHandle own(tried ? WorldHandle(tried) : make_c_world());
    auto d = initialised(souple_rigid_body_description_init);
    d.radius_m = 0.1, d.half_length_m = 0.1, d.half_extents_m = {0.1, 0.1, 0.1};
    d.shape = k % 4, d.motion = k % 3;
    random.spoil(d.shape, d.motion);
    random.spoil(d.radius_m, d.half_extents_m, d.half_length_m, d.pose, d.mass_kg, d.density_kg_m3,
                 d.velocity_m_s, d.angular_velocity_rad_s, d.collision_groups, d.collision_mask);
    souple_body body = SOUPLE_NO_BODY;
    if (souple_world_add_rigid_body(own.get(), &d, &body) != SOUPLE_OK) {
      EXPECT_EQ(body, SOUPLE_NO_BODY);
      ++refused;
      continue;
    }
    ++made;
    auto j = initialised(souple_joint_description_init);
    random.spoil(j.kind, j.body_a, j.body_b, j.point_m, j.axis, j.arm_m, j.reach_m, j.collide);
    souple_joint joint = 0;
    souple_world_add_joint(own.get(), &j, &joint);
    souple_world_step(own.get(), nullptr);
    souple_pose pose{};
    ASSERT_EQ(souple_world_rigid_pose(own.get(), body, &pose), SOUPLE_OK);
    EXPECT_TRUE(std::isfinite(pose.translation_m.x + pose.rotation_wxyz[0]));
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(made, 100);
}

// The functions of souple.h that give a status, all of which test_c_refusals_*.cpp or
// test_c_versions.cpp refuse.
TEST(CRefusalTable, EveryFunctionThatCanRefuseIsRefusedHere) {
  const auto text_of = [](const std::filesystem::path& file) {
    std::ifstream stream(file);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string header = text_of(SOUPLE_C_HEADER);
  std::string here;
  for (const char* part : {"assets", "bodies", "world", "haptics"})
    here += text_of(std::filesystem::path(__FILE__).parent_path() /
                    (std::string("test_c_refusals_") + part + ".cpp"));
  ASSERT_FALSE(header.empty() || here.empty());
  const std::regex declaration("SOUPLE_API souple_status\\s+(souple_\\w+)\\((?!void|size_t)");
  std::size_t count = 0;
  for (std::sregex_iterator at(header.begin(), header.end(), declaration), end; at != end; ++at) {
    const std::string name = (*at)[1];
    ++count;
    EXPECT_TRUE(name == "souple_check_abi" || here.find('"' + name + '"') != std::string::npos) << name;
  }
  EXPECT_GE(count, 50u);
}

}  // namespace
}  // namespace souple
