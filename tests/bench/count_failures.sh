#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# count_failures.sh ROW PROGRAM FILTER: runs the matching tests of a GoogleTest program and prints the
# row with the number that failed. No match at all is an error, not a zero.
set -euo pipefail
row=$1 program=$2 filter=$3
report=$(mktemp "${TMPDIR:-/tmp}/souple-count.XXXXXX")
trap 'rm -f "$report"' EXIT
"$program" --gtest_filter="$filter" >"$report" 2>&1 || true
run=$(sed -n 's/^\[==========\] \([0-9]*\) tests\? from .* ran.*/\1/p' "$report")
passed=$(sed -n 's/^\[  PASSED  \] \([0-9]*\) tests\?.*/\1/p' "$report")
if [ "${run:-0}" -eq 0 ]; then
  echo "no test of $program matches $filter, or it ended early" >&2
  exit 1
fi
printf 'row %s value=%d unit=1 runs=%d\n' "$row" $((run - passed)) "$run"
