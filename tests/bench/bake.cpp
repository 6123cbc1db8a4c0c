// SPDX-License-Identifier: GPL-3.0-or-later
// Bake of liver-smooth.obj at about 10k tets, dynamic h = 0.01 s: time by stage, memory, bytes.
#include <map>

#include "formats/write/asset_writer.hpp"
#include "tests/bench/liver.hpp"
#include "tests/bench/row.hpp"

int main() {
  using namespace souple;
  using namespace souple::bench;
  std::map<std::string, std::vector<double>> stages;
  std::vector<double> totals;
  ResultHash hash;
  double tets = 0, memory = 0, bytes = 0;
  for (int run = 0; run < 3; ++run) {
    BakeOutcome outcome;
    std::vector<std::byte> file;
    double write_s = 0;
    totals.push_back(seconds_of([&] {
      outcome = bake_or_exit(liver_recipe(10000, 2));
      write_s = seconds_of([&] { file = value_or_exit(write_asset_memory(outcome.asset)); });
    }));
    // "compliance NAME": the recipe has one.
    for (const auto& stage : outcome.report.stages)
      stages[stage.name.substr(0, stage.name.find(' '))].push_back(stage.wall_s);
    stages["write"].push_back(write_s);
    hash = ResultHash();
    hash.add(file);
    tets = double(outcome.asset.levels.back().mesh.tets.size());
    memory = double(outcome.report.peak_memory_bytes) / 1e6;
    bytes = double(file.size()) / 1e6;
  }
  print_row("bake.liver_10k.total", "s", totals, hash);
  for (const auto& [name, seconds] : stages)
    print_row("bake.liver_10k.share." + name, "%", 100 * median(seconds) / median(totals), hash);
  print_row("bake.liver_10k.tets", "1", tets, hash);
  print_row("bake.liver_10k.peak_memory", "MB", memory, hash);
  print_row("bake.liver_10k.asset", "MB", bytes, hash);
  return 0;
}
