// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/process/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <locale>
#include <new>
#include <stdexcept>

namespace souple {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool address_space_can_be_limited = false;
#else
constexpr bool address_space_can_be_limited = true;
#endif

enum ExitStatus : int { answered = 0, threw = 101, out_of_memory = 102, could_not_answer = 103 };

constexpr int answer_fd = 3;

class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  void set(int fd) { fd_ = fd; }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }

 private:
  int fd_;
};

/// Bytes of address space this process has mapped; 0 if unknown.
std::size_t mapped_bytes() {
  std::FILE* file = std::fopen("/proc/self/statm", "re");
  if (file == nullptr) return 0;
  unsigned long pages = 0;
  const int read = std::fscanf(file, "%lu", &pages);
  std::fclose(file);
  return read == 1 ? pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

void limit(int resource, rlim_t value) {
  rlimit both{value, value};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

/// In the child, right after fork: nothing of the parent's files, handlers or console is left.
void isolate(int write_end, const ChildLimits& limits, std::size_t mapped) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGINT, SIGTERM, SIGPIPE, SIGXCPU})
    std::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  // Up and away from 0 … 3 first: with a closed stdin the pipe itself may sit there.
  const int keep = ::fcntl(write_end, F_DUPFD, answer_fd + 1);
  const int null = ::open("/dev/null", O_RDWR);
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(null, fd);
  ::dup2(keep, answer_fd);
  ::close_range(answer_fd + 1, ~0U, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limits.time_s)) + 2);
  if (address_space_can_be_limited) limit(RLIMIT_AS, mapped + limits.memory_bytes);
}

bool write_all(int fd, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

[[noreturn]] void child_main(const std::function<std::string()>& work) {
  int status = threw;
  try {
    std::locale::global(std::locale::classic());
    status = write_all(answer_fd, work()) ? answered : could_not_answer;
  } catch (const std::bad_alloc&) {
    status = out_of_memory;
  } catch (const std::length_error&) {  // a container asked for more than there can be
    status = out_of_memory;
  } catch (...) {
    status = threw;
  }
  ::_exit(status);
}

enum class Reading { finished, too_slow, too_long };

/// Reads until the child closes its end. Grows with what arrives, never by what is announced.
Reading read_answer(int fd, const ChildLimits& limits, std::string& answer) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(limits.time_s));
  std::array<char, 65536> buffer;
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return Reading::too_slow;
    pollfd wait{fd, POLLIN, 0};
    const int ready = ::poll(&wait, 1, static_cast<int>(std::min<std::int64_t>(left, 60'000)));
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t n = ::read(fd, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return Reading::finished;
    if (answer.size() + static_cast<std::size_t>(n) > limits.memory_bytes) return Reading::too_long;
    answer.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

/// After the pipe closed: why the child ended, if not well.
Status judge(int status, const ChildLimits& limits) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == answered) return {};
  if (WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory)
    return make_issue(IssueCode::surface_reader_memory,
                      "the limit is " + std::to_string(limits.memory_bytes >> 20) + " MiB");
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU))
    return make_issue(IssueCode::surface_reader_timeout, "the CPU time ran out");
  if (WIFSIGNALED(status))
    return make_issue(IssueCode::surface_reader_crashed,
                      "ended by signal " + std::to_string(WTERMSIG(status)));
  return make_issue(IssueCode::surface_reader_crashed,
                    "ended with status " + std::to_string(WEXITSTATUS(status)));
}

}  // namespace

Result<std::string> run_in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return make_issue(IssueCode::io_child_not_started, std::string("pipe: ") + std::strerror(errno));
  Descriptor read_end(ends[0]), write_end(ends[1]);
  const std::size_t mapped = mapped_bytes();
  const pid_t child = ::fork();
  if (child < 0)
    return make_issue(IssueCode::io_child_not_started, std::string("fork: ") + std::strerror(errno));
  if (child == 0) {
    isolate(write_end.get(), limits, mapped);
    child_main(work);
  }
  write_end.close();
  std::string answer;
  Reading reading = Reading::too_long;
  try {
    reading = read_answer(read_end.get(), limits, answer);
  } catch (const std::bad_alloc&) {
    reading = Reading::too_long;
  }
  if (reading != Reading::finished) ::kill(child, SIGKILL);
  const int status = wait_for(child);
  if (reading == Reading::too_slow)
    return make_issue(IssueCode::surface_reader_timeout,
                      "no result within " + std::to_string(limits.time_s) + " s");
  if (reading == Reading::too_long)
    return make_issue(IssueCode::surface_reader_memory, "the mesh exceeds the memory limit");
  if (const Status well = judge(status, limits); !well) return well.issue();
  return answer;
}

}  // namespace souple
