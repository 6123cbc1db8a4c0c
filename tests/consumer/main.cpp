// SPDX-License-Identifier: MIT
// Opens an asset from its file and from memory, and prints what both hold. Usage: consumer ASSET
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "formats/core/issue.hpp"
#include "formats/read/asset_reader.hpp"
#include "runtime/load/load_soft_body.hpp"

namespace {

struct Counts {
  std::size_t levels = 0, nodes = 0, tets = 0, compliances = 0;
  bool operator==(const Counts&) const = default;
};

int refuse(const souple::Issue& issue) {
  std::fprintf(stderr, "%s\n", souple::format_issue(issue).c_str());
  return souple::exit_code(issue.code);
}

souple::Result<Counts> count_parts(souple::AssetReader& reader) {
  const std::size_t level_count = reader.level_count();
  auto level = reader.read_level(level_count - 1);
  if (!level) return level.issue();
  auto body = souple::load_soft_body(reader);
  if (!body) return body.issue();
  return Counts{level_count, level->mesh.nodes.size(), level->mesh.tets.size(),
                reader.compliance_names().size()};
}

std::vector<std::byte> bytes_of(const char* file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<char> text(std::istreambuf_iterator<char>(stream), {});
  std::vector<std::byte> bytes(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) bytes[i] = static_cast<std::byte>(text[i]);
  return bytes;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    std::fprintf(stderr, "usage: consumer ASSET\n");
    return 1;
  }
  auto from_file = souple::AssetReader::open(arguments[1]);
  if (!from_file) return refuse(from_file.issue());
  auto file_counts = count_parts(*from_file);
  if (!file_counts) return refuse(file_counts.issue());

  const std::vector<std::byte> bytes = bytes_of(arguments[1]);
  auto from_memory = souple::AssetReader::open_memory(bytes);
  if (!from_memory) return refuse(from_memory.issue());
  auto memory_counts = count_parts(*from_memory);
  if (!memory_counts) return refuse(memory_counts.issue());

  const Counts& counts = *file_counts;
  std::printf("levels %zu nodes %zu tets %zu compliances %zu\n", counts.levels, counts.nodes,
              counts.tets, counts.compliances);
  if (!(counts == *memory_counts) || counts.tets == 0) {
    std::fprintf(stderr, "the asset in memory differs from the one in the file, or is empty\n");
    return 4;
  }
  return 0;
}
