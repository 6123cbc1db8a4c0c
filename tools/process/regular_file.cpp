// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/process/regular_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>

namespace souple {
namespace fs = std::filesystem;
namespace {

Issue cannot_read(const fs::path& file, int error) {
  if (error == ENOENT || error == ENOTDIR)
    return make_issue(IssueCode::io_file_missing, "there is no such file", file.string());
  return make_issue(IssueCode::io_cannot_read, std::string("cannot read: ") + std::strerror(error),
                    file.string());
}

Issue exceeds(const fs::path& file, std::size_t limit, IssueCode too_large) {
  return make_issue(too_large, "the file is larger than " + std::to_string(limit) + " bytes",
                    file.string());
}

/// Reads to the end; the file may grow meanwhile.
Result<std::string> read_open_file(int fd, const fs::path& file, std::size_t limit,
                                   IssueCode too_large) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) return cannot_read(file, errno);
  if (!S_ISREG(status.st_mode)) return cannot_read(file, S_ISDIR(status.st_mode) ? EISDIR : EINVAL);
  if (static_cast<std::uintmax_t>(status.st_size) > limit) return exceeds(file, limit, too_large);
  std::string bytes;
  bytes.reserve(static_cast<std::size_t>(status.st_size));
  std::array<char, 65536> buffer;
  while (true) {
    const ssize_t count = ::read(fd, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return cannot_read(file, errno);
    if (count == 0) return bytes;
    if (bytes.size() + static_cast<std::size_t>(count) > limit) return exceeds(file, limit, too_large);
    bytes.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

Result<std::string> read_regular_file(const fs::path& file, std::size_t limit, IssueCode too_large) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return cannot_read(file, errno);
  Result<std::string> bytes = read_open_file(fd, file, limit, too_large);
  ::close(fd);
  return bytes;
}

std::string hash_text(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string hex;
  for (const unsigned char byte : canonical.digest) {
    hex += digits[byte >> 4];
    hex += digits[byte & 15];
  }
  return hex;
}

}  // namespace souple
