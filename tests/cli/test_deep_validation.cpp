// SPDX-License-Identifier: GPL-3.0-or-later
// Assets that are whole and sound but lie about how exact they are.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "formats/read/asset_reader.hpp"
#include "formats/write/asset_writer.hpp"
#include "tests/cli/run_souple.hpp"
#include "tests/cli/schema_check.hpp"

namespace souple::test {
namespace {
namespace fs = std::filesystem;

class DeepValidation : public SoupleCommand {
 protected:
  /// The liver with one compliance after `change`; only a deep look can tell.
  RunResult validate_changed(const std::function<void(Asset&)>& change) const {
    auto reader = AssetReader::open(baked_liver());
    auto asset = reader ? read_asset(*reader) : Result<Asset>(reader.issue());
    EXPECT_TRUE(asset.ok());
    if (!asset) return {};
    change(*asset);
    const auto written = write_asset(*asset, path("a.souple"));
    EXPECT_TRUE(written.ok()) << format_issue(written.issue());
    EXPECT_EQ(run_souple({"validate", path("a.souple").string()}).exit_code, 0);
    return run_souple({"validate", "--deep", "--json", path("a.souple").string()});
  }
};

TEST_F(DeepValidation, ConfirmsWhatBakeWrote) {
  const auto result = validate_changed([](Asset&) {});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  const auto json = result.json();
  EXPECT_EQ(schema_violation(json, load_schema("validate")), "");
  ASSERT_EQ(json["deep"].size(), 2u);
  for (const auto& one : json["deep"]) {
    EXPECT_EQ(one["holds"], true);
    EXPECT_LT(one["reference_residual"], 1e-10);
    EXPECT_GT(one["least_curvature"], 0);
  }
}

TEST_F(DeepValidation, ReportsThatWithoutDeepNothingWasMeasured) {
  const auto json = run_souple({"validate", "--json", baked_liver().string()}).json();
  EXPECT_FALSE(json.contains("deep"));
}

TEST_F(DeepValidation, FindsAComplianceOfAnotherMaterial) {
  const auto result =
      validate_changed([](Asset& asset) { asset.material.regions[0].young_pa *= 1.05; });
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_EQ(result.json()["issues"][0]["code"], "S3305");
  EXPECT_EQ(result.json()["deep"][0]["holds"], false);
}

TEST_F(DeepValidation, FindsErrorsThatWereStatedTooSmall) {
  const auto result = validate_changed([](Asset& asset) {
    ComplianceHeader& header = asset.compliances[0].header;
    header.error.scaled_spectral /= 1000;
    header.error.worst_column /= 1000;
    header.error.frobenius /= 1000;
  });
  EXPECT_EQ(result.exit_code, 3) << result.out;
}

TEST_F(DeepValidation, FindsOneWrongBlock) {
  const auto result = validate_changed([](Asset& asset) {
    ComplianceVariant& variant = asset.compliances[0];
    if (variant.header.representation != ComplianceRepresentation::dense_tiled) {
      for (float& entry : variant.hierarchy.scale.front()) entry *= 1.1F;
      return;
    }
    // The coupling of the first node to the others becomes a tenth larger.
    for (std::int64_t row = 1; row < std::min<std::int64_t>(variant.header.tile_nodes, 20); ++row) {
      const auto stride = static_cast<std::size_t>(3 * variant.header.tile_nodes);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          for (const std::size_t at : {(static_cast<std::size_t>(3 * row) + i) * stride + j,
                                       j * stride + static_cast<std::size_t>(3 * row) + i}) {
            float value = 0;
            std::memcpy(&value, variant.payload.data() + 4 * at, 4);
            value *= 1.1F;
            std::memcpy(variant.payload.data() + 4 * at, &value, 4);
          }
    }
  });
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_EQ(result.json()["issues"][0]["code"], "S3305");
}

}  // namespace
}  // namespace souple::test
