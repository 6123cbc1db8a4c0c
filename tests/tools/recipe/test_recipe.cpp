// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/recipe.hpp"

#include <gtest/gtest.h>

#include "tools/recipe/recipe_parameters.hpp"

namespace souple {
namespace {

const char* const full_recipe = R"(
[surface]
file = "liver.obj"
unit = "cm"
size_m = 0.2
[mesh]
tets = 4000
levels = 3
hierarchy = "nested"
interior_coarsening = 2
features = "keep"
[[mesh.refine]]
edge_length_m = 0.004
sphere = { centre = [0, 0, 0.1], radius_m = 0.02 }
[[mesh.refine]]
edge_length_m = 0.005
surface = "patch.stl"
distance_m = 0.01
[material]
young_pa = 5e3
poisson = 0.45
density = 1060
rayleigh_mass_per_s = 0.2
rayleigh_stiffness_s = 0.02
[[material.region]]
name = "tumour"
young_pa = 5e4
surface = "tumour.off"
[[material.region]]
name = "cap"
density = 1200
box = { min = [0, 0, 0], max = [1, 1, 1] }
[[fixed]]
name = "left"
box = { min = [-1, -1, -1], max = [0, 1, 1] }
[[fixed]]
name = "ball"
sphere = { centre = [0, 0, 0], radius_m = 0.05 }
[[fixed]]
name = "foot"
plane = { point = [0, 0, 0.01], normal = [0, 0, 2] }
[[fixed]]
name = "tip"
nearest = { point = [0, 0, 1], count = 3 }
[[compliance]]
name = "fast"
time_step_s = 0.001
tolerance = 0.05
error_norm = "worst-column"
nodes = { sphere = { centre = [0, 0, 0.1], radius_m = 0.02 } }
coarsening = 1
way = "by-solves"
[[compliance]]
name = "held"
kind = "static"
fixed = "foot"
scalar = "float64"
)";

IssueCode code_of(const std::string& text) {
  const auto recipe = parse_recipe(text, "r.toml");
  if (!recipe) return recipe.issue().code;
  const Status status = check_recipe(*recipe);
  return status ? IssueCode{} : status.issue().code;
}

TEST(Recipe, ReadsEveryKey) {
  const auto recipe = parse_recipe(full_recipe, "r.toml");
  ASSERT_TRUE(recipe.ok()) << format_issue(recipe.issue());
  EXPECT_TRUE(check_recipe(*recipe).ok());
  EXPECT_EQ(recipe->surface.file, "liver.obj");
  EXPECT_EQ(recipe->surface.unit, "cm");
  EXPECT_EQ(recipe->mesh.tets, 4000);
  EXPECT_EQ(recipe->mesh.levels, 3);
  EXPECT_EQ(recipe->material.density_kg_m3, 1060);
  EXPECT_EQ(recipe->material.rayleigh_stiffness_s, 0.02);
  EXPECT_EQ(recipe->mesh.interior_coarsening, 2);
  EXPECT_EQ(recipe->mesh.features, "keep");
  ASSERT_EQ(recipe->refine.size(), 2u);
  EXPECT_EQ(std::get<SphereSelection>(recipe->refine[0].where).radius_m, 0.02);
  EXPECT_EQ(std::get<FileSelection>(recipe->refine[1].where).file, "patch.stl");
  EXPECT_EQ(recipe->refine[1].distance_m, 0.01);
  ASSERT_EQ(recipe->regions.size(), 2u);
  EXPECT_EQ(recipe->regions[0].young_pa, 5e4);
  EXPECT_EQ(recipe->regions[0].poisson, 0.45);  // [material] is the default of its regions
  EXPECT_EQ(recipe->regions[1].density_kg_m3, 1200);
  ASSERT_EQ(recipe->fixed.size(), 4u);
  EXPECT_EQ(std::get<SphereSelection>(recipe->fixed[1].selection).radius_m, 0.05);
  EXPECT_EQ(std::get<NearestSelection>(recipe->fixed[3].selection).count, 3);
  ASSERT_EQ(recipe->compliances.size(), 2u);
  EXPECT_EQ(recipe->compliances[0].time_step_s, 0.001);
  EXPECT_EQ(recipe->compliances[1].kind, ComplianceKind::static_equilibrium);
  EXPECT_EQ(recipe->compliances[1].time_step_s, 0);
  EXPECT_EQ(recipe->compliances[1].scalar, ScalarType::float64);
}

TEST(Recipe, ReadsHowAComplianceIsStored) {
  const auto recipe = parse_recipe(full_recipe, "r.toml");
  ASSERT_TRUE(recipe.ok());
  const ComplianceRequest& fast = recipe->compliances[0];
  EXPECT_EQ(fast.tolerance, 0.05);
  EXPECT_EQ(fast.error_norm, "worst-column");
  ASSERT_TRUE(fast.nodes.has_value());
  EXPECT_EQ(std::get<SphereSelection>(*fast.nodes).radius_m, 0.02);
  EXPECT_EQ(fast.coarsening, 1);
  EXPECT_EQ(fast.way, "by-solves");
  EXPECT_EQ(recipe->compliances[1].tolerance, 0) << "a scalar type alone asks for the dense form";
  EXPECT_EQ(recipe->compliances[1].way, "auto");
  const auto plain = parse_recipe("[[compliance]]", "r.toml");
  ASSERT_TRUE(plain.ok());
  EXPECT_EQ(plain->compliances[0].tolerance, 1e-3);
  EXPECT_EQ(plain->compliances[0].error_norm, "scaled-spectral");
}

TEST(Recipe, RefusesStorageOutOfRangeOrInContradiction) {
  const auto entry = [](const std::string& keys) {
    return code_of("[surface]\nfile = \"a.obj\"\n[[compliance]]\n" + keys);
  };
  EXPECT_EQ(entry("tolerance = 0.5"), IssueCode{});
  EXPECT_EQ(entry("tolerance = 0"), IssueCode{});
  for (const char* wrong :
       {"tolerance = 0.51", "tolerance = -1e-3", "tolerance = nan", "tolerance = \"fine\"",
        "error_norm = \"max\"", "coarsening = 2", "coarsening = -1", "coarsening = 0.5",
        "way = \"magic\"", "nodes = {}", "nodes = { group = \"x\" }",
        "nodes = { nearest = {point=[0,0,0]}, sphere = {centre=[0,0,0], radius_m=1} }",
        "nodes = { sphere = {centre=[0,0,0], radius_m=-1} }"})
    EXPECT_EQ(entry(wrong), IssueCode::config_bad_value) << wrong;
  EXPECT_EQ(entry("tolerence = 1e-3"), IssueCode::config_unknown_key);
  EXPECT_EQ(entry("nodes = { sphere = {centre=[0,0,0], radius_m=1}, all = true }"),
            IssueCode::config_unknown_key);
  for (const char* contradiction :
       {"tolerance = 1e-3\nscalar = \"float32\"", "scalar = \"float32\"\nerror_norm = \"frobenius\"",
        "tolerance = 0\nerror_norm = \"frobenius\"", "tolerance = 0\nway = \"by-solves\"",
        "scalar = \"float64\"\nway = \"by-solves\""})
    EXPECT_EQ(entry(contradiction), IssueCode::usage_conflict) << contradiction;
}

TEST(Recipe, RefusesACoarseComplianceOfABodyOfOneLevel) {
  const std::string coarse = "[[compliance]]\ncoarsening = 1\n";
  const std::string surface = "[surface]\nfile = \"a.obj\"\n";
  EXPECT_EQ(code_of(surface + "[mesh]\nlevels = 1\n" + coarse), IssueCode::recipe_needs_coarser_level);
  EXPECT_EQ(code_of(surface + "[mesh]\nlevels = 2\n" + coarse), IssueCode{});
  EXPECT_EQ(code_of("[surface]\nfile = \"a.msh\"\n" + coarse), IssueCode::recipe_needs_coarser_level);
}

TEST(Recipe, RefusesTwoCompliancesThatScenesCouldNotTellApart) {
  const std::string surface =
      "[surface]\nfile = \"a.obj\"\n[[fixed]]\nname = \"f\"\nnearest = {point=[0,0,0], count=3}\n";
  const auto two = [&](const std::string& a, const std::string& b) {
    return code_of(surface + "[[compliance]]\nname = \"a\"\n" + a + "\n[[compliance]]\nname = \"b\"\n" +
                   b + "\n");
  };
  EXPECT_EQ(two("", ""), IssueCode::recipe_same_compliance);
  EXPECT_EQ(two("time_step_s = 0.01", ""), IssueCode::recipe_same_compliance);
  EXPECT_EQ(two("way = \"dense\"", ""), IssueCode::recipe_same_compliance);
  EXPECT_EQ(two("kind = \"static\"\nfixed = \"f\"", "kind = \"static\"\nfixed = \"f\""),
            IssueCode::recipe_same_compliance);
  for (const char* other : {"time_step_s = 0.02", "tolerance = 0.01", "fixed = \"f\"", "tolerance = 0",
                            "error_norm = \"frobenius\"", "coarsening = 1",
                            "nodes = { nearest = {point=[0,0,0], count=9} }"})
    EXPECT_EQ(two("", other), IssueCode{}) << other;
}

TEST(Recipe, AComplianceForBdf2IsThatOfTwoThirdsOfAnEulerStep) {
  const std::string surface = "[surface]\nfile = \"a.obj\"\n";
  const auto recipe =
      parse_recipe(surface + "[[compliance]]\nintegrator = \"bdf2\"\ntime_step_s = 0.015\n", "r.toml");
  ASSERT_TRUE(recipe.ok()) << format_issue(recipe.issue());
  EXPECT_EQ(recipe->compliances[0].time_step_s, 0.015);
  EXPECT_DOUBLE_EQ(euler_step(recipe->compliances[0]), 0.01);
  EXPECT_EQ(code_of(surface + "[[compliance]]\nname = \"a\"\nintegrator = \"bdf2\"\n"
                              "time_step_s = 0.015\n[[compliance]]\nname = \"b\"\n"),
            IssueCode::recipe_same_compliance)
      << "b is of 0.01 s";
  EXPECT_EQ(code_of(surface + "[[compliance]]\nintegrator = \"explicit_euler\""),
            IssueCode::config_bad_value);
  EXPECT_EQ(code_of(surface + "[[compliance]]\nkind = \"static\"\nintegrator = \"bdf2\""),
            IssueCode::usage_conflict);
}

TEST(Recipe, CompliancesThatWereStoredDenseAreBakedDenseAgain) {
  const auto old = parse_recipe(
      "[surface]\nfile = \"a.obj\"\n[[compliance]]\nname = \"x\"\nkind = \"dynamic\"\n"
      "time_step_s = 0.01\nscalar = \"float32\"\n",
      "an asset of format 1.1");
  ASSERT_TRUE(old.ok());
  EXPECT_EQ(old->compliances[0].tolerance, 0);
}

TEST(Recipe, EmptyTextIsTheDefaultsOfASoftOrgan) {
  const auto recipe = parse_recipe("", "r.toml");
  ASSERT_TRUE(recipe.ok());
  EXPECT_EQ(chosen_tets(*recipe), 10000);
  EXPECT_EQ(chosen_levels(*recipe), 2);
  EXPECT_EQ(recipe->material.young_pa, 1e4);
  EXPECT_EQ(recipe->material.poisson, 0.4);
  ASSERT_EQ(recipe->compliances.size(), 1u);
  EXPECT_EQ(recipe->compliances[0].time_step_s, 0.01);
  EXPECT_EQ(check_recipe(*recipe).issue().code, IssueCode::usage_missing_argument);
}

TEST(Recipe, CanonicalTextReadsBackAsItself) {
  const auto recipe = parse_recipe(full_recipe, "r.toml");
  ASSERT_TRUE(recipe.ok());
  const std::string text = canonical_recipe_text(*recipe);
  const auto again = parse_recipe(text, "again");
  ASSERT_TRUE(again.ok()) << format_issue(again.issue()) << text;
  EXPECT_EQ(canonical_recipe_text(*again), text);
  Recipe defaults;
  defaults.surface.file = "a \"quoted\" \\ name.obj";
  const auto read_back = parse_recipe(canonical_recipe_text(defaults), "defaults");
  ASSERT_TRUE(read_back.ok());
  EXPECT_EQ(read_back->surface.file, defaults.surface.file);
  EXPECT_EQ(canonical_recipe_text(*read_back), canonical_recipe_text(defaults));
}

TEST(Recipe, CanonicalTextLeavesOutTheFolderOfTheSurface) {
  Recipe one, two;
  one.surface.file = "/home/me/liver.obj";
  two.surface.file = "../liver.obj";
  EXPECT_EQ(canonical_recipe_text(one), canonical_recipe_text(two));
}

TEST(Recipe, RefusesWhatItDoesNotKnowOrCannotUse) {
  EXPECT_EQ(code_of("[mesh]\ntet = 5"), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of("[mseh]\ntets = 5"), IssueCode::config_unknown_key);
  EXPECT_EQ(code_of("[mesh]\ntets = 5.5"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[mesh]\ntets = -1"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[mesh]\ntets = 99999999999"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[mesh]\ntets = 1000\nedge_length_m = 0.1"), IssueCode::usage_conflict);
  EXPECT_EQ(code_of("[mesh]\nhierarchy = \"flat\""), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[surface]\nunit = \"furlong\""), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[surface]\nsize_m = -1.0"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[material]\nyoung_pa = 0"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[material]\nyoung_pa = nan"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[material]\npoisson = 0.5"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[material]\ndensity = -5"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[mesh]\ninterior_coarsening = 0.5"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[mesh]\nmesher = \"magic\""), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[compliance]]\ntime_step_s = 0"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[compliance]]\nkind = \"static\"\ntime_step_s = 0.1"), IssueCode::usage_conflict);
  EXPECT_EQ(code_of("[[compliance]]\nname = \"../x\""), IssueCode::config_bad_value);
}

