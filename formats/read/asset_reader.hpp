// SPDX-License-Identifier: MIT
// Reads `*.souple` assets. Every group opens on its own: what is not asked for is not read.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/core/asset.hpp"
#include "formats/core/result.hpp"

namespace souple {

namespace storage {
class ByteDevice;
}

/// What one group of the file costs.
struct GroupCost {
  std::string path;                ///< "mesh/levels/1", "compliance/default"
  std::uint64_t stored_bytes = 0;  ///< in the file, compressed
  std::uint64_t raw_bytes = 0;     ///< decoded
  /// Of a compliance: its payload's share of both, and the decoded size of the chunks that it is read
  /// in.
  std::uint64_t payload_stored_bytes = 0;
  std::uint64_t payload_raw_bytes = 0;
  std::uint64_t payload_chunk_bytes = 0;
};

/// What a variant is, without the numbers that its use needs.
struct ComplianceSummary {
  ComplianceHeader header;
  std::uint64_t surface_node_count = 0;    ///< finest-level nodes that it stands for
  std::int64_t depth = 0;                  ///< hierarchical only, as what follows
  std::vector<Index> rank;                 ///< [2^depth - 1] of HierarchicalIndex
  std::vector<std::int64_t> record_begin;  ///< [2^depth + 1]
};

struct LevelSizes {
  std::uint64_t node_count = 0;
  std::uint64_t tet_count = 0;
  std::uint64_t boundary_triangle_count = 0;
  bool has_parents = false;  ///< what ties the level to the coarser one; both false at level 0
  bool has_embedding = false;
  RigidMotionError rigid_motion_error;
};

struct VisualSizes {
  std::uint64_t vertex_count = 0;
  std::uint64_t triangle_count = 0;
};

/// An opened asset. Movable; closes the file when destroyed. Not for real-time threads; one thread at a
/// time (several readers in several threads share one lock inside). Names are listed in ascending
/// order. Every length, index, rank, type and value is checked before it is used or allocated for.
class AssetReader {
 public:
  /// Issues: io_file_missing, io_cannot_read, asset_not_an_asset, asset_corrupt, unsupported_version.
  static Result<AssetReader> open(const std::filesystem::path& file);
  /// As open, from the bytes of a file; `bytes` must outlive the reader.
  static Result<AssetReader> open_memory(std::span<const std::byte> bytes);

  AssetReader(AssetReader&&) noexcept;
  AssetReader& operator=(AssetReader&&) noexcept;
  ~AssetReader();

  int version_major() const;
  int version_minor() const;
  const std::string& content_hash() const;  ///< as stored: hex, over the logical content
  Result<Provenance> read_provenance();
  /// automatic if the asset does not say.
  Result<SolverKind> read_default_solver();

  std::size_t level_count() const;
  Result<MeshLevel> read_level(std::size_t level);
  /// The level without parents, embedding and errors: what a simulation needs, and no more is read.
  Result<MeshLevel> read_level_mesh(std::size_t level);
  Result<LevelSizes> read_level_sizes(std::size_t level);  ///< headers only, no bulk data
  bool has_multigrid() const;
  /// From level `level`, 1 and up, to the one below it. asset_missing_part without one.
  Result<LevelTransition> read_transition(std::size_t level);
  bool has_visual() const;
  Result<VisualMesh> read_visual();         ///< asset_missing_part without one
  Result<VisualSizes> read_visual_sizes();  ///< headers only; zeros without one
  Result<Material> read_material();
  const std::vector<std::string>& fixed_set_names() const;
  Result<FixedSet> read_fixed_set(const std::string& name);
  const std::vector<std::string>& compliance_names() const;
  Result<ComplianceHeader> read_compliance_header(const std::string& name);
  Result<ComplianceVariant> read_compliance(const std::string& name);
  /// All of a variant but its payload, which is not read: `payload` stays empty.
  Result<ComplianceVariant> read_compliance_index(const std::string& name);
  Result<GroupCost> read_compliance_cost(const std::string& name);  ///< headers only
  /// Headers and, of a hierarchical one, ranks and the places of its records.
  Result<ComplianceSummary> read_compliance_summary(const std::string& name);
  /// Bytes [begin, begin + bytes.size()) of a hierarchical payload (asset_corrupt for a dense one):
  /// reads the chunks they lie in and no others. The record of leaf l is [record_begin[l],
  /// record_begin[l + 1]). The variant that was read last stays open, so that many small reads cost
  /// their chunks alone.
  Status read_payload(const std::string& name, std::uint64_t begin, std::span<std::byte> bytes);

  Result<std::vector<GroupCost>> group_costs();  ///< headers only, no bulk data
  /// Bytes fetched from the file so far, metadata included, as counted below HDF5.
  std::uint64_t bytes_read() const;

 private:
  struct State;
  explicit AssetReader(std::unique_ptr<State> state);
  static Result<AssetReader> open_device(std::unique_ptr<storage::ByteDevice> device,
                                         const std::string& where);
  std::unique_ptr<State> state_;
};

/// Everything at once. Same issues as AssetReader; does not verify the content hash (validate does).
Result<Asset> read_asset(AssetReader& reader);

}  // namespace souple
