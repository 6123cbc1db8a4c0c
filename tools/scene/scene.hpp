// SPDX-License-Identifier: GPL-3.0-or-later
// A scene as text and data: the world's settings, its bodies and what to write. SI units.
#pragma once
#include <compare>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/core/result.hpp"
#include "runtime/haptics/haptic_settings.hpp"
#include "runtime/world/constraints.hpp"
#include "runtime/world/loads.hpp"
#include "runtime/world/settings.hpp"

namespace souple {

/// Where a load acts, in metres in the frame of the body at rest; nothing given: on the whole boundary.
struct LoadPlace {
  std::string set;             ///< a node set of the asset
  std::optional<Point> point;  ///< the nearest point of the boundary
  struct Box {
    Point min{}, max{};
  };
  std::optional<Box> box;
};

struct SceneLoad {
  LoadDescription load;  ///< without nodes and triangles, which the asset decides
  LoadPlace place;
};

struct SceneSoftBody {
  SoftBodyDescription description;
  std::filesystem::path asset;
  std::vector<SceneLoad> loads;
};

/// A file with the surface of a rigid body.
struct RigidMeshFile {
  std::filesystem::path file;
  double scale = 1;   ///< metres per unit of the file
  double size_m = 0;  ///< > 0: longest side after scaling, instead
  friend auto operator<=>(const RigidMeshFile&, const RigidMeshFile&) = default;
};

struct SceneRigidBody {
  RigidBodyDescription description;   ///< of a mesh without the surface, which build_world loads
  std::optional<RigidMeshFile> mesh;  ///< of a shape of kind mesh
};

using SceneBody = std::variant<SceneSoftBody, SceneRigidBody>;

enum class FrameContent : std::uint8_t { tets, surface };

struct SceneOutput {
  std::int64_t frames_every = 1;  ///< steps between frames; frame 0 is the initial state
  bool vtu = true;
  FrameContent content = FrameContent::tets;  ///< of soft bodies
  bool combined = false;    ///< one file per frame with the surfaces of all bodies as well
  double plane_size_m = 1;  ///< side of the square that stands for a plane
};

struct ScenePair {
  std::string a, b;  ///< names of bodies
  PairRule rule;
};

struct SceneJoint {
  JointDescription description;  ///< without the bodies
  std::string a, b;              ///< names of bodies; b empty: the world
};

/// Takes hold of a body at the start.
struct SceneGrab {
  std::string body;
  GrabDescription description;  ///< without the body
  /// Of the point that was grabbed, and the turn about it since; none: it stays.
  std::vector<Keyframe> path;
  double release_s = std::numeric_limits<double>::infinity();
};

enum class ProbeDevice : std::uint8_t {
  path,  ///< plays where a hand was, and feels nothing
  hand,  ///< a simulated hand that wants to go there, and gives way
  udp,   ///< another program of this machine
};

enum class ProbePassivity : std::uint8_t { off, each_freedom, total_power };

/// A tool that a hand holds: one rigid body of the scene, or two that open about a hinge.
struct SceneProbe {
  std::string name;
  std::vector<std::string> jaws;  ///< rigid bodies, which stand as they do at the start
  Pose pose;                      ///< of the handle, at the start
  Point hinge_m{};                ///< of two jaws: in the world, at the start
  Point axis{0, 1, 0};            ///< the first jaw turns about it by half the opening, the second back
  double opening_rad = 0;         ///< at the start
  HandleCoupling coupling;
  HapticSettings haptics;
  ProbePassivity passivity = ProbePassivity::off;

  ProbeDevice device = ProbeDevice::path;
  std::filesystem::path path_file;  ///< of path and hand; empty: the keyframes
  std::vector<DeviceSample> path;
  double grip = 0.5;  ///< of the hand: 0 limp, 1 stiff
  double resolution_m = 0, turn_resolution_rad = 0, opening_resolution_rad = 0;
  std::size_t delay_ticks = 0;
  std::uint16_t port = 0;  ///< of udp
};

struct Scene {
  WorldSettings world;
  std::vector<SceneBody> bodies;  ///< with names that are unique and fit for file names
  std::vector<ScenePair> pairs;
  std::vector<SceneJoint> joints;
  std::vector<SceneGrab> grabs;
  std::vector<SceneProbe> probes;
  SceneOutput output;
};

/// Every key is known, of its kind and in range, or the scene is refused. `name` stands in messages.
/// Issues: config_*.
Result<Scene> parse_scene(std::string_view text, const std::string& name);
/// As parse_scene; relative assets and meshes are taken relative to the scene's folder.
Result<Scene> read_scene(const std::filesystem::path& file);

const std::string& scene_body_name(const SceneBody& body);
std::string_view contact_method_name(ContactMethod method);
std::string_view rotation_method_name(RotationMethod method);
std::string_view integrator_name(Integrator integrator);
std::string_view probe_device_name(ProbeDevice device);
std::string_view probe_passivity_name(ProbePassivity passivity);

}  // namespace souple
