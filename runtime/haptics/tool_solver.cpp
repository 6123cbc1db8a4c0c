// SPDX-License-Identifier: MIT
#include "runtime/haptics/tool_solver.hpp"

#include <algorithm>
#include <cmath>
#if defined(__AVX2__) && defined(__FMA__)
#include <immintrin.h>
#endif

namespace souple {
namespace {

// Contacts between two looks at the clock, which take about 25 ns each.
constexpr std::size_t contacts_per_look = 16;

float usable_inverse(double x) {
  const float inverse = float(1 / x);
  return x > 0 && std::isfinite(inverse) ? inverse : 0.0F;
}

SingleLaw single_law(const ConstraintLaw& law, const Mat3& block) {
  SingleLaw single;
  const double rho = 3 / block.trace();
  if (!block.allFinite() || !(rho > 0) || !std::isfinite(float(rho))) return single;
  single.rho = float(rho);
  if (law.kind == ConstraintLaw::Kind::bilateral) {
    single.softness = float(law.softness / rho);
    const Mat3 inverse = (block + law.softness / rho * Mat3::Identity()).inverse();
    if (!inverse.allFinite()) return single;
    single.kind = SingleLaw::Kind::bilateral;
    for (std::size_t k = 0; k < 9; ++k)
      single.inverse[k] = float(inverse(Eigen::Index(k / 3), Eigen::Index(k % 3)));
    return single;
  }
  single.inverse_normal = usable_inverse(block(0, 0));
  if (single.inverse_normal == 0) return single;
  single.kind = SingleLaw::Kind::frictional;
  single.friction = float(law.friction);
  single.inverse_tangential = usable_inverse(0.5 * (block(1, 1) + block(2, 2)));
  single.coupling = {float(block(1, 0)), float(block(2, 0))};
  return single;
}

// See LocalLaw::next_force.
void next_force(const SingleLaw& law, const float* gap, const float* force, float* next) {
  if (law.kind == SingleLaw::Kind::bilateral) {
    const float u[3] = {gap[0] + law.softness * force[0], gap[1] + law.softness * force[1],
                        gap[2] + law.softness * force[2]};
    for (std::size_t r = 0; r < 3; ++r)
      next[r] = force[r] - (law.inverse[3 * r] * u[0] + law.inverse[3 * r + 1] * u[1] +
                            law.inverse[3 * r + 2] * u[2]);
    return;
  }
  const float change = -gap[0] * law.inverse_normal, normal = force[0] + change;
  next[0] = next[1] = next[2] = 0;
  if (!(normal > 0)) return;
  next[0] = normal;
  if (law.friction == 0) return;
  float t = force[1] - (gap[1] + law.coupling[0] * change) * law.inverse_tangential;
  float s = force[2] - (gap[2] + law.coupling[1] * change) * law.inverse_tangential;
  const float length2 = t * t + s * s, limit = law.friction * normal;
  if (length2 > limit * limit) {
    const float scale = limit / std::sqrt(length2);
    t *= scale;
    s *= scale;
  }
  next[1] = t;
  next[2] = s;
}

// Square of the norm of r - P(r - rho (u + mu |u_t| n)): see LocalLaw::natural_map.
float natural_map2(const SingleLaw& law, const float* u, const float* f) {
  if (law.kind == SingleLaw::Kind::bilateral) {
    float sum = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      const float error = law.rho * (u[r] + law.softness * f[r]);
      sum += error * error;
    }
    return sum;
  }
  const float mu = law.friction;
  const float r0 = f[0] - law.rho * (u[0] + mu * std::sqrt(u[1] * u[1] + u[2] * u[2]));
  const float r1 = f[1] - law.rho * u[1], r2 = f[2] - law.rho * u[2];
  const float tangential = std::sqrt(r1 * r1 + r2 * r2);
  float p0 = r0, scale = 1;
  if (tangential > mu * r0) {
    const bool polar = mu * tangential <= -r0;
    p0 = polar ? 0 : (r0 + mu * tangential) / (1 + mu * mu);
    scale = polar || tangential == 0 ? 0 : mu * p0 / tangential;
  }
  const float d0 = f[0] - p0, d1 = f[1] - scale * r1, d2 = f[2] - scale * r2;
  return d0 * d0 + d1 * d1 + d2 * d2;
}

std::size_t padded(std::size_t rows) {
  return (rows + PaddedColumns::pack - 1) / PaddedColumns::pack * PaddedColumns::pack;
}

// Rows [first, last) of the gap, which are multiples of 16, by three columns of W.
#if defined(__AVX2__) && defined(__FMA__)
void add_columns(const float* a, std::size_t stride, const float* change, std::size_t first,
                 std::size_t last, float* y) {
  const float *b = a + stride, *c = b + stride;
  const __m256 x = _mm256_set1_ps(change[0]), t = _mm256_set1_ps(change[1]),
               s = _mm256_set1_ps(change[2]);
  for (std::size_t k = first; k < last; k += 16) {
    __m256 low = _mm256_load_ps(y + k), high = _mm256_load_ps(y + k + 8);
    low = _mm256_fmadd_ps(x, _mm256_load_ps(a + k), low);
    high = _mm256_fmadd_ps(x, _mm256_load_ps(a + k + 8), high);
    low = _mm256_fmadd_ps(t, _mm256_load_ps(b + k), low);
    high = _mm256_fmadd_ps(t, _mm256_load_ps(b + k + 8), high);
    _mm256_store_ps(y + k, _mm256_fmadd_ps(s, _mm256_load_ps(c + k), low));
    _mm256_store_ps(y + k + 8, _mm256_fmadd_ps(s, _mm256_load_ps(c + k + 8), high));
  }
}
#else
void add_columns(const float* a, std::size_t stride, const float* change, std::size_t first,
                 std::size_t last, float* y) {
  const float *b = a + stride, *c = b + stride;
  for (std::size_t k = first; k < last; ++k)
    y[k] += change[0] * a[k] + change[1] * b[k] + change[2] * c[k];
}
#endif

double relative(double residual2, double force2) {
  return std::sqrt(force2 > 0 ? residual2 / force2 : residual2);
}

}  // namespace

