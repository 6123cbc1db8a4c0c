// SPDX-License-Identifier: GPL-3.0-or-later
// Files made to hurt: each has to end in a coded refusal or a sound surface, quickly.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <random>

#include "tests/tools/real_surface.hpp"
#include "tools/geometry/surface_measure.hpp"
#include "tools/surface/repair.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

class HostileSurface : public ::testing::Test {
 protected:
  HostileSurface() {
    std::string name = (fs::temp_directory_path() / "souple-hostile-XXXXXX").string();
    dir_ = ::mkdtemp(name.data());
  }
  ~HostileSurface() override { fs::remove_all(dir_); }

  fs::path file(const std::string& name, std::string_view bytes) const {
    std::ofstream(dir_ / name, std::ios::binary) << bytes;
    return dir_ / name;
  }

  static Result<ImportedSurface> import(const fs::path& path) {
    ImportOptions options;
    options.time_limit_s = 20;
    options.memory_limit_bytes = std::size_t{256} << 20;
    return import_surface(path, options);
  }

  /// A code, or IssueCode{} for a surface.
  IssueCode code(const std::string& name, std::string_view bytes) const {
    const auto surface = import(file(name, bytes));
    return surface.ok() ? IssueCode{} : surface.issue().code;
  }

  fs::path dir_;
};

const std::string triangle_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

std::string binary_stl(std::uint32_t declared, const std::vector<float>& corners) {
  std::string bytes(80, '\0');
  bytes.append(reinterpret_cast<const char*>(&declared), 4);
  for (std::size_t t = 0; t + 9 <= corners.size(); t += 9) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(&corners[t]), 36);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST_F(HostileSurface, RefusesWhatIsNoRegularFile) {
  EXPECT_EQ(import(dir_).issue().code, IssueCode::io_cannot_read);
  EXPECT_EQ(import(dir_ / "missing.obj").issue().code, IssueCode::io_file_missing);
  EXPECT_EQ(import("/dev/zero").issue().code, IssueCode::io_cannot_read);
  const fs::path fifo = dir_ / "fifo.obj";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(import(fifo).issue().code, IssueCode::io_cannot_read);
}

TEST_F(HostileSurface, RefusesEmptyAndForeignContent) {
  for (const char* name :
       {"a.obj", "a.off", "a.ply", "a.stl", "a.gltf", "a.glb", "a.fbx", "a.dae", "a.3ds"}) {
    EXPECT_EQ(code(name, ""), IssueCode::surface_empty_file) << name;
    EXPECT_EQ(code(name, " \n\t\n"), IssueCode::surface_empty_file) << name;
    const auto foreign = code(name, "this is a letter to my aunt\n");
    EXPECT_TRUE(foreign == IssueCode::surface_wrong_format ||
                foreign == IssueCode::surface_no_triangles)
        << name << " " << issue_code_text(foreign);
  }
  EXPECT_EQ(code("a.docx", "PK\x03\x04"), IssueCode::unsupported_surface_format);
  EXPECT_EQ(code("noextension", "PK\x03\x04"), IssueCode::unsupported_surface_format);
}

