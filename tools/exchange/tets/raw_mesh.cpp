// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/raw_mesh.hpp"

namespace souple {

bool add_cell(RawMesh& mesh, const CellType& type, const std::vector<Index>& nodes) {
  switch (type.kind) {
    case CellKind::tet:
      mesh.tets.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
      if (type.node_count > 4) ++mesh.linearised_count;
      return true;
    case CellKind::quad:
      mesh.triangles.push_back({nodes[0], nodes[2], nodes[3]});
      [[fallthrough]];
    case CellKind::triangle:
      mesh.triangles.push_back({nodes[0], nodes[1], nodes[2]});
      return false;
    case CellKind::volume:
      ++mesh.volume_cell_count;
      return false;
    case CellKind::other:
      ++mesh.other_cell_count;
      return false;
  }
  return false;
}

}  // namespace souple
