// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/exchange/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "tools/process/regular_file.hpp"

namespace souple {
namespace fs = std::filesystem;
namespace {

Issue cannot_write(const fs::path& file, int error) {
  return make_issue(IssueCode::io_cannot_write, std::string("cannot write: ") + std::strerror(error),
                    file.string());
}

/// Closes a file descriptor at the end of a scope.
class OpenFile {
 public:
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  int get() const { return descriptor_; }
  bool close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return ::close(descriptor) == 0;
  }

 private:
  int descriptor_;
};

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      if (written == 0) errno = ENOSPC;
      return false;
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

fs::path folder_of(const fs::path& file) {
  return file.parent_path().empty() ? fs::path(".") : file.parent_path();
}

std::string temporary_name(const fs::path& file) {
  return (folder_of(file) / ("." + file.filename().string() + ".XXXXXX")).string();
}

/// mkstemp makes private files; outputs get the permissions that the umask allows.
mode_t usual_permissions() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

}  // namespace

Status write_pieces_atomically(const fs::path& file,
                               const std::function<Status(const AppendBytes& append)>& produce) {
  if (auto checked = check_output_file(file); !checked) return checked;
  std::string temporary = temporary_name(file);
  OpenFile out(::mkstemp(temporary.data()));
  if (out.get() < 0) return cannot_write(file, errno);
  Status status = produce([&](std::string_view bytes) -> Status {
    if (write_all(out.get(), bytes)) return {};
    return cannot_write(file, errno);
  });
  if (status && !(::fchmod(out.get(), usual_permissions()) == 0 && ::fsync(out.get()) == 0 &&
                  out.close() && ::rename(temporary.c_str(), file.c_str()) == 0))
    status = cannot_write(file, errno);
  if (!status) ::unlink(temporary.c_str());
  return status;
}

Status write_file_atomically(const fs::path& file, std::string_view text) {
  return write_pieces_atomically(file, [&](const AppendBytes& append) { return append(text); });
}

Result<std::string> read_text_file(const fs::path& file, std::size_t limit) {
  return read_regular_file(file, limit);
}

Status make_output_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return cannot_write(folder, error.value());
  if (!fs::is_directory(folder, error)) return cannot_write(folder, ENOTDIR);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) return cannot_write(folder, errno);
  return {};
}

Status check_output_file(const fs::path& file) {
  std::error_code error;
  if (file.filename().empty()) return cannot_write(file, EISDIR);
  if (fs::is_directory(file, error)) return cannot_write(file, EISDIR);
  const fs::path folder = folder_of(file);
  if (!fs::is_directory(folder, error))
    return cannot_write(file, fs::exists(folder, error) ? ENOTDIR : ENOENT);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) return cannot_write(file, errno);
  return {};
}

}  // namespace souple
