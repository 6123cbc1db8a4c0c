#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# bake_matrix.sh SOUPLE: bakes four real surfaces at 1k, 10k and 50k tets and validates every asset.
# Prints how many fail as a row, the times as rows, and the details on stderr.
set -euo pipefail
souple=$1
data=${SOUPLE_DATA_DIR:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../../.." && pwd)/shared/data}
work=$(mktemp -d "${BENCH_TMP:-${TMPDIR:-/tmp}}/souple-matrix.XXXXXX")
trap 'rm -rf "$work"' EXIT
failures=0
for tets in 1000 10000 50000; do
  for surface in liver-smooth.obj dino.off bunny_10k.obj anchor.off; do
    start=$(date +%s.%N)
    if "$souple" bake "$data/surfaces/$surface" --size-m 0.2 --tets "$tets" -q -o "$work/a.souple" >&2 &&
      "$souple" validate -q "$work/a.souple" >&2; then
      seconds=$(awk -v a="$start" -v b="$(date +%s.%N)" 'BEGIN { printf "%.2f", b - a }')
      bytes=$(stat -c %s "$work/a.souple")
      printf '%s %s tets: %s s, %s bytes\n' "$surface" "$tets" "$seconds" "$bytes" >&2
      printf 'row matrix.%s.%s value=%s unit=s\n' "${surface%%[-_.]*}" "$tets" "$seconds"
    else
      failures=$((failures + 1))
      printf '%s %s tets: FAILED\n' "$surface" "$tets" >&2
    fi
    rm -f "$work/a.souple"
  done
done
printf 'row matrix.failures value=%d unit=1 runs=12\n' "$failures"