void PreparedProblem::reserve(std::size_t contact_capacity) {
  problem.reserve(contact_capacity);
  laws.reserve(contact_capacity);
}

void PreparedProblem::prepare() {
  laws.clear();
  reach = {};
  std::array<double, most_jaws> count{};
  const auto for_touches = [&](auto&& visit) {
    for (const ToolContact& c : problem.contacts)
      for (const ToolTouch* touch : {&c.a, &c.b})
        if (touch->jaw >= 0) visit(std::size_t(touch->jaw), touch->local);
  };
  for (std::size_t i = 0; i < problem.contacts.size(); ++i)
    laws.push_back(single_law(problem.contacts[i].law, problem.delassus.block(i, i)));
  for_touches([&](std::size_t jaw, const Vec3& local) {
    reach[jaw].centre += local;
    reach[jaw].touches = true;
    ++count[jaw];
  });
  for (std::size_t jaw = 0; jaw < most_jaws; ++jaw)
    if (reach[jaw].touches) reach[jaw].centre /= count[jaw];
  for_touches([&](std::size_t jaw, const Vec3& local) {
    reach[jaw].radius = std::max(reach[jaw].radius, (local - reach[jaw].centre).norm());
  });
}

void ToolSolver::reserve(std::size_t contact_capacity) {
  const std::size_t rows = padded(3 * contact_capacity);
  for (auto* list : {&force_, &synchronised_, &shift_, &last_force_, &last_response_})
    list->reserve(rows);
  gap_.assign(rows + PaddedColumns::pack - 1, 0.0F);
  gap_offset_ = aligned_offset(gap_);
}

