#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures of the levels 0 to 3 of three nested hierarchies beside their targets.
# Usage: hierarchy_pictures.sh PROGRAM OUT_FOLDER (PROGRAM: souple_bench_hierarchy_levels)
set -euo pipefail
if [ $# -ne 2 ]; then
  echo "usage: hierarchy_pictures.sh PROGRAM OUT_FOLDER" >&2
  exit 1
fi
program=$1
out=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
data=${SOUPLE_DATA_DIR:-$root/../shared/data}
for needed in xvfb-run f3d montage; do
  if ! command -v "$needed" >/dev/null 2>&1; then
    echo "hierarchy_pictures: $needed is missing" >&2
    exit 1
  fi
done

# Edges are drawn on the levels, so that their size shows.
render() {
  xvfb-run -a f3d --quiet --output "$2" --resolution 520,520 --up="$3" --edges --line-width=0.5 \
    --geometry-only --camera-azimuth-angle="$4" --bg-color=1,1,1 --color=0.85,0.5,0.42 --roughness=0.6 \
    "$1" >/dev/null 2>&1 || { echo "hierarchy_pictures: f3d could not render $1" >&2; exit 1; }
}

for shape in "liver-smooth.obj 150 +Z 150" "dino.off 1250 +Z 30" "bunny_10k.obj 1250 +Y 0"; do
  read -r file tets up azimuth <<<"$shape"
  name=${file%.*}
  folder=$out/$name
  mkdir -p "$folder"
  "$program" "$data/surfaces/$file" "$tets" 4 "$folder"
  pictures=()
  for part in level_0 level_1 level_2 level_3 target; do
    render "$folder/$part.vtu" "$folder/$part.png" "$up" "$azimuth"
    pictures+=(-label "$name, $part" "$folder/$part.png")
  done
  montage -background white -pointsize 20 -tile 5x -geometry 520x520+4+4 "${pictures[@]}" \
    "$out/$name.png"
  echo "$out/$name.png"
done
