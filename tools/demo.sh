#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds the command, bakes a liver, drops it on a ball and a floor, lifts it by
# its tip with forceps in a hand that feels it, makes pictures of both. Does again only what changed.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

usage() {
  cat <<'TEXT'
Usage: tools/demo.sh [--no-install] [--again]
  --no-install  do not look for missing packages
  --again       bake, run and render even if nothing changed
Results: build/demo (the asset; frames and report.json of both scenes; liver_drop.png, forceps.png).
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
recipe=assets/recipes/liver.toml
surface=assets/surfaces/liver-smooth.obj
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

# simulate NAME STEPS: the scene of that name.
simulate() {
  local scene=assets/scenes/$1.toml run=$out/$1
  if outdated "$run/report.json" "$asset" "$scene" "$souple"; then
    say "running $scene, $2 steps"
    "$souple" simulate "$scene" --steps "$2" -o "$run"
  else
    say "the run of $1 is up to date"
  fi
}

# render_frame FRAME PICTURE CAMERA...: the camera stands still, so that the pictures can be compared.
render_frame() {
  local frame=$1 picture=$2
  shift 2
  xvfb-run -a f3d --quiet --output "$picture" --resolution 720,540 --up=+Z --geometry-only \
    --camera-view-up=0,0,1 --camera-view-angle=30 --bg-color=1,1,1 --ssao --fxaa --roughness=0.45 \
    --scalars=body --colormap=0,1,0.42,0.36,0.5,1,1,1,1,0.45,0.72,1 "$@" "$frame" >/dev/null 2>&1
}

# render NAME "FRAMES" CAMERA...: one strip of frames, 0.03 s apart.
render() {
  local name=$1 frames=$2 run=$out/$1 strip=$out/$1.png pictures=() frame picture program
  shift 2
  for program in xvfb-run f3d montage; do
    if ! command -v "$program" >/dev/null 2>&1; then
      say "no pictures: $program is missing (tools/install_packages.sh demo)"
      return
    fi
  done
  if ! outdated "$strip" "$run/report.json" tools/demo.sh; then
    say "the pictures of $name are up to date"
    return
  fi
  say "rendering frames of $name"
  mkdir -p "$run/pictures"
  for frame in $frames; do
    picture=$(printf '%s/pictures/frame_%06d.png' "$run" "$frame")
    if ! render_frame "$(printf '%s/frames/scene_%06d.vtu' "$run" "$frame")" "$picture" "$@" ||
      [ ! -s "$picture" ]; then
      say "no pictures: f3d could not render frame $frame of $name"
      return
    fi
    pictures+=(-label "$(awk -v f="$frame" 'BEGIN {printf "%.2f s", 0.03 * f}')" "$picture")
  done
  if ! montage -background white -fill '#333333' -pointsize 22 -tile 4x -geometry 480x360+4+4 \
    "${pictures[@]}" "$strip.part.png"; then
    rm -f "$strip.part.png"
    say "no strip: montage failed; the pictures are in $run/pictures"
    return
  fi
  mv "$strip.part.png" "$strip"
}

# Where the results of a scene are.
files() {
  local run=$out/$1 strip=$out/$1.png
  printf '\nframes    %s/scene.pvd (ParaView), %s/frames/*.vtu (f3d)\n' "$run" "$run"
  printf 'report    %s/report.json\n' "$run"
  if [ "$strip" -nt "$run/report.json" ]; then printf 'pictures  %s\n' "$strip"; fi
}

# The main numbers of the drop, from its report.
drop_summary() {
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
  ' "$out/liver_drop/report.json"
}

# What the hand felt, from the report of the forceps.
forceps_summary() {
  awk '
    function number() {gsub(/[^0-9.e+-]/, "", $2); return $2}
    /"probes":/ {inside = 1}
    inside && /"ticks":/ && !ticks {ticks = number()}
    inside && /"sweeps":/ && !sweeps {sweeps = number()}
    inside && /"contacts":/ && !contacts {contacts = number()}
    inside && /"largest_force_n":/ {force = number()}
    inside && /"largest_step_n":/ {step = number()}
    END {
      printf "the hand  %d ticks of %.1f sweeps; force up to %.1f N, steps of it up to %.2g N\n",
             ticks, sweeps / ticks, force, step
    }
  ' "$out/forceps/report.json"
}

mkdir -p "$out"
install_packages
build
bake
simulate liver_drop 240
render liver_drop "0 2 4 5 6 7 9 11 14 20 40 80" --range=0,2 \
  --camera-position=0.38,-0.66,0.34 --camera-focal-point=0.0,0,0.09
simulate forceps 360
render forceps "0 20 36 42 50 66 80 110" --range=0,3 \
  --camera-position=0.36,-0.78,0.2 --camera-focal-point=0.04,0,0.03
printf '\nasset     %s (%s bytes)\n' "$asset" "$(stat -c %s "$asset")"
files liver_drop
drop_summary
files forceps
forceps_summary