TEST(Recipe, RefusesPartsOfTheBodyWithoutExactlyOneSelection) {
  EXPECT_EQ(code_of("[[material.region]]\nname = \"a\""), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[material.region]]\nname = \"a\"\nsurface = \"b.off\"\ngroup = \"c\""),
            IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[material.region]]\nsurface = \"b.off\""), IssueCode::config_missing_key);
  EXPECT_EQ(code_of("[[material.region]]\nname = \"a\"\nsurface = \"b.off\"\nyoung_pa = -1"),
            IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[mesh.refine]]\nsurface = \"b.off\"\ndistance_m = 0.1"),
            IssueCode::config_missing_key);
  EXPECT_EQ(code_of("[[mesh.refine]]\nedge_length_m = 0.1\nsurface = \"b.off\""),
            IssueCode::config_missing_key);
  EXPECT_EQ(code_of("[[mesh.refine]]\nedge_length_m = 0.1"), IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[mesh.refine]]\nedge_length_m = 0.1\nsphere = {centre=[0,0,0], radius_m=0}"),
            IssueCode::config_bad_value);
}

TEST(Recipe, TakesAGivenTetMeshAsItIsUnlessAskedToMeshItAnew) {
  const auto read = [](const std::string& mesh) {
    auto recipe = parse_recipe("[surface]\nfile = \"a.MSH\"\n[mesh]\n" + mesh, "r.toml");
    EXPECT_TRUE(recipe.ok());
    return recipe ? *recipe : Recipe{};
  };
  EXPECT_TRUE(keeps_given_tets(read("")));
  EXPECT_EQ(chosen_tets(read("")), 0);
  EXPECT_EQ(chosen_levels(read("")), 1);
  EXPECT_TRUE(check_recipe(read("")).ok());
  EXPECT_TRUE(check_recipe(read("levels = 3")).ok());
  EXPECT_FALSE(keeps_given_tets(read("tets = 4000")));
  EXPECT_EQ(chosen_tets(read("tets = 4000")), 4000);
  EXPECT_FALSE(keeps_given_tets(read("edge_length_m = 0.01")));
  for (const char* idle : {"mesher = \"lattice\"", "interior_coarsening = 2", "features = \"keep\"",
                           "hierarchy = \"embedded\"",
                           "[[mesh.refine]]\nedge_length_m = 0.1\nsphere = {centre=[0,0,0], "
                           "radius_m=1}"}) {
    const Status status = check_recipe(read(idle));
    ASSERT_FALSE(status.ok()) << idle;
    EXPECT_EQ(status.issue().code, IssueCode::usage_conflict) << idle;
  }
}

