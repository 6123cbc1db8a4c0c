// SPDX-License-Identifier: GPL-3.0-or-later
// A scene as text and data: the world's settings, its bodies and what to write. SI units.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/core/result.hpp"
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

using SceneBody = std::variant<SceneSoftBody, RigidBodyDescription>;

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

struct Scene {
  WorldSettings world;
  std::vector<SceneBody> bodies;  ///< with names that are unique and fit for file names
  std::vector<ScenePair> pairs;
  SceneOutput output;
};

/// Every key is known, of its kind and in range, or the scene is refused. `name` stands in messages.
/// Issues: config_*.
Result<Scene> parse_scene(std::string_view text, const std::string& name);
/// As parse_scene; relative assets are taken relative to the scene's folder.
Result<Scene> read_scene(const std::filesystem::path& file);

const std::string& scene_body_name(const SceneBody& body);
std::string_view contact_method_name(ContactMethod method);
std::string_view rotation_method_name(RotationMethod method);
std::string_view integrator_name(Integrator integrator);

}  // namespace souple
