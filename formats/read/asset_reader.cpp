// SPDX-License-Identifier: MIT
#include "formats/read/asset_reader.hpp"

#include <exception>
#include <optional>
#include <utility>

#include "formats/core/limits.hpp"
#include "formats/read/internal/read_compliance.hpp"
#include "formats/read/internal/read_parts.hpp"
#include "formats/storage/device_driver.hpp"
#include "formats/storage/group_reader.hpp"
#include "formats/storage/hdf5_session.hpp"
#include "formats/storage/layout.hpp"
#include "formats/storage/superblock.hpp"

namespace souple {
namespace {

using storage::GroupReader;
using storage::Hdf5Session;

/// Lack of memory becomes an issue; nothing else below throws.
template <class Read>
auto guarded(const Read& read) -> decltype(read()) {
  try {
    const Hdf5Session session;
    return read();
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what());
  }
}

Result<GroupReader> open_path(const GroupReader& root, const std::vector<std::string>& path) {
  Result<GroupReader> group = root.group(path.front());
  for (std::size_t i = 1; i < path.size() && group; ++i) group = group->group(path[i]);
  return group;
}

/// Names of the children of a group that may be absent.
Result<std::vector<std::string>> part_names(const GroupReader& root, const char* name) {
  const Result<bool> found = root.has(name);
  if (!found) return found.issue();
  if (!*found) return std::vector<std::string>{};
  const Result<GroupReader> group = root.group(name);
  if (!group) return group.issue();
  return group->child_names(limits::parts);
}

/// Children of mesh/levels must be 0 … n - 1.
Result<std::size_t> count_levels(const GroupReader& root) {
  const Result<GroupReader> levels = open_path(root, {layout::mesh, layout::levels});
  if (!levels) return levels.issue();
  const Result<std::vector<std::string>> names = levels->child_names(limits::levels);
  if (!names) return names.issue();
  for (std::size_t l = 0; l < names->size(); ++l)
    if (const Result<bool> found = levels->has(std::to_string(l)); !found || !*found)
      return make_issue(IssueCode::asset_corrupt, "the levels are not numbered from 0",
                        levels->where());
  if (names->empty()) return make_issue(IssueCode::asset_missing_part, "no level", levels->where());
  return names->size();
}

/// What a group's datasets cost; those of the kinds this version does not know are left out.
Result<GroupCost> cost_of(const GroupReader& root, const std::vector<std::string>& path) {
  const Result<GroupReader> group = open_path(root, path);
  if (!group) return group.issue();
  GroupCost cost;
  for (const std::string& part : path) cost.path += (cost.path.empty() ? "" : "/") + part;
  const Result<std::vector<std::string>> names = group->child_names(limits::parts);
  if (!names) return names.issue();
  for (const std::string& name : *names) {
    const Result<storage::DatasetReader> dataset = group->dataset(name);
    if (!dataset) continue;
    cost.stored_bytes += dataset->stored_bytes();
    cost.raw_bytes += dataset->raw_bytes();
    if (path.front() != layout::compliance || name != layout::payload) continue;
    cost.payload_stored_bytes = dataset->stored_bytes();
    cost.payload_raw_bytes = dataset->raw_bytes();
    cost.payload_chunk_bytes = dataset->chunk_bytes();
  }
  return cost;
}

}  // namespace

namespace {

/// The payload that was read last.
struct OpenPayload {
  std::string name;
  storage::DatasetReader dataset;
};

}  // namespace

struct AssetReader::State {
  std::unique_ptr<storage::ByteDevice> device;
  std::string where;
  storage::Handle file;
  int version_major = 0;
  int version_minor = 0;
  std::string content_hash;
  std::size_t level_count = 0;
  bool has_multigrid = false;
  bool has_visual = false;
  std::vector<std::string> fixed_sets;
  std::vector<std::string> compliances;
  std::optional<OpenPayload> payload;

  State(std::unique_ptr<storage::ByteDevice> bytes, std::string name)
      : device(std::move(bytes)), where(std::move(name)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    const Hdf5Session session;
    payload.reset();
    file.close();
  }

