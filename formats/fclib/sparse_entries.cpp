// SPDX-License-Identifier: MIT
#include "formats/fclib/sparse_entries.hpp"

#include <algorithm>

#include "formats/fclib/names.hpp"

namespace souple::fclib {
namespace {

struct Entry {
  std::uint32_t row, column;
  double value;

  // Of the block, column-major.
  std::uint64_t block() const { return std::uint64_t{column / 3} << 32 | row / 3; }
};

struct Checked {
  const SparseMatrix& matrix;
  const std::string& where;

  Issue damaged(std::string what) const {
    return make_issue(IssueCode::contact_file_damaged, std::move(what), where);
  }
  Issue outside(std::size_t entry) const {
    return make_issue(IssueCode::contact_problem_invalid,
                      "entry " + std::to_string(entry) + " lies outside the matrix", where);
  }
  bool inside(std::int64_t index) const { return index >= 0 && index < matrix.rows; }

  Status check_size() const {
    if (matrix.rows != matrix.columns || matrix.rows <= 0 || matrix.rows % 3 != 0)
      return make_issue(IssueCode::contact_problem_invalid,
                        "it is " + std::to_string(matrix.rows) + " x " +
                            std::to_string(matrix.columns) + ", not square in blocks of three",
                        where);
    if (matrix.rows / 3 > static_cast<std::int64_t>(limits::contacts))
      return make_issue(IssueCode::contact_problem_too_large,
                        std::to_string(matrix.rows / 3) + " contacts; at most " +
                            std::to_string(limits::contacts) + " are taken",
                        where);
    return {};
  }

  Result<std::vector<Entry>> triplets() const {
    const auto count = static_cast<std::uint64_t>(matrix.nz);
    if (matrix.nz > matrix.nzmax || count > matrix.p.size() || count > matrix.i.size() ||
        count > matrix.x.size())
      return damaged(std::to_string(matrix.nz) + " triplets, but the lists are shorter");
    std::vector<Entry> entries;
    entries.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      if (!inside(matrix.p[k]) || !inside(matrix.i[k])) return outside(k);
      entries.push_back({static_cast<std::uint32_t>(matrix.p[k]),
                         static_cast<std::uint32_t>(matrix.i[k]), matrix.x[k]});
    }
    return entries;
  }

  // By columns or, transposed, by rows.
  Result<std::vector<Entry>> compressed() const {
    const auto lines = static_cast<std::size_t>(matrix.rows);
    const auto length = static_cast<std::int64_t>(std::min(matrix.i.size(), matrix.x.size()));
    if (matrix.p.size() != lines + 1 || matrix.p[0] != 0 || !std::ranges::is_sorted(matrix.p) ||
        matrix.p[lines] > length || matrix.p[lines] > matrix.nzmax)
      return damaged("the pointers do not ascend from 0 to the length of the lists");
    std::vector<Entry> entries;
    entries.reserve(static_cast<std::size_t>(matrix.p[lines]));
    for (std::size_t line = 0; line < lines; ++line)
      for (auto k = static_cast<std::size_t>(matrix.p[line]);
           k < static_cast<std::size_t>(matrix.p[line + 1]); ++k) {
        if (!inside(matrix.i[k])) return outside(k);
        const auto across = static_cast<std::uint32_t>(matrix.i[k]);
        const auto along = static_cast<std::uint32_t>(line);
        entries.push_back(matrix.nz == compressed_columns ? Entry{across, along, matrix.x[k]}
                                                          : Entry{along, across, matrix.x[k]});
      }
    return entries;
  }

  Result<std::vector<Entry>> entries() const {
    if (matrix.nz >= 0) return triplets();
    if (matrix.nz == compressed_columns || matrix.nz == compressed_rows) return compressed();
    return damaged("nz is " + std::to_string(matrix.nz) + ": none of the three storages");
  }
};

BlockColumns gather(const std::vector<Entry>& entries, std::size_t size) {
  BlockColumns blocks;
  blocks.begin.assign(size + 1, 0);
  std::uint64_t last = ~std::uint64_t{0};
  for (const Entry& entry : entries) {
    if (entry.block() != last) {
      last = entry.block();
      blocks.row.push_back(entry.row / 3);
      blocks.value.resize(blocks.value.size() + 9);
      ++blocks.begin[entry.column / 3 + 1];
    }
    blocks.value[blocks.value.size() - 9 + 3 * (entry.column % 3) + entry.row % 3] += entry.value;
  }
  for (std::size_t j = 0; j < size; ++j) blocks.begin[j + 1] += blocks.begin[j];
  return blocks;
}

}  // namespace

Result<BlockColumns> blocks_of(const SparseMatrix& matrix, const std::string& where) {
  const Checked checked{matrix, where};
  if (Status status = checked.check_size(); !status) return status.issue();
  Result<std::vector<Entry>> entries = checked.entries();
  if (!entries) return entries.issue();
  // Stable: duplicates add up in the order of the file, so that its sum is that of any reader.
  std::ranges::stable_sort(*entries, {}, &Entry::block);
  std::size_t count = 0;
  for (std::size_t k = 0; k < entries->size(); ++k)
    count += k == 0 || (*entries)[k].block() != (*entries)[k - 1].block() ? 1 : 0;
  if (count > limits::contact_blocks)
    return make_issue(IssueCode::contact_problem_too_large,
                      std::to_string(count) + " blocks; at most " +
                          std::to_string(limits::contact_blocks) + " are taken",
                      where);
  return gather(*entries, static_cast<std::size_t>(matrix.rows) / 3);
}

SparseMatrix compressed_columns_of(const BlockColumns& blocks) {
  SparseMatrix matrix;
  matrix.rows = matrix.columns = 3 * static_cast<std::int64_t>(blocks.size());
  matrix.nz = compressed_columns;
  matrix.p.push_back(0);
  for (std::size_t j = 0; j < 3 * blocks.size(); ++j) {
    for (std::size_t b = blocks.begin[j / 3]; b < blocks.begin[j / 3 + 1]; ++b)
      for (std::size_t k = 0; k < 3; ++k) {
        const double value = blocks.value[9 * b + 3 * (j % 3) + k];
        if (value == 0) continue;
        matrix.i.push_back(3 * static_cast<std::int64_t>(blocks.row[b]) + static_cast<std::int64_t>(k));
        matrix.x.push_back(value);
      }
    matrix.p.push_back(static_cast<std::int64_t>(matrix.i.size()));
  }
  matrix.nzmax = static_cast<std::int64_t>(matrix.i.size());
  return matrix;
}

}  // namespace souple::fclib
