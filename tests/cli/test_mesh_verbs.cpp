// SPDX-License-Identifier: GPL-3.0-or-later
// The verbs of single stages, and what bake does with dirty surfaces and given tets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;

/// A cube of side `side` from the origin; `open` leaves out the last face.
std::string cube_off(double side, bool open = false) {
  std::string text = open ? "OFF\n8 10 0\n" : "OFF\n8 12 0\n";
  for (const int z : {0, 1})
    for (const int y : {0, 1})
      for (const int x : {0, 1})
        text += std::to_string(x * side) + " " + std::to_string(y * side) + " " +
                std::to_string(z * side) + "\n";
  text += "3 0 2 3\n3 0 3 1\n3 0 1 5\n3 0 5 4\n3 1 3 7\n3 1 7 5\n3 3 2 6\n3 3 6 7\n3 2 0 4\n3 2 4 6\n";
  return open ? text : text + "3 4 5 7\n3 4 7 6\n";
}

/// One regular-ish tet of five, in gmsh's format 2.
const char* const five_tets =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"bone\"\n3 2 \"fat\"\n"
    "$EndPhysicalNames\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n"
    "8 0 1 1\n$EndNodes\n$Elements\n5\n1 4 2 1 1 1 2 4 5\n2 4 2 1 1 2 3 4 7\n3 4 2 2 1 5 2 7 6\n"
    "4 4 2 2 1 4 5 7 8\n5 4 2 2 1 2 4 5 7\n$EndElements\n";