  Result<GroupReader> root() { return GroupReader::root(file.get(), *device, where); }

  Result<GroupReader> open(const std::vector<std::string>& path) {
    const Result<GroupReader> top = root();
    return top ? open_path(*top, path) : Result<GroupReader>(top.issue());
  }

  Result<GroupReader> level(std::size_t l) {
    if (l >= level_count)
      return make_issue(IssueCode::asset_missing_part,
                        "level " + std::to_string(l) + " of " + std::to_string(level_count), where);
    return open({layout::mesh, layout::levels, std::to_string(l)});
  }

  Result<storage::MeshCounts> counts(std::size_t l) {
    const Result<GroupReader> group = level(l);
    return group ? storage::read_level_counts(*group) : Result<storage::MeshCounts>(group.issue());
  }
  Result<storage::MeshCounts> finest_counts() { return counts(level_count - 1); }

  /// Opens the part and hands it to `read` together with the sizes of the finest level.
  template <class Read>
  auto read_part(const std::vector<std::string>& path, const Read& read)
      -> decltype(read(std::declval<GroupReader&>(), std::declval<storage::MeshCounts&>())) {
    const Result<GroupReader> group = open(path);
    if (!group) return group.issue();
    const Result<storage::MeshCounts> finest = finest_counts();
    if (!finest) return finest.issue();
    return read(*group, *finest);
  }

  Status read_identity();
  Status read_contents();
  Result<storage::DatasetReader*> payload_of(const std::string& name);
};

/// Opened and its chunks looked at, unless it still is from the last time.
Result<storage::DatasetReader*> AssetReader::State::payload_of(const std::string& name) {
  if (payload && payload->name == name) return &payload->dataset;
  const Result<GroupReader> group = open({layout::compliance, name});
  if (!group) return group.issue();
  const Result<ComplianceHeader> header = storage::read_compliance_header(*group, name);
  if (!header) return header.issue();
  Result<storage::DatasetReader> dataset = storage::open_payload(*group, *header);
  if (!dataset) return dataset.issue();
  if (Status status = dataset->check_chunks(); !status) return status.issue();
  payload.emplace(OpenPayload{name, std::move(*dataset)});
  return &payload->dataset;
}

/// Format, version and hash: the attributes that decide whether to go on.
Status AssetReader::State::read_identity() {
  const Result<GroupReader> top = root();
  if (!top) return top.issue();
  const Result<std::string> format = top->text(layout::format);
  if (!format || *format != layout::format_name)
    return make_issue(IssueCode::asset_not_an_asset, "HDF5, but not of the format \"souple\"", where);
  const Result<std::int64_t> major = top->integer(layout::version_major);
  if (!major) return major.issue();
  const Result<std::int64_t> minor = top->integer(layout::version_minor);
  if (!minor) return minor.issue();
  if (*major < 1 || *minor < 0 || *major > 100000 || *minor > 100000)
    return make_issue(IssueCode::asset_corrupt, "the version is out of range", where);
  version_major = static_cast<int>(*major);
  version_minor = static_cast<int>(*minor);
  if (version_major != asset_version_major)
    return make_issue(IssueCode::unsupported_version,
                      "version " + std::to_string(version_major) + "." + std::to_string(version_minor) +
                          ", this program reads " + std::to_string(asset_version_major) + ".x",
                      where);
  const Result<std::string> hash = top->text(layout::content_hash);
  if (!hash) return hash.issue();
  content_hash = *hash;
  return {};
}

Status AssetReader::State::read_contents() {
  const Result<GroupReader> top = root();
  if (!top) return top.issue();
  const Result<std::size_t> count = count_levels(*top);
  if (!count) return count.issue();
  level_count = *count;
  const Result<bool> multigrid = top->has(layout::multigrid);
  if (!multigrid) return multigrid.issue();
  has_multigrid = *multigrid;
  const Result<GroupReader> mesh = top->group(layout::mesh);
  const Result<bool> visual = mesh ? mesh->has(layout::visual) : Result<bool>(mesh.issue());
  if (!visual) return visual.issue();
  has_visual = *visual;
  Result<std::vector<std::string>> sets = part_names(*top, layout::constraints);
  if (!sets) return sets.issue();
  fixed_sets = std::move(sets).value();
  Result<std::vector<std::string>> variants = part_names(*top, layout::compliance);
  if (!variants) return variants.issue();
  compliances = std::move(variants).value();
  return {};
}

