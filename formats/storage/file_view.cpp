// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "formats/storage/byte_device.hpp"

namespace souple::storage {
namespace {

class FileView final : public ByteDevice {
 public:
  FileView(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}
  FileView(const FileView&) = delete;
  FileView& operator=(const FileView&) = delete;
  ~FileView() override { ::close(descriptor_); }
  std::uint64_t size() const override { return size_; }

 private:
  /// pread, not mmap: a file that shrinks while it is open gives an error and no signal.
  bool fetch(std::uint64_t offset, std::span<std::byte> bytes) noexcept override {
    while (!bytes.empty()) {
      const ssize_t count =
          ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      offset += static_cast<std::uint64_t>(count);
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    return true;
  }
  int descriptor_;
  std::uint64_t size_;
};

Issue open_issue(int error, const std::filesystem::path& file) {
  const bool missing = error == ENOENT || error == ENOTDIR;
  return make_issue(missing ? IssueCode::io_file_missing : IssueCode::io_cannot_read,
                    std::generic_category().message(error), file.string());
}

}  // namespace

Result<std::unique_ptr<ByteDevice>> open_file_view(const std::filesystem::path& file) {
  // Without O_NONBLOCK a named pipe would wait here for a writer.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return open_issue(errno, file);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    const bool folder = S_ISDIR(status.st_mode);
    ::close(descriptor);
    return make_issue(folder ? IssueCode::io_cannot_read : IssueCode::io_file_missing,
                      folder ? "is a directory" : "is not a regular file", file.string());
  }
  return std::unique_ptr<ByteDevice>(
      std::make_unique<FileView>(descriptor, static_cast<std::uint64_t>(status.st_size)));
}

}  // namespace souple::storage
