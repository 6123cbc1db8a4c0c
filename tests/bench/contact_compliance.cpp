// SPDX-License-Identifier: GPL-3.0-or-later
// What one contact costs on a liver of about 10.5k nodes: C0 between 450 nodes (150 contacts of three
// nodes), the Delassus operator from it, and the correction of all nodes; and the interior's part of
// it.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "formats/write/asset_writer.hpp"
#include "runtime/compliance/contact_blocks.hpp"
#include "runtime/contact/contact.hpp"
#include "runtime/contact/delassus_operator.hpp"
#include "runtime/fem/sparse_factor.hpp"
#include "runtime/load/load_soft_body.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"

namespace {

using namespace souple;
using namespace souple::bench;

constexpr std::size_t contacts = 150, contact_nodes = 450;
constexpr int runs = 40;

// The rows nearest to the surface point `centre`, from the `first` nearest on, ascending.
std::vector<Index> patch(const SoftBodyAsset& body, const BodyCompliance& compliance, Index centre,
                         std::size_t first) {
  const auto rest = body.model().rest_positions();
  const Vec3 c = as_vec3(rest[std::size_t(compliance.nodes[std::size_t(centre)])]);
  std::vector<Index> rows(compliance.nodes.size());
  std::iota(rows.begin(), rows.end(), Index{0});
  std::ranges::sort(rows, {}, [&](Index row) {
    return std::pair((as_vec3(rest[std::size_t(compliance.nodes[std::size_t(row)])]) - c).norm(), row);
  });
  rows.erase(rows.begin(), rows.begin() + std::ptrdiff_t(first));
  rows.resize(contact_nodes);
  std::ranges::sort(rows);
  return rows;
}

struct BlockTimes {
  std::vector<double> cold, evicted, half, one_by_one;
};

// Pushes everything else out of the processor's caches.
void evict_caches(ResultHash& hash) {
  static std::vector<double> other(std::size_t{12} << 20);
  for (double& value : other) value += 1;
  hash.add(std::span<const double>(&other[0], 1));
}

// `other` shares half of its rows with `rows`.
BlockTimes time_blocks(const RestCompliance& rest, const std::vector<Index>& rows,
                       const std::vector<Index>& other, ContactBlocks& blocks, ResultHash& hash) {
  BlockTimes times;
  blocks.update(rest, rows);  // grows its memory
  for (int run = 0; run < runs; ++run) {
    blocks.clear();
    evict_caches(hash);
    times.evicted.push_back(seconds_of([&] { blocks.update(rest, rows); }));
    blocks.clear();
    times.cold.push_back(seconds_of([&] { blocks.update(rest, rows); }));
    times.half.push_back(seconds_of([&] { blocks.update(rest, other); }));
  }
  ComplianceWork work;
  std::vector<float> block(9);
  times.one_by_one = repeated_seconds(1, [&] {
    for (const Index& a : rows)
      for (const Index& b : rows)
        rest.gather_block(std::span(&a, 1), std::span(&b, 1), block.data(), 3, work);
  });
  hash.add(std::span(blocks.values(), blocks.count()));
  return times;
}

void time_delassus(const ContactBlocks& blocks, ResultHash& hash) {
  std::vector<Touch> touches;
  std::vector<Mat3> frames, rotations;
  for (std::size_t i = 0; i < contacts; ++i) {
    frames.push_back(contact_frame(Vec3(1, 0.3, double(i) / contacts).normalized()));
    for (std::size_t k = 0; k < 3; ++k) touches.push_back({Index(i), Index(3 * i + k), 1.0 / 3});
  }
  for (std::size_t k = 0; k < contact_nodes; ++k)
    rotations.push_back(Eigen::AngleAxisd(0.01 * double(k), Vec3(0, 0.6, 0.8)).toRotationMatrix());
  std::vector<double> delassus(9 * contacts * contacts);
  const DelassusTarget<double> w{delassus.data(), 3 * contacts};
  DelassusWork<float> work;
  const auto seconds = repeated_seconds(runs, [&] {
    std::ranges::fill(delassus, 0.0);
    add_to_delassus<float>({touches, frames, rotations},
                           {blocks.values(), blocks.stride(), blocks.slots()}, 1, w, work);
    mirror_delassus(contacts, w);
  });
  hash.add(delassus);
  print_row("contact.delassus", "ms", seconds, hash, 1e3);
}

// The correction of all nodes as a step does it, and how far the interior is from the exact one.
void time_correction(const SoftBodyAsset& body, const BodyCompliance& compliance,
                     const std::vector<Index>& rows, ResultHash& hash) {
  const CorotationalModel& model = body.model();
  const Eigen::Index size = 3 * Eigen::Index{model.node_count()};
  std::vector<double> force(3 * rows.size()), surface(3 * compliance.nodes.size());
  for (std::size_t k = 0; k < force.size(); ++k)
    force[k] = std::sin(double(k / 3)) * (k % 3 == 2) + 0.3;
  const std::vector<Mat3> rotations(std::size_t(model.node_count()),
                                    Mat3(Eigen::AngleAxisd(1, Vec3(0, 0.6, 0.8))));
  Eigen::VectorXd u = Eigen::VectorXd::Zero(size), motion = u;
  ComplianceWork work;
  std::vector<float> extension_work(compliance.extension.work_size());
  std::vector<double> surface_s, interior_s, turn_s, total_s;
  for (int run = 0; run < runs; ++run) {
    surface_s.push_back(seconds_of([&] { compliance.rest->apply(rows, force, surface, work); }));
    interior_s.push_back(seconds_of([&] {
      u.setZero();
      for (std::size_t row = 0; row < compliance.nodes.size(); ++row)
        node_entry(u, compliance.nodes[row]) = Eigen::Map<const Vec3>(surface.data() + 3 * row);
      compliance.extension.apply(u, extension_work);
    }));
    turn_s.push_back(seconds_of([&] {
      for (Index node = 0; node < model.node_count(); ++node)
        node_entry(motion, node).noalias() += rotations[std::size_t(node)] * node_entry(u, node);
    }));
    total_s.push_back(surface_s.back() + interior_s.back() + turn_s.back());
  }
  hash.add(std::span<const double>(motion.data(), std::size_t(size)));
  print_row("contact.correction", "ms", total_s, hash, 1e3);
  print_row("contact.correction.surface", "ms", surface_s, hash, 1e3);
  print_row("contact.correction.interior", "ms", interior_s, hash, 1e3);
  print_row("contact.correction.rotations", "ms", turn_s, hash, 1e3);

  // The same interior from a double precision factor: the way it was done before.
  BlockMatrix a0(model.pattern());
  model.assemble_rest(compliance.header.mass_factor, compliance.header.stiffness_factor, a0);
  std::vector<Index> inner;
  for (Index node = 0; node < model.node_count(); ++node)
    if (compliance.row_of_node[std::size_t(node)] < 0) inner.push_back(node);
  Eigen::VectorXd load(3 * Eigen::Index(inner.size())), scratch(load.size());
  for (std::size_t k = 0; k < inner.size(); ++k) {
    Vec3 sum = Vec3::Zero();
    for (Index b = model.pattern().row_begin[std::size_t(inner[k])];
         b < model.pattern().row_begin[std::size_t(inner[k]) + 1]; ++b) {
      const Index other = model.pattern().column[std::size_t(b)];
      if (compliance.row_of_node[std::size_t(other)] >= 0) sum -= a0.block(b) * node_entry(u, other);
    }
    load.segment<3>(3 * Eigen::Index(k)) = sum;
  }
  SparseFactor factor;
  factor.analyze(model.pattern(), model.rest_positions(), inner);
  if (!factor.factorize(a0)) return;
  const auto naive_s = repeated_seconds(3, [&] {
    Eigen::VectorXd x = load;
    factor.solve(x, scratch);
  });
  factor.solve(load, scratch);
  double largest = 0, error = 0;
  for (Index node = 0; node < model.node_count(); ++node)
    largest = std::max(largest, node_entry(u, node).norm());
  for (std::size_t k = 0; k < inner.size(); ++k)
    error = std::max(error, (load.segment<3>(3 * Eigen::Index(k)) - node_entry(u, inner[k])).norm());
  print_row("contact.correction.interior_double", "ms", naive_s, hash, 1e3);
  print_row("contact.interior_error", "1", error / largest, hash);
  // Of the error that the compliance of the surface is allowed.
  print_row("correction.interior.error", "1", error / largest / compliance.header.tolerance_asked,
            hash);
  print_row("contact.interior_bytes", "MB", double(compliance.extension.resident_bytes()) / 1e6, hash);
  print_row("contact.interior_double_bytes", "MB", double(factor.bytes()) / 1e6, hash);
}

std::vector<double> load_times(std::span<const std::byte> bytes, const LoadOptions& options,
                               std::shared_ptr<const SoftBodyAsset>& body) {
  return repeated_seconds(3, [&] {
    body = value_or_exit(load_soft_body(value_or_exit(AssetReader::open_memory(bytes)), options));
  });
}

}  // namespace

