// SPDX-License-Identifier: MIT
// The state of a world as bytes. One walk over the state serves writing, checking and reading, so that
// the three cannot disagree; what is read is checked from end to end before anything is changed.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "runtime/world/world_state.hpp"

namespace souple {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> magic{'S', 'O', 'U', 'P', 'S', 'N', 'A', 'P'};
constexpr std::uint32_t snapshot_version = 3;

// FNV-1a, 64 bits: against damage, not against forgery, from which the checks of sizes protect.
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const std::byte b : bytes) hash = (hash ^ std::uint64_t(b)) * 1099511628211ull;
  return hash;
}

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  bool local(void* data, std::size_t size) { return state(data, size); }
  bool state(void* data, std::size_t size) {
    const auto* from = static_cast<const std::byte*>(data);
    out_.insert(out_.end(), from, from + size);
    return true;
  }
  bool doubles(double* data, std::size_t count) { return state(data, count * sizeof(double)); }
  template <class T>
  bool resize(std::vector<T>&, std::uint64_t) {
    return true;
  }

 private:
  std::vector<std::byte>& out_;
};

/// Reads what the walk needs to go on, leaves the state alone.
class Checker {
 public:
  explicit Checker(std::span<const std::byte> bytes) : bytes_(bytes) {}
  bool local(void* data, std::size_t size) {
    if (size > bytes_.size()) return false;
    std::memcpy(data, bytes_.data(), size);
    return state(data, size);
  }
  bool state(void*, std::size_t size) {
    if (size > bytes_.size()) return false;
    bytes_ = bytes_.subspan(size);
    return true;
  }
  bool doubles(double*, std::size_t count) {
    if (count > bytes_.size() / sizeof(double)) return false;
    for (; count > 0; --count) {
      double value;
      if (!local(&value, sizeof value) || !std::isfinite(value)) return false;
    }
    return true;
  }
  template <class T>
  bool resize(std::vector<T>&, std::uint64_t count) {
    return count <= bytes_.size() / sizeof(T);
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

/// Of bytes that a Checker has seen.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : next_(bytes.data()) {}
  bool local(void* data, std::size_t size) { return state(data, size); }
  bool state(void* data, std::size_t size) {
    if (size > 0) std::memcpy(data, next_, size);
    next_ += size;
    return true;
  }
  bool doubles(double* data, std::size_t count) { return state(data, count * sizeof(double)); }
  template <class T>
  bool resize(std::vector<T>& list, std::uint64_t count) {
    list.resize(count);
    return true;
  }

 private:
  const std::byte* next_;
};

// What both sides know already; the same in the bytes, or they are of another world.
template <class Stream, class T>
bool same(Stream& s, const T& known) {
  T value = known;
  return s.local(&value, sizeof value) && value == known;
}

template <class Stream>
bool walk(Stream& s, Eigen::VectorXd& vector) {
  return same(s, std::uint64_t(vector.size())) && s.doubles(vector.data(), std::size_t(vector.size()));
}

template <class Stream>
bool walk(Stream& s, std::vector<ContactMemory>& list) {
  std::uint64_t count = list.size();
  if (!s.local(&count, sizeof count) || !s.resize(list, count)) return false;
  for (std::uint64_t k = 0; k < count; ++k) {
    // A checker has no list of its own to walk over.
    ContactMemory scratch;
    ContactMemory& m = k < list.size() ? list[k] : scratch;
    if (!s.state(&m.key, sizeof m.key)) return false;
    for (Vec3* v : {&m.force, &m.change, &m.lasting, &m.course[0], &m.course[1], &m.course[2]})
      if (!s.doubles(v->data(), 3)) return false;
  }
  return true;
}

template <class Stream>
bool walk(Stream& s, FreeRigidState& body) {
  return s.doubles(body.position.data(), 3) && s.doubles(body.orientation.coeffs().data(), 4) &&
         s.doubles(body.velocity.data(), 3) && s.doubles(body.spin.data(), 3);
}

template <class Stream>
bool walk(Stream& s, RigidPlacement& at) {
  return s.doubles(at.rotation.data(), 9) && s.doubles(at.translation.data(), 3);
}

template <class Stream>
bool walk(Stream& s, HeldState& body) {
  return walk(s, body.now) && walk(s, body.next);
}

template <class Stream>
bool walk(Stream& s, SoftBody& body) {
  bool has_history = body.history.valid;
  StepSolver::Memory solver = body.solver->memory();
  if (!walk(s, body.x) || !walk(s, body.v) || !s.local(&has_history, sizeof has_history) ||
      !s.state(&body.stabilisation.growing_steps, sizeof(int)) ||
      !s.doubles(&body.stabilisation.relaxation, 1) || !s.doubles(body.owed.linear.data(), 3) ||
      !s.doubles(body.owed.angular.data(), 3) || !walk(s, body.history.motion) ||
      !walk(s, body.history.velocity) || !s.local(&solver, sizeof solver) ||
      !body.solver->may_recall(solver))
    return false;
  if constexpr (std::is_same_v<Stream, Reader>) {
    body.history.valid = has_history;
    body.history.begun = false;
    body.solver->recall(solver);
  }
  return true;
}

}  // namespace

template <class Stream>
bool World::State::walk_state(Stream& s) {
  if (!same(s, magic) || !same(s, snapshot_version) || !same(s, settings.integrator) ||
      !same(s, settings.time_step_s) || !same(s, std::uint64_t(bodies.size())))
    return false;
  for (const auto index : soft_indices)
    if (!same(s, index) || !walk(s, soft(index))) return false;
  for (const auto index : rigid_indices)
    if (!same(s, index) || (rigid(index).free && !walk(s, *rigid(index).free)) ||
        (rigid(index).held && !walk(s, *rigid(index).held)))
      return false;
  for (BodyRest& r : rest)
    if (!s.doubles(&r.quiet_s, 1) || !s.state(&r.is_asleep, sizeof r.is_asleep) ||
        !s.state(&r.group, sizeof r.group))
      return false;
  if (!same(s, std::uint64_t(pins.handles.size()))) return false;
  for (Handle& handle : pins.handles)
    if (!walk(s, handle.now) || !walk(s, handle.next)) return false;
  return s.doubles(&time, 1) && s.state(&last_energy_j, sizeof last_energy_j) &&
         walk(s, memory.entries());
}

std::vector<std::byte> World::snapshot() const {
  std::vector<std::byte> bytes;
  Writer writer(bytes);
  state_->walk_state(writer);  // changes nothing when it writes
  std::uint64_t sum = checksum(bytes);
  writer.local(&sum, sizeof sum);
  return bytes;
}

Status World::restore(std::span<const std::byte> bytes) {
  const auto refuse = [](const char* what) { return make_issue(IssueCode::snapshot_invalid, what); };
  std::uint64_t sum = 0;
  if (bytes.size() < sizeof sum) return refuse("too short for a snapshot");
  const auto content = bytes.first(bytes.size() - sizeof sum);
  std::memcpy(&sum, bytes.data() + content.size(), sizeof sum);
  if (sum != checksum(content)) return refuse("its bytes are damaged: the checksum differs");
  Checker checker(content);
  if (!state_->walk_state(checker) || !checker.at_end())
    return refuse("it is of a world with other bodies, another time step, integrator or solver");
  Reader reader(content);
  state_->walk_state(reader);
  state_->forget_contacts();
  return {};
}

}  // namespace souple
