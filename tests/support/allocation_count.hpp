// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

namespace souple::test {

/// Calls of operator new and malloc-family growth through it in this process so far.
std::size_t allocation_count();

}  // namespace souple::test
