// SPDX-License-Identifier: MIT
#include "formats/core/contact_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace souple {
namespace {

Status bad(std::string what, const char* where) {
  return make_issue(IssueCode::contact_problem_invalid, std::move(what), where);
}

bool usable(double value) { return std::abs(value) <= limits::contact_number; }

// A block column: where it begins and that its rows ascend inside the matrix.
bool is_sound_column(const BlockColumns& w, std::size_t j) {
  if (w.begin[j] > w.begin[j + 1]) return false;
  for (std::size_t b = w.begin[j]; b < w.begin[j + 1]; ++b)
    if (w.row[b] >= w.size() || (b > w.begin[j] && w.row[b] <= w.row[b - 1])) return false;
  return true;
}

Status check_matrix(const BlockColumns& w) {
  if (w.begin.empty() || w.begin.front() != 0 || w.begin.back() != w.row.size() ||
      w.value.size() != 9 * w.row.size())
    return bad("the lists of its blocks do not belong together", "W");
  for (std::size_t j = 0; j < w.size(); ++j)
    if (w.begin[j + 1] > w.row.size() || !is_sound_column(w, j))
      return bad("block column " + std::to_string(j) + " leaves the matrix or is not in order", "W");
  if (!std::ranges::all_of(w.value, usable)) return bad("a value is not a usable number", "W");
  return {};
}

}  // namespace

BlockColumns block_columns_of_dense(std::span<const double> dense, std::size_t contact_count) {
  const std::size_t height = 3 * contact_count;
  BlockColumns w;
  for (std::size_t j = 0; j < contact_count; ++j) {
    for (std::size_t i = 0; i < contact_count; ++i) {
      std::array<double, 9> block{};
      for (std::size_t k = 0; k < 9; ++k) block[k] = dense[(3 * j + k / 3) * height + 3 * i + k % 3];
      if (std::ranges::all_of(block, [](double value) { return value == 0; })) continue;
      w.row.push_back(static_cast<std::uint32_t>(i));
      w.value.insert(w.value.end(), block.begin(), block.end());
    }
    w.begin.push_back(w.row.size());
  }
  return w;
}

Status check_contact_problem(const ContactProblem& problem) {
  const std::size_t contacts = problem.mu.size();
  if (contacts == 0) return bad("it has no contact", "vectors/mu");
  if (contacts > limits::contacts || problem.w.row.size() > limits::contact_blocks)
    return make_issue(IssueCode::contact_problem_too_large,
                      std::to_string(contacts) + " contacts and " +
                          std::to_string(problem.w.row.size()) + " blocks; at most " +
                          std::to_string(limits::contacts) + " and " +
                          std::to_string(limits::contact_blocks) + " are taken",
                      "W");
  if (problem.w.size() != contacts || problem.q.size() != 3 * contacts)
    return bad("W, q and mu are not of one size", "W");
  for (const double mu : problem.mu)
    if (!(mu >= 0) || !usable(mu))
      return bad("a coefficient of friction is " + std::to_string(mu), "vectors/mu");
  if (!std::ranges::all_of(problem.q, usable))
    return bad("a value is not a usable number", "vectors/q");
  return check_matrix(problem.w);
}

}  // namespace souple
