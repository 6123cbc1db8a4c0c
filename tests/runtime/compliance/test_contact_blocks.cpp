// SPDX-License-Identifier: MIT
#include "runtime/compliance/contact_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/allocation_count.hpp"
#include "tests/support/fake_compliance.hpp"

namespace souple {
namespace {

using test::FakeCompliance;

constexpr Index node_count = 300;

FakeCompliance stand_in() { return FakeCompliance(test::random_compliance(node_count, 40, 1)); }

std::vector<Index> random_rows(std::mt19937& random, std::size_t count) {
  std::vector<Index> all(node_count);
  for (Index k = 0; k < node_count; ++k) all[std::size_t(k)] = k;
  std::ranges::shuffle(all, random);
  all.resize(count);
  std::ranges::sort(all);
  return all;
}

// About this share of the rows leaves, and about as many others come.
std::vector<Index> changed_rows(std::mt19937& random, std::vector<Index> rows, double share) {
  std::bernoulli_distribution leaves(share);
  std::uniform_int_distribution<Index> any(0, node_count - 1);
  std::erase_if(rows, [&](Index) { return leaves(random); });
  for (int k = int(share * double(rows.size())) + 1; k > 0; --k) rows.push_back(any(random));
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

// The blocks between rows in the order of the rows, from the lower triangle by slots.
std::vector<float> values_of(const ContactBlocks& blocks, std::size_t count) {
  std::vector<float> values;
  for (std::size_t i = 0; i < 3 * count; ++i)
    for (std::size_t j = 0; j < 3 * count; ++j) {
      const std::size_t row = 3 * std::size_t(blocks.slots()[i / 3]) + i % 3,
                        column = 3 * std::size_t(blocks.slots()[j / 3]) + j % 3;
      values.push_back(blocks.values()[column / 3 <= row / 3 ? row * blocks.stride() + column
                                                             : column * blocks.stride() + row]);
    }
  return values;
}

std::vector<float> fresh_values(const RestCompliance& rest, const std::vector<Index>& rows) {
  std::vector<float> values(9 * rows.size() * rows.size());
  ComplianceWork work;
  rest.gather_block(rows, rows, values.data(), 3 * rows.size(), work);
  return values;
}

TEST(ContactBlocks, AreThoseOfAFreshEvaluationToTheBitWhateverCameBefore) {
  FakeCompliance rest = stand_in();
  rest.backwards = true;
  std::mt19937 random(7);
  ContactBlocks blocks;
  std::vector<Index> rows = random_rows(random, 120);
  for (int step = 0; step < 60; ++step) {
    blocks.update(rest, rows);
    ASSERT_EQ(blocks.count(), rows.size());
    ASSERT_EQ(values_of(blocks, rows.size()), fresh_values(rest, rows)) << "step " << step;
    const double shares[] = {0, 0.02, 0.5, 0.9, 1};
    rows = step % 11 == 10 ? random_rows(random, std::size_t(random() % 250))
                           : changed_rows(random, rows, shares[step % 5]);
  }
}

TEST(ContactBlocks, HaveSlotsInTheOrderOfTheCompliance) {
  FakeCompliance rest = stand_in();
  rest.backwards = true;
  std::mt19937 random(8);
  ContactBlocks blocks;
  for (const std::size_t count : {200, 40, 41, 1, 0, 150}) {
    const auto rows = random_rows(random, count);
    blocks.update(rest, rows);
    ASSERT_EQ(blocks.count(), count);
    for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(blocks.slots()[k], Index(count - 1 - k));
  }
}

TEST(ContactBlocks, EvaluateOnlyWhatIsNew) {
  const FakeCompliance rest = stand_in();
  std::mt19937 random(9);
  ContactBlocks blocks;
  std::vector<Index> rows = random_rows(random, 80);
  blocks.update(rest, rows);
  EXPECT_LE(rest.evaluated, 80u * 80u);
  rest.evaluated = 0;
  blocks.update(rest, rows);
  EXPECT_EQ(rest.evaluated, 0u) << "the same contacts again";
  rows.erase(rows.begin() + 17);
  blocks.update(rest, rows);
  EXPECT_EQ(rest.evaluated, 0u) << "a contact that ends";
  Index fresh = 0;
  while (std::ranges::binary_search(rows, fresh)) ++fresh;
  rows.insert(std::ranges::lower_bound(rows, fresh), fresh);
  blocks.update(rest, rows);
  EXPECT_EQ(rest.evaluated, 80u) << "one row against all others and itself";
  blocks.clear();
  rest.evaluated = 0;
  blocks.update(rest, rows);
  EXPECT_GE(rest.evaluated, 80u * 81u / 2) << "nothing is left after clear";
}

TEST(ContactBlocks, AllocateNothingBelowTheLargestCountSoFar) {
  const FakeCompliance rest = stand_in();
  std::mt19937 random(10);
  ContactBlocks blocks;
  blocks.update(rest, random_rows(random, 200));
  std::vector<std::vector<Index>> steps;
  for (const std::size_t count : {200, 10, 150, 0, 200}) steps.push_back(random_rows(random, count));
  const std::size_t before = test::allocation_count();
  for (const auto& rows : steps) blocks.update(rest, rows);
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace souple