TEST(Recipe, KnowsGroupsOnlyOfAGivenTetMesh) {
  const std::string region = "[[material.region]]\nname = \"a\"\ngroup = \"bone\"";
  EXPECT_EQ(code_of("[surface]\nfile = \"a.vtu\"\n" + region), IssueCode{});
  EXPECT_EQ(code_of("[surface]\nfile = \"a.obj\"\n" + region), IssueCode::usage_conflict);
}

TEST(Recipe, RefusesFixedSetsWithoutExactlyOneSelection) {
  EXPECT_EQ(code_of("[[fixed]]\nname = \"a\""), IssueCode::config_bad_value);
  EXPECT_EQ(
      code_of(
          "[[fixed]]\nname = \"a\"\nnearest = {point=[0,0,0]}\nsphere = {centre=[0,0,0], radius_m=1}"),
      IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[fixed]]\nnearest = {point=[0,0,0]}"), IssueCode::config_missing_key);
  EXPECT_EQ(code_of("[[fixed]]\nname = \"a\"\nbox = {min=[1,0,0], max=[0,1,1]}"),
            IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[fixed]]\nname = \"a\"\nplane = {point=[0,0,0], normal=[0,0,0]}"),
            IssueCode::config_bad_value);
  EXPECT_EQ(code_of("[[fixed]]\nname = \"a\"\nbox = {min=[0,0,0], max=[1,1,1], top=3}"),
            IssueCode::config_unknown_key);
}

