// SPDX-License-Identifier: MIT
// Counts every heap allocation of the process: malloc itself is wrapped, because Eigen calls it
// directly.
#include "tests/support/allocation_count.hpp"

#include <atomic>
#include <cstdlib>

namespace {
std::atomic<std::size_t> count{0};
}

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

// The sanitizers bring an allocator of their own; there the count stays zero and nothing is asserted.
#if !defined(__SANITIZE_ADDRESS__)
void* malloc(std::size_t size) {
  ++count;
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  ++count;
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
  ++count;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++count;
  return __libc_memalign(alignment, size);
}
#endif
}

namespace souple::test {

std::size_t allocation_count() { return count; }

}  // namespace souple::test
