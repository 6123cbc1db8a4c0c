// SPDX-License-Identifier: MIT
// A small body made in code: a box of Kuhn-subdivided cubes, whose refinement is the box of twice as
// many, with a smooth symmetric compliance that nobody solved for.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"

namespace souple::test {

/// What ties a level to the coarser one.
enum class Ties { parents, embedding, both };

struct SampleOptions {
  int cells = 1;  ///< of the coarsest level, along every side
  int levels = 2;
  int regions = 2;
  bool fixed_bottom = true;    ///< a fixed set "bottom" and a second dynamic variant that holds it
  bool static_variant = true;  ///< float64, needs fixed_bottom
  std::int64_t tile_nodes = 8;
  /// With an embedding, the inner nodes of finer levels are moved off the middles of their parents.
  Ties ties = Ties::both;
  /// Variants "compressed" and, above one level, "coarse": hierarchical, the latter with a
  /// prolongation.
  bool hierarchical = true;
  bool multigrid = true;  ///< prolongations and product plans, above one level
  int visual_cells = 3;  ///< of the box whose surface is shown, 2 % larger than the body; 0: none
};

Asset make_sample_asset(const SampleOptions& options = {});

/// One level of the box: `cells` cubes along every side of 0.2 m.
TetMesh make_box(int cells);

bool same_content(const Asset& a, const Asset& b);

/// A folder of its own, removed with what is in it.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  const std::string& folder() const { return folder_; }
  std::size_t entry_count() const;

 private:
  std::string folder_;
};

std::vector<std::byte> read_bytes(const std::string& file);
void write_bytes(const std::string& file, std::span<const std::byte> bytes);

}  // namespace souple::test