TEST(Recipe, RefusesWhatItsPartsDoNotAgreeOn) {
  const std::string surface = "[surface]\nfile = \"a.obj\"\n";
  EXPECT_EQ(code_of(surface), IssueCode{});
  EXPECT_EQ(code_of(surface + "[mesh]\nhierarchy = \"embedded\""), IssueCode{});
  EXPECT_EQ(code_of(surface + "[mesh]\ntets = 1"), IssueCode::recipe_too_few_tets);
  EXPECT_EQ(code_of(surface + "[mesh]\ntets = 1000\nmax_error_m = 0.01"), IssueCode::usage_conflict);
  EXPECT_EQ(code_of(surface + "[[material.region]]\nname = \"a\"\nsurface = \"b\"\n"
                              "[[material.region]]\nname = \"a\"\nsurface = \"c\""),
            IssueCode::config_bad_value);
  EXPECT_EQ(code_of(surface + "[mesh]\ntets = 500\nlevels = 3"), IssueCode::recipe_too_few_tets);
  EXPECT_EQ(code_of(surface + "[[compliance]]\nfixed = \"foot\""), IssueCode::config_bad_value);
  EXPECT_EQ(code_of(surface + "[[compliance]]\nkind = \"static\""), IssueCode::compliance_singular);
  EXPECT_EQ(code_of(surface + "[[compliance]]\n[[compliance]]\ntime_step_s = 0.02"),
            IssueCode::config_bad_value);
  EXPECT_EQ(code_of(surface + "[[fixed]]\nname=\"a\"\nnearest={point=[0,0,0]}\n"
                              "[[fixed]]\nname=\"a\"\nnearest={point=[0,0,0]}\n"),
            IssueCode::config_bad_value);
}