void ToolSolver::begin(const PreparedProblem& prepared) {
  problem_ = &prepared;
  const ToolProblem& problem = prepared.problem;
  count_ = problem.contacts.size();
  ticks_ = 0;
  force_.assign(problem.force.begin(), problem.force.end());
  for (std::size_t i = 0; i < count_; ++i)
    if (prepared.laws[i].kind == SingleLaw::Kind::immovable) std::fill_n(&force_[3 * i], 3, 0.0F);
  synchronised_ = force_;
  std::copy(problem.gap.begin(), problem.gap.end(), gap());
  std::fill(gap() + 3 * count_, gap() + padded(3 * count_), 0.0F);
  shift_.assign(3 * count_, 0.0F);
  last_force_.assign(3 * count_, 0.0F);
  last_response_.assign(3 * count_, 0.0F);
  shrink();
}

// Exactly: every contact point is taken to where the jaw carries it, and the gap changes by that
// displacement in the contact's frame. The motion beyond the reach is left out in the same direction.
bool ToolSolver::move_to(const JawPoses& poses, double reach_m) {
  const ToolProblem& problem = problem_->problem;
  std::array<Mat3, most_jaws> turn;
  std::array<Vec3, most_jaws> line;
  double farthest = 0;
  for (std::size_t jaw = 0; jaw < problem.jaw_count; ++jaw) {
    turn[jaw] = poses[jaw].rotation - problem.jaw_pose[jaw].rotation;
    line[jaw] = poses[jaw].translation - problem.jaw_pose[jaw].translation;
    const PreparedProblem::Reach& points = problem_->reach[jaw];
    if (!points.touches) continue;
    // The norm of R - R' is at most its Frobenius norm, which is sqrt(2) times it.
    farthest = std::max(farthest, (turn[jaw] * points.centre + line[jaw]).norm() +
                                      turn[jaw].norm() / std::sqrt(2.0) * points.radius);
  }
  const double share = farthest > reach_m ? reach_m / farthest : 1;
  for (std::size_t i = 0; i < count_; ++i) {
    const ToolContact& c = problem.contacts[i];
    Vec3 moved = Vec3::Zero();
    if (c.a.jaw >= 0) moved += turn[std::size_t(c.a.jaw)] * c.a.local + line[std::size_t(c.a.jaw)];
    if (c.b.jaw >= 0) moved -= turn[std::size_t(c.b.jaw)] * c.b.local + line[std::size_t(c.b.jaw)];
    const Vec3 opened = share * (c.frame.transpose() * moved);
    for (std::size_t r = 0; r < 3; ++r) {
      const float now = float(opened[Eigen::Index(r)]);
      gap()[3 * i + r] += now - shift_[3 * i + r];
      shift_[3 * i + r] = now;
    }
  }
  return share == 1;
}

// The hand goes on as it went: so do forces and gaps, which costs no product with W, since the gaps are
// linear in both. Not all the way: what the last tick left unsolved would go on as well, and grow.
void ToolSolver::extrapolate() {
  constexpr float share = 0.7F;
  for (std::size_t k = 0; k < 3 * count_; ++k) {
    const float f = force_[k], response = gap()[k] - shift_[k];
    if (ticks_ > 1) {
      force_[k] += share * (f - last_force_[k]);
      gap()[k] += share * (response - last_response_[k]);
    }
    last_force_[k] = f;
    last_response_[k] = response;
  }
  synchronised_ = force_;
  shrink();
}

void ToolSolver::add_column(std::size_t contact, const float* change, std::size_t first,
                            std::size_t last) {
  const PaddedColumns& w = problem_->problem.delassus;
  add_columns(w.column(3 * contact), w.stride(), change, first, last, gap());
}

double ToolSolver::Sums::residual() const { return relative(residual2, force2); }

// Over the contacts at the front; false if time was up.
bool ToolSolver::sweep(Sums& sums, Clock::time_point deadline) {
  float residual2 = 0, force2 = 0;
  for (std::size_t i = 0; i < front_; ++i) {
    if (i % contacts_per_look == contacts_per_look - 1 && Clock::now() >= deadline) return false;
    const SingleLaw& law = problem_->laws[i];
    if (law.kind == SingleLaw::Kind::immovable) continue;
    float* f = &force_[3 * i];
    const float* u = gap() + 3 * i;
    if (law.kind == SingleLaw::Kind::frictional && f[0] == 0 && u[0] >= 0) continue;
    residual2 += natural_map2(law, u, f);
    float next[3], change[3];
    next_force(law, u, f, next);
    for (std::size_t r = 0; r < 3; ++r) change[r] = next[r] - f[r];
    if (change[0] != 0 || change[1] != 0 || change[2] != 0) add_column(i, change, 0, edge_);
    std::copy_n(next, 3, f);
    force2 += next[0] * next[0] + next[1] * next[1] + next[2] * next[2];
  }
  sums.residual2 = residual2;
  sums.force2 = force2;
  return true;
}

