// SPDX-License-Identifier: GPL-3.0-or-later
// souple export ASSET -o FILE: tets, surfaces or a compliance of an asset for other programs.
#include <algorithm>
#include <array>
#include <optional>

#include "formats/read/asset_reader.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/cli/json_output.hpp"
#include "tools/commands/compliance_options.hpp"
#include "tools/commands/export_sofa.hpp"
#include "tools/exchange/atomic_file.hpp"
#include "tools/exchange/mesh_writer.hpp"
#include "tools/exchange/nearest_name.hpp"

namespace souple {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 5> tet_formats{"msh", "mesh", "vtu", "vtk", "node"};

constexpr std::string_view sofa_format = "sofa-comp", sofa_extension = "comp";

struct ExportOptions {
  std::string asset, output, format, level, variant;
  bool visual = false;
  EffortOptions effort;

  void add_to(CLI::App& app) {
    app.add_option("ASSET", asset, "the .souple file")->required();
    app.add_option(
        "-o,--output", output,
        "tets: " + tet_extensions() + "; surface: " + surface_extensions() + "; compliance: .comp");
    app.add_option(
        "--to", format,
        "format, by its extension, or sofa-comp (what SOFA's PrecomputedConstraintCorrection "
        "reads); without -o the file stands beside");
    app.add_option("--variant", variant, "sofa-comp: the compliance; without it the only dynamic one");
    app.add_option("--level", level, "level of the hierarchy, 0 the coarsest; without it the finest");
    app.add_flag("--visual", visual, "the surface stored for display instead of the boundary");
    effort.add_to(app);
  }
};

/// The file to write and, in lower case and without dot, its extension.
struct Target {
  fs::path file;
  std::string extension;
  bool is_volume = false;
};

std::string extension_of(const fs::path& file) {
  std::string text = file.extension().string();
  if (!text.empty()) text.erase(0, 1);
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// A compliance for SOFA was asked for, by name or by the file's extension.
Result<bool> wants_sofa(const ExportOptions& given) {
  const bool sofa = given.format == sofa_format ||
                    (given.format.empty() && extension_of(given.output) == sofa_extension);
  if (!sofa && !given.variant.empty())
    return make_issue(IssueCode::usage_conflict, "only sofa-comp writes a compliance", "--variant",
                      "Leave it out, or add --to sofa-comp.");
  if (sofa && (given.visual || !given.level.empty()))
    return make_issue(IssueCode::usage_conflict, "a compliance belongs to the finest level",
                      given.visual ? "--visual" : "--level", "Leave it out.");
  return sofa;
}

Result<Target> target_of(const ExportOptions& given) {
  if (given.output.empty() && given.format.empty())
    return make_issue(IssueCode::usage_missing_argument, "no file and no format were given", "-o, --to",
                      "Name a file, or a format with --to.");
  Target target{given.output, extension_of(given.output), false};
  if (given.output.empty()) target.file = fs::path(given.asset).replace_extension(given.format);
  if (given.output.empty()) target.extension = extension_of(target.file);
  if (!given.format.empty() && given.format != target.extension)
    return make_issue(IssueCode::usage_conflict,
                      "the file is called ." + target.extension + ", the format " + given.format,
                      "--to", "Leave one of them out.");
  target.is_volume = std::ranges::find(tet_formats, target.extension) != tet_formats.end();
  if (target.is_volume && given.visual)
    return make_issue(IssueCode::usage_conflict, "." + target.extension + " holds tets", "--visual",
                      "Take a surface format: " + surface_extensions() + ".");
  return target;
}

Result<std::size_t> level_of(const ExportOptions& given, std::size_t count) {
  if (given.level.empty()) return count - 1;
  if (given.visual)
    return make_issue(IssueCode::usage_conflict, "the surface for display belongs to no level",
                      "--level", "Leave it out.");
  const auto level = integer_option("--level", given.level, 0, static_cast<std::int64_t>(count) - 1);
  if (!level) return level.issue();
  return static_cast<std::size_t>(*level);
}

/// What was written, for the report.
struct Written {
  std::string what;
  std::size_t point_count = 0, element_count = 0;
};

Result<Written> write_volume(AssetReader& reader, std::size_t level, const fs::path& file) {
  const auto mesh = reader.read_level(level);
  if (!mesh) return mesh.issue();
  std::vector<Index> labels;
  if (level + 1 == reader.level_count()) {
    auto material = reader.read_material();
    if (!material) return material.issue();
    labels = std::move(material->tet_region);
  }
  if (auto status = write_tets(mesh->mesh, labels, file); !status) return status.issue();
  return Written{"tets", mesh->mesh.nodes.size(), mesh->mesh.tets.size()};
}

/// Without the points that no triangle uses.
TriangleMesh compact(const std::vector<Point>& points, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh{{}, triangles};
  const std::vector<Index> used = used_nodes(triangles);
  for (const Index i : used) mesh.vertices.push_back(points[static_cast<std::size_t>(i)]);
  for (Triangle& t : mesh.triangles)
    for (Index& i : t) i = static_cast<Index>(std::ranges::lower_bound(used, i) - used.begin());
  return mesh;
}

Result<Written> write_boundary(AssetReader& reader, std::size_t level, const fs::path& file) {
  const auto mesh = reader.read_level(level);
  if (!mesh) return mesh.issue();
  const TriangleMesh surface = compact(mesh->mesh.nodes, mesh->boundary);
  if (auto status = write_surface(surface, file); !status) return status.issue();
  return Written{"boundary", surface.vertices.size(), surface.triangles.size()};
}

Result<Written> write_visual(AssetReader& reader, const fs::path& file) {
  const auto visual = reader.read_visual();
  if (!visual) return visual.issue();
  if (auto status = write_surface(visual->surface, file); !status) return status.issue();
  return Written{"visual", visual->surface.vertices.size(), visual->surface.triangles.size()};
}

Result<ExitCode> print_report(const CommandLine& line, const Json& document, const std::string& text) {
  const Status printed = line.common().json    ? print_json(document)
                         : line.common().quiet ? Status{}
                                               : print_data(text);
  if (!printed) return printed.issue();
  return ExitCode::ok;
}

Result<ExitCode> run_sofa(const ExportOptions& given, const CommandLine& line) {
  auto reader = AssetReader::open(given.asset);
  if (!reader) return reader.issue();
  const auto effort = given.effort.stage();
  if (!effort) return effort.issue();
  Console console(line.common().verbosity());
  const auto written =
      export_sofa_comp(*reader, given.asset, given.output, given.variant, *effort, console);
  if (!written) return written.issue();
  Json document = schema_header("export");
  document["asset"] = given.asset;
  document["output"] = written->file.string();
  document["what"] = "compliance";
  document["level"] = reader->level_count() - 1;
  document["point_count"] = written->node_count;
  document["element_count"] = 3 * written->node_count;
  document["variant"] = written->variant;
  document["time_step_s"] = written->time_step_s;
  return print_report(line, document,
                      written->file.string() + ": compliance " + written->variant + ", " +
                          std::to_string(written->node_count) +
                          " nodes, in the order of the tets that export writes\n");
}

}  // namespace

Result<ExitCode> run_export(const Arguments& arguments) {
  ExportOptions given;
  CommandLine line("export",
                   "Tets, surfaces or a compliance of an asset for other programs, in SI units.");
  given.add_to(line.app());
  const auto parsed = line.parse(arguments);
  if (!parsed) return parsed.issue();
  if (*parsed == ParseOutcome::help_printed) return ExitCode::ok;
  const auto sofa = wants_sofa(given);
  if (!sofa) return sofa.issue();
  if (*sofa) return run_sofa(given, line);
  const auto target = target_of(given);
  if (!target) return target.issue();
  if (auto status = check_output_file(target->file); !status) return status.issue();
  auto reader = AssetReader::open(given.asset);
  if (!reader) return reader.issue();
  const auto level = level_of(given, reader->level_count());
  if (!level) return level.issue();
  const auto written = given.visual        ? write_visual(*reader, target->file)
                       : target->is_volume ? write_volume(*reader, *level, target->file)
                                           : write_boundary(*reader, *level, target->file);
  if (!written) return written.issue();
  Json document = schema_header("export");
  document["asset"] = given.asset;
  document["output"] = target->file.string();
  document["what"] = written->what;
  document["level"] = given.visual ? Json() : Json(*level);
  document["point_count"] = written->point_count;
  document["element_count"] = written->element_count;
  const std::string text = target->file.string() + ": " + written->what + ", " +
                           std::to_string(written->point_count) + " points, " +
                           std::to_string(written->element_count) +
                           (target->is_volume ? " tets\n" : " triangles\n");
  return print_report(line, document, text);
}

}  // namespace souple