TEST(Recipe, RefusesMoreTextThanAnAssetHolds) {
  std::string text = "[surface]\nfile = \"a.obj\"\n";
  for (int i = 0; i < 256; ++i)
    text += "[[fixed]]\nname = \"a" + std::to_string(i) + std::string(55, 'x') +
            "\"\nbox = {min=[-1.2345678901234568e-06,-1.2345678901234568e-06,-1.2345678901234568e-06], "
            "max=[1.2345678901234568e-06,1.2345678901234568e-06,1.2345678901234568e-06]}\n";
  EXPECT_EQ(code_of(text), IssueCode::config_bad_value);
}

Status override_with(Recipe& recipe, const std::string& option, const std::string& text) {
  for (const RecipeParameter& parameter : recipe_parameters())
    if (parameter.option == option) {
      const std::vector<RecipeOverride> options{{&parameter, text}};
      return override_recipe(recipe, options);
    }
  return make_issue(IssueCode::usage_unknown_option, option);
}

TEST(RecipeOverride, WinsOverTheRecipe) {
  Recipe recipe;
  EXPECT_TRUE(override_with(recipe, "--edge-length-m", "0.02").ok());
  EXPECT_EQ(recipe.mesh.edge_length_m, 0.02);
  EXPECT_TRUE(override_with(recipe, "--tets", "777").ok());
  EXPECT_EQ(recipe.mesh.tets, 777);
  EXPECT_EQ(recipe.mesh.edge_length_m, 0);
  EXPECT_TRUE(override_with(recipe, "--unit", "mm").ok());
  EXPECT_EQ(recipe.surface.unit, "mm");
}

