// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/scene/frame_writer.hpp"

#include <algorithm>
#include <cctype>
#include <system_error>

#include "runtime/collision/mass_properties.hpp"
#include "runtime/collision/rigid_mesh.hpp"
#include "runtime/world/soft_body_asset.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/shape_mesh.hpp"

namespace souple {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t frame_digits = 6;

std::string frame_name(const std::string& body, std::size_t frame) {
  std::string number = std::to_string(frame);
  if (number.size() < frame_digits) number.insert(0, frame_digits - number.size(), '0');
  return body + "_" + number + ".vtu";
}

/// "<anything>_<6 or more digits>.vtu": what frame_name makes.
bool is_frame_name(const std::string& name) {
  if (!name.ends_with(".vtu")) return false;
  const std::string stem = name.substr(0, name.size() - 4);
  const std::size_t mark = stem.rfind('_');
  if (mark == std::string::npos || stem.size() - mark - 1 < frame_digits) return false;
  return std::all_of(stem.begin() + static_cast<std::ptrdiff_t>(mark) + 1, stem.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Keeps the triangles' points only, renumbered.
void drop_unused_points(VtuMesh& mesh) {
  const std::vector<Index> used = used_nodes(mesh.triangles);
  std::vector<Index> new_index(mesh.points.size(), 0);
  std::vector<Point> points;
  for (const Index node : used) {
    new_index[static_cast<std::size_t>(node)] = static_cast<Index>(points.size());
    points.push_back(mesh.points[static_cast<std::size_t>(node)]);
  }
  for (VtuField& field : mesh.fields) {
    const auto width = static_cast<std::ptrdiff_t>(field.component_count);
    std::vector<double> values;
    for (const Index node : used)
      values.insert(values.end(), field.values.begin() + node * width,
                    field.values.begin() + (node + 1) * width);
    field.values = std::move(values);
  }
  for (Triangle& t : mesh.triangles)
    for (Index& node : t) node = new_index[static_cast<std::size_t>(node)];
  mesh.points = std::move(points);
}

VtuField constant_field(std::string name, std::size_t rows, double value) {
  return {std::move(name), 1, std::vector<double>(rows, value)};
}

VtuMesh soft_mesh(const World& world, BodyId body, const std::vector<Point>& first,
                  FrameContent content) {
  const auto positions = world.positions(body);
  std::vector<Point> displacement(positions.begin(), positions.end());
  for (std::size_t i = 0; i < displacement.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) displacement[i][axis] -= first[i][axis];
  VtuMesh mesh;
  mesh.points.assign(positions.begin(), positions.end());
  mesh.fields = {vector_field("displacement", displacement),
                 vector_field("velocity", world.velocities(body)),
                 constant_field("body", positions.size(), body.index)};
  const SoftBodyAsset& asset = world.asset(body);
  if (content == FrameContent::tets) {
    mesh.tets.assign(asset.model().tets().begin(), asset.model().tets().end());
  } else {
    mesh.triangles.assign(asset.surface().triangles().begin(), asset.surface().triangles().end());
    drop_unused_points(mesh);
  }
  return mesh;
}

/// Of the points of a free rigid body, m/s; of another one zero.
std::vector<Point> point_velocities(const RigidShape& shape, const World& world, BodyId body,
                                    const std::vector<Point>& points) {
  std::vector<Point> velocities(points.size());
  const Vec3 velocity = as_vec3(world.rigid_velocity(body));
  const Vec3 spin = as_vec3(world.rigid_angular_velocity(body));
  if (velocity.isZero(0) && spin.isZero(0)) return velocities;
  const Point centre = place(world.rigid_pose(body), as_point(mass_properties(shape).centre));
  for (std::size_t k = 0; k < points.size(); ++k)
    velocities[k] = as_point(velocity + spin.cross(as_vec3(points[k]) - as_vec3(centre)));
  return velocities;
}

VtuMesh rigid_mesh(const RigidShape& shape, const World& world, BodyId body, const Pose& first,
                   double plane_size_m) {
  TriangleMesh shown = placed_surface(shape, world.rigid_pose(body), plane_size_m);
  std::vector<Point> displacement = placed_surface(shape, first, plane_size_m).vertices;
  for (std::size_t k = 0; k < displacement.size(); ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      displacement[k][axis] = shown.vertices[k][axis] - displacement[k][axis];
  VtuMesh mesh;
  mesh.points = std::move(shown.vertices);
  mesh.triangles = std::move(shown.triangles);
  mesh.fields = {vector_field("displacement", displacement),
                 vector_field("velocity", point_velocities(shape, world, body, mesh.points)),
                 constant_field("body", mesh.points.size(), body.index)};
  return mesh;
}

}  // namespace

TriangleMesh placed_surface(const RigidShape& shape, const Pose& pose, double plane_size_m) {
  if (shape.mesh == nullptr) return triangulate_shape(shape, pose, plane_size_m);
  TriangleMesh mesh;
  for (const Point& vertex : shape.mesh->vertices()) mesh.vertices.push_back(place(pose, vertex));
  mesh.triangles.assign(shape.mesh->triangles().begin(), shape.mesh->triangles().end());
  return mesh;
}

FrameWriter::FrameWriter(const Scene& scene, const SceneWorld& built, fs::path folder)
    : scene_(scene), built_(built), folder_(std::move(folder)) {
  for (const BodyId body : built_.bodies) {
    first_positions_.emplace_back();
    first_poses_.emplace_back();
    if (!built_.world.is_soft(body)) {
      first_poses_.back() = built_.world.rigid_pose(body);
      continue;
    }
    const auto positions = built_.world.positions(body);
    first_positions_.back().assign(positions.begin(), positions.end());
  }
}

Status FrameWriter::prepare() {
  const fs::path frames = folder_ / "frames";
  if (auto status = make_output_folder(frames); !status) return status;
  std::error_code error;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(frames, error))
    if (entry.is_regular_file(error) && is_frame_name(entry.path().filename().string()))
      old.push_back(entry.path());
  for (const fs::path& file : old)
    if (!fs::remove(file, error))
      return make_issue(IssueCode::io_cannot_write, "cannot remove an old frame: " + error.message(),
                        file.string());
  return {};
}

VtuMesh FrameWriter::body_mesh(std::size_t body, FrameContent content) const {
  if (!built_.world.is_soft(built_.bodies[body]))
    return rigid_mesh(built_.shapes[body], built_.world, built_.bodies[body], first_poses_[body],
                      scene_.output.plane_size_m);
  return soft_mesh(built_.world, built_.bodies[body], first_positions_[body], content);
}

Status FrameWriter::write_piece(const VtuMesh& mesh, const std::string& name, int part) {
  const std::string file = "frames/" + frame_name(name, frame_count_);
  if (auto status = write_vtu(mesh, folder_ / file); !status) return status;
  entries_.push_back({built_.world.time_s(), part, name, file});
  return {};
}

Status FrameWriter::write_frame() {
  if (!scene_.output.vtu) return {};
  const std::size_t first_entry = entries_.size();
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const VtuMesh mesh = body_mesh(i, scene_.output.content);
    if (auto status = write_piece(mesh, scene_body_name(scene_.bodies[i]), static_cast<int>(i));
        !status) {
      // A frame counts only when all its bodies are there.
      entries_.resize(first_entry);
      return status;
    }
  }
  if (scene_.output.combined) {
    VtuMesh all;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      append_mesh(all, body_mesh(i, FrameContent::surface));
    if (auto status = write_vtu(all, folder_ / "frames" / frame_name("scene", frame_count_)); !status)
      return status;
  }
  ++frame_count_;
  return {};
}

Status FrameWriter::finish() {
  if (!scene_.output.vtu) return {};
  return write_file_atomically(folder_ / "scene.pvd", pvd_text(entries_));
}

}  // namespace souple
