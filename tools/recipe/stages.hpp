// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

/// Hears how far a bake is. Called from the baking thread.
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  virtual void stage(std::string_view name) = 0;  ///< the stage that begins
  virtual void fraction(double done) = 0;         ///< of the stage, in [0, 1]
};

struct StageTime {
  std::string name;
  double wall_s = 0;
};

/// Tells the sink of the stage and keeps its time.
class Stages {
 public:
  Stages(ProgressSink& sink, std::vector<StageTime>& times) : sink_(sink), times_(times) {}

  template <class Work>
  auto run(const std::string& name, const Work& work) {
    sink_.stage(name);
    const auto begin = std::chrono::steady_clock::now();
    auto result = work();
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    times_.push_back({name, wall.count()});
    return result;
  }

 private:
  ProgressSink& sink_;
  std::vector<StageTime>& times_;
};

}  // namespace souple