AssetReader::AssetReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
AssetReader::AssetReader(AssetReader&&) noexcept = default;
AssetReader& AssetReader::operator=(AssetReader&&) noexcept = default;
AssetReader::~AssetReader() = default;

Result<AssetReader> AssetReader::open_device(std::unique_ptr<storage::ByteDevice> device,
                                             const std::string& where) {
  // The state closes its file under the lock, so it must not live inside of guarded().
  auto state = std::make_unique<State>(std::move(device), where);
  const Status opened = guarded([&]() -> Status {
    if (Status status = storage::check_superblock(*state->device, where); !status) return status;
    state->file = storage::open_device(*state->device);
    if (!state->file) return make_issue(IssueCode::asset_corrupt, "HDF5 cannot open the file", where);
    if (Status status = state->read_identity(); !status) return status;
    return state->read_contents();
  });
  if (!opened) return opened.issue();
  return AssetReader(std::move(state));
}

Result<AssetReader> AssetReader::open(const std::filesystem::path& file) {
  try {
    Result<std::unique_ptr<storage::ByteDevice>> device = storage::open_file_view(file);
    if (!device) return device.issue();
    return open_device(std::move(device).value(), file.string());
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what());
  }
}

Result<AssetReader> AssetReader::open_memory(std::span<const std::byte> bytes) {
  try {
    return open_device(storage::make_memory_view(bytes), "memory");
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what());
  }
}

int AssetReader::version_major() const { return state_->version_major; }
int AssetReader::version_minor() const { return state_->version_minor; }
const std::string& AssetReader::content_hash() const { return state_->content_hash; }
std::size_t AssetReader::level_count() const { return state_->level_count; }
bool AssetReader::has_multigrid() const { return state_->has_multigrid; }
bool AssetReader::has_visual() const { return state_->has_visual; }
const std::vector<std::string>& AssetReader::fixed_set_names() const { return state_->fixed_sets; }
const std::vector<std::string>& AssetReader::compliance_names() const { return state_->compliances; }
std::uint64_t AssetReader::bytes_read() const { return state_->device->bytes_read(); }

Result<Provenance> AssetReader::read_provenance() {
  return guarded([&]() -> Result<Provenance> {
    const Result<GroupReader> top = state_->root();
    if (!top) return top.issue();
    Provenance provenance;
    const std::pair<const char*, std::string*> places[] = {
        {layout::generator, &provenance.generator},
        {layout::recipe, &provenance.recipe},
        {layout::input_name, &provenance.input_name},
        {layout::input_hash, &provenance.input_hash}};
    for (const auto& [attribute, place] : places) {
      Result<std::string> text = top->text(attribute);
      if (!text) return text.issue();
      *place = std::move(text).value();
    }
    return provenance;
  });
}

Result<SolverKind> AssetReader::read_default_solver() {
  return guarded([&]() -> Result<SolverKind> {
    const Result<GroupReader> top = state_->root();
    if (!top) return top.issue();
    const Result<bool> is_there = top->has_attribute(layout::default_solver);
    if (!is_there) return is_there.issue();
    if (!*is_there) return SolverKind::automatic;
    const Result<std::string> name = top->text(layout::default_solver);
    if (!name) return name.issue();
    const auto kind = solver_of_name(*name);
    if (!kind || *kind == SolverKind::automatic)
      return make_issue(IssueCode::asset_corrupt, "there is no solver \"" + *name + "\"",
                        layout::default_solver);
    return *kind;
  });
}

Result<MeshLevel> AssetReader::read_level(std::size_t level) {
  return guarded([&]() -> Result<MeshLevel> {
    const Result<GroupReader> group = state_->level(level);
    if (!group) return group.issue();
    if (level == 0) return storage::read_level(*group, {});
    const Result<storage::MeshCounts> coarse = state_->counts(level - 1);
    if (!coarse) return coarse.issue();
    return storage::read_level(*group, *coarse);
  });
}

