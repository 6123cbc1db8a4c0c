#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the Debian packages that the named sets need and that are missing; does nothing, and touches
# no network, when all are there. Usage: tools/install_packages.sh [--list] [build|test|demo|lint|all]…
set -euo pipefail

# The sets. Debian 12 names; --no-install-recommends, so what is needed is named here.
packages_of() {
  case "$1" in
    build)
      echo g++ cmake ninja-build pkg-config git \
        libeigen3-dev libcgal-dev libassimp-dev libsuitesparse-dev libopenblas-dev \
        libhdf5-dev libzstd-dev libxxhash-dev zlib1g-dev \
        libcli11-dev nlohmann-json3-dev libtomlplusplus-dev libtbb-dev ;;
    test) echo libgtest-dev libbenchmark-dev libexpat1-dev hdf5-tools python3-h5py time ;;
    # montage writes labels in Helvetica, which imagemagick alone does not bring.
    demo) echo f3d xvfb xauth imagemagick fonts-urw-base35 ;;
    lint) echo clang-format clang-tidy shellcheck ;;
    all) packages_of build; packages_of test; packages_of demo; packages_of lint ;;
    *) return 1 ;;
  esac
}

say() { printf 'install_packages: %s\n' "$*" >&2; }

usage() {
  cat <<TEXT
Usage: tools/install_packages.sh [--list] [build|test|demo|lint|all]…
Installs the missing packages of the named sets (default: build). --list prints them instead.
TEXT
}

is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null || true)" = installed ]
}

# Runs a command as root, or explains what to do.
as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null 2>&1; then
    sudo -- "$@"
  else
    say "these packages are missing and installing them needs root: ${missing[*]}"
    say "run this as root, install sudo, or ask your administrator for:"
    say "  apt-get install --no-install-recommends ${missing[*]}"
    exit 1
  fi
}

apt_install() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
    -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300 -q "$@"
}

# True if apt knows a candidate for every missing package: then the lists need no update first.
lists_know_all() {
  local package
  for package in "${missing[@]}"; do
    apt-cache show --no-all-versions "$package" >/dev/null 2>&1 || return 1
  done
}

list_only=0
sets=()
for argument in "$@"; do
  case "$argument" in
    --list) list_only=1 ;;
    -h | --help) usage; exit 0 ;;
    *)
      packages_of "$argument" >/dev/null || { say "unknown set: $argument"; usage >&2; exit 1; }
      sets+=("$argument") ;;
  esac
done
[ "${#sets[@]}" -gt 0 ] || sets=(build)

wanted=()
for set_name in "${sets[@]}"; do
  read -r -a names <<<"$(packages_of "$set_name" | tr '\n' ' ')"
  wanted+=("${names[@]}")
done
if [ "$list_only" -eq 1 ]; then printf '%s\n' "${wanted[@]}"; exit 0; fi

if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
  say "this is not a Debian system; install the equivalents of these yourself: ${wanted[*]}"
  exit 1
fi

missing=()
for package in "${wanted[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [ "${#missing[@]}" -eq 0 ]; then exit 0; fi

say "installing: ${missing[*]}"
if ! lists_know_all; then as_root apt-get update -q; fi
if ! apt_install "${missing[@]}"; then
  say "retrying with fresh package lists"
  as_root apt-get update -q
  apt_install "${missing[@]}"
fi

for package in "${missing[@]}"; do
  is_installed "$package" || { say "apt-get did not install $package"; exit 1; }
done