// The gaps behind the front.
void ToolSolver::synchronise() {
  const std::size_t end = problem_->problem.delassus.stride();
  for (std::size_t i = 0; i < front_; ++i) {
    float change[3];
    for (std::size_t r = 0; r < 3; ++r) change[r] = force_[3 * i + r] - synchronised_[3 * i + r];
    if (change[0] != 0 || change[1] != 0 || change[2] != 0) add_column(i, change, edge_, end);
    std::copy_n(&force_[3 * i], 3, &synchronised_[3 * i]);
  }
}

// The front ends with the last contact that bears a force. All gaps are up to date.
void ToolSolver::shrink() {
  front_ = 0;
  for (std::size_t i = 0; i < count_; ++i)
    if (problem_->laws[i].kind == SingleLaw::Kind::bilateral || force_[3 * i] != 0) front_ = i + 1;
  edge_ = padded(3 * front_);
}

// Contacts behind the front that have closed join it; whether there were any.
bool ToolSolver::take_up_closed() {
  std::size_t last = front_;
  for (std::size_t i = front_; i < count_; ++i)
    if (problem_->laws[i].kind == SingleLaw::Kind::frictional && gap()[3 * i] < 0) last = i + 1;
  if (last == front_) return false;
  front_ = last;
  edge_ = padded(3 * front_);
  return true;
}

// Of the first `contacts`, whose gaps are up to date.
double ToolSolver::residual(std::size_t contacts) const {
  double residual2 = 0, force2 = 0;
  for (std::size_t i = 0; i < contacts; ++i) {
    const SingleLaw& law = problem_->laws[i];
    const float *f = &force_[3 * i], *u = gap() + 3 * i;
    if (law.kind == SingleLaw::Kind::immovable) continue;
    if (law.kind == SingleLaw::Kind::frictional && f[0] == 0 && u[0] >= 0) continue;
    residual2 += double(natural_map2(law, u, f));
    force2 += double(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  }
  return relative(residual2, force2);
}

TickSolve ToolSolver::solve(double residual_goal, int max_sweeps, Clock::time_point deadline) {
  TickSolve result;
  ++ticks_;
  extrapolate();
  take_up_closed();
  Sums sums;
  // What follows the sweeps takes its time too, as long as it lately did and half as much again (more
  // with a problem that no cache holds yet); but no more than half of the time is kept for it, or a
  // tick that was once interrupted would end the sweeps of those that follow before they begin.
  Clock::duration& closing = closing_[ticks_ == 1];
  const auto begun = Clock::now();
  const bool bounded = deadline != Clock::time_point::max();
  while (front_ > 0) {
    const auto kept = std::min(3 * closing / 2, (deadline - begun) / 2);
    const auto stop = bounded ? deadline - kept : deadline;
    bool content = false;
    while (!content && result.in_time && result.sweeps < max_sweeps) {
      result.in_time = sweep(sums, stop) && Clock::now() < stop;
      ++result.sweeps;
      content = sums.residual() <= residual_goal && residual(front_) <= residual_goal;
    }
    const auto closing_began = Clock::now();
    synchronise();
    result.residual = residual(count_);
    closing = (7 * closing + (Clock::now() - closing_began)) / 8;
    const bool grew = take_up_closed();
    if (!result.in_time || result.sweeps >= max_sweeps) break;
    if (!grew && result.residual <= residual_goal) break;
  }
  shrink();
  return result;
}

std::size_t ToolSolver::active_count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < front_; ++i)
    count += force_[3 * i] != 0 || force_[3 * i + 1] != 0 || force_[3 * i + 2] != 0;
  return count;
}

}  // namespace souple
