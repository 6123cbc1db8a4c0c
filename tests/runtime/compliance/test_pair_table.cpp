// SPDX-License-Identifier: MIT
#include "runtime/compliance/pair_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/allocation_count.hpp"
#include "tests/support/random_records.hpp"

namespace souple {
namespace {

using test::RandomRecords;

constexpr std::size_t plenty = std::size_t{1} << 30;

std::vector<float> block_of(const RestCompliance& rest, const std::vector<Index>& rows,
                            const std::vector<Index>& columns) {
  std::vector<float> out(9 * rows.size() * columns.size());
  ComplianceWork work;
  rest.gather_block(rows, columns, out.data(), 3 * columns.size(), work);
  return out;
}

std::vector<Index> shuffled_rows(Index count, unsigned seed) {
  std::vector<Index> rows;
  for (Index row = 0; row < count; ++row) rows.push_back(row);
  std::mt19937 random(seed);
  std::ranges::shuffle(rows, random);
  return rows;
}

TEST(PairTable, GivesEveryBlockToTwoToTheMinusFifteenOfItsLargestEntry) {
  const RandomRecords sample(300, 3, 11);
  const auto table = sample.open(plenty), factors = sample.open(0);
  ASSERT_TRUE(table.ok() && factors.ok());
  ASSERT_EQ((*table)->table_bytes(), PairTable::bytes_for(300));
  ASSERT_EQ((*factors)->table_bytes(), 0u);
  const std::vector<Index> rows = shuffled_rows(300, 1), columns = shuffled_rows(300, 2);
  const auto found = block_of(**table, rows, columns), exact = block_of(**factors, rows, columns);
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t b = 0; b < columns.size(); ++b) {
      float largest = 0, error = 0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
          const std::size_t at = (3 * a + i) * 3 * columns.size() + 3 * b + j;
          largest = std::max(largest, std::abs(exact[at]));
          error = std::max(error, std::abs(found[at] - exact[at]));
        }
      ASSERT_LE(error, std::ldexp(largest, -15)) << rows[a] << " " << columns[b];
    }
}

TEST(PairTable, IsSymmetricToTheBitAndTheSameHoweverItIsAsked) {
  const RandomRecords sample(93, 3, 11);
  const auto opened = sample.open(plenty);
  ASSERT_TRUE(opened.ok());
  std::vector<Index> rows = shuffled_rows(93, 3);
  rows.resize(50);
  std::ranges::sort(rows, {}, [&](Index row) { return (*opened)->order_of(row); });
  const std::size_t size = 3 * rows.size();
  const std::vector<float> block = block_of(**opened, rows, rows);
  std::vector<float> lower(size * size);
  ComplianceWork work;
  (*opened)->gather_lower(rows, lower.data(), size, work);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) {
      ASSERT_EQ(block[i * size + j], block[j * size + i]);
      if (j / 3 <= i / 3) {
        ASSERT_EQ(lower[i * size + j], block[i * size + j]) << i << " " << j;
      }
    }
}

TEST(PairTable, WritesNothingBeyondItsRowsAndAllocatesNothingOnceWarm) {
  const RandomRecords sample(93, 3, 11);
  const auto opened = sample.open(plenty);
  ASSERT_TRUE(opened.ok());
  std::vector<Index> rows = shuffled_rows(93, 4);
  std::ranges::sort(rows, {}, [&](Index row) { return (*opened)->order_of(row); });
  const std::size_t size = 3 * rows.size(), stride = size + 5;
  std::vector<float> out(size * stride, -7.0F);
  ComplianceWork work;
  (*opened)->gather_lower(rows, out.data(), stride, work);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = size; j < stride; ++j) ASSERT_EQ(out[i * stride + j], -7.0F);
  (*opened)->gather_block(rows, rows, out.data(), stride, work);
  const auto before = test::allocation_count();
  (*opened)->gather_lower(rows, out.data(), stride, work);
  (*opened)->gather_block(rows, rows, out.data(), stride, work);
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(PairTable, IsMadeOnlyWithinItsBudget) {
  const RandomRecords sample(93, 3, 11);
  EXPECT_EQ((*sample.open(PairTable::bytes_for(93) - 1))->table_bytes(), 0u);
  EXPECT_GT((*sample.open(PairTable::bytes_for(93)))->table_bytes(), 0u);
}

TEST(StoredPair, RoundsBlocksOfAnyScale) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (const float scale : {1e-29F, 1e-12F, 1.0F, 1e20F, 1e36F})
    for (int trial = 0; trial < 200; ++trial) {
      std::array<float, 9> block{};
      for (float& entry : block) entry = scale * normal(random);
      float largest = 0;
      for (const float entry : block) largest = std::max(largest, std::abs(entry));
      const StoredPair pair = stored_pair(block.data(), 3);
      constexpr std::size_t place[9] = {0, 1, 2, 4, 5, 6, 3, 7, 8};
      const float step = std::bit_cast<float>(std::uint32_t{pair.step} << 16);
      for (std::size_t k = 0; k < 9; ++k)
        ASSERT_LE(std::abs(step * float(pair.mantissa[place[k]]) - block[k]), std::ldexp(largest, -15));
    }
  const std::array<float, 9> nothing{}, hardly{1e-38F, 0, 0, 0, 1e-40F};
  for (const auto& block : {nothing, hardly}) {
    const StoredPair pair = stored_pair(block.data(), 3);
    EXPECT_EQ(pair.step, 0);
    EXPECT_EQ(pair.mantissa, (std::array<std::int16_t, 9>{}));
  }
}

}  // namespace
}  // namespace souple
