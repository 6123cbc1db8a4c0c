// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/recipe/partial_bake.hpp"

#include <algorithm>
#include <cctype>
#include <system_error>
#include <vector>

#include "formats/read/asset_reader.hpp"
#include "formats/read/validate.hpp"
#include "formats/write/asset_writer.hpp"
#include "tools/process/regular_file.hpp"

namespace souple {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t largest_input = std::size_t{16} << 30;
constexpr std::string_view mark = ", unfinished bake ";

std::string lower_extension(const fs::path& file) {
  std::string text = file.extension().string();
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Every file that the body is made of; none if they cannot all be named.
std::vector<fs::path> input_files(const Recipe& recipe) {
  std::vector<fs::path> files{recipe.surface.file};
  const auto add_part = [&](const auto& request) {
    if (const auto* part = std::get_if<FileSelection>(&request.where)) files.push_back(part->file);
  };
  std::ranges::for_each(recipe.refine, add_part);
  std::ranges::for_each(recipe.regions, add_part);
  const std::string extension = lower_extension(recipe.surface.file);
  // TetGen writes a mesh into two files.
  if (extension == ".node") files.push_back(fs::path(recipe.surface.file).replace_extension(".ele"));
  if (extension == ".ele") files.push_back(fs::path(recipe.surface.file).replace_extension(".node"));
  if (std::ranges::any_of(files, [](const auto& f) { return lower_extension(f) == ".gltf"; }))
    return {};
  return files;
}

std::string key_of(const Recipe& recipe, const std::string& generator) {
  const auto files = input_files(recipe);
  if (files.empty()) return {};
  std::string text = generator + "\n" + canonical_recipe_text(recipe);
  for (const fs::path& file : files) {
    const auto bytes = read_regular_file(file, largest_input);
    if (!bytes) return {};
    text += "\n" + lower_extension(file) + " " + hash_text(*bytes);
  }
  return hash_text(text);
}

Issue not_found(const fs::path& file) {
  return make_issue(IssueCode::io_file_missing, "no finished stages of this bake are kept",
                    file.string());
}

}  // namespace

PartialBake::PartialBake(const fs::path& output, const Recipe& recipe, const std::string& generator,
                         std::size_t memory_limit_bytes)
    : file_(output.string() + ".partial"),
      generator_(generator),
      key_(key_of(recipe, generator)),
      limits_(" within " + std::to_string(memory_limit_bytes) + " bytes") {}

Result<Asset> PartialBake::find() const {
  std::error_code error;
  if (key_.empty() || !fs::is_regular_file(file_, error)) return not_found(file_);
  auto reader = AssetReader::open(file_);
  if (!reader) return reader.issue();
  const auto provenance = reader->read_provenance();
  if (!provenance) return provenance.issue();
  const std::string wanted = generator_ + std::string(mark) + key_;
  if (!provenance->generator.starts_with(wanted)) return not_found(file_);
  const ValidationReport report = validate_asset_file(file_);
  const auto error_found = std::ranges::find(report.issues, Severity::error, &Issue::severity);
  if (error_found != report.issues.end()) return *error_found;
  auto asset = read_asset(*reader);
  if (!asset) return asset;
  if (provenance->generator != wanted + limits_) asset->compliances.clear();
  asset->provenance.generator = generator_;
  return asset;
}

Status PartialBake::keep(Asset& asset) const {
  if (key_.empty()) return {};
  // The asset may be large: its provenance is changed for the time of writing instead of copying it.
  asset.provenance.generator = generator_ + std::string(mark) + key_ + limits_;
  const Status written = write_asset(asset, file_);
  asset.provenance.generator = generator_;
  return written;
}

void PartialBake::remove() const {
  std::error_code error;
  if (!key_.empty()) fs::remove(file_, error);
}

}  // namespace souple
