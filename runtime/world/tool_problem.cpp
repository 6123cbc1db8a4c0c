// SPDX-License-Identifier: MIT
// Bodies that a hand holds, and what a step leaves for it (METHOD 5).
#include "runtime/world/tool_problem.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/world/rigid_path.hpp"
#include "runtime/world/world_state.hpp"

namespace souple {

void ToolProblem::reserve(std::size_t contact_capacity) {
  capacity_ = contact_capacity;
  contacts.reserve(contact_capacity);
  delassus.reset(3 * contact_capacity, 3 * contact_capacity);
  delassus.reset(0, 0);
  for (auto* rows : {&free_gap, &force, &gap}) rows->reserve(3 * contact_capacity);
}

bool World::State::is_held(BodyId body) const {
  return body.index < bodies.size() && !is_soft(body.index) && rigid(body.index).held;
}

Status World::move_handle(BodyId held_body, const Pose& pose) {
  State& s = *state_;
  if (!s.is_held(held_body))
    return make_issue(IssueCode::world_parameter_invalid, "there is no such held body");
  RigidBody& body = s.rigid(held_body.index);
  if (auto status = check_pose(pose, IssueCode::world_parameter_invalid, body.name); !status)
    return status;
  body.held->next = placement(pose);
  return {};
}

// Those of the islands of the tool: what bears most, then what is nearest. Returns how many are left
// out.
std::size_t World::State::collect_tool_contacts(std::span<const BodyId> tool, std::size_t capacity) {
  std::vector<std::uint32_t>& chosen = tool_scratch.contacts;
  chosen.clear();
  if (contacts.empty()) return 0;
  const auto of_tool = [&](std::uint32_t body) {
    return std::ranges::any_of(tool, [&](BodyId b) { return b.index == body; });
  };
  for (std::size_t k = 0; k < islands.count(); ++k) {
    const auto own = islands.contacts(k);
    if (std::ranges::any_of(own, [&](std::uint32_t i) {
          return of_tool(contacts[i].a.body) || of_tool(contacts[i].b.body);
        }))
      chosen.insert(chosen.end(), own.begin(), own.end());
  }
  const auto rank = [&](std::uint32_t i) {
    const bool always = laws[i].kind == ConstraintLaw::Kind::bilateral;
    const double load = always ? std::numeric_limits<double>::infinity() : at(force, i).squaredNorm();
    return std::tuple(-load, gap[3 * std::size_t(i)], i);
  };
  std::ranges::sort(chosen, {}, rank);
  const std::size_t left_out = chosen.size() - std::min(chosen.size(), capacity);
  chosen.resize(chosen.size() - left_out);
  return left_out;
}

void World::State::describe_tool_contact(std::size_t contact, std::span<const BodyId> tool,
                                         ToolContact& to) const {
  const Contact& c = contacts[contact];
  to.key = c.key;
  to.frame = c.frame;
  to.law = laws[contact];
  for (const auto& [side, touch] : {std::pair(&c.a, &to.a), std::pair(&c.b, &to.b)}) {
    *touch = {};
    for (std::size_t jaw = 0; jaw < tool.size(); ++jaw) {
      if (side->body != tool[jaw].index) continue;
      const RigidBody& body = rigid(side->body);
      touch->jaw = std::int32_t(jaw);
      // The arm is from the centre of the coupling, as it was at the start of the step.
      touch->local = body.start.rotation.transpose() * side->arm + body.free->body_frame.translation;
    }
  }
}

// Contacts that were left out keep the forces of the step, whose gaps are then part of what is free.
void World::State::fill_gaps(ToolProblem& problem) const {
  const std::size_t count = problem.contacts.size();
  for (auto* rows : {&problem.free_gap, &problem.force, &problem.gap}) rows->resize(3 * count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = tool_scratch.contacts[k];
    for (std::size_t r = 0; r < 3; ++r) {
      problem.force[3 * k + r] = float(force[3 * i + r]);
      problem.gap[3 * k + r] = float(gap[3 * i + r] - (r == 0 ? shift[i] : 0));
      problem.free_gap[3 * k + r] = float(free_gap[3 * i + r]);
    }
  }
  if (problem.left_out == 0) return;
  problem.free_gap = problem.gap;
  for (std::size_t column = 0; column < 3 * count; ++column)
    for (std::size_t row = 0; row < 3 * count; ++row)
      problem.free_gap[row] -= problem.delassus.column(column)[row] * problem.force[column];
}

Status World::tool_problem(std::span<const BodyId> tool, ToolProblem& problem) const {
  State& s = *state_;
  if (tool.empty() || tool.size() > most_jaws ||
      !std::ranges::all_of(tool, [&](BodyId body) { return s.is_held(body); }) || s.penalty())
    return make_issue(IssueCode::world_parameter_invalid,
                      "a tool is one or two held bodies of a world whose contacts obey laws");
  problem.left_out = s.collect_tool_contacts(tool, problem.capacity());
  const std::vector<std::uint32_t>& chosen = s.tool_scratch.contacts;
  problem.contacts.resize(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k)
    s.describe_tool_contact(chosen[k], tool, problem.contacts[k]);
  problem.delassus.reset(3 * chosen.size(), 3 * chosen.size());
  s.contact_operator.gather(chosen, problem.delassus, s.tool_scratch.gather);
  s.fill_gaps(problem);
  problem.jaw_count = tool.size();
  for (std::size_t jaw = 0; jaw < tool.size(); ++jaw) {
    problem.jaw_body[jaw] = tool[jaw].index;
    problem.jaw_pose[jaw] = s.rigid(tool[jaw].index).held->now;
  }
  problem.world_time_s = s.time;
  problem.time_step_s = s.settings.time_step_s;
  return {};
}

}  // namespace souple