Result<MeshLevel> AssetReader::read_level_mesh(std::size_t level) {
  return guarded([&]() -> Result<MeshLevel> {
    const Result<GroupReader> group = state_->level(level);
    return group ? storage::read_level_mesh(*group) : Result<MeshLevel>(group.issue());
  });
}

Result<LevelSizes> AssetReader::read_level_sizes(std::size_t level) {
  return guarded([&]() -> Result<LevelSizes> {
    const Result<GroupReader> group = state_->level(level);
    if (!group) return group.issue();
    const Result<storage::MeshCounts> counts = storage::read_level_counts(*group);
    if (!counts) return counts.issue();
    const Result<storage::DatasetReader> boundary = group->dataset(layout::boundary);
    if (!boundary) return boundary.issue();
    LevelSizes sizes{counts->nodes, counts->tets, boundary->rows(), false, false, {}};
    if (level == 0) return sizes;
    const Result<storage::LevelTies> ties = storage::read_level_ties(*group);
    if (!ties) return ties.issue();
    sizes.has_parents = ties->parents;
    sizes.has_embedding = ties->embedding;
    sizes.rigid_motion_error = ties->rigid_motion_error;
    return sizes;
  });
}

Result<LevelTransition> AssetReader::read_transition(std::size_t level) {
  return guarded([&]() -> Result<LevelTransition> {
    if (level == 0 || level >= state_->level_count)
      return make_issue(IssueCode::asset_missing_part,
                        "nothing leads down from level " + std::to_string(level), state_->where);
    const Result<GroupReader> group = state_->open({layout::multigrid, std::to_string(level)});
    if (!group) return group.issue();
    const Result<storage::MeshCounts> fine = state_->counts(level);
    if (!fine) return fine.issue();
    const Result<storage::MeshCounts> coarse = state_->counts(level - 1);
    if (!coarse) return coarse.issue();
    return storage::read_transition(*group, *fine, *coarse);
  });
}

Result<VisualMesh> AssetReader::read_visual() {
  return guarded([&] {
    return state_->read_part({layout::mesh, layout::visual}, storage::read_visual);
  });
}

Result<VisualSizes> AssetReader::read_visual_sizes() {
  if (!state_->has_visual) return VisualSizes{};
  return guarded([&]() -> Result<VisualSizes> {
    const Result<GroupReader> group = state_->open({layout::mesh, layout::visual});
    if (!group) return group.issue();
    const Result<storage::DatasetReader> vertices = group->dataset(layout::vertices);
    if (!vertices) return vertices.issue();
    const Result<storage::DatasetReader> triangles = group->dataset(layout::triangles);
    if (!triangles) return triangles.issue();
    return VisualSizes{vertices->rows(), triangles->rows()};
  });
}

Result<Material> AssetReader::read_material() {
  return guarded([&] {
    return state_->read_part({layout::material}, [](const GroupReader& group, const auto& finest) {
      return storage::read_material(group, finest);
    });
  });
}

Result<FixedSet> AssetReader::read_fixed_set(const std::string& name) {
  return guarded([&] {
    return state_->read_part({layout::constraints, name},
                             [&](const GroupReader& group, const auto& finest) {
                               return storage::read_fixed_set(group, name, finest);
                             });
  });
}

Result<ComplianceHeader> AssetReader::read_compliance_header(const std::string& name) {
  return guarded([&]() -> Result<ComplianceHeader> {
    const Result<GroupReader> group = state_->open({layout::compliance, name});
    if (!group) return group.issue();
    return storage::read_compliance_header(*group, name);
  });
}

Result<ComplianceVariant> AssetReader::read_compliance(const std::string& name) {
  return guarded([&] {
    return state_->read_part({layout::compliance, name},
                             [&](const GroupReader& group, const auto& finest) {
                               return storage::read_compliance(group, name, finest);
                             });
  });
}

