// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace souple {

/// How the linear system of a step is solved. All stop at the same residual of the same equations.
enum class SolverKind : std::uint8_t {
  automatic,             ///< SoftBodyAsset::default_solver, with a spare: see StepSolver::add_spare
  jacobi_pcg,            ///< conjugate gradients, inverted 3x3 diagonal blocks
  gauss_seidel_pcg,      ///< conjugate gradients, symmetric block Gauss-Seidel
  multigrid,             ///< V-cycles alone
  multigrid_pcg,         ///< conjugate gradients, one V-cycle
  direct,                ///< Cholesky factor of the present tangent
  warped_pcg,            ///< conjugate gradients, R A0^-1 R^T through a factor of the rest matrix
  warped_multigrid_pcg,  ///< conjugate gradients, R A0^-1 R^T through a V-cycle of the rest matrix
};

struct SolverName {
  SolverKind kind;
  std::string_view name;  ///< as scenes and assets write it
};

inline constexpr std::array<SolverName, 8> solver_names{{
    {SolverKind::automatic, "automatic"},
    {SolverKind::jacobi_pcg, "jacobi_pcg"},
    {SolverKind::gauss_seidel_pcg, "gauss_seidel_pcg"},
    {SolverKind::multigrid, "multigrid"},
    {SolverKind::multigrid_pcg, "multigrid_pcg"},
    {SolverKind::direct, "direct"},
    {SolverKind::warped_pcg, "warped_pcg"},
    {SolverKind::warped_multigrid_pcg, "warped_multigrid_pcg"},
}};

constexpr std::string_view solver_name(SolverKind kind) {
  return solver_names[static_cast<std::size_t>(kind)].name;
}

constexpr std::optional<SolverKind> solver_of_name(std::string_view name) {
  for (const auto& known : solver_names)
    if (known.name == name) return known.kind;
  return std::nullopt;
}

}  // namespace souple
