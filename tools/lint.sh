#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Looks at the style of what changed: clang-format on every file, clang-tidy on every source file that a
# build knows. Reports, and fails only with --strict.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

usage() {
  cat <<'TEXT'
Usage: tools/lint.sh [--strict] [--all] [--format-only | --tidy-only] [--base COMMIT] [--build DIR] [FILE…]
  --all          every source file instead of those that differ from the base
  --base COMMIT  what "changed" is measured against (default: HEAD; new files count)
  --build DIR    holds compile_commands.json (default: build/release)
  --strict       exit status 1 if anything was found
Install clang-format and clang-tidy with: tools/install_packages.sh lint
TEXT
}

strict=0
all=0
format=1
tidy=1
base=HEAD
build_dir=build/release
files=()
while [ $# -gt 0 ]; do
  case "$1" in
    --strict) strict=1 ;;
    --all) all=1 ;;
    --format-only) tidy=0 ;;
    --tidy-only) format=0 ;;
    --base) base=${2:?--base needs a commit}; shift ;;
    --build) build_dir=${2:?--build needs a folder}; shift ;;
    -h | --help) usage; exit 0 ;;
    -*) echo "unknown option: $1" >&2; usage >&2; exit 2 ;;
    *) files+=("$1") ;;
  esac
  shift
done

# Source files that exist, one a line.
list_files() {
  if [ "$all" -eq 1 ]; then
    find formats runtime tools tests -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.c' \)
  else
    { git diff --name-only --diff-filter=d "$base"; git ls-files --others --exclude-standard; } |
      grep -E '\.(hpp|cpp|h|c)$' || true
  fi | LC_ALL=C sort -u
}

if [ "${#files[@]}" -eq 0 ]; then mapfile -t files < <(list_files); fi
if [ "${#files[@]}" -eq 0 ]; then
  echo "no source files changed"
  exit 0
fi

finding_count=0

check_format() {
  local file bad=()
  for file in "${files[@]}"; do
    clang-format --dry-run -Werror --style=file "$file" >/dev/null 2>&1 || bad+=("$file")
  done
  finding_count=$((finding_count + ${#bad[@]}))
  if [ "${#bad[@]}" -eq 0 ]; then
    echo "${#files[@]} files are formatted"
  else
    printf 'not as clang-format would: %s\n' "${bad[@]}"
    echo "${#bad[@]} of ${#files[@]} files are not formatted; mend with: clang-format -i FILE"
  fi
}

check_tidy() {
  local file tidy_count sources=()
  if [ ! -f "$build_dir/compile_commands.json" ]; then
    echo "clang-tidy needs $build_dir/compile_commands.json: run cmake --preset release first" >&2
    exit 2
  fi
  for file in "${files[@]}"; do
    if grep -qF "$root/$file\"" "$build_dir/compile_commands.json"; then sources+=("$file"); fi
  done
  for file in "${sources[@]}"; do
    # Options that only g++ knows are no finding.
    clang-tidy --quiet -p "$build_dir" --extra-arg=-Wno-unknown-warning-option "$file" 2>/dev/null || true
  done >"$tidy_log"
  cat "$tidy_log"
  tidy_count=$(grep -cE ': (warning|error): ' "$tidy_log" || true)
  finding_count=$((finding_count + tidy_count))
  echo "clang-tidy: $tidy_count findings in ${#sources[@]} source files"
}

need() {
  command -v "$1" >/dev/null 2>&1 || { echo "$1 is not installed: tools/install_packages.sh lint" >&2; exit 2; }
}

if [ "$format" -eq 1 ]; then
  need clang-format
  check_format
fi
if [ "$tidy" -eq 1 ]; then
  need clang-tidy
  tidy_log=$(mktemp)
  trap 'rm -f "$tidy_log"' EXIT
  check_tidy
fi
if [ "$strict" -eq 1 ] && [ "$finding_count" -gt 0 ]; then exit 1; fi
