// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <span>

#include "formats/read/asset_reader.hpp"
#include "runtime/c_api/internal/buffers.hpp"
#include "runtime/c_api/internal/convert.hpp"
#include "runtime/c_api/internal/handles.hpp"
#include "runtime/load/load_soft_body.hpp"

namespace souple::c_api {
namespace {

const souple_load_options& default_options() {
  static const souple_load_options options = [] {
    souple_load_options made{};
    made.visual = 1;
    made.table_bytes = LoadOptions{}.table_bytes;
    return made;
  }();
  return options;
}

Result<LoadOptions> to_options(const souple_load_options* given) {
  LoadOptions options;
  options.visual = true;
  if (!given) return options;
  auto read = read_struct(given, default_options(), "options");
  if (!read) return read.issue();
  if (auto status = check_reserved(read->reserved); !status) return status.issue();
  constexpr std::uint64_t most_table_bytes = std::uint64_t{1} << 40;
  if (read->table_bytes > most_table_bytes)
    return invalid("tables of " + std::to_string(read->table_bytes) + " bytes", "table_bytes");
  options.no_compliances = read->no_compliances != 0;
  options.visual = read->visual != 0;
  options.multigrid = read->multigrid != 0;
  options.streaming = read->streaming != 0;
  options.table_bytes = std::size_t(read->table_bytes);
  if (auto status = check_array(read->compliances, read->compliance_count, "compliances"); !status)
    return status.issue();
  for (std::size_t k = 0; k < read->compliance_count; ++k) {
    auto name = to_text(read->compliances[k], "compliances");
    if (!name) return name.issue();
    options.compliances.push_back(std::move(*name));
  }
  if (read->streaming_failed)
    options.streaming_failed = [failed = read->streaming_failed,
                                user = read->streaming_user](const Issue& issue) {
      failed(user, static_cast<souple_status>(issue.code), issue.what.c_str());
    };
  return options;
}

Status open_from(Result<AssetReader> reader, const souple_load_options* given, souple_asset** asset) {
  if (!reader) return reader.issue();
  const auto options = to_options(given);
  if (!options) return options.issue();
  auto made = std::make_unique<souple_asset>();
  made->content_hash = reader->content_hash();
  made->format_major = reader->version_major();
  made->format_minor = reader->version_minor();
  made->level_count = reader->level_count();
  auto body = load_soft_body(std::move(*reader), *options);
  if (!body) return body.issue();
  made->body = std::move(*body);
  *asset = made.release();
  return {};
}

souple_asset_facts facts_of(const souple_asset& asset) {
  const SoftBodyAsset& body = *asset.body;
  souple_asset_facts facts{};
  facts.format_major = asset.format_major;
  facts.format_minor = asset.format_minor;
  facts.solver = static_cast<std::int32_t>(body.default_solver());
  facts.level_count = asset.level_count;
  facts.node_count = std::size_t(body.model().node_count());
  facts.tet_count = std::size_t(body.model().tet_count());
  facts.surface_node_count = body.surface().nodes().size();
  facts.surface_triangle_count = body.surface().triangles().size();
  if (const VisualSurface* visual = body.visual()) {
    facts.visual_vertex_count = visual->vertex_count();
    facts.visual_triangle_count = visual->triangles().size();
  }
  facts.fixed_set_count = body.fixed_sets().size();
  facts.compliance_count = body.compliances().size();
  facts.resident_bytes = body.resident_bytes();
  facts.longest_side_m = body.longest_side_m();
  facts.mass_kg = body.model().total_mass();
  return facts;
}

souple_triangle from_triangle(const Triangle& t) { return {{t[0], t[1], t[2]}}; }

}  // namespace
}  // namespace souple::c_api

using namespace souple;
using namespace souple::c_api;

extern "C" {

souple_status souple_load_options_init(souple_load_options* options, size_t struct_size) {
  return guarded([&] { return init_struct(options, struct_size, default_options(), "options"); });
}

souple_status souple_asset_open_file(const char* path, const souple_load_options* options,
                                     souple_asset** asset) {
  return guarded([&]() -> Status {
    if (auto status = need({{path, "path"}, {asset, "asset"}}); !status) return status;
    const auto text = to_text(path, "path");
    if (!text) return text.issue();
    return open_from(AssetReader::open(*text), options, asset);
  });
}

souple_status souple_asset_open_memory(const void* bytes, size_t size,
                                       const souple_load_options* options, souple_asset** asset) {
  return guarded([&]() -> Status {
    if (auto status = need({{bytes, "bytes"}, {asset, "asset"}}); !status) return status;
    const std::span<const std::byte> content(static_cast<const std::byte*>(bytes), size);
    return open_from(AssetReader::open_memory(content), options, asset);
  });
}

void souple_asset_release(souple_asset* asset) { delete asset; }

souple_status souple_asset_facts_init(souple_asset_facts* facts, size_t struct_size) {
  return guarded([&] { return init_struct(facts, struct_size, {}, "facts"); });
}

souple_status souple_asset_get_facts(const souple_asset* asset, souple_asset_facts* facts) {
  return guarded([&]() -> Status {
    if (auto status = need({{asset, "asset"}, {facts, "facts"}}); !status) return status;
    return write_struct(facts, facts_of(*asset), "facts");
  });
}

const char* souple_asset_content_hash(const souple_asset* asset) {
  return asset ? asset->content_hash.c_str() : nullptr;
}

const char* souple_asset_fixed_set_name(const souple_asset* asset, size_t index) {
  if (!asset || index >= asset->body->fixed_sets().size()) return nullptr;
  return asset->body->fixed_sets()[index].name.c_str();
}

souple_status souple_asset_fixed_set_nodes(const souple_asset* asset, const char* name, int32_t* nodes,
                                           size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{asset, "asset"}, {name, "name"}}); !status) return status;
    const auto text = to_text(name, "name");
    if (!text) return text.issue();
    const FixedSet* set = asset->body->find_fixed_set(*text);
    if (!set)
      return make_issue(IssueCode::fixed_set_invalid, "the asset has no fixed set \"" + *text + "\"",
                        "name");
    return fill(nodes, capacity, needed, set->nodes.size(),
                [&](std::size_t i) { return set->nodes[i]; });
  });
}

