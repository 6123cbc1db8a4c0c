#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the C interface alone into a prefix of its own, builds examples/c against it as a program in C
# would (shared, static, and without cmake) and runs it on an asset.
# Usage: check_c_example.sh BUILD_DIR EXAMPLE_SOURCE CC CXX C_FLAGS MAKER…
# MAKER… with the path of the asset appended makes that asset.
set -euo pipefail
build_dir=$1
example=$2
c_compiler=$3
cxx_compiler=$4
flags=$5
shift 5
source "$(dirname "$0")/step.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/souple c example.XXXXXX")
trap 'rm -rf "$work"' EXIT

asset="$work/small asset.souple"
step "make a small asset" "$@" "$asset"
for component in c runtime; do
  step "install component $component" cmake --install "$build_dir" --prefix "$work/prefix" \
    --component "$component"
done
mv "$work/prefix" "$work/moved prefix"
prefix="$work/moved prefix"

# The shared library brings all it needs: a program in C finds neither Eigen nor HDF5 nor zstd.
step "configure with the shared library" cmake -S "$example" -B "$work/shared" -G Ninja \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="$c_compiler" -DCMAKE_C_FLAGS="$flags" \
  -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_HDF5=ON -DCMAKE_DISABLE_FIND_PACKAGE_zstd=ON
step "build with the shared library" cmake --build "$work/shared" -j 1
echo "== run with the shared library"
"$work/shared/touch" "$asset" | tee "$work/shared.txt"

echo "== refuses what is no asset"
status=0
"$work/shared/touch" "$example/touch.c" || status=$?
if [ "$status" -ne 1 ]; then
  echo "a text file should end with exit code 1, got $status"
  exit 1
fi

# Without cmake, and as strictly as C11 allows. Flags are words.
library=$(dirname "$(find "$prefix" -name libsouple.so -print -quit)")
# shellcheck disable=SC2086
step "build without cmake" "$c_compiler" $flags -std=c11 -Wall -Wextra -pedantic -Werror -I"$prefix/include" \
  "$example/touch.c" -o "$work/plain" -L"$library" -lsouple -Wl,-rpath,"$library"
"$work/plain" "$asset" >"$work/plain.txt"
cmp "$work/shared.txt" "$work/plain.txt"

for component in c_static load; do
  step "install component $component" cmake --install "$build_dir" --prefix "$prefix" \
    --component "$component"
done
mkdir "$work/static"
cat >"$work/static/CMakeLists.txt" <<TEXT
cmake_minimum_required(VERSION 3.25)
project(static_example LANGUAGES C CXX)
find_package(souple 0.1 REQUIRED COMPONENTS c_static)
add_executable(touch "$example/touch.c")
target_link_libraries(touch PRIVATE souple::c_static)
TEXT
step "configure with the static library" cmake -S "$work/static" -B "$work/static/build" -G Ninja \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="$c_compiler" -DCMAKE_CXX_COMPILER="$cxx_compiler" \
  -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" -DCMAKE_PREFIX_PATH="$prefix"
step "build with the static library" cmake --build "$work/static/build" -j 1
"$work/static/build/touch" "$asset" >"$work/static.txt"
cmp "$work/shared.txt" "$work/static.txt"
echo "the same output from the shared and the static library"
