// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/scene_world.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "runtime/collision/rigid_mesh.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "runtime/world/integrator.hpp"
#include "runtime/world/rigid_path.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "tools/exchange/nearest_name.hpp"
#include "tools/exchange/numbers.hpp"
#include "tools/exchange/shape_mesh.hpp"
#include "tools/scene/scene_loads.hpp"

namespace souple {
namespace {

using SharedAsset = std::shared_ptr<const SoftBodyAsset>;
using FixedSetNames = std::set<std::string>;

// The runtime's own match is on the ratio of the factors to 1e-6 (METHOD 4.2).
constexpr double ratio_tolerance = 1e-6;

std::string describe(const ComplianceHeader& header) {
  std::string text = "\"" + header.name + "\" (";
  text += header.kind == ComplianceKind::static_equilibrium
              ? "static"
              : "time step " + rounded_text(header.time_step_s, 9) + " s";
  return text +
         (header.fixed_set.empty() ? ", nothing fixed)" : ", fixed \"" + header.fixed_set + "\")");
}

Result<std::vector<ComplianceHeader>> read_headers(AssetReader& reader) {
  std::vector<ComplianceHeader> headers;
  for (const std::string& name : reader.compliance_names()) {
    auto header = reader.read_compliance_header(name);
    if (!header) return header.issue();
    headers.push_back(std::move(*header));
  }
  return headers;
}

Status check_fixed_set(const AssetReader& reader, const std::string& fixed,
                       const std::filesystem::path& file) {
  const auto& names = reader.fixed_set_names();
  if (fixed.empty() || std::ranges::find(names, fixed) != names.end()) return {};
  return make_issue(IssueCode::fixed_set_invalid,
                    "the asset has no fixed set \"" + fixed + "\"; it has " +
                        (names.empty() ? "none" : join_names(names)),
                    file.string());
}

/// What the scene asks a compliance for.
struct AskedCompliance {
  Integrator integrator = Integrator::implicit_euler;
  double time_step_s = 0;
  SystemFactors factors;
};

std::string describe(const AskedCompliance& asked) {
  const std::string step = rounded_text(asked.time_step_s, 9) + " s";
  if (asked.integrator == Integrator::quasi_static) return "a static compliance";
  if (asked.integrator == Integrator::bdf2)
    return "the dynamic compliance of BDF2 with time step " + step + ", which is that of time step " +
           rounded_text(euler_step_of_bdf2(asked.time_step_s), 9) + " s,";
  return "a dynamic compliance with time step " + step;
}

Issue no_match(const std::vector<ComplianceHeader>& headers, const AskedCompliance& asked,
               const std::string& fixed, const std::filesystem::path& file) {
  std::string held;
  for (const auto& header : headers) held += (held.empty() ? "" : ", ") + describe(header);
  return make_issue(IssueCode::scene_no_matching_compliance,
                    "the scene asks for " + describe(asked) + " and " +
                        (fixed.empty() ? "nothing fixed" : "\"" + fixed + "\" fixed") +
                        "; the asset has " + (held.empty() ? "none at all" : held),
                    file.string());
}

/// The first variant for this system and fixed set, or an issue.
Result<std::string> matching_variant(const std::vector<ComplianceHeader>& headers,
                                     const AskedCompliance& asked, const std::string& fixed,
                                     const std::filesystem::path& file) {
  const double wanted = asked.factors.mass / asked.factors.stiffness;
  for (const auto& header : headers) {
    if (header.fixed_set != fixed) continue;
    const double ratio = header.mass_factor / header.stiffness_factor;
    if (std::abs(ratio - wanted) <= ratio_tolerance * wanted) return header.name;
  }
  return no_match(headers, asked, fixed, file);
}

/// Names of the variants that the bodies of one asset need.
Result<std::vector<std::string>> variants_for(AssetReader& reader, const WorldSettings& settings,
                                              const FixedSetNames& fixed_sets,
                                              const std::filesystem::path& file) {
  auto headers = read_headers(reader);
  if (!headers) return headers.issue();
  const auto material = reader.read_material();
  if (!material) return material.issue();
  const AskedCompliance asked{
      settings.integrator, settings.time_step_s,
      system_factors(settings.integrator, settings.time_step_s, material->rayleigh_mass_per_s,
                     material->rayleigh_stiffness_s)};
  std::vector<std::string> names;
  for (const std::string& fixed : fixed_sets) {
    if (auto status = check_fixed_set(reader, fixed, file); !status) return status.issue();
    if (settings.contact_method != ContactMethod::warped) continue;
    auto name = matching_variant(*headers, asked, fixed, file);
    if (!name) return name.issue();
    names.push_back(std::move(*name));
  }
  return names;
}

// The automatic choice may come to a cycle on its way.
bool may_use_levels(SolverKind kind) {
  return kind == SolverKind::automatic || kind == SolverKind::multigrid ||
         kind == SolverKind::multigrid_pcg || kind == SolverKind::warped_multigrid_pcg;
}

struct LoadedAsset {
  SharedAsset asset;
  AssetUse use;
};

Result<LoadedAsset> load_asset(const std::filesystem::path& file, const WorldSettings& settings,
                               const FixedSetNames& fixed_sets) {
  auto reader = AssetReader::open(file);
  if (!reader) return reader.issue();
  LoadedAsset loaded;
  LoadOptions options;
  auto names = variants_for(*reader, settings, fixed_sets, file);
  if (!names) return names.issue();
  options.compliances = *names;
  options.no_compliances = names->empty();
  options.multigrid = may_use_levels(settings.free_motion.solver);
  auto asset = load_soft_body(*reader, options);
  if (!asset) return asset.issue();
  loaded.asset = std::move(*asset);
  std::error_code error;
  const auto file_bytes = std::filesystem::file_size(file, error);
  loaded.use = {file, error ? 0 : file_bytes, reader->bytes_read(), loaded.asset->resident_bytes(),
                std::move(*names)};
  return loaded;
}

Status add_loads(World& world, BodyId body, const SceneSoftBody& soft) {
  for (const SceneLoad& one : soft.loads) {
    const auto load = place_load(one, world.asset(body), soft.description.name);
    if (!load) return load.issue();
    if (auto added = world.add_load(body, *load); !added) return added.issue();
  }
  return {};
}

BodyId body_called(const std::string& name, const Scene& scene, const SceneWorld& built) {
  const auto place = std::ranges::find(scene.bodies, name, scene_body_name);
  return built.bodies[std::size_t(place - scene.bodies.begin())];
}

Status add_constraints(const Scene& scene, SceneWorld& built) {
  const auto body = [&](const std::string& name) { return body_called(name, scene, built); };
  for (const ScenePair& pair : scene.pairs)
    if (auto status = built.world.set_pair(body(pair.a), body(pair.b), pair.rule); !status)
      return status;
  for (const SceneJoint& joint : scene.joints) {
    JointDescription description = joint.description;
    description.body_a = body(joint.a);
    if (!joint.b.empty()) description.body_b = body(joint.b);
    if (auto added = built.world.add_joint(description); !added) return added.issue();
  }
  for (const SceneGrab& grab : scene.grabs) {
    GrabDescription description = grab.description;
    description.body = body(grab.body);
    auto id = built.world.grab(description);
    if (!id) return id.issue();
    built.grabs.push_back(*id);
  }
  return {};
}

/// Surfaces of rigid bodies, each file read once for a size.
class RigidMeshes {
 public:
  explicit RigidMeshes(const MeshLoader& load) : load_(load) {}

