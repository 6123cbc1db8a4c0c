#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs the scoreboard on rows whose outcome is known. Usage: selftest.sh BUILD_DIR
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scoreboard=("$here/../scoreboard.sh" --rows "$here/rows" --build "$1" --no-build --timeout-s 1)
work=$(mktemp -d "${TMPDIR:-/tmp}/souple selftest.XXXXXX")
trap 'rm -rf "$work"' EXIT
export SELFTEST_COUNT=$work/count
failed=0

expect() {
  if ! eval "$2"; then
    echo "not so: $1"
    failed=$((failed + 1))
  fi
}

status=0
"${scoreboard[@]}" --json >"$work/json" 2>"$work/talk" || status=$?
expect "a short row is no failure" '[ $status -eq 0 ]'
expect "rows with one command share one run" '[ "$(wc -l <"$SELFTEST_COUNT")" -eq 1 ]'
expect "JSON is right" 'cmake -DFILE="$work/json" -P "$here/check_json.cmake"'

status=0
"${scoreboard[@]}" --strict fake >"$work/table" 2>"$work/talk" || status=$?
expect "--strict fails on a short row" '[ $status -eq 1 ]'
expect "the spread is shown" 'grep -q "1.5 ms (1.25…1.75, 5 runs) *green *00ff" "$work/table"'
expect "a short row is shown" 'grep -q "^fake.red .* red " "$work/table"'
expect "only the named rows" '! grep -q "^crash" "$work/table"'
expect "the closing counts" 'grep -qx "2 green, 1 red, 1 without a target, 3 errors" "$work/table"'

status=0
"${scoreboard[@]}" --strict fake.green crash.pipe >"$work/table" 2>"$work/talk" || status=$?
expect "--strict passes on green rows" '[ $status -eq 0 ]'

status=0
"${scoreboard[@]}" no.such.row >"$work/table" 2>"$work/talk" || status=$?
expect "an unknown name is refused" '[ $status -eq 2 ]'

rm -f "$SELFTEST_COUNT"
"${scoreboard[@]}" --list >"$work/table"
expect "--list shows every row" '[ "$(wc -l <"$work/table")" -eq 12 ]'
expect "--list runs nothing" '[ ! -e "$SELFTEST_COUNT" ]'

mkdir "$work/bad"
echo 'bad.row | 0 | text | about | 1 | s | true' >"$work/bad/bad.row"
status=0
"$here/../scoreboard.sh" --rows "$work/bad" >/dev/null 2>"$work/talk" || status=$?
expect "an unknown comparison is refused" '[ $status -eq 2 ] && grep -q "about" "$work/talk"'

if [ "$failed" -gt 0 ]; then
  cat "$work/talk"
  exit 1
fi
echo "the scoreboard does what it says"
