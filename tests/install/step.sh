# SPDX-License-Identifier: MIT
# Sourced by the checks of the installed package; $work is a folder of their own.

# step NAME COMMAND…: runs it, and shows what it printed only if it fails.
step() {
  echo "== $1"
  shift
  if ! "$@" >"$work/log" 2>&1; then
    cat "$work/log"
    exit 1
  fi
}
