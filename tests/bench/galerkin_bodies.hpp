// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies with levels for the benchmark of Galerkin products: boxes of the thesis's sizes, whose
// midpoints stay (weights 1 and 1/2), and a liver whose levels are fitted or embedded (4 weights).
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "runtime/fem/corotational_model.hpp"
#include "runtime/multigrid/prolongation.hpp"

namespace souple::bench {

enum class LevelKind { unmoved, fitted, embedded };

struct BodyChoice {
  std::string name;
  LevelKind kind;
  std::size_t coarse_tets;   ///< of the liver
  std::array<int, 3> cells;  ///< of the box: 6 tets each
  int level_count;
};

/// Finest tangent matrix with every element turned on its own, and P of every level, finest first.
struct GalerkinBody {
  LevelKind kind;
  std::vector<MeshLevel> levels;
  std::unique_ptr<const CorotationalModel> model;
  std::vector<Mat3> rotations;
  BlockMatrixF fine;
  std::vector<Prolongation> prolongations;
};

/// Factors of M and K in a step of 0.01 s with alpha = 0.1 and beta = 0.01.
inline constexpr double mass_factor = 1e4 + 10, stiffness_factor = 2;

/// The thesis's four sizes as boxes (of 432, 1152, 3456 and 7680 tets), then what is ours.
const std::vector<BodyChoice>& galerkin_bodies();

/// Ends the program with a message if it cannot be made.
GalerkinBody make_galerkin_body(const BodyChoice& choice);

}  // namespace souple::bench
