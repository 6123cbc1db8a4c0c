#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every source file names in its first lines the licence of its folder. Usage: check_licences.sh [ROOT]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "${1:-$here/../..}"

licence_of() {
  case "$1" in
    formats/* | runtime/* | tests/formats/* | tests/runtime/* | tests/consumer/*) echo MIT ;;
    tools/* | tests/tools/* | tests/cli/*) echo GPL-3.0-or-later ;;
    *) echo either ;;
  esac
}

failures=0
checked=0
while IFS= read -r -d '' file; do
  checked=$((checked + 1))
  found=$(head -n 2 "$file" | sed -n 's/.*SPDX-License-Identifier: *\([A-Za-z0-9.-]*\).*/\1/p' | head -n 1)
  wanted=$(licence_of "$file")
  if [ "$wanted" = either ] && { [ "$found" = MIT ] || [ "$found" = GPL-3.0-or-later ]; }; then continue; fi
  if [ "$found" != "$wanted" ]; then
    echo "$file: SPDX line says '${found:-nothing}', its folder is $wanted"
    failures=$((failures + 1))
  fi
done < <(find formats runtime tools tests -type f \( -name '*.hpp' -o -name '*.cpp' -o -name '*.c' \
  -o -name '*.h' -o -name '*.def' -o -name '*.sh' \) -print0 | LC_ALL=C sort -z)

for text in LICENSE formats/LICENSE runtime/LICENSE tools/LICENSE; do
  if [ ! -s "$text" ]; then
    echo "$text is missing"
    failures=$((failures + 1))
  fi
done

if [ "$failures" -gt 0 ]; then
  echo "$failures files with the wrong licence"
  exit 1
fi
echo "$checked files name the licence of their folder"
