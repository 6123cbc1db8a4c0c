// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the command line about compliances; `bake` and `precompute` share them, `validate` and
// `export` the effort.
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "formats/core/result.hpp"
#include "tools/recipe/bake.hpp"
#include "tools/recipe/recipe_parameters.hpp"

namespace souple {

/// What computing may take: --memory-mb and --threads.
class EffortOptions {
 public:
  void add_to(CLI::App& app);
  /// Issue usage_bad_value.
  Result<ComplianceStage> stage() const;

 private:
  std::optional<std::string> memory_mb_, threads_;
};

class ComplianceOptions {
 public:
  void add_to(CLI::App& app);
  /// Options win over the recipe. Issues: usage_bad_value, usage_conflict.
  Status apply(Recipe& recipe) const { return override_compliances(recipe, overrides_); }
  /// Memory and threads. Issue usage_bad_value.
  Result<ComplianceStage> stage() const { return effort_.stage(); }

 private:
  ComplianceOverrides overrides_;
  EffortOptions effort_;
};

}  // namespace souple
