// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"
#include "tools/recipe/recipe.hpp"

namespace souple {

/// The finished stages of a bake, kept beside its output as `OUTPUT.partial`: an asset that lacks
/// compliances. What a stage depends on, the generator, the recipe and the bytes of its files, is
/// hashed into the provenance; only a bake of the same hash goes on from it.
class PartialBake {
 public:
  /// Reads the files of the recipe for their hash. Where that cannot be told (a glTF keeps its geometry
  /// in further files, a file is missing) nothing is kept or found.
  PartialBake(const std::filesystem::path& output, const Recipe& recipe, const std::string& generator,
              std::size_t memory_limit_bytes);

  const std::filesystem::path& file() const { return file_; }
  /// What was kept for this very bake, with `generator` in its provenance; an issue if nothing usable
  /// is there. Compliances found under another memory limit are left out: they may have come about in
  /// another way. Issues: io_file_missing, or those of validate_asset_file.
  Result<Asset> find() const;
  /// Issues: those of write_asset.
  Status keep(Asset& unfinished) const;
  void remove() const;

 private:
  std::filesystem::path file_;
  std::string generator_;
  std::string key_;     ///< empty: nothing is kept
  std::string limits_;  ///< what compliances depend on beyond the key
};

}  // namespace souple
