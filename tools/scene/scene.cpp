// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "tools/exchange/strict_toml.hpp"
#include "tools/scene/scene_parts.hpp"

namespace souple {
namespace {

constexpr std::size_t body_limit = 10000;

// Wide enough for any scene, narrow enough that no product of two of them overflows.
constexpr NumberRange length_range{0, 1e6, true};
constexpr NumberRange tolerance_range{1e-15, 0.5};
constexpr std::int64_t iteration_limit = 1'000'000;

const std::array<std::string, 3> contact_methods{"warped", "exact", "penalty"};
const std::array<std::string, 2> unconverged_steps{"keep_best", "refuse"};
const std::array<std::string, 4> integrators{"implicit_euler", "bdf2", "quasi_static",
                                             "explicit_euler"};
const std::array<std::string, 3> rotation_methods{"polar", "qr", "gram_schmidt"};
const std::array<std::string, 2> frame_contents{"tets", "surface"};

const std::vector<std::string>& solver_choices() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& known : solver_names) list.emplace_back(known.name);
    return list;
  }();
  return names;
}

WorldSettings parse_world(TomlTable world) {
  WorldSettings s;
  world.require("time_step_s", "the length of a step; an asset holds compliances for some steps only");
  s.time_step_s = world.number("time_step_s", {1e-7, 10}).value_or(s.time_step_s);
  if (const auto integrator = world.choice("integrator", integrators))
    s.integrator =
        static_cast<Integrator>(std::ranges::find(integrators, *integrator) - integrators.begin());
  if (s.integrator == Integrator::explicit_euler) s.contact_method = ContactMethod::exact;
  if (const auto method = world.choice("rotation_method", rotation_methods))
    s.rotation_method = static_cast<RotationMethod>(std::ranges::find(rotation_methods, *method) -
                                                    rotation_methods.begin());
  s.gravity_m_s2 = world.point("gravity", {-1e4, 1e4}).value_or(s.gravity_m_s2);
  s.friction = world.number("friction", {0, 10}).value_or(s.friction);
  s.alarm_distance_m = world.number("alarm_distance_m", {0, 1e6}).value_or(s.alarm_distance_m);
  if (const auto method = world.choice("contact_method", contact_methods)) {
    s.contact_method = static_cast<ContactMethod>(std::ranges::find(contact_methods, *method) -
                                                  contact_methods.begin());
    if (*method == "warped" && s.integrator == Integrator::explicit_euler)
      world.refuse(IssueCode::usage_conflict,
                   "the explicit integrator has no compliance that could be warped", "contact_method",
                   "Leave it out: explicit steps use the exact one, which is diagonal.");
  }
  s.feed_forward_forces = world.flag("feed_forward_forces").value_or(s.feed_forward_forces);
  auto& contact = s.contact_solver;
  contact.tolerance = world.number("contact_tolerance", tolerance_range).value_or(contact.tolerance);
  contact.max_sweeps = static_cast<int>(
      world.integer("contact_max_sweeps", 1, iteration_limit).value_or(contact.max_sweeps));
  contact.penetration_m =
      world.number("contact_penetration_m", {0, 1e6}).value_or(contact.penetration_m);
  s.contact_passes =
      static_cast<int>(world.integer("contact_passes", 1, 20).value_or(s.contact_passes));
  if (s.contact_method == ContactMethod::penalty)
    s.penalty_stiffness_n_m =
        world.number("penalty_stiffness_n_m", {0, 1e12}).value_or(s.penalty_stiffness_n_m);
  s.sleep_after_s = world.number("sleep_after_s", {0, 1e6}).value_or(s.sleep_after_s);
  s.sleep_speed = world.number("sleep_speed", {0, 1e6, true}).value_or(s.sleep_speed);
  auto& free = s.free_motion;
  if (const auto solver = world.choice("solver", solver_choices()))
    free.solver = solver_of_name(*solver).value_or(free.solver);
  if (world.choice("solver_unconverged", unconverged_steps).value_or("keep_best") == "refuse")
    free.unconverged = UnconvergedStep::refuse;
  free.tolerance = world.number("solver_tolerance", tolerance_range).value_or(free.tolerance);
  free.max_iterations = static_cast<int>(
      world.integer("solver_max_iterations", 1, iteration_limit).value_or(free.max_iterations));
  return s;
}

