// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/process/child_answer.hpp"

#include <gtest/gtest.h>

namespace souple {
namespace {

TEST(ChildAnswer, HandsBytesBackUnchanged) {
  const std::string bytes("a\0b\xff", 4);
  const std::string sealed = seal_answer(bytes);
  const auto opened = open_answer(sealed);
  ASSERT_TRUE(opened.ok());
  EXPECT_EQ(*opened, bytes);
}

TEST(ChildAnswer, HandsAnIssueBackWithPrintableText) {
  const std::string sealed = seal_answer(make_issue(IssueCode::tet_inverted, "3\x1b[31m tets"));
  const auto opened = open_answer(sealed);
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.issue().code, IssueCode::tet_inverted);
  EXPECT_EQ(opened.issue().what, "3 [31m tets");
}

TEST(ChildAnswer, RefusesEveryTruncationAndEveryFlippedBit) {
  const std::string sealed = seal_answer(std::string("forty-two"));
  for (std::size_t size = 0; size < sealed.size(); ++size)
    EXPECT_FALSE(open_answer(std::string_view(sealed).substr(0, size)).ok()) << size;
  for (std::size_t bit = 0; bit < 8 * sealed.size(); ++bit) {
    std::string damaged = sealed;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    EXPECT_FALSE(open_answer(damaged).ok()) << bit;
  }
}

}  // namespace
}  // namespace souple
