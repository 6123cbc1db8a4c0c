// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

#include "formats/core/result.hpp"
#include "tools/exchange/vtu_writer.hpp"
#include "tools/scene/scene_world.hpp"

namespace souple {

/// As triangulate_shape, of meshes too.
TriangleMesh placed_surface(const RigidShape& shape, const Pose& pose, double plane_size_m);

/// Writes frames of a scene: `frames/<body>_000012.vtu` per body, `frames/scene_000012.vtu` with the
/// surfaces of all bodies if asked for, and `scene.pvd` that lists them with their times.
/// Fields at the points: displacement (m, since the first frame), velocity (m/s), body (its number).
class FrameWriter {
 public:
  /// `scene` and `built` must outlive the writer; the state now is what displacements refer to.
  FrameWriter(const Scene& scene, const SceneWorld& built, std::filesystem::path folder);

  /// Makes the folder and takes old frames out of it, so that no two runs mix. Issue io_cannot_write.
  Status prepare();
  Status write_frame();
  Status finish();  ///< the collection of the frames written so far
  std::size_t frame_count() const { return frame_count_; }

 private:
  VtuMesh body_mesh(std::size_t body, FrameContent content) const;
  Status write_piece(const VtuMesh& mesh, const std::string& name, int part);

  const Scene& scene_;
  const SceneWorld& built_;
  std::filesystem::path folder_;
  std::vector<std::vector<Point>> first_positions_;  ///< of soft bodies
  std::vector<Pose> first_poses_;                    ///< of rigid bodies
  std::vector<PvdEntry> entries_;
  std::size_t frame_count_ = 0;
};

}  // namespace souple
