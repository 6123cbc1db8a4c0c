// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/tets/tet_pieces.hpp"

#include <algorithm>
#include <numeric>

namespace souple {
namespace {

struct Face {
  Triangle key;
  Index tet;
};

std::vector<Face> sorted_faces(const std::vector<Tet>& tets) {
  std::vector<Face> faces;
  faces.reserve(4 * tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (std::size_t k = 0; k < 4; ++k) {
      const Tet& tet = tets[t];
      Triangle key{tet[(k + 1) % 4], tet[(k + 2) % 4], tet[(k + 3) % 4]};
      std::ranges::sort(key);
      faces.push_back({key, static_cast<Index>(t)});
    }
  std::ranges::sort(faces, [](const Face& a, const Face& b) {
    return a.key != b.key ? a.key < b.key : a.tet < b.tet;
  });
  return faces;
}

/// The smallest member of its set stands for each tet.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  Index root(Index i) {
    while (at(i) != i) i = at(i) = at(at(i));
    return i;
  }
  void join(Index a, Index b) {
    const Index ra = root(a), rb = root(b);
    at(std::max(ra, rb)) = std::min(ra, rb);
  }

 private:
  Index& at(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parent_;
};

std::size_t corner_of(const std::vector<Tet>& tets, Index tet, Index node) {
  const auto t = static_cast<std::size_t>(tet);
  return 4 * t + static_cast<std::size_t>(std::ranges::find(tets[t], node) - tets[t].begin());
}

}  // namespace

TetPieces find_tet_pieces(const std::vector<Tet>& tets) {
  TetPieces pieces;
  Sets sets(tets.size());
  const std::vector<Face> faces = sorted_faces(tets);
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    for (; end < faces.size() && faces[end].key == faces[i].key; ++end)
      sets.join(faces[i].tet, faces[end].tet);
    pieces.crowded_face_count += end - i > 2;
    i = end;
  }
  for (std::size_t t = 0; t < tets.size(); ++t) {
    const auto root = static_cast<std::size_t>(sets.root(static_cast<Index>(t)));
    pieces.piece_of_tet.push_back(root == t ? static_cast<Index>(pieces.piece_count++)
                                            : pieces.piece_of_tet[root]);
  }
  return pieces;
}

std::vector<char> tets_of_smaller_touching_pieces(const std::vector<Point>& nodes,
                                                  const std::vector<Tet>& tets,
                                                  const TetPieces& pieces) {
  std::vector<double> volumes(pieces.piece_count, 0);
  std::vector<std::vector<std::size_t>> members(pieces.piece_count);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    const auto corner = [&](std::size_t k) { return nodes[static_cast<std::size_t>(tets[t][k])]; };
    const auto piece = static_cast<std::size_t>(pieces.piece_of_tet[t]);
    volumes[piece] += signed_volume6(corner(0), corner(1), corner(2), corner(3));
    members[piece].push_back(t);
  }
  std::vector<std::size_t> order(pieces.piece_count);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return volumes[a] > volumes[b]; });

  std::vector<char> taken(nodes.size(), 0), unwanted(tets.size(), 0);
  for (const std::size_t piece : order) {
    const bool touches = std::ranges::any_of(members[piece], [&](std::size_t t) {
      return std::ranges::any_of(tets[t],
                                 [&](Index i) { return taken[static_cast<std::size_t>(i)] != 0; });
    });
    for (const std::size_t t : members[piece]) {
      unwanted[t] = touches;
      if (!touches)
        for (const Index i : tets[t]) taken[static_cast<std::size_t>(i)] = 1;
    }
  }
  return unwanted;
}

std::size_t split_pinched_nodes(std::vector<Point>& nodes, std::vector<Tet>& tets) {
  Sets corners(4 * tets.size());
  const std::vector<Face> faces = sorted_faces(tets);
  for (std::size_t i = 1; i < faces.size(); ++i)
    if (faces[i].key == faces[i - 1].key)
      for (const Index node : faces[i].key)
        corners.join(static_cast<Index>(corner_of(tets, faces[i - 1].tet, node)),
                     static_cast<Index>(corner_of(tets, faces[i].tet, node)));
  const std::size_t count_before = nodes.size();
  std::vector<char> taken(nodes.size(), 0);
  std::vector<Index> node_of_corner(4 * tets.size());
  for (std::size_t c = 0; c < node_of_corner.size(); ++c) {
    const Index node = tets[c / 4][c % 4];
    const auto root = static_cast<std::size_t>(corners.root(static_cast<Index>(c)));
    if (root != c) {
      node_of_corner[c] = node_of_corner[root];
    } else if (taken[static_cast<std::size_t>(node)] == 0) {
      taken[static_cast<std::size_t>(node)] = 1;
      node_of_corner[c] = node;
    } else {
      node_of_corner[c] = static_cast<Index>(nodes.size());
      nodes.push_back(Point(nodes[static_cast<std::size_t>(node)]));
    }
  }
  for (std::size_t c = 0; c < node_of_corner.size(); ++c) tets[c / 4][c % 4] = node_of_corner[c];
  return nodes.size() - count_before;
}

}  // namespace souple
