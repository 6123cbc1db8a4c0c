// SPDX-License-Identifier: GPL-3.0-or-later
// The whole contact step of a liver of 4406 tets that lies on a floor, warped and exact side by side
// from the same states: what SOFA v26.06 takes 25.8 and 697 ms for.
#include <algorithm>

#include "tests/bench/liver.hpp"
#include "tests/bench/phase_times.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr int settle_steps = 60, measured_steps = 40;

World lying_liver(const std::shared_ptr<const SoftBodyAsset>& liver, ContactMethod method) {
  WorldSettings settings;
  settings.contact_method = method;
  World world = value_or_exit(World::create(settings));
  SoftBodyDescription body;
  double lowest = 0;
  for (const Point& p : liver->model().rest_positions()) lowest = std::min(lowest, p[1]);
  const double half = 0.70710678118654752;  // a quarter turn about x
  body.pose = {{half, half, 0, 0}, {0, 0, -lowest + 0.001}};
  value_or_exit(world.add_soft_body(liver, body));
  RigidBodyDescription floor;
  floor.path = {{0, {}}};
  value_or_exit(world.add_rigid_body(floor));
  return world;
}

}  // namespace

int main() {
  const auto liver = baked_liver(4406, 1);
  World warped = lying_liver(liver, ContactMethod::warped);
  World exact = lying_liver(liver, ContactMethod::exact);
  for (int k = 0; k < settle_steps; ++k) value_or_exit(warped.step());
  PhaseRows warped_rows, exact_rows;
  for (int k = 0; k < measured_steps; ++k) {
    if (auto status = exact.copy_state(warped); !status) exit_with(status.issue());
    exact_rows.add(value_or_exit(exact.step()));
    warped_rows.add(value_or_exit(warped.step()));
  }
  ResultHash hash;
  hash.add(warped.positions({0}));
  print_row("contact_step.tets", "1", double(liver->model().tets().size()), hash);
  warped_rows.print("contact_step.warped", hash);
  exact_rows.print("contact_step.exact", hash);
  return 0;
}