  Result<std::shared_ptr<const RigidMesh>> get(const RigidMeshFile& file) {
    if (const auto known = meshes_.find(file); known != meshes_.end()) return known->second;
    if (!load_)
      return make_issue(IssueCode::unsupported_feature, "surfaces of rigid bodies are not read here");
    auto surface = load_(file);
    if (!surface) return surface.issue();
    auto mesh = RigidMesh::make(std::move(*surface));
    if (!mesh) return mesh.issue();
    return meshes_[file] = std::make_shared<const RigidMesh>(std::move(*mesh));
  }

 private:
  const MeshLoader& load_;
  std::map<RigidMeshFile, std::shared_ptr<const RigidMesh>> meshes_;
};

Issue in_file(Issue issue, const std::filesystem::path& file) {
  if (issue.where.empty()) issue.where = file.string();
  return issue;
}

/// One that a probe holds joins the world with its tool.
Result<BodyId> add_rigid_body(const SceneRigidBody& body, bool held, RigidMeshes& meshes,
                              SceneWorld& built) {
  RigidBodyDescription description = body.description;
  if (body.mesh) {
    auto mesh = meshes.get(*body.mesh);
    if (!mesh) return in_file(mesh.issue(), body.mesh->file);
    description.shape.mesh = std::move(*mesh);
  }
  built.shapes.back() = description.shape;
  if (held) return BodyId{};
  return built.world.add_rigid_body(description);
}

Status add_tools(const Scene& scene, SceneWorld& built) {
  for (const SceneProbe& probe : scene.probes) {
    std::vector<std::size_t> places;
    std::vector<RigidShape> shapes;
    for (const std::string& jaw : probe.jaws) {
      const auto body = std::ranges::find(scene.bodies, jaw, scene_body_name);
      places.push_back(std::size_t(body - scene.bodies.begin()));
      shapes.push_back(built.shapes[places.back()]);
    }
    auto tool = add_tool(built.world, scene, probe, shapes);
    if (!tool) return tool.issue();
    for (std::size_t k = 0; k < places.size(); ++k) built.bodies[places[k]] = tool->tool.bodies()[k];
    built.tools.push_back(std::move(*tool));
  }
  return {};
}

}  // namespace

Result<SceneWorld> build_world(const Scene& scene, const MeshLoader& load_mesh) {
  auto world = World::create(scene.world);
  if (!world) return world.issue();
  SceneWorld built{std::move(*world), {}, {}};
  RigidMeshes meshes(load_mesh);
  std::map<std::filesystem::path, FixedSetNames> wanted;
  for (const SceneBody& body : scene.bodies)
    if (const auto* soft = std::get_if<SceneSoftBody>(&body))
      wanted[soft->asset.lexically_normal()].insert(soft->description.fixed_set);
  std::map<std::filesystem::path, SharedAsset> assets;
  for (const auto& [file, fixed_sets] : wanted) {
    auto loaded = load_asset(file, scene.world, fixed_sets);
    if (!loaded) return in_file(loaded.issue(), file);
    assets[file] = std::move(loaded->asset);
    built.assets.push_back(std::move(loaded->use));
  }
  for (const SceneBody& body : scene.bodies) {
    const auto* soft = std::get_if<SceneSoftBody>(&body);
    built.shapes.emplace_back();
    auto id = soft != nullptr
                  ? built.world.add_soft_body(assets[soft->asset.lexically_normal()], soft->description)
                  : add_rigid_body(std::get<SceneRigidBody>(body),
                                   is_held(scene, scene_body_name(body)), meshes, built);
    if (!id) return id.issue();
    built.bodies.push_back(*id);
    if (soft != nullptr)
      if (auto status = add_loads(built.world, *id, *soft); !status) return status.issue();
  }
  if (auto status = add_tools(scene, built); !status) return status.issue();
  if (auto status = add_constraints(scene, built); !status) return status.issue();
  return built;
}

// The handle of the world turns about the origin, that of the scene about the point it grabbed.
Status drive_grabs(const Scene& scene, SceneWorld& built) {
  const double next_s = built.world.time_s() + scene.world.time_step_s;
  for (std::size_t k = 0; k < scene.grabs.size(); ++k) {
    const SceneGrab& grab = scene.grabs[k];
    std::optional<GrabId>& id = built.grabs[k];
    if (!id) continue;
    if (next_s > grab.release_s) {
      if (auto status = built.world.release(*id); !status) return status;
      id.reset();
      continue;
    }
    if (grab.path.empty()) continue;
    Pose handle = pose_at(grab.path, next_s);
    const Point turned = place({handle.rotation, {}}, grab.description.point_m);
    for (std::size_t axis = 0; axis < 3; ++axis) handle.translation[axis] -= turned[axis];
    if (auto status = built.world.move_grab(*id, handle); !status) return status;
  }
  return {};
}

}  // namespace souple
