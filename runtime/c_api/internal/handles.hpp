// SPDX-License-Identifier: MIT
// What is behind the opaque handles of the C interface.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "runtime/c_api/internal/refusal.hpp"
#include "runtime/collision/rigid_mesh.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "runtime/world/world.hpp"

struct souple_asset {
  std::shared_ptr<const souple::SoftBodyAsset> body;
  std::string content_hash;
  int format_major = 0, format_minor = 0;
  std::size_t level_count = 0;
};

struct souple_rigid_mesh {
  std::shared_ptr<const souple::RigidMesh> mesh;
};

struct souple_world {
  souple::World world;
  /// Room for the shown vertices of any of its bodies, on their way to single precision.
  mutable std::vector<souple::Point> vertices{};
};

namespace souple::c_api {

/// Issue api_no_such_object unless the world has such a body.
Status check_body(const souple_world& world, souple_body body);
Status check_soft(const souple_world& world, souple_body body);
Status check_rigid(const souple_world& world, souple_body body);

}  // namespace souple::c_api
