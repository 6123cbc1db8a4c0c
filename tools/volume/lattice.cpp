// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/volume/lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "tools/geometry/vector.hpp"
#include "tools/volume/lattice_stencils.hpp"

namespace souple {
namespace {

/// A node is moved onto a cut that is nearer to it than this part of the edge: the pair for which the
/// paper proves its best angle.
constexpr double warp_long = 0.24999, warp_short = 0.41189;
constexpr int root_steps = 8;
/// Empty cells around the body, so that no lattice node at the rim is inside.
constexpr double margin_cells = 1.01;

struct Cut {
  Point point{};
  bool live = true;  ///< no end of the edge was moved onto the surface
};

/// Nodes 0 … corner_count - 1 are the corners of the cubes, the rest their centres.
class Lattice {
 public:
  Lattice(const Implicit& inside, const Box& box, double spacing) : inside_(inside), h_(spacing) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double side = box.high[k] - box.low[k];
      cells_[k] = static_cast<std::int64_t>(std::ceil(side / h_ + 2 * margin_cells));
      low_[k] = (box.low[k] + box.high[k]) / 2 - h_ * static_cast<double>(cells_[k]) / 2;
    }
    corner_count_ = (cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1);
    const std::int64_t count = corner_count_ + cells_[0] * cells_[1] * cells_[2];
    points_.resize(static_cast<std::size_t>(count));
    values_.resize(points_.size());
  }

  TetMesh stuff() {
    evaluate();
    for_each_edge([&](std::int64_t a, std::int64_t b) { cut(a, b); });
    warp();
    StencilWriter writer;
    for_each_tet([&](const std::array<std::int64_t, 4>& nodes) { write(writer, nodes); });
    return writer.take();
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  std::int64_t corner(const Cell& c) const {
    return c[0] + (cells_[0] + 1) * (c[1] + (cells_[1] + 1) * c[2]);
  }
  std::int64_t centre(const Cell& c) const {
    return corner_count_ + c[0] + cells_[0] * (c[1] + cells_[1] * c[2]);
  }
  bool is_corner(std::int64_t node) const { return node < corner_count_; }
  bool is_long(std::int64_t a, std::int64_t b) const { return is_corner(a) == is_corner(b); }
  double value(std::int64_t node) const { return values_[static_cast<std::size_t>(node)]; }
  Point& point(std::int64_t node) { return points_[static_cast<std::size_t>(node)]; }

  template <class Use>
  static void for_each_cell(const Cell& count, const Use& use) {
    for (Cell c{0, 0, 0}; c[2] < count[2]; ++c[2])
      for (c[1] = 0; c[1] < count[1]; ++c[1])
        for (c[0] = 0; c[0] < count[0]; ++c[0]) use(c);
  }

  void evaluate() {
    const auto place = [&](const Cell& c, double shift) {
      Point p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = low_[k] + h_ * (static_cast<double>(c[k]) + shift);
      return p;
    };
    const auto set = [&](std::int64_t node, const Point& p) {
      point(node) = p;
      values_[static_cast<std::size_t>(node)] = inside_(p);
    };
    for_each_cell({cells_[0] + 1, cells_[1] + 1, cells_[2] + 1},
                  [&](const Cell& c) { set(corner(c), place(c, 0)); });
    for_each_cell(cells_, [&](const Cell& c) { set(centre(c), place(c, 0.5)); });
  }

  template <class Use>
  void for_each_edge(const Use& use) const {
    for_each_cell({cells_[0] + 1, cells_[1] + 1, cells_[2] + 1}, [&](const Cell& c) {
      for (std::size_t k = 0; k < 3; ++k) {
        Cell next = c;
        if (++next[k] <= cells_[k]) use(corner(c), corner(next));
      }
    });
    for_each_cell(cells_, [&](const Cell& c) {
      for (std::size_t k = 0; k < 3; ++k) {
        Cell next = c;
        if (++next[k] < cells_[k]) use(centre(c), centre(next));
      }
      for (int k = 0; k < 8; ++k)
        use(corner({c[0] + (k & 1), c[1] + (k >> 1 & 1), c[2] + (k >> 2 & 1)}), centre(c));
    });
  }

  /// Every edge between two centres, with each side of the square between their cubes, is a tet.
  template <class Use>
  void for_each_tet(const Use& use) const {
    for_each_cell(cells_, [&](const Cell& c) {
      for (std::size_t k = 0; k < 3; ++k) {
        Cell next = c;
        if (++next[k] >= cells_[k]) continue;
        const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
        std::array<std::int64_t, 4> square;
        for (std::size_t s = 0; s < 4; ++s) {
          Cell p = next;
          if (s == 1 || s == 2) ++p[u];
          if (s >= 2) ++p[v];
          square[s] = corner(p);
        }
        for (std::size_t s = 0; s < 4; ++s)
          use({centre(c), centre(next), square[s], square[(s + 1) % 4]});
      }
    });
  }

  std::uint64_t key(std::int64_t a, std::int64_t b) const {
    const auto low = static_cast<std::uint64_t>(std::min(a, b));
    const auto high = static_cast<std::uint64_t>(std::max(a, b));
    return low << 32 | high;
  }

  /// Bisection mixed with regula falsi: distances are not smooth across edges of the surface.
  void cut(std::int64_t a, std::int64_t b) {
    if ((value(a) < 0) == (value(b) < 0)) return;
    if (value(b) < 0) std::swap(a, b);
    Point in = point(a), out = point(b);
    double f_in = value(a), f_out = value(b);
    for (int step = 0; step < root_steps && f_out > 0; ++step) {
      const double secant = f_in / (f_in - f_out);
      const Point middle = add_scaled(in, step % 2 == 0 ? secant : 0.5, subtract(out, in));
      const double f = inside_(middle);
      (f < 0 ? in : out) = middle;
      (f < 0 ? f_in : f_out) = f;
    }
    const double part = f_out > f_in ? f_in / (f_in - f_out) : 0.5;
    cuts_.emplace(key(a, b), Cut{add_scaled(in, part, subtract(out, in)), true});
    cut_edges_.push_back({a, b});
  }

  void warp() {
    std::unordered_map<std::int64_t, std::vector<std::int64_t>> neighbours;
    std::vector<std::int64_t> nodes;
    for (const auto& [a, b] : cut_edges_) {
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
      nodes.insert(nodes.end(), {a, b});
    }
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const std::int64_t node : nodes) warp_node(node, neighbours[node]);
  }

