// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's unstructured grid (`*.vtu`) and its time collection (`*.pvd`), for ParaView, f3d and VTK.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "formats/core/mesh.hpp"
#include "formats/core/result.hpp"

namespace souple {

/// Values at the points of a mesh, one row after another.
struct VtuField {
  std::string name;
  int component_count = 1;
  std::vector<double> values;  ///< row-major: rows x component_count
};

/// Triangles come before tets in the order of cells.
struct VtuMesh {
  std::vector<Point> points;
  std::vector<Triangle> triangles;
  std::vector<Tet> tets;
  std::vector<VtuField> fields;
  std::vector<Index> tet_regions;  ///< cell data "region": of every tet, or empty; triangles get -1

  std::size_t cell_count() const { return triangles.size() + tets.size(); }
};

/// A field of three components from vectors.
VtuField vector_field(std::string name, std::span<const Point> rows);

/// Puts `part` behind `mesh`. A field that only one of them has is padded with zeros, regions with -1.
void append_mesh(VtuMesh& mesh, const VtuMesh& part);

/// The file as text: XML 1.0, float64 and int32 arrays as base64 with a 64-bit byte count in front,
/// little-endian; exact, and the same bytes for the same mesh.
/// Issue vtu_mesh_invalid: an index outside the points, or a field or regions of the wrong size.
Result<std::string> vtu_text(const VtuMesh& mesh);
Status write_vtu(const VtuMesh& mesh, const std::filesystem::path& file);

/// One file of a time series.
struct PvdEntry {
  double time_s = 0;
  int part = 0;
  std::string name;
  std::string file;  ///< relative to the .pvd
};

std::string pvd_text(std::span<const PvdEntry> entries);

/// & < > " ' and nothing else changed.
std::string xml_escaped(std::string_view text);

}  // namespace souple