TEST(RecipeOverride, RefusesEveryTextThatIsNotANumberInRange) {
  Recipe recipe;
  for (const char* text : {"", "abc", "nan", "-1", "1e9", "10.5", "99999999999999999999", "1 000"})
    EXPECT_EQ(override_with(recipe, "--tets", text).issue().code, IssueCode::usage_bad_value) << text;
  for (const char* text : {"", "nan", "inf", "0", "-3", "1e400"})
    EXPECT_EQ(override_with(recipe, "--young-pa", text).issue().code, IssueCode::usage_bad_value)
        << text;
  EXPECT_EQ(override_with(recipe, "--unit", "furlong").issue().code, IssueCode::usage_bad_value);
  EXPECT_EQ(recipe.mesh.tets, Recipe{}.mesh.tets);
}

TEST(RecipeOverride, TimeStepNeedsExactlyOneDynamicCompliance) {
  Recipe recipe;
  ASSERT_TRUE(override_compliances(recipe, {.time_step_s = "0.005"}).ok());
  EXPECT_EQ(recipe.compliances[0].time_step_s, 0.005);
  for (const char* text : {"0", "-0.01", "nan", ""})
    EXPECT_EQ(override_compliances(recipe, {.time_step_s = text}).issue().code,
              IssueCode::usage_bad_value);
  recipe.compliances.emplace_back().name = "second";
  EXPECT_EQ(override_compliances(recipe, {.time_step_s = "0.01"}).issue().code,
            IssueCode::usage_conflict);
}

TEST(RecipeOverride, AToleranceCompressesAndAScalarTypeMakesDense) {
  Recipe recipe;
  ASSERT_TRUE(override_compliances(recipe, {.tolerance = "0.02"}).ok());
  EXPECT_EQ(recipe.compliances[0].tolerance, 0.02);
  ASSERT_TRUE(override_compliances(recipe, {.scalar = "float64"}).ok());
  EXPECT_EQ(recipe.compliances[0].scalar, ScalarType::float64);
  EXPECT_EQ(recipe.compliances[0].tolerance, 0);
  ASSERT_TRUE(override_compliances(recipe, {.tolerance = "0", .scalar = "float32"}).ok());
  for (const char* text : {"-0.1", "0.51", "nan", "1e-3x"})
    EXPECT_EQ(override_compliances(recipe, {.tolerance = text}).issue().code,
              IssueCode::usage_bad_value);
  EXPECT_EQ(override_compliances(recipe, {.scalar = "float16"}).issue().code,
            IssueCode::usage_bad_value);
  EXPECT_EQ(override_compliances(recipe, {.tolerance = "0.1", .scalar = "float32"}).issue().code,
            IssueCode::usage_conflict);
}

TEST(RecipeParameters, MirrorEveryKeyByAnOptionOfItsOwn) {
  const auto table = recipe_parameters();
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_TRUE(table[i].option.starts_with("--"));
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(table[i].option, table[j].option);
  }
}

}  // namespace
}  // namespace souple