souple_status souple_compliance_facts_init(souple_compliance_facts* facts, size_t struct_size) {
  return guarded([&] { return init_struct(facts, struct_size, {}, "facts"); });
}

souple_status souple_asset_get_compliance(const souple_asset* asset, size_t index,
                                          souple_compliance_facts* facts) {
  return guarded([&]() -> Status {
    if (auto status = need({{asset, "asset"}, {facts, "facts"}}); !status) return status;
    const auto held = asset->body->compliances();
    if (index >= held.size())
      return invalid("the asset holds " + std::to_string(held.size()) + " compliances", "index");
    const ComplianceHeader& header = held[index].header;
    souple_compliance_facts made{};
    made.kind = static_cast<std::int32_t>(header.kind);
    made.name = header.name.c_str();
    made.fixed_set = header.fixed_set.c_str();
    made.time_step_s = header.time_step_s;
    made.node_count = held[index].nodes.size();
    return write_struct(facts, made, "facts");
  });
}

souple_status souple_asset_rest_positions(const souple_asset* asset, souple_vec3* positions_m,
                                          size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{asset, "asset"}}); !status) return status;
    const auto rest = asset->body->model().rest_positions();
    return fill(positions_m, capacity, needed, rest.size(),
                [&](std::size_t i) { return from_point(rest[i]); });
  });
}

souple_status souple_asset_surface_nodes(const souple_asset* asset, int32_t* nodes, size_t capacity,
                                         size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{asset, "asset"}}); !status) return status;
    const auto all = asset->body->surface().nodes();
    return fill(nodes, capacity, needed, all.size(), [&](std::size_t i) { return all[i]; });
  });
}

souple_status souple_asset_surface_triangles(const souple_asset* asset, souple_triangle* triangles,
                                             size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{asset, "asset"}}); !status) return status;
    const auto all = asset->body->surface().triangles();
    const auto nodes = asset->body->surface().nodes();
    return fill(triangles, capacity, needed, all.size(), [&](std::size_t i) {
      souple_triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k)
        triangle.corner[k] =
            static_cast<std::int32_t>(std::ranges::lower_bound(nodes, all[i][k]) - nodes.begin());
      return triangle;
    });
  });
}

souple_status souple_asset_visual_triangles(const souple_asset* asset, souple_triangle* triangles,
                                            size_t capacity, size_t* needed) {
  return guarded([&]() -> Status {
    if (auto status = need({{asset, "asset"}}); !status) return status;
    const VisualSurface* visual = asset->body->visual();
    if (!visual)
      return make_issue(IssueCode::asset_missing_part, "no surface to be shown was loaded", "asset");
    const auto all = visual->triangles();
    return fill(triangles, capacity, needed, all.size(),
                [&](std::size_t i) { return from_triangle(all[i]); });
  });
}

souple_status souple_rigid_mesh_create(const souple_vec3* vertices_m, size_t vertex_count,
                                       const souple_triangle* triangles, size_t triangle_count,
                                       souple_rigid_mesh** mesh) {
  return guarded([&]() -> Status {
    if (auto status = need({{vertices_m, "vertices_m"}, {triangles, "triangles"}, {mesh, "mesh"}});
        !status)
      return status;
    if (auto status = check_array(vertices_m, vertex_count, "vertex_count"); !status) return status;
    if (auto status = check_array(triangles, triangle_count, "triangle_count"); !status) return status;
    TriangleMesh surface;
    const auto vertices = as_points(vertices_m, vertex_count);
    surface.vertices.assign(vertices.begin(), vertices.end());
    surface.triangles.resize(triangle_count);
    for (std::size_t t = 0; t < triangle_count; ++t)
      std::ranges::copy(triangles[t].corner, surface.triangles[t].begin());
    auto made = RigidMesh::make(std::move(surface));
    if (!made) return made.issue();
    *mesh = new souple_rigid_mesh{std::make_shared<const RigidMesh>(std::move(*made))};
    return {};
  });
}

void souple_rigid_mesh_release(souple_rigid_mesh* mesh) { delete mesh; }

}  // extern "C"