SceneOutput parse_output(TomlTable output) {
  SceneOutput o;
  o.frames_every = output.integer("frames_every", 1, 1'000'000).value_or(o.frames_every);
  o.vtu = output.flag("vtu").value_or(o.vtu);
  if (output.choice("content", frame_contents).value_or("tets") == "surface")
    o.content = FrameContent::surface;
  o.combined = output.flag("combined").value_or(o.combined);
  o.plane_size_m = output.number("plane_size_m", length_range).value_or(o.plane_size_m);
  return o;
}

void check_names(TomlTable& root, const Scene& scene) {
  std::set<std::string> names{"scene"};  // the combined frames are called so
  for (const SceneBody& body : scene.bodies)
    if (!names.insert(scene_body_name(body)).second)
      root.refuse(IssueCode::config_bad_value,
                  "two bodies are called \"" + scene_body_name(body) + "\", or one \"scene\"", "body",
                  "Give every body a name of its own, other than \"scene\".");
}

Result<Scene> parse_scene_table(TomlTable& root) {
  Scene scene;
  scene.world = parse_world(root.table("world"));
  scene.output = parse_output(root.table("output"));
  std::vector<TomlTable> bodies = root.tables("body");
  root.require("body", "a scene needs at least one [[body]]");
  root.require("world", "a table with the time step and the laws");
  if (bodies.size() > body_limit)
    root.refuse(IssueCode::config_bad_value, "more than " + std::to_string(body_limit) + " bodies",
                "body");
  else
    for (TomlTable& entry : bodies) scene.bodies.push_back(parse_body(entry, scene.bodies.size() + 1));
  parse_constraints(root, scene);
  parse_probes(root, scene);
  if (root.status()) check_names(root, scene);
  if (auto status = root.finish(); !status) return status.issue();
  return scene;
}

}  // namespace

Result<Scene> parse_scene(std::string_view text, const std::string& name) {
  auto root = TomlTable::parse(text, name);
  if (!root) return root.issue();
  return parse_scene_table(*root);
}

Result<Scene> read_scene(const std::filesystem::path& file) {
  auto root = TomlTable::parse_file(file);
  if (!root) return root.issue();
  auto scene = parse_scene_table(*root);
  if (!scene) return scene;
  for (SceneBody& body : scene->bodies) {
    auto* soft = std::get_if<SceneSoftBody>(&body);
    auto* rigid = std::get_if<SceneRigidBody>(&body);
    if (soft != nullptr && soft->asset.is_relative()) soft->asset = file.parent_path() / soft->asset;
    if (rigid != nullptr && rigid->mesh && rigid->mesh->file.is_relative())
      rigid->mesh->file = file.parent_path() / rigid->mesh->file;
  }
  for (SceneProbe& probe : scene->probes)
    if (!probe.path_file.empty() && probe.path_file.is_relative())
      probe.path_file = file.parent_path() / probe.path_file;
  return scene;
}

const std::string& scene_body_name(const SceneBody& body) {
  if (const auto* soft = std::get_if<SceneSoftBody>(&body)) return soft->description.name;
  return std::get<SceneRigidBody>(body).description.name;
}

std::string_view contact_method_name(ContactMethod method) {
  return contact_methods[static_cast<std::size_t>(method)];
}

std::string_view rotation_method_name(RotationMethod method) {
  return rotation_methods[static_cast<std::size_t>(method)];
}

std::string_view integrator_name(Integrator integrator) {
  return integrators[static_cast<std::size_t>(integrator)];
}

}  // namespace souple
