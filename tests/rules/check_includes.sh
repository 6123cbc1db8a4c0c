#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Holds every #include of the tree against includes.rules: which folder may use which of ours and which
# package. Prints one line for each breach. Usage: check_includes.sh [ROOT [RULES]]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "${1:-$here/../..}" && pwd)
rules=$(realpath "${2:-$here/includes.rules}")
cd "$root"

list_sources() {
  find formats runtime tools tests -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.c' \
    -o -name '*.def' \) -print 2>/dev/null | LC_ALL=C sort || true
}

mapfile -t sources < <(list_sources)
if [ "${#sources[@]}" -eq 0 ]; then
  echo "check_includes: no sources under $root" >&2
  exit 1
fi

awk -f "$here/check_includes.awk" "$rules" "${sources[@]}"
