// SPDX-License-Identifier: MIT
#include "formats/read/content_hash.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace souple {
namespace {

/// Every item is preceded by its count, so that no two contents give the same stream.
class ContentHasher {
 public:
  ContentHasher() : state_(XXH3_createState()) {
    if (state_ == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }

  void add(std::uint64_t value) { XXH3_128bits_update(state_.get(), &value, sizeof value); }
  void add(double value) { XXH3_128bits_update(state_.get(), &value, sizeof value); }
  void add(std::string_view text) { add_bytes(text.data(), text.size(), text.size()); }
  template <class T>
  void add(const std::vector<T>& rows) {
    add_bytes(rows.data(), rows.size(), rows.size() * sizeof(T));
  }

  std::string hex() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    std::string text;
    for (const unsigned char byte : canonical.digest) {
      text += "0123456789abcdef"[byte >> 4];
      text += "0123456789abcdef"[byte & 15];
    }
    return text;
  }

 private:
  struct Release {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  void add_bytes(const void* bytes, std::size_t count, std::size_t byte_count) {
    add(static_cast<std::uint64_t>(count));
    if (byte_count > 0) XXH3_128bits_update(state_.get(), bytes, byte_count);
  }
  std::unique_ptr<XXH3_state_t, Release> state_;
};

void add_level(ContentHasher& hasher, const MeshLevel& level) {
  hasher.add(level.mesh.nodes);
  hasher.add(level.mesh.tets);
  hasher.add(level.boundary);
  hasher.add(level.parents);
}

void add_embedding(ContentHasher& hasher, const std::vector<Embedding>& rows) {
  // Field by field: the padding of a row has no value.
  hasher.add(static_cast<std::uint64_t>(rows.size()));
  for (const Embedding& row : rows) {
    hasher.add(static_cast<std::uint64_t>(row.tet));
    for (const double weight : row.weights) hasher.add(weight);
  }
}

/// What version 1.1 brought, each part under its name: content that has none of it keeps its hash.
void add_parts_of_1_1(ContentHasher& hasher, const Asset& asset) {
  const auto begin = [&](std::string_view part, std::size_t place) {
    hasher.add(part);
    hasher.add(static_cast<std::uint64_t>(place));
  };
  for (std::size_t l = 0; l < asset.levels.size(); ++l) {
    const MeshLevel& level = asset.levels[l];
    if (!level.embedding.empty()) {
      begin("embedding", l);
      add_embedding(hasher, level.embedding);
    }
    const RigidMotionError& error = level.rigid_motion_error;
    if (error.parents == -1 && error.embedding == -1) continue;
    begin("rigid_motion_error", l);
    hasher.add(error.parents);
    hasher.add(error.embedding);
  }
  if (asset.visual.surface.vertices.empty()) return;
  begin("visual", 0);
  hasher.add(asset.visual.surface.vertices);
  hasher.add(asset.visual.surface.triangles);
  add_embedding(hasher, asset.visual.embedding);
}

void add_hierarchy(ContentHasher& hasher, const HierarchicalIndex& index) {
  hasher.add(static_cast<std::uint64_t>(index.depth));
  hasher.add(index.order);
  hasher.add(index.scale);
  hasher.add(index.leaf_step);
  hasher.add(index.leaf_planes);
  hasher.add(index.rank);
  hasher.add(index.step);
  hasher.add(index.singular);
  hasher.add(index.planes);
  hasher.add(index.record_begin);
}

void add_prolongation(ContentHasher& hasher, const std::vector<RowProlongation>& prolongation) {
  // Field by field, as embeddings.
  hasher.add(static_cast<std::uint64_t>(prolongation.size()));
  for (const RowProlongation& row : prolongation) {
    for (const Index source : row.row) hasher.add(static_cast<std::uint64_t>(source));
    for (const double weight : row.weight) hasher.add(weight);
  }
}

/// The same for version 1.2.
void add_parts_of_1_2(ContentHasher& hasher, const std::vector<const ComplianceVariant*>& variants) {
  for (const ComplianceVariant* variant : variants) {
    const ComplianceHeader& header = variant->header;
    if (header.representation == ComplianceRepresentation::hierarchical) {
      hasher.add(std::string_view("hierarchy of " + header.name));
      hasher.add(header.shift);
      add_hierarchy(hasher, variant->hierarchy);
    }
    if (header.error_norm != ErrorNorm::scaled_spectral) {
      hasher.add(std::string_view("error norm of " + header.name));
      hasher.add(static_cast<std::uint64_t>(header.error_norm));
    }
    if (header.coarsening != 0) {
      hasher.add(std::string_view("coarsening of " + header.name));
      hasher.add(static_cast<std::uint64_t>(header.coarsening));
      add_prolongation(hasher, variant->prolongation);
    }
  }
}

/// The same for version 1.3.
void add_parts_of_1_3(ContentHasher& hasher, const Asset& asset) {
  for (std::size_t l = 0; l < asset.multigrid.size(); ++l) {
    const LevelTransition& transition = asset.multigrid[l];
    hasher.add(std::string_view("multigrid"));
    hasher.add(static_cast<std::uint64_t>(l + 1));
    hasher.add(transition.row_begin);
    hasher.add(transition.column);
    hasher.add(transition.weight);
    hasher.add(transition.pattern_begin);
    hasher.add(transition.pattern_column);
    hasher.add(transition.pieces);
    hasher.add(transition.slots);
    hasher.add(transition.targets);
  }
  if (asset.default_solver == SolverKind::automatic) return;
  hasher.add(std::string_view("default solver"));
  hasher.add(solver_name(asset.default_solver));
}

void add_material(ContentHasher& hasher, const Material& material) {
  hasher.add(static_cast<std::uint64_t>(material.regions.size()));
  for (const MaterialRegion& region : material.regions) {
    hasher.add(std::string_view(region.name));
    for (const double value : {region.young_pa, region.poisson, region.density_kg_m3})
      hasher.add(value);
  }
  hasher.add(material.tet_region);
  hasher.add(material.rayleigh_mass_per_s);
  hasher.add(material.rayleigh_stiffness_s);
}

void add_header(ContentHasher& hasher, const ComplianceHeader& header) {
  hasher.add(std::string_view(header.name));
  hasher.add(static_cast<std::uint64_t>(header.kind));
  hasher.add(std::string_view(header.fixed_set));
  for (const double value :
       {header.time_step_s, header.mass_factor, header.stiffness_factor, header.tolerance_asked,
        header.error.solve_residual, header.error.scaled_spectral, header.error.frobenius,
        header.error.worst_column})
    hasher.add(value);
  hasher.add(static_cast<std::uint64_t>(header.representation));
  hasher.add(static_cast<std::uint64_t>(header.scalar));
  for (const std::int64_t value :
       {header.node_count, header.tile_nodes, header.block_count, header.block_scalars})
    hasher.add(static_cast<std::uint64_t>(value));
}

template <class Part, class Name>
std::vector<const Part*> by_name(const std::vector<Part>& parts, const Name& name) {
  std::vector<const Part*> sorted;
  for (const Part& part : parts) sorted.push_back(&part);
  std::ranges::stable_sort(sorted, {}, [&](const Part* part) { return std::string_view(name(*part)); });
  return sorted;
}

}  // namespace

std::string content_hash(const Asset& asset) {
  ContentHasher hasher;
  hasher.add(static_cast<std::uint64_t>(asset.levels.size()));
  for (const MeshLevel& level : asset.levels) add_level(hasher, level);
  add_material(hasher, asset.material);
  hasher.add(static_cast<std::uint64_t>(asset.fixed_sets.size()));
  for (const FixedSet* set :
       by_name(asset.fixed_sets, [](const auto& s) -> const std::string& { return s.name; })) {
    hasher.add(std::string_view(set->name));
    hasher.add(set->nodes);
  }
  hasher.add(static_cast<std::uint64_t>(asset.compliances.size()));
  const auto variants =
      by_name(asset.compliances, [](const auto& v) -> const std::string& { return v.header.name; });
  for (const ComplianceVariant* variant : variants) {
    add_header(hasher, variant->header);
    hasher.add(variant->nodes);
    hasher.add(variant->payload);
  }
  add_parts_of_1_1(hasher, asset);
  add_parts_of_1_2(hasher, variants);
  add_parts_of_1_3(hasher, asset);
  return hasher.hex();
}

}  // namespace souple