TEST_F(HostileSurface, ReadsWhatLiesAboutItsExtension) {
  const auto surface = import(file("really_obj.ply", triangle_obj + "f 1 2 3\n"));
  ASSERT_TRUE(surface.ok()) << format_issue(surface.issue());
  EXPECT_EQ(surface->report.format, "obj");
  const auto off = import(file("really_off.stl", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  ASSERT_TRUE(off.ok()) << format_issue(off.issue());
  EXPECT_EQ(off->report.format, "off");
}

TEST_F(HostileSurface, ReadsTheLooseFormsOfObj) {
  const std::string forms[] = {
      "f 1 2 3\n",          "f 1/1 2/2 3/3\n",     "f 1/1/1 2/2/2 3/3/3\r\n",
      "f 1//1 2//1 3//1\n", "f -3 -2 -1\n",        "f\t1\t2\t3",
      "f 1 2 \\\n3\n",      "f 1 2 3 # a comment", "l 1 2\nf 1 2 3\ncall x.obj\n"};
  for (const std::string& form : forms) {
    const auto surface = import(file("a.obj", "\xEF\xBB\xBF# mark\n" + triangle_obj + form));
    ASSERT_TRUE(surface.ok()) << form << format_issue(surface.issue());
    EXPECT_EQ(surface->mesh.triangles.size(), 1u) << form;
  }
}

TEST_F(HostileSurface, RefusesBadIndices) {
  for (const char* face : {"f 0 1 2\n", "f 1 2 4\n", "f -4 -2 -1\n", "f 1 2 99999999999\n"})
    EXPECT_EQ(code("a.obj", triangle_obj + face), IssueCode::surface_bad_index) << face;
  EXPECT_EQ(code("a.obj", triangle_obj + "f 1 2 99999999999999999999999\n"),
            IssueCode::surface_malformed);
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(code("a.off", off + "3 0 1 3\n"), IssueCode::surface_bad_index);
  EXPECT_EQ(code("a.off", off + "3 0 1 -1\n"), IssueCode::surface_bad_index);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(code("a.ply", ply + "3 0 1 2\n"), IssueCode{});
  EXPECT_EQ(code("a.ply", ply + "3 0 1 3\n"), IssueCode::surface_bad_index);
  EXPECT_EQ(code("a.ply", ply + "3 0 1 -1\n"), IssueCode::surface_bad_index);
}

TEST_F(HostileSurface, RefusesNumbersThatAreNotFiniteOrHuge) {
  for (const char* x : {"nan", "inf", "-INF", "1e999"}) {
    const std::string v = std::string(x) + " 0 0\n";
    EXPECT_EQ(code("a.obj", triangle_obj + "v " + v + "f 1 2 4\n"), IssueCode::surface_not_finite) << x;
    EXPECT_EQ(code("a.off", "OFF\n3 1 0\n0 0 0\n0 1 0\n" + v + "3 0 1 2\n"),
              IssueCode::surface_not_finite)
        << x;
    EXPECT_EQ(
        code("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex " +
                          v + "endloop\nendfacet\nendsolid a\n"),
        IssueCode::surface_not_finite)
        << x;
  }
  const float nan = std::nanf("");
  EXPECT_EQ(code("a.stl", binary_stl(1, {0, 0, 0, 1, 0, 0, nan, 1, 0})), IssueCode::surface_not_finite);
  EXPECT_EQ(code("a.stl", binary_stl(1, {0, 0, 0, 3e38f, 0, 0, 0, 3e38f, 0})),
            IssueCode::surface_too_far);
  EXPECT_EQ(code("a.obj", triangle_obj + "v 3e38 0 0\nf 1 2 4\n"), IssueCode::surface_too_far);
  EXPECT_EQ(code("a.obj", triangle_obj + "v 1e-400 0 5\nf 1 2 4\n"), IssueCode{});
}

TEST_F(HostileSurface, RefusesDeclaredCountsBeyondTheContent) {
  EXPECT_EQ(code("a.off", "OFF\n2000000000 2000000000 0\n0 0 0\n"), IssueCode::surface_malformed);
  EXPECT_EQ(code("a.off", "OFF\n-5 -7 0\n0 0 0\n"), IssueCode::surface_malformed);
  EXPECT_EQ(code("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"),
            IssueCode::surface_malformed);
  EXPECT_EQ(code("a.stl", binary_stl(4'000'000'000U, {0, 0, 0, 1, 0, 0, 0, 1, 0})),
            IssueCode::surface_malformed);
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty "
      "float y\n"
      "property float z\nelement face 1\nproperty list int int vertex_indices\nend_header\n";
  EXPECT_EQ(code("a.ply", ply + std::string(100, '\1')), IssueCode::surface_malformed);
  const std::string list =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n";
  const auto huge_list = code("a.ply", list + std::string(12, '\0') + "\xff\xff\xff\xff\1\1\1\1");
  EXPECT_TRUE(
      huge_list == IssueCode::surface_reader_memory || huge_list == IssueCode::surface_malformed ||
      huge_list == IssueCode::surface_reader_timeout || huge_list == IssueCode::surface_bad_index)
      << issue_code_text(huge_list);
}

TEST_F(HostileSurface, RefusesSurfacesWithoutTrianglesOrExtent) {
  EXPECT_EQ(code("a.obj", triangle_obj), IssueCode::surface_no_triangles);
  EXPECT_EQ(code("a.obj", triangle_obj + "l 1 2\nf 1 2\n"), IssueCode::surface_no_triangles);
  EXPECT_EQ(code("a.obj", triangle_obj + "f 1 1 2\n"), IssueCode::surface_no_triangles);
  EXPECT_EQ(code("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), IssueCode::surface_no_triangles);
  EXPECT_EQ(code("a.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n"), IssueCode::surface_no_extent);
  EXPECT_EQ(code("a.obj", "v 0 0 0\nv 1e-300 0 0\nv 0 1e-300 0\nf 1 2 3\n"),
            IssueCode::surface_no_extent);
}

TEST_F(HostileSurface, RefusesOtherTextEncodings) {
  const std::string text = triangle_obj + "f 1 2 3\n";
  std::string little = "\xFF\xFE", bare;
  for (const char c : text) {
    little += {c, '\0'};
    bare += {'\0', c};
  }
  EXPECT_EQ(code("a.obj", little), IssueCode::surface_text_encoding);
  EXPECT_EQ(code("a.obj", bare), IssueCode::surface_text_encoding);
}

TEST_F(HostileSurface, KeepsAwayFromFilesOutsideTheFolder) {
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"buffers":[{"uri":"URI","byteLength":36}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
      R"("componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})";
  const auto with = [&](std::string_view uri) {
    std::string text = gltf;
    return text.replace(text.find("URI"), 3, uri);
  };
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  file("data.bin", {reinterpret_cast<const char*>(corners), sizeof corners});
  EXPECT_EQ(code("a.gltf", with("data.bin")), IssueCode{});
  fs::create_directory(dir_ / "sub");
  std::ofstream(dir_ / "sub/a.gltf") << with("../data.bin");
  EXPECT_FALSE(import(dir_ / "sub/a.gltf").ok());
  EXPECT_FALSE(import(file("a.gltf", with("/dev/zero"))).ok());
}

TEST_F(HostileSurface, RefusesCountsOfABinaryGltfBeyondItsContent) {
  const auto glb = [](const std::string& json, std::uint32_t total, std::uint32_t json_bytes) {
    std::string bytes = "glTF";
    for (const std::uint32_t word : {2U, total, json_bytes, 0x4E4F534AU})
      bytes.append(reinterpret_cast<const char*>(&word), 4);
    return bytes + json;
  };
  const auto mesh = [](const std::string& count, const std::string& length) {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + length +
           R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + length +
           R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + count +
           R"(,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
           R"("nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})";
  };
  const auto size = [](const std::string& text) { return static_cast<std::uint32_t>(text.size()); };
  const std::string bomb = mesh("1000000000", "4000000000");
  for (const std::string& bytes :
       {glb(bomb, size(bomb) + 20, size(bomb)), glb(bomb, 0xFFFFFFFFU, 0xFFFFFFF0U),
        glb(mesh("3", "36"), 20, 0xFFFFFFFFU), glb("", 20, 0)}) {
    const IssueCode refused = code("a.glb", bytes);
    EXPECT_EQ(refused, IssueCode::surface_malformed) << issue_code_text(refused);
  }
}

TEST_F(HostileSurface, ReadsNamesInAnyLanguageAndRefusesAFlatShapeAtTheRepair) {
  SOUPLE_NEEDS_REAL_SURFACES();
  const auto flat = import(real_surface_dir() / "测试模型.off");
  ASSERT_TRUE(flat.ok()) << format_issue(flat.issue());
  EXPECT_EQ(repair_surface(flat->mesh, {}).issue().code, IssueCode::surface_hopeless);
  const std::string text = triangle_obj + "f 1 2 3\n";
  for (const char* name : {"печень.obj", "كبد.obj", "肝臓 (2).obj", "a\nb.obj", "\xff\xfe.obj",
                           "-o.obj", "%s%n.obj", "..obj"})
    EXPECT_EQ(code(name, text), IssueCode{}) << name;
  EXPECT_EQ(code("печень.doc", "PK\x03\x04"), IssueCode::unsupported_surface_format);
}

TEST_F(HostileSurface, TurnsMirroredAndNestedShapesRightSideOut) {
  SOUPLE_NEEDS_REAL_SURFACES();
  struct Case {
    const char* name;
    std::size_t shells;
    double volume;  ///< cubed units of the file
  };
  // As other programs measured them; the first has three cubes, two of them mirrored, and a hollow one.
  for (const Case& c : {Case{"cubes_with_mirroring_and_pivot.fbx", 5, 3e-3 + 0.000939632 - 0.000463412},
                        Case{"nested.glb", 3, 0.898779}}) {
    const auto surface = import(real_surface_dir() / c.name);
    ASSERT_TRUE(surface.ok()) << format_issue(surface.issue());
    const auto solid = repair_surface(surface->mesh, {});
    ASSERT_TRUE(solid.ok()) << format_issue(solid.issue());
    EXPECT_TRUE(check_closed_oriented_manifold(solid->mesh).ok()) << c.name;
    EXPECT_EQ(solid->report.orient.shell_count, c.shells) << c.name;
    EXPECT_NEAR(signed_volume(solid->mesh), c.volume, 1e-6 * c.volume) << c.name;
  }
}

TEST_F(HostileSurface, RefusesTheHostileRealFilesByTheirCodes) {
  SOUPLE_NEEDS_REAL_SURFACES();
  struct Case {
    const char* name;
    const char* code;
  };
  for (const Case& c :
       {Case{"BoxWithInfinites.glb", "S3005"}, Case{"IndexOutOfRange.gltf", "S3004"},
        Case{"IndexOutOfRange.bin", "S5010"}, Case{"box_UTF16BE.obj", "S3003"},
        Case{"empty.ply", "S3000"}, Case{"invalid.off", "S3004"}, Case{"malformed.obj", "S3004"}}) {
    const auto surface = import(real_surface_dir() / c.name);
    ASSERT_FALSE(surface.ok()) << c.name;
    EXPECT_EQ(issue_code_text(surface.issue().code), c.code) << format_issue(surface.issue());
    EXPECT_NE(surface.issue().where.find(c.name), std::string::npos);
  }
}

TEST_F(HostileSurface, ReadsRealFilesUnderTheWrongExtension) {
  SOUPLE_NEEDS_REAL_SURFACES();
  struct Case {
    const char *name, *as, *format;
  };
  for (const Case& c :
       {Case{"cube_binary.ply", "a.obj", "ply"}, Case{"tetrahedron.off", "a.stl", "off"},
        Case{"round.stl", "a.ply", "stl"}, Case{"nested.glb", "a.3ds", "gltf"},
        Case{"huesitos.fbx", "a.dae", "fbx"}, Case{"test1.3ds", "a.glb", "3ds"}}) {
    fs::copy_file(real_surface_dir() / c.name, dir_ / c.as, fs::copy_options::overwrite_existing);
    const auto surface = import(dir_ / c.as);
    ASSERT_TRUE(surface.ok()) << c.name << ": " << format_issue(surface.issue());
    EXPECT_EQ(surface->report.format, c.format) << c.name;
  }
}

TEST_F(HostileSurface, EndsEveryTruncationAndManyBitFlipsWithoutACrashOfItsOwn) {
  SOUPLE_NEEDS_REAL_SURFACES();
  std::mt19937 random(3);
  for (const char* name :
       {"cube_binary.ply", "shared.STL", "nested.glb", "test1.3ds", "cube_UTF8BOM.dae",
        "tetrahedron.off", "negative_indices.obj", "huesitos.fbx"}) {
    std::ifstream in(real_surface_dir() / name, std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(in), {}};
    const std::string ending = fs::path(name).extension();
    for (int i = 0; i < 24; ++i) {
      std::string bytes = whole;
      if (i % 2 == 0) {
        bytes.resize(random() % whole.size());
      } else {
        for (int k = 0; k < 8; ++k)
          bytes[random() % whole.size()] ^= static_cast<char>(1 << (random() % 8));
      }
      const auto surface = import(file("mangled" + ending, bytes));
      if (surface) {
        EXPECT_TRUE(check_triangle_mesh(surface->mesh).ok()) << name << " " << i;
      } else {
        EXPECT_EQ(exit_code(surface.issue().code) == 3 || exit_code(surface.issue().code) == 5, true)
            << name << " " << i << ": " << format_issue(surface.issue());
      }
    }
  }
}

}  // namespace
}  // namespace souple