class MeshVerbs : public SoupleCommand {
 protected:
  std::string text(const std::string& name) const { return path(name).string(); }
  nlohmann::json report(const std::string& schema, const std::vector<std::string>& words) const {
    const auto result = run_souple(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(schema_violation(result.json(), load_schema(schema)), "");
    return result.json();
  }
};

TEST_F(MeshVerbs, RepairLooksOnlyWithoutAnOutput) {
  const auto json = report("repair", {"repair", write("c.off", cube_off(1, true)).string(), "--json"});
  EXPECT_EQ(json["triage"]["boundary_edge_count"], 4);
  EXPECT_EQ(json["triage"]["hole_count"], 1);
  EXPECT_TRUE(json["repair"].is_null());
  EXPECT_EQ(names(), std::vector<std::string>{"c.off"});
}

TEST_F(MeshVerbs, RepairWritesASolidInEveryFormat) {
  const auto open = write("c.off", cube_off(1, true)).string();
  for (const std::string name : {"a.obj", "a.off", "a.ply", "a.stl", "a.glb"}) {
    const auto json = report("repair", {"repair", open, "-o", text(name), "--json"});
    EXPECT_NEAR(json["repair"]["volume_m3"].get<double>(), 1, 0.02) << name;
    const auto again = report("repair", {"repair", text(name), "--json"});
    EXPECT_EQ(again["triage"]["grade"], "good") << name;
  }
}

TEST_F(MeshVerbs, RepairRefusesWhatHasNoVolumeAndWritesNothing) {
  const auto flat = write("f.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").string();
  expect_issue(run_souple({"repair", flat, "-o", text("a.obj"), "--json"}), 3, "S3026");
  expect_issue(run_souple({"repair", flat, "-o", text("a.xyz")}), 5, "S5001");
  EXPECT_EQ(names(), std::vector<std::string>{"f.off"});
}

TEST_F(MeshVerbs, DecimateKeepsTheVolumeAndObeysTheCount) {
  const auto json = report("decimate", {"decimate", surface("liver-smooth.obj").string(), "--faces",
                                        "800", "-o", text("a.off"), "--json"});
  EXPECT_LE(json["decimate"]["face_count_after"], 800);
  EXPECT_NEAR(json["decimate"]["volume_after_m3"].get<double>() /
                  json["decimate"]["volume_before_m3"].get<double>(),
              1, 1e-3);
  expect_issue(run_souple({"decimate", surface("dino.off").string(), "-o", text("b.off")}), 1, "S1003");
  expect_issue(run_souple({"decimate", write("c.off", cube_off(1, true)).string(), "--faces", "100",
                           "-o", text("b.off")}),
               3, "S3020");
}

TEST_F(MeshVerbs, DecimateStaysWithinAnError) {
  const auto json = report("decimate", {"decimate", surface("dino.off").string(), "--max-error-m",
                                        "0.02", "-o", text("a.stl"), "--json"});
  EXPECT_LE(json["decimate"]["hausdorff_m"].get<double>(), 0.02);
  EXPECT_LT(json["decimate"]["face_count_after"], json["decimate"]["face_count_before"]);
}

TEST_F(MeshVerbs, StagesOneByOneGiveAnAsset) {
  const auto tets =
      report("tetrahedralize", {"tetrahedralize", surface("anchor.off").string(), "--size-m", "0.2",
                                "--tets", "600", "-o", text("a.msh"), "--json"});
  EXPECT_NEAR(tets["tetrahedralize"]["tet_count"].get<double>(), 600, 120);
  const auto levels =
      report("bake", {"hierarchy", text("a.msh"), "--surface", surface("anchor.off").string(),
                      "--size-m", "0.2", "--levels", "2", "-o", text("a.souple"), "--json"});
  ASSERT_EQ(levels["levels"].size(), 2u);
  EXPECT_EQ(levels["levels"][1]["tet_count"].get<int>(),
            8 * tets["tetrahedralize"]["tet_count"].get<int>());
  EXPECT_EQ(run_souple({"validate", text("a.souple")}).exit_code, 0);
}

TEST_F(MeshVerbs, SeveralMeshesBecomeAnEmbeddedHierarchy) {
  for (const auto& [file, tets] : {std::pair{"a.msh", "200"}, {"b.vtu", "900"}})
    ASSERT_EQ(run_souple({"tetrahedralize", surface("liver-smooth.obj").string(), "--size-m", "0.2",
                          "--tets", tets, "-o", text(file)})
                  .exit_code,
              0);
  const auto json =
      report("bake", {"hierarchy", text("a.msh"), text("b.vtu"), "-o", text("a.souple"), "--json"});
  ASSERT_EQ(json["levels"].size(), 2u);
  EXPECT_LT(json["levels"][1]["rigid_motion_error"]["embedding"].get<double>(), 1e-9);
  EXPECT_EQ(run_souple({"validate", text("a.souple")}).exit_code, 0);
  expect_issue(
      run_souple({"hierarchy", text("a.msh"), text("b.vtu"), "--levels", "2", "-o", text("b.souple")}),
      1, "S1004");
}

TEST_F(MeshVerbs, BakeTakesGivenTetsAsTheyAre) {
  const auto mesh = write("m.msh", five_tets).string();
  const auto json = report("bake", {"bake", mesh, "--size-m", "0.1", "-o", text("a.souple"), "--json"});
  ASSERT_EQ(json["levels"].size(), 1u);
  EXPECT_EQ(json["levels"][0]["tet_count"], 5);
  EXPECT_TRUE(json["coarse_mesh"].is_null());
  const auto finer = report("bake", {"bake", mesh, "--levels", "3", "-o", text("b.souple"), "--json"});
  EXPECT_EQ(finer["levels"][2]["tet_count"], 320);
  EXPECT_NEAR(finer["finest_quality"]["volume_m3"].get<double>(), 1, 1e-12);
  const auto anew = report("bake", {"bake", mesh, "--tets", "300", "-o", text("c.souple"), "--json"});
  EXPECT_GT(anew["levels"][0]["tet_count"], 150);
  expect_issue(run_souple({"bake", mesh, "--mesher", "lattice", "-o", text("d.souple")}), 1, "S1004");
}

TEST_F(MeshVerbs, BakeMendsInvertedTetsOnRequestOnly) {
  std::string bad = five_tets;
  bad.replace(bad.find("1 1 2 4 5"), 9, "1 2 1 4 5");
  const auto mesh = write("m.msh", bad).string();
  expect_issue(run_souple({"bake", mesh, "-o", text("a.souple")}), 3, "S3041");
  const auto json =
      report("bake", {"bake", mesh, "--repair", "mend", "-o", text("a.souple"), "--json"});
  EXPECT_EQ(json["import_tets"]["turned_count"], 1);
}

TEST_F(MeshVerbs, RegionsComeFromPartsAndFromGroups) {
  write("cube.off", cube_off(0.1));
  const auto recipe = write("r.toml",
                            "[surface]\nfile = \"cube.off\"\n[mesh]\ntets = 3000\nlevels = 1\n"
                            "[[material.region]]\nname = \"half\"\nyoung_pa = 1e6\n"
                            "box = { min = [-1, -1, -1], max = [0.05, 1, 1] }\n");
  const auto json =
      report("bake", {"bake", "--recipe", recipe.string(), "-o", text("a.souple"), "--json"});
  ASSERT_EQ(json["regions"].size(), 2u);
  EXPECT_NEAR(json["regions"][1]["volume_m3"].get<double>(), 5e-4, 0.5e-4);
  EXPECT_NEAR(json["regions"][1]["wanted_volume_m3"].get<double>(), 5e-4, 0.1e-4);
  const auto groups =
      write("g.toml", "[[material.region]]\nname = \"hard\"\nyoung_pa = 1e6\ngroup = \"bone\"\n");
  const auto mesh = write("m.msh", five_tets).string();
  const auto by_group = report("bake", {"bake", mesh, "--recipe", groups.string(), "--levels", "2",
                                        "-o", text("b.souple"), "--json"});
  EXPECT_EQ(by_group["regions"][1]["tet_count"], 16);
  const auto unknown = write("u.toml", "[[material.region]]\nname = \"hard\"\ngroup = \"steel\"\n");
  const auto refused = run_souple({"bake", mesh, "--recipe", unknown.string(), "-o", text("c.souple")});
  expect_issue(refused, 1, "S1012");
  EXPECT_NE(refused.err.find("bone"), std::string::npos) << refused.err;
  const auto far = write("f.toml",
                         "[[material.region]]\nname = \"far\"\n"
                         "sphere = { centre = [9, 9, 9], radius_m = 0.1 }\n");
  expect_issue(run_souple({"bake", mesh, "--recipe", far.string(), "-o", text("c.souple")}), 1,
               "S1012");
}

TEST_F(MeshVerbs, LocalSizesRefineWhereTheyAre) {
  write("cube.off", cube_off(0.1));
  const auto tets_with = [&](const std::string& refine) {
    const auto recipe = write("r.toml",
                              "[surface]\nfile = \"cube.off\"\n[mesh]\nedge_length_m = 0.02\n"
                              "levels = 1\nvisual = \"none\"\n" +
                                  refine);
    return report("bake", {"bake", "--recipe", recipe.string(), "-o", text("a.souple"),
                           "--json"})["levels"][0]["tet_count"]
        .get<int>();
  };
  const int plain = tets_with("");
  EXPECT_GT(tets_with("[[mesh.refine]]\nedge_length_m = 0.004\n"
                      "sphere = { centre = [0.1, 0.1, 0.1], radius_m = 0.02 }\n"),
            plain + 100);
  EXPECT_GT(tets_with("[[mesh.refine]]\nedge_length_m = 0.008\ndistance_m = 0.01\n"
                      "box = { min = [-1, -1, 0.09], max = [1, 1, 1] }\n"),
            plain + 300);
}

TEST_F(MeshVerbs, ExportWritesTetsBoundaryAndVisual) {
  const auto asset = baked_liver().string();
  for (const std::string name : {"a.msh", "a.mesh", "a.vtu", "a.vtk", "a.node"}) {
    const auto json = report("export", {"export", asset, "-o", text(name), "--json"});
    EXPECT_EQ(json["what"], "tets") << name;
    // What was written can be baked again: the same tets.
    const auto again = report("bake", {"bake", text(name), "-o", text("again.souple"), "--json"});
    EXPECT_EQ(again["levels"][0]["tet_count"], json["element_count"]) << name;
  }
  for (const std::string name : {"a.obj", "a.off", "a.ply", "a.stl", "a.glb"}) {
    const auto boundary = report("export", {"export", asset, "-o", text(name), "--json"});
    EXPECT_EQ(boundary["what"], "boundary");
    EXPECT_EQ(report("repair", {"repair", text(name), "--json"})["triage"]["grade"], "good") << name;
  }
  const auto visual = report("export", {"export", asset, "--visual", "-o", text("v.obj"), "--json"});
  EXPECT_EQ(visual["element_count"], 4384);
  expect_issue(run_souple({"export", asset, "--visual", "-o", text("v.msh")}), 1, "S1004");
  expect_issue(run_souple({"export", asset, "--level", "7", "-o", text("v.msh")}), 1, "S1002");
  expect_issue(run_souple({"export", asset, "-o", text("v.xyz")}), 5, "S5001");
  expect_issue(run_souple({"export", asset}), 1, "S1003");
  expect_issue(run_souple({"export", asset, "-o", text("v.msh"), "--to", "obj"}), 1, "S1004");
}

TEST_F(MeshVerbs, AVisualSurfaceLiesWhereTheOriginalDoes) {
  const auto asset = baked_liver().string();
  ASSERT_EQ(run_souple({"export", asset, "--visual", "-o", text("v.off")}).exit_code, 0);
  const auto triage = [&](const std::string& file, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"repair", file, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return report("repair", words)["triage"];
  };
  const auto exported = triage(text("v.off"));
  const auto original = triage(surface("liver-smooth.obj").string(), {"--size-m", "0.2"});
  EXPECT_NEAR(exported["volume_m3"].get<double>() / original["volume_m3"].get<double>(), 1, 1e-9);
}

}  // namespace
}  // namespace souple::test
