// SPDX-License-Identifier: MIT
#include "formats/write/replace_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string>
#include <system_error>

namespace souple {
namespace {

namespace fs = std::filesystem;

/// A new file beside the target; removed when it goes out of scope, unless it was moved into place.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) : target_(target) {
    static std::atomic<unsigned> counter{0};
    // Another program may have left a file of the same name behind: try some.
    for (int attempt = 0; attempt < 100 && descriptor_ < 0; ++attempt) {
      const std::string name =
          ".souple-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp";
      path_ = target.parent_path() / name;
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      error_ = descriptor_ < 0 ? errno : 0;
      if (descriptor_ < 0 && errno != EEXIST) break;
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (created_and_unmoved()) ::unlink(path_.c_str());
  }

  bool write(std::span<const std::byte> bytes) {
    while (error_ == 0 && !bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count >= 0)
        bytes = bytes.subspan(static_cast<std::size_t>(count));
      else if (errno != EINTR)
        error_ = errno;
    }
    return error_ == 0;
  }

  bool move_into_place() {
    if (error_ == 0 && ::fsync(descriptor_) != 0) error_ = errno;
    // Some file systems report a full disk only here.
    if (descriptor_ >= 0 && ::close(descriptor_) != 0 && error_ == 0) error_ = errno;
    if (descriptor_ >= 0) closed_ = true;
    descriptor_ = -1;
    if (error_ == 0 && ::rename(path_.c_str(), target_.c_str()) != 0) error_ = errno;
    moved_ = error_ == 0;
    return moved_;
  }

  int error() const { return error_; }

 private:
  bool created_and_unmoved() const { return (descriptor_ >= 0 || closed_) && !moved_; }

  fs::path target_, path_;
  int descriptor_ = -1;
  int error_ = 0;
  bool closed_ = false;
  bool moved_ = false;
};

/// So that the new name survives a power cut. Best effort: not every file system can.
void flush_folder(const fs::path& folder) {
  const int descriptor =
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

/// A link is followed, so that it keeps pointing to the file.
fs::path resolve(const fs::path& file) {
  std::error_code error;
  if (!fs::is_symlink(file, error) || error) return file;
  const fs::path resolved = fs::canonical(file, error);
  return error ? file : resolved;
}

Issue write_issue(const std::string& what, const fs::path& file) {
  return make_issue(IssueCode::io_cannot_write, what, file.string());
}

}  // namespace

Status replace_file(const fs::path& file, std::span<const std::span<const std::byte>> pieces) {
  if (!file.has_filename() || file.native().find('\0') != std::string::npos)
    return write_issue("the path names no file", file);
  const fs::path target = resolve(file);
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return write_issue(fs::is_directory(status) ? "is a directory" : "is not a regular file", file);
  TemporaryFile temporary(target);
  for (const auto& piece : pieces)
    if (!temporary.write(piece)) break;
  if (!temporary.move_into_place())
    return write_issue(std::generic_category().message(temporary.error()), file);
  flush_folder(target.parent_path());
  return {};
}

}  // namespace souple