int main() {
  Recipe recipe = liver_recipe(56000, 1);
  recipe.compliances.front().tolerance = 1e-3;
  const auto bytes_of_file = value_or_exit(write_asset_memory(bake_or_exit(recipe).asset));
  std::shared_ptr<const SoftBodyAsset> liver, plain;
  const auto load_s = load_times(bytes_of_file, {}, liver),
             plain_load_s = load_times(bytes_of_file, {.table_bytes = 0}, plain);
  const BodyCompliance& compliance = liver->compliances()[0];
  const auto rows = patch(*liver, compliance, 100, 0);
  const auto other = patch(*liver, compliance, 100, contact_nodes / 2);
  ResultHash hash;
  ContactBlocks blocks;
  const BlockTimes times = time_blocks(*compliance.rest, rows, other, blocks, hash);
  ContactBlocks from_factors;
  const BlockTimes without_table =
      time_blocks(*plain->compliances()[0].rest, rows, other, from_factors, hash);
  print_row("contact.nodes", "1", double(liver->model().node_count()), hash);
  print_row("contact.surface_nodes", "1", double(compliance.rest->row_count()), hash);
  print_row("contact.c0_cold", "ms", times.cold, hash, 1e3);
  print_row("contact.c0_evicted", "ms", times.evicted, hash, 1e3);
  print_row("contact.c0_half", "ms", times.half, hash, 1e3);
  print_row("contact.c0_factors_cold", "ms", without_table.cold, hash, 1e3);
  print_row("contact.c0_factors_half", "ms", without_table.half, hash, 1e3);
  print_row("contact.c0_one_by_one", "ms", without_table.one_by_one, hash, 1e3);
  const std::size_t bytes = compliance.rest->resident_bytes(), table = compliance.rest->table_bytes();
  print_row("contact.c0_bytes", "MB", double(bytes - table) / 1e6, hash);
  print_row("contact.table_bytes", "MB", double(table) / 1e6, hash);
  print_row("contact.load", "s", load_s, hash);
  print_row("contact.load_without_table", "s", plain_load_s, hash);
  time_delassus(blocks, hash);
  std::vector<Index> loaded(rows.begin(), rows.begin() + std::ptrdiff_t(contacts));
  time_correction(*liver, compliance, loaded, hash);
  const auto create_s = repeated_seconds(2, [&] {
    (void)RestExtension::create(liver->model(), compliance.header.mass_factor,
                                compliance.header.stiffness_factor, compliance.nodes, {});
  });
  print_row("contact.interior_create", "s", create_s, hash);
  return 0;
}
