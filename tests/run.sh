#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing, builds, and runs every test: the full build, the runtime alone, the rules of
# who may use what, the installed package. Ends with a line of counts; exit status 0 if nothing failed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

usage() {
  cat <<'TEXT'
Usage: tests/run.sh [--all] [--preset NAME] [--no-install] [--strict-format]
  --all            the tests labelled `slow` too
  --preset NAME    release (default), debug or asan
  --no-install     do not look for missing packages
  --strict-format  badly formatted files are a failure, not a remark
Data tests read SOUPLE_DATA_DIR (default: ../shared/data). With CI set they fail without it.
TEXT
}

preset=release
all=0
install=1
format_arguments=()
while [ $# -gt 0 ]; do
  case "$1" in
    --all) all=1 ;;
    --preset)
      preset=${2:?--preset needs a name}
      shift ;;
    --no-install) install=0 ;;
    --strict-format) format_arguments=(--strict) ;;
    -h | --help) usage; exit 0 ;;
    *) echo "unknown option: $1" >&2; usage >&2; exit 2 ;;
  esac
  shift
done
case "$preset" in
  release | debug | asan) ;;
  *) echo "unknown preset: $preset (release, debug, asan)" >&2; exit 2 ;;
esac

passed=0
failed=0
skipped=0
logs=$(mktemp -d "${TMPDIR:-/tmp}/souple-tests.XXXXXX")
trap 'rm -rf "$logs"' EXIT

heading() { printf '\n== %s\n' "$1"; }

# Ends a run that cannot go on; the closing line says so too.
close() {
  heading "total"
  if [ "$skipped" -gt 0 ]; then echo "($skipped tests were skipped: their data or program is not here)"; fi
  echo "$passed passed, $failed failed"
  if [ "$failed" -gt 0 ] || [ "$passed" -eq 0 ]; then exit 1; fi
  exit 0
}

give_up() {
  echo "FAILED: $1"
  failed=$((failed + 1))
  close
}

# Configures and builds a preset; a failed build goes on as far as it can, and counts as one failure.
build_preset() {
  local name=$1 jobs
  jobs=$(tools/build_jobs.sh)
  heading "configure $name"
  if ! cmake --preset "$name" >"$logs/configure" 2>&1; then
    cat "$logs/configure"
    give_up "configure $name"
  fi
  tail -n 1 "$logs/configure"
  heading "build $name with $jobs jobs"
  if ! cmake --build --preset "$name" -j "$jobs" -- -k 0; then
    echo "FAILED: build $name"
    failed=$((failed + 1))
  fi
}

# Adds the counts of a JUnit file that ctest wrote. A test that could not run has failed.
add_counts() {
  local counts run_passed run_failed run_skipped
  counts=$(awk '
    /<testcase / {
      if ($0 ~ / status="run"/) passed++
      else if ($0 ~ / status="disabled"/) skipped++
      else if ($0 ~ / status="notrun"/) { notrun++; pending = 1; next }
      else failed++
    }
    pending && /<skipped message="SKIP_/ { skipped++; notrun--; pending = 0 }
    END { print passed + 0, failed + notrun, skipped + 0 }' "$1")
  read -r run_passed run_failed run_skipped <<<"$counts"
  passed=$((passed + run_passed))
  failed=$((failed + run_failed))
  skipped=$((skipped + run_skipped))
}

run_ctest() {
  local name=$1 status=0 failed_before=$failed
  shift
  heading "test $name"
  rm -f "$logs/$name.xml"
  ctest --preset "$name" -j "$(tools/build_jobs.sh)" --no-tests=error --output-junit "$logs/$name.xml" "$@" || status=$?
  if [ -f "$logs/$name.xml" ]; then add_counts "$logs/$name.xml"; fi
  if [ "$status" -ne 0 ] && [ "$failed" -eq "$failed_before" ]; then
    echo "FAILED: ctest ended with status $status"
    failed=$((failed + 1))
  fi
}

if [ "$install" -eq 1 ]; then
  heading "packages"
  if ! tools/install_packages.sh build test; then give_up "packages"; fi
  echo "all there"
fi

selection=()
if [ "$all" -eq 0 ]; then selection=(--label-exclude slow); fi

build_preset "$preset"
run_ctest "$preset" "${selection[@]}"

build_preset runtime-only
run_ctest runtime-only "${selection[@]}"

heading "format"
if command -v clang-format >/dev/null 2>&1; then
  if tools/lint.sh --format-only --all "${format_arguments[@]}"; then
    if [ "${#format_arguments[@]}" -gt 0 ]; then passed=$((passed + 1)); fi
  else
    failed=$((failed + 1))
  fi
else
  echo "clang-format is not installed: not looked at"
fi

close
