// SPDX-License-Identifier: MIT
#include "tests/support/dense_compliance.hpp"

#include <Eigen/Dense>
#include <cstring>

#include "runtime/compliance/dense_tiled_compliance.hpp"
#include "tests/support/box_mesh.hpp"

namespace souple::test {
namespace {

constexpr Index tile_nodes = 16;

Eigen::Matrix<double, 6, 12> strain_displacement(const TetMesh& mesh, const Tet& tet, double& volume) {
  Eigen::Matrix4d corners;
  for (int i = 0; i < 4; ++i) {
    corners(i, 0) = 1;
    for (int k = 0; k < 3; ++k)
      corners(i, k + 1) = mesh.nodes[std::size_t(tet[std::size_t(i)])][std::size_t(k)];
  }
  volume = corners.determinant() / 6;
  const Eigen::Matrix4d coefficients = corners.inverse();  // column i: 1, x, y, z coefficients of N_i
  Eigen::Matrix<double, 6, 12> b = Eigen::Matrix<double, 6, 12>::Zero();
  for (int i = 0; i < 4; ++i) {
    const double x = coefficients(1, i), y = coefficients(2, i), z = coefficients(3, i);
    b.block<3, 3>(0, 3 * i).diagonal() << x, y, z;
    b.row(3).segment<3>(3 * i) << y, x, 0;
    b.row(4).segment<3>(3 * i) << 0, z, y;
    b.row(5).segment<3>(3 * i) << z, 0, x;
  }
  return b;
}

ComplianceVariant to_variant(const Eigen::MatrixXd& full, const std::vector<Index>& nodes) {
  ComplianceVariant variant;
  variant.nodes = nodes;
  const TileLayout layout{Index(nodes.size()), tile_nodes};
  variant.header.scalar = ScalarType::float64;
  variant.header.node_count = layout.node_count;
  variant.header.tile_nodes = tile_nodes;
  variant.header.block_count = layout.block_count();
  variant.header.block_scalars = layout.block_scalars();
  std::vector<double> tiles(std::size_t(layout.block_count() * layout.block_scalars()), 0.0);
  for (std::int64_t i = 0; i < 3 * layout.node_count; ++i)
    for (std::int64_t j = 0; j < 3 * layout.node_count; ++j) {
      const std::int64_t stride = 3 * tile_nodes, ti = i / stride, tj = j / stride;
      if (tj > ti) continue;
      tiles[std::size_t(TileLayout::block_index(ti, tj) * layout.block_scalars() +
                        (i % stride) * stride + j % stride)] =
          full(3 * nodes[std::size_t(i / 3)] + i % 3, 3 * nodes[std::size_t(j / 3)] + j % 3);
    }
  variant.payload.resize(tiles.size() * sizeof(double));
  std::memcpy(variant.payload.data(), tiles.data(), variant.payload.size());
  return variant;
}

}  // namespace

Eigen::MatrixXd dense_stiffness(const TetMesh& mesh, double young_pa, double poisson,
                                const Eigen::Matrix3d& rotation) {
  Eigen::Matrix<double, 6, 6> d = Eigen::Matrix<double, 6, 6>::Zero();
  const double factor = young_pa / ((1 + poisson) * (1 - 2 * poisson));
  d.topLeftCorner<3, 3>().setConstant(factor * poisson);
  d.topLeftCorner<3, 3>().diagonal().setConstant(factor * (1 - poisson));
  d.bottomRightCorner<3, 3>().diagonal().setConstant(factor * (0.5 - poisson));
  const auto size = 3 * Eigen::Index(mesh.nodes.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(size, size);
  for (const Tet& tet : mesh.tets) {
    double volume = 0;
    const auto b = strain_displacement(mesh, tet, volume);
    const Eigen::Matrix<double, 12, 12> element = volume * b.transpose() * d * b;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        k.block<3, 3>(3 * tet[std::size_t(i)], 3 * tet[std::size_t(j)]) +=
            rotation * element.block<3, 3>(3 * i, 3 * j) * rotation.transpose();
  }
  return k;
}

Eigen::VectorXd lumped_masses(const TetMesh& mesh, double density) {
  Eigen::VectorXd masses = Eigen::VectorXd::Zero(Eigen::Index(mesh.nodes.size()));
  for (const Tet& tet : mesh.tets) {
    double volume = 0;
    strain_displacement(mesh, tet, volume);
    for (const Index node : tet) masses[node] += volume * density / 4;
  }
  return masses;
}

Eigen::MatrixXd dense_compliance(const TetMesh& mesh, const Material& material, double mass_factor,
                                 double stiffness_factor, const std::vector<Index>& fixed) {
  const auto& region = material.regions[0];
  Eigen::MatrixXd a = stiffness_factor * dense_stiffness(mesh, region.young_pa, region.poisson);
  const Eigen::VectorXd masses = lumped_masses(mesh, region.density_kg_m3);
  for (Eigen::Index i = 0; i < a.rows(); ++i) a(i, i) += mass_factor * masses[i / 3];
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    if (std::find(fixed.begin(), fixed.end(), Index(i / 3)) == fixed.end()) free.push_back(i);
  const Eigen::MatrixXd part = a(free, free);
  const Eigen::MatrixXd inverse = part.llt().solve(Eigen::MatrixXd::Identity(part.rows(), part.cols()));
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(a.rows(), a.cols());
  c(free, free) = inverse;
  return c;
}

Asset make_asset(TetMesh mesh, const Material& material, double time_step_s,
                 std::vector<FixedSet> fixed_sets, const std::string& fixed_set) {
  Asset asset;
  asset.levels.push_back(level_of(std::move(mesh)));
  asset.material = material;
  std::vector<Index> fixed;
  for (const auto& set : fixed_sets)
    if (set.name == fixed_set) fixed = set.nodes;
  asset.fixed_sets = std::move(fixed_sets);
  const double mass_factor =
      1 / (time_step_s * time_step_s) + material.rayleigh_mass_per_s / time_step_s;
  const double stiffness_factor = 1 + material.rayleigh_stiffness_s / time_step_s;
  const auto full =
      dense_compliance(asset.levels[0].mesh, material, mass_factor, stiffness_factor, fixed);
  std::vector<Index> nodes = used_nodes(asset.levels[0].boundary);
  std::erase_if(nodes,
                [&](Index n) { return std::find(fixed.begin(), fixed.end(), n) != fixed.end(); });
  ComplianceVariant variant = to_variant(full, nodes);
  variant.header.name = "test";
  variant.header.time_step_s = time_step_s;
  variant.header.fixed_set = fixed_set;
  variant.header.mass_factor = mass_factor;
  variant.header.stiffness_factor = stiffness_factor;
  asset.compliances.push_back(std::move(variant));
  return asset;
}

SoftBodyContent make_content(TetMesh mesh, const Material& material, double time_step_s,
                             std::vector<FixedSet> fixed_sets, const std::string& fixed_set) {
  Asset asset = make_asset(std::move(mesh), material, time_step_s, std::move(fixed_sets), fixed_set);
  SoftBodyContent content;
  content.level = std::move(asset.levels[0]);
  content.material = std::move(asset.material);
  content.fixed_sets = std::move(asset.fixed_sets);
  ComplianceVariant& variant = asset.compliances[0];
  const std::size_t block_bytes = std::size_t(variant.header.block_scalars) * sizeof(double);
  content.compliances.push_back(
      {variant.header, variant.nodes,
       std::make_unique<MemoryBlockSource>(std::move(variant.payload), block_bytes)});
  return content;
}

std::shared_ptr<const SoftBodyAsset> make_body(TetMesh mesh, const Material& material,
                                               double time_step_s, std::vector<FixedSet> fixed_sets,
                                               const std::string& fixed_set) {
  auto body = SoftBodyAsset::create(
      make_content(std::move(mesh), material, time_step_s, std::move(fixed_sets), fixed_set));
  return body ? *body : nullptr;
}

}  // namespace souple::test