  void warp_node(std::int64_t node, const std::vector<std::int64_t>& neighbours) {
    double nearest = HUGE_VAL;
    Point target{};
    for (const std::int64_t other : neighbours) {
      const Cut& c = cuts_.at(key(node, other));
      if (!c.live) continue;
      const double away = norm(subtract(c.point, point(node)));
      const double length = is_long(node, other) ? h_ : std::sqrt(0.75) * h_;
      if (away >= (is_long(node, other) ? warp_long : warp_short) * length || away >= nearest) continue;
      nearest = away;
      target = c.point;
    }
    if (nearest == HUGE_VAL) return;
    point(node) = target;
    values_[static_cast<std::size_t>(node)] = 0;
    moved_.insert({node, true});
    for (const std::int64_t other : neighbours) cuts_.at(key(node, other)).live = false;
  }

  /// Parity of the cube's index: of two nodes at the ends of a long edge, one is even.
  bool is_even(std::int64_t node) const {
    const bool at_corner = is_corner(node);
    const std::int64_t i = at_corner ? node : node - corner_count_;
    const std::int64_t nx = cells_[0] + (at_corner ? 1 : 0), ny = cells_[1] + (at_corner ? 1 : 0);
    return (i % nx + i / nx % ny + i / nx / ny) % 2 == 0;
  }

  void write(StencilWriter& writer, const std::array<std::int64_t, 4>& nodes) {
    std::array<StencilNode, 4> stencil;
    bool any_inside = false;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::int64_t n = nodes[k];
      const int sign = moved_.contains(n) ? 0 : value(n) < 0 ? 1 : -1;
      any_inside |= sign > 0;
      stencil[k] = {static_cast<std::uint64_t>(n), sign, is_even(n) ? 1 : 2, point(n)};
    }
    if (!any_inside) return;
    writer.write(stencil, [&](std::size_t a, std::size_t b) {
      const std::uint64_t edge = key(nodes[a], nodes[b]);
      return StencilNode{edge | std::uint64_t{1} << 63, 0, is_long(nodes[a], nodes[b]) ? 0 : 3,
                         cuts_.at(edge).point};
    });
  }

  const Implicit& inside_;
  double h_;
  Point low_{};
  Cell cells_{};
  std::int64_t corner_count_ = 0;
  std::vector<Point> points_;
  std::vector<double> values_;
  std::unordered_map<std::uint64_t, Cut> cuts_;
  std::vector<std::array<std::int64_t, 2>> cut_edges_;
  std::unordered_map<std::int64_t, bool> moved_;
};

}  // namespace

double lattice_node_count(const Box& box, double spacing) {
  double cells = 1;
  for (std::size_t k = 0; k < 3; ++k)
    cells *= std::ceil((box.high[k] - box.low[k]) / spacing + 2 * margin_cells) + 1;
  return 2 * cells;
}

TetMesh stuff_isosurface(const Implicit& inside, const Box& box, double spacing) {
  return Lattice(inside, box, spacing).stuff();
}

}  // namespace souple