Result<ComplianceVariant> AssetReader::read_compliance_index(const std::string& name) {
  return guarded([&] {
    return state_->read_part({layout::compliance, name},
                             [&](const GroupReader& group, const auto& finest) {
                               return storage::read_compliance_index(group, name, finest);
                             });
  });
}

Result<GroupCost> AssetReader::read_compliance_cost(const std::string& name) {
  return guarded([&]() -> Result<GroupCost> {
    const Result<GroupReader> top = state_->root();
    return top ? cost_of(*top, {layout::compliance, name}) : Result<GroupCost>(top.issue());
  });
}

Result<ComplianceSummary> AssetReader::read_compliance_summary(const std::string& name) {
  return guarded([&]() -> Result<ComplianceSummary> {
    const Result<GroupReader> group = state_->open({layout::compliance, name});
    if (!group) return group.issue();
    return storage::read_compliance_summary(*group, name);
  });
}

Status AssetReader::read_payload(const std::string& name, std::uint64_t begin,
                                 std::span<std::byte> bytes) {
  return guarded([&]() -> Status {
    const Result<storage::DatasetReader*> payload = state_->payload_of(name);
    if (!payload) return payload.issue();
    return (*payload)->read_range(begin, bytes);
  });
}

Result<std::vector<GroupCost>> AssetReader::group_costs() {
  return guarded([&]() -> Result<std::vector<GroupCost>> {
    const Result<GroupReader> top = state_->root();
    if (!top) return top.issue();
    std::vector<std::vector<std::string>> paths;
    for (std::size_t l = 0; l < state_->level_count; ++l)
      paths.push_back({layout::mesh, layout::levels, std::to_string(l)});
    if (state_->has_visual) paths.push_back({layout::mesh, layout::visual});
    for (std::size_t l = 1; state_->has_multigrid && l < state_->level_count; ++l)
      paths.push_back({layout::multigrid, std::to_string(l)});
    const Result<bool> has_material = top->has(layout::material);
    if (has_material && *has_material) paths.push_back({layout::material});
    for (const std::string& name : state_->fixed_sets) paths.push_back({layout::constraints, name});
    for (const std::string& name : state_->compliances) paths.push_back({layout::compliance, name});
    std::vector<GroupCost> costs;
    for (const std::vector<std::string>& path : paths) {
      Result<GroupCost> cost = cost_of(*top, path);
      if (!cost) return cost.issue();
      costs.push_back(std::move(cost).value());
    }
    return costs;
  });
}

Result<Asset> read_asset(AssetReader& reader) {
  try {
    Asset asset;
    for (std::size_t l = 0; l < reader.level_count(); ++l) {
      Result<MeshLevel> level = reader.read_level(l);
      if (!level) return level.issue();
      asset.levels.push_back(std::move(level).value());
    }
    for (std::size_t l = 1; reader.has_multigrid() && l < reader.level_count(); ++l) {
      Result<LevelTransition> transition = reader.read_transition(l);
      if (!transition) return transition.issue();
      asset.multigrid.push_back(std::move(transition).value());
    }
    if (reader.has_visual()) {
      Result<VisualMesh> visual = reader.read_visual();
      if (!visual) return visual.issue();
      asset.visual = std::move(visual).value();
    }
    Result<Material> material = reader.read_material();
    if (!material) return material.issue();
    asset.material = std::move(material).value();
    for (const std::string& name : reader.fixed_set_names()) {
      Result<FixedSet> set = reader.read_fixed_set(name);
      if (!set) return set.issue();
      asset.fixed_sets.push_back(std::move(set).value());
    }
    for (const std::string& name : reader.compliance_names()) {
      Result<ComplianceVariant> variant = reader.read_compliance(name);
      if (!variant) return variant.issue();
      asset.compliances.push_back(std::move(variant).value());
    }
    Result<Provenance> provenance = reader.read_provenance();
    if (!provenance) return provenance.issue();
    asset.provenance = std::move(provenance).value();
    const Result<SolverKind> solver = reader.read_default_solver();
    if (!solver) return solver.issue();
    asset.default_solver = *solver;
    return asset;
  } catch (const std::exception& error) {
    return make_issue(IssueCode::io_out_of_memory, error.what());
  }
}

}  // namespace souple
