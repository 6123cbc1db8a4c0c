// SPDX-License-Identifier: MIT
// A local problem of frictional contact as plain data. Rows per contact: normal, two tangential.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/core/result.hpp"

namespace souple {

namespace limits {
inline constexpr std::size_t contacts = std::size_t{1} << 20;
inline constexpr std::size_t contact_blocks = std::size_t{1} << 24;
inline constexpr double contact_number = 1e100;  ///< |value|: products of three stay finite
}  // namespace limits

/// A square matrix of 3x3 blocks by block columns: the blocks of block column j are [begin[j],
/// begin[j + 1]), their block rows ascend; block b is column-major at value + 9 b.
struct BlockColumns {
  std::vector<std::size_t> begin{0};
  std::vector<std::uint32_t> row;
  std::vector<double> value;

  std::size_t size() const { return begin.size() - 1; }  ///< in blocks
};

/// Forces r (N, or N s) and what goes with them, u = W r + q. Both 3m.
struct ContactState {
  std::vector<double> u, r;
};

/// Find r and u = W r + q with u + mu |u_t| n in the dual of K = {|r_t| <= mu r_n}, r in K, and both
/// perpendicular.
struct ContactProblem {
  std::string title, description, math_info;
  BlockColumns w;
  std::vector<double> q;   ///< 3m
  std::vector<double> mu;  ///< m, >= 0

  std::size_t contact_count() const { return mu.size(); }
};

/// Of a dense W (3m x 3m, column-major); blocks of zeros are left out.
BlockColumns block_columns_of_dense(std::span<const double> dense, std::size_t contact_count);

/// Sizes, indices, order and values. Issues: contact_problem_invalid, contact_problem_too_large.
Status check_contact_problem(const ContactProblem& problem);

}  // namespace souple
