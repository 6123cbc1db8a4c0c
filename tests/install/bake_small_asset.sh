#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Usage: bake_small_asset.sh SOUPLE SURFACE ASSET
set -euo pipefail
exec "$1" bake "$2" -o "$3" --tets 1000 --levels 1 --size-m 0.2
