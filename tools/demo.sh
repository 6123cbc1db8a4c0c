#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds the command, bakes a liver, drops it on a ball and a floor, makes
# pictures of it. Does again only what changed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

usage() {
  cat <<'TEXT'
Usage: tools/demo.sh [--no-install] [--again]
  --no-install  do not look for missing packages
  --again       bake, run and render even if nothing changed
Results: build/demo (the asset, the frames, report.json, liver_drop.png).
TEXT
}

install=1
again=0
while [ $# -gt 0 ]; do
  case "$1" in
    --no-install) install=0 ;;
    --again) again=1 ;;
    -h | --help) usage; exit 0 ;;
    *) echo "demo: unknown option: $1" >&2; usage >&2; exit 1 ;;
  esac
  shift
done

out=build/demo
asset=$out/liver.souple
run=$out/liver_drop
strip=$out/liver_drop.png
recipe=assets/recipes/liver.toml
surface=assets/surfaces/liver-smooth.obj
scene=assets/scenes/liver_drop.toml
steps=240
souple=build/release/bin/souple

say() { printf 'demo: %s\n' "$*" >&2; }

# Whether the first file is missing or older than one of the others.
outdated() {
  local target=$1 source
  shift
  if [ "$again" -eq 1 ] || [ ! -e "$target" ]; then return 0; fi
  for source in "$@"; do
    if [ "$source" -nt "$target" ]; then return 0; fi
  done
  return 1
}

install_packages() {
  if [ "$install" -eq 0 ]; then return; fi
  # The release preset configures the tests as well: hence the set `test`.
  ./tools/install_packages.sh build test
  # Without these there are no pictures, and the rest still works.
  ./tools/install_packages.sh demo || say "the renderer could not be installed: no pictures"
}

build() {
  local log=build/demo/configure.log
  if ! cmake --preset release >"$log" 2>&1; then
    cat "$log" >&2
    say "configuring failed"
    exit 1
  fi
  cmake --build --preset release --target souple -j "$(tools/build_jobs.sh)" >&2
}

bake() {
  if outdated "$asset" "$recipe" "$surface" "$souple"; then
    say "baking $surface"
    "$souple" bake --recipe "$recipe" -o "$asset"
  else
    say "the asset is up to date"
  fi
}

simulate() {
  if outdated "$run/report.json" "$asset" "$scene" "$souple"; then
    say "running $scene, $steps steps"
    "$souple" simulate "$scene" --steps "$steps" -o "$run"
  else
    say "the run is up to date"
  fi
}

# One frame as a picture. The camera stands still, so that the pictures can be compared.
render_frame() {
  xvfb-run -a f3d --quiet --output "$2" --resolution 720,540 --up=+Z --geometry-only \
    --camera-position=0.38,-0.66,0.34 --camera-focal-point=0.0,0,0.09 --camera-view-up=0,0,1 \
    --camera-view-angle=30 --bg-color=1,1,1 --ssao --fxaa --roughness=0.45 \
    --scalars=body --range=0,2 --colormap=0,1,0.42,0.36,0.5,1,1,1,1,0.45,0.72,1 "$1" >/dev/null 2>&1
}

# Frames are 3 steps of 0.01 s apart: falling, the first touch, the deepest, coming to rest.
render() {
  local frames=(0 2 4 5 6 7 9 11 14 20 40 80) pictures=() frame picture
  for program in xvfb-run f3d montage; do
    if ! command -v "$program" >/dev/null 2>&1; then
      say "no pictures: $program is missing (tools/install_packages.sh demo)"
      return
    fi
  done
  if ! outdated "$strip" "$run/report.json" tools/demo.sh; then
    say "the pictures are up to date"
    return
  fi
  say "rendering ${#frames[@]} frames"
  mkdir -p "$out/pictures"
  for frame in "${frames[@]}"; do
    picture=$(printf '%s/pictures/frame_%06d.png' "$out" "$frame")
    if ! render_frame "$(printf '%s/frames/scene_%06d.vtu' "$run" "$frame")" "$picture" ||
      [ ! -s "$picture" ]; then
      say "no pictures: f3d could not render frame $frame"
      return
    fi
    pictures+=(-label "$(awk -v f="$frame" 'BEGIN {printf "%.2f s", 0.03 * f}')" "$picture")
  done
  if ! montage -background white -fill '#333333' -pointsize 22 -tile 4x -geometry 480x360+4+4 \
    "${pictures[@]}" "$strip.part.png"; then
    rm -f "$strip.part.png"
    say "no strip: montage failed; the pictures are in $out/pictures"
    return
  fi
  mv "$strip.part.png" "$strip"
}

# The main numbers of the run, from its report.
summary() {
  printf '\nasset     %s (%s bytes)\n' "$asset" "$(stat -c %s "$asset")"
  printf 'frames    %s/scene.pvd (ParaView), %s/frames/*.vtu (f3d)\n' "$run" "$run"
  printf 'report    %s/report.json\n' "$run"
  if [ "$strip" -nt "$run/report.json" ]; then printf 'pictures  %s\n' "$strip"; fi
  awk '
    /"steps_per_s":/ {gsub(/[^0-9.e+-]/, "", $2); printf "speed     %.0f steps/s\n", $2}
    /"last_step":/ {last = 1}
    last && /"contact_count":/ {gsub(/,/, "", $2); printf "contacts  %s in the last step\n", $2}
    last && /"penetration_m":/ {
      gsub(/,/, "", $2)
      printf "at rest   penetration %.2g m at vertices", $2
    }
    last && /"surface_depth_m":/ {gsub(/,/, "", $2); printf ", %.2g m of the surface", $2}
    last && /"kinetic_energy_j":/ {gsub(/,/, "", $2); printf ", kinetic energy %.2g J\n", $2; exit}
  ' "$run/report.json"
}

mkdir -p "$out"
install_packages
build
bake
simulate
render
summary
