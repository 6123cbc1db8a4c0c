// SPDX-License-Identifier: GPL-3.0-or-later
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/scene.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>

#include "tools/surface/surface_readers.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_side_file = std::uintmax_t{1} << 30;

/// Serves the surface from memory under a name of the right extension, and regular files in its folder
/// or below; nothing else on the machine is reachable from inside a file.
class FolderOnly : public Assimp::IOSystem {
 public:
  FolderOnly(std::string name, std::string_view bytes, fs::path folder)
      : name_(std::move(name)), bytes_(bytes), folder_(std::move(folder)) {}

  bool Exists(const char* file) const override { return file == name_ || is_beside(file); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* = "rb") override {
    if (file == name_) return stream(bytes_);
    if (!is_beside(file)) return nullptr;
    std::ifstream in(folder_ / file, std::ios::binary);
    held_.push_back(std::make_unique<std::string>(std::istreambuf_iterator<char>(in),
                                                  std::istreambuf_iterator<char>()));
    return stream(*held_.back());
  }
  void Close(Assimp::IOStream* file) override { delete file; }

 private:
  static Assimp::IOStream* stream(std::string_view bytes) {
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                      bytes.size());
  }
  bool is_beside(const fs::path& file) const {
    if (file.empty() || file.is_absolute()) return false;
    for (const fs::path& part : file)
      if (part == "..") return false;
    std::error_code error;
    const fs::path full = folder_ / file;
    return fs::is_regular_file(full, error) && fs::file_size(full, error) <= largest_side_file &&
           !error;
  }

  std::string name_;
  std::string_view bytes_;
  fs::path folder_;
  std::vector<std::unique_ptr<std::string>> held_;
};

/// assimp drops faces whose indices are out of range and says so only in its log.
class IndexWarning : public Assimp::LogStream {
 public:
  explicit IndexWarning(bool& seen) : seen_(seen) {}
  void write(const char* message) override {
    if (std::string_view(message).find("out-of-range") != std::string_view::npos) seen_ = true;
  }

 private:
  bool& seen_;
};

/// Row-major affine map in double; assimp stores its own in single precision.
struct Affine {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Point operator()(const aiVector3D& p) const {
    Point out;
    for (std::size_t r = 0; r < 3; ++r)
      out[r] =
          rows[r][0] * double{p.x} + rows[r][1] * double{p.y} + rows[r][2] * double{p.z} + rows[r][3];
    return out;
  }
  /// First `inner`, then this.
  Affine after(const aiMatrix4x4& inner) const {
    Affine out;
    for (std::size_t r = 0; r < 3; ++r)
      for (unsigned c = 0; c < 4; ++c) {
        out.rows[r][c] = c == 3 ? rows[r][3] : 0;
        for (unsigned k = 0; k < 3; ++k) out.rows[r][c] += rows[r][k] * double{inner[k][c]};
      }
    return out;
  }
  bool is_mirrored() const {
    return signed_volume6({0, 0, 0}, {rows[0][0], rows[1][0], rows[2][0]},
                          {rows[0][1], rows[1][1], rows[2][1]},
                          {rows[0][2], rows[1][2], rows[2][2]}) < 0;
  }
};

void append_mesh(const aiMesh& mesh, const Affine& placed, PolygonSoup& soup) {
  const std::size_t first = soup.points.size();
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) soup.points.push_back(placed(mesh.mVertices[i]));
  const bool turn = placed.is_mirrored();
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < 3) continue;  // points and lines
    Polygon& polygon = soup.polygons.emplace_back();
    for (unsigned k = 0; k < face.mNumIndices; ++k)
      polygon.push_back(face.mIndices[k] < mesh.mNumVertices ? first + face.mIndices[k]
                                                             : ~std::size_t{0});
    if (turn) std::reverse(polygon.begin(), polygon.end());
  }
}

PolygonSoup place_meshes(const aiScene& scene) {
  struct Placed {
    const aiNode* node;
    Affine parent;
  };
  PolygonSoup soup;
  std::vector<Placed> pending{{scene.mRootNode, {}}};
  while (!pending.empty()) {
    const Placed at = pending.back();
    pending.pop_back();
    const Affine world = at.parent.after(at.node->mTransformation);
    for (unsigned m = 0; m < at.node->mNumMeshes; ++m)
      if (at.node->mMeshes[m] < scene.mNumMeshes)
        append_mesh(*scene.mMeshes[at.node->mMeshes[m]], world, soup);
    for (unsigned c = at.node->mNumChildren; c > 0; --c)
      pending.push_back({at.node->mChildren[c - 1], world});
  }
  return soup;
}

std::string_view extension_of(SurfaceFormat format, std::string_view bytes) {
  switch (format) {
    case SurfaceFormat::fbx:
      return ".fbx";
    case SurfaceFormat::collada:
      return ".dae";
    case SurfaceFormat::three_ds:
      return ".3ds";
    default:
      return bytes.starts_with("glTF") ? ".glb" : ".gltf";
  }
}

}  // namespace

Result<PolygonSoup> read_with_assimp(SurfaceFormat format, std::string_view bytes,
                                     const fs::path& file) {
  const std::string name = "surface" + std::string(extension_of(format, bytes));
  bool has_bad_index = false;
  Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(new IndexWarning(has_bad_index), Assimp::Logger::Warn);
  Assimp::Importer importer;
  importer.SetIOHandler(new FolderOnly(name, bytes, file.parent_path()));
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_CAMERAS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_LIGHTS, false);
  const aiScene* scene = importer.ReadFile(name, 0);
  if (scene == nullptr || scene->mRootNode == nullptr)
    return make_issue(IssueCode::surface_malformed,
                      "not readable as " + std::string(surface_format_name(format)) + ": " +
                          std::string(importer.GetErrorString()).substr(0, 200));
  if (has_bad_index)
    return make_issue(IssueCode::surface_bad_index, "a face names a vertex that does not exist");
  return place_meshes(*scene);
}

}  // namespace souple
