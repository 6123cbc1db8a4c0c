#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fails unless the shared library exports the functions of souple.h, all of them and nothing else.
# Usage: check_exports.sh LIBRARY HEADER
set -euo pipefail
library=$1
header=$2

exported=$(nm -D --defined-only "$library" | awk '$2 != "A" {sub(/@.*/, "", $3); print $3}' | LC_ALL=C sort)
# A function's name stands before the first parenthesis after SOUPLE_API.
declared=$(grep -v '^#' "$header" | tr '\n' ' ' | grep -oE 'SOUPLE_API [^;(]*\(' |
  sed -E 's/.*[ *](souple_[a-z0-9_]+)\($/\1/' | LC_ALL=C sort)
if [ "$(wc -l <<<"$declared")" -lt 60 ]; then
  echo "only $(wc -l <<<"$declared") functions were found in $header"
  exit 1
fi
if ! diff <(echo "$declared") <(echo "$exported"); then
  echo "$library exports (>) other symbols than $header declares (<)"
  exit 1
fi
echo "$(wc -l <<<"$exported") functions, nothing else"
