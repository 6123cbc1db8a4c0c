// SPDX-License-Identifier: GPL-3.0-or-later
// What the exact method pays at every step: the factor of the tangent, and the compliance of the
// contact nodes from it, by one solve a column and in Gram form; side by side. In full double
// precision, on one core.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "tests/bench/bench_data.hpp"
#include "tests/bench/row.hpp"
#include "tools/exchange/tet_file.hpp"
#include "tools/surface/import_surface.hpp"
#include "tools/surface/prepare.hpp"
#include "tools/volume/tetrahedralize.hpp"

namespace souple::bench {
namespace {

constexpr double longest_side_m = 0.2;
constexpr double mass_factor = 1e4 + 10, stiffness_factor = 2;  // h 0.01 s, alpha 0.1, beta 0.01
constexpr int runs = 15;

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

template <class Work>
double cpu_seconds_of(Work&& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

TetMesh file_mesh(const char* file) {
  ImportTetsOptions options;
  options.size_m = longest_side_m;
  options.mend = true;
  return value_or_exit(import_tets(data_folder() / "tets" / file, options)).mesh;
}

TetMesh liver_mesh(std::size_t tets) {
  ImportOptions import;
  import.size_m = longest_side_m;
  const auto surface =
      value_or_exit(import_surface(data_folder() / "surfaces" / "liver-smooth.obj", import));
  TetrahedralizeOptions options;
  options.target_tet_count = tets;
  return value_or_exit(tetrahedralize(value_or_exit(orient_closed_surface(surface.mesh)).mesh, options))
      .mesh;
}

// Nodes of the boundary: the `count` nearest to the first one, or each as far as can be from all
// before it.
std::vector<Index> contact_nodes(const TetMesh& mesh, std::size_t count, bool spread) {
  std::vector<Index> nodes;
  for (const auto& triangle : boundary_triangles(mesh.tets))
    nodes.insert(nodes.end(), triangle.begin(), triangle.end());
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  count = std::min(count, nodes.size());
  const auto distance = [&](Index a, Index b) {
    return (as_vec3(mesh.nodes[std::size_t(a)]) - as_vec3(mesh.nodes[std::size_t(b)])).norm();
  };
  if (!spread) {
    const Index centre = nodes.front();
    std::ranges::sort(nodes, {}, [&](Index n) { return std::pair(distance(n, centre), n); });
    nodes.resize(count);
    std::ranges::sort(nodes);
    return nodes;
  }
  std::vector<Index> chosen;
  std::vector<double> nearest(nodes.size(), INFINITY);
  for (Index next = nodes.front(); chosen.size() < count;) {
    chosen.push_back(next);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      nearest[k] = std::min(nearest[k], distance(nodes[k], next));
    next = nodes[std::size_t(std::ranges::max_element(nearest) - nearest.begin())];
  }
  std::ranges::sort(chosen);
  return chosen;
}

// A free body with its tangent, factorised.
class Body {
 public:
  explicit Body(const TetMesh& mesh)
      : model_(std::move(*CorotationalModel::create(mesh, material()))), a_(model_.pattern()) {
    model_.assemble_rest(mass_factor, stiffness_factor, a_);
    std::vector<Index> nodes(mesh.nodes.size());
    std::iota(nodes.begin(), nodes.end(), Index{0});
    factor_.analyze(model_.pattern(), model_.rest_positions(), nodes);
    (void)factor_.factorize(a_);
  }

  void time_factor(const std::string& name) {
    std::vector<double> seconds;
    for (int run = 0; run < runs; ++run)
      seconds.push_back(cpu_seconds_of([&] { (void)factor_.factorize(a_); }));
    print_row("exact_compliance." + name + ".factor", "ms", seconds, {}, 1e3);
    factor_seconds_ = median(seconds);
  }

  void time_block(const std::string& name, const std::vector<Index>& nodes) {
    const std::size_t size = 3 * nodes.size();
    std::vector<double> by_columns(size * size), block(size * size), column_s, gram_s, ratio;
    InverseBlockWork work;
    factor_.inverse_block(nodes, block, work);  // grows its memory
    for (int run = 0; run < runs; ++run) {
      // The slow way three times only.
      if (run < 3) column_s.push_back(cpu_seconds_of([&] { solve_columns(nodes, by_columns); }));
      gram_s.push_back(cpu_seconds_of([&] { factor_.inverse_block(nodes, block, work); }));
    }
    double largest = 0, error = 0;
    for (std::size_t k = 0; k < block.size(); ++k) {
      largest = std::max(largest, std::abs(by_columns[k]));
      error = std::max(error, std::abs(by_columns[k] - block[k]));
    }
    ResultHash hash;
    hash.add(block);
    const std::string part = "exact_compliance." + name;
    print_row(part + ".nodes", "1", double(nodes.size()), hash);
    print_row(part + ".by_columns", "ms", column_s, hash, 1e3);
    print_row(part + ".gram", "ms", gram_s, hash, 1e3);
    print_row(part + ".speedup", "1", median(column_s) / median(gram_s), hash);
    print_row(part + ".difference", "1", error / largest, hash);
    print_row(part + ".with_factor", "ms", 1e3 * (factor_seconds_ + median(gram_s)), hash);
  }

 private:
  static Material material() {
    Material material;
    material.regions.push_back({"all", 1e4, 0.4, 1000});
    return material;
  }

  void solve_columns(const std::vector<Index>& nodes, std::vector<double>& block) {
    const std::size_t size = 3 * nodes.size();
    Eigen::VectorXd column(factor_.size()), work(factor_.size());
    for (std::size_t c = 0; c < size; ++c) {
      column.setZero();
      column[3 * nodes[c / 3] + Eigen::Index(c % 3)] = 1;
      factor_.solve(column, work);
      for (std::size_t r = 0; r < size; ++r)
        block[r * size + c] = column[3 * nodes[r / 3] + Eigen::Index(r % 3)];
    }
  }

  CorotationalModel model_;
  BlockMatrix a_;
  SparseFactor factor_;
  double factor_seconds_ = 0;
};

void measure(const std::string& name, const TetMesh& mesh, std::size_t contacts) {
  Body body(mesh);
  print_row("exact_compliance." + name + ".tets", "1", double(mesh.tets.size()), {});
  body.time_factor(name);
  body.time_block(name + ".region", contact_nodes(mesh, contacts, false));
  body.time_block(name + ".spread", contact_nodes(mesh, contacts, true));
  // Every contact on a triangle of its own: three nodes.
  body.time_block(name + ".faces", contact_nodes(mesh, 3 * contacts, false));
}

}  // namespace
}  // namespace souple::bench

int main() {
  using namespace souple::bench;
  measure("torus", file_mesh("torus_low_res.msh"), 35);
  measure("armadillo", file_mesh("Armadillo_Tetra_4406.vtu"), 152);
  measure("liver", liver_mesh(10000), 150);
  return 0;
}
