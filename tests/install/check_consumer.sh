#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs a build into a prefix of its own, builds tests/consumer against it as any application would,
# runs it on an asset and looks at what it linked.
# Usage: check_consumer.sh BUILD_DIR CONSUMER_SOURCE CHECK_LINK_LINE CXX CXX_FLAGS MAKER…
# MAKER… with the path of the asset appended makes that asset.
set -euo pipefail
build_dir=$1
consumer_source=$2
check_link_line=$3
compiler=$4
flags=$5
shift 5
source "$(dirname "$0")/step.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/souple consumer.XXXXXX")
trap 'rm -rf "$work"' EXIT

asset="$work/small asset.souple"
step "make a small asset" "$@" "$asset"
step "install into a prefix of its own" cmake --install "$build_dir" --prefix "$work/prefix"

# The prefix must not need the tree it came from: move it before it is used.
mv "$work/prefix" "$work/moved prefix"
step "configure the consumer" cmake -S "$consumer_source" -B "$work/build" -G Ninja \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" \
  -DCMAKE_PREFIX_PATH="$work/moved prefix" \
  -DCMAKE_DISABLE_FIND_PACKAGE_CGAL=ON -DCMAKE_DISABLE_FIND_PACKAGE_assimp=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON -DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON
step "build the consumer" cmake --build "$work/build" -j 1

echo "== run the consumer"
"$work/build/consumer" "$asset"
echo "== refuses what is no asset"
status=0
"$work/build/consumer" "$consumer_source/main.cpp" || status=$?
if [ "$status" -ne 3 ]; then
  echo "a text file should end with exit code 3, got $status"
  exit 1
fi
echo "== look at what it links"
"$check_link_line" "$work/build" consumer cgal gmp assimp suitesparse blas cli11 tbb

# Whoever asks for the runtime alone must not be asked for HDF5 or zstd, and finds every header it needs.
mkdir "$work/runtime"
cat >"$work/runtime/CMakeLists.txt" <<'TEXT'
cmake_minimum_required(VERSION 3.25)
project(runtime_consumer CXX)
find_package(souple 0.1 REQUIRED COMPONENTS runtime devices)
if(NOT TARGET souple::runtime OR NOT TARGET souple::devices OR TARGET souple::formats_read)
  message(FATAL_ERROR "component runtime must give souple::runtime and no more than it needs")
endif()
find_package(souple 99 QUIET)
if(souple_FOUND)
  message(FATAL_ERROR "version 99 must not be found")
endif()
add_library(all_headers OBJECT all_headers.cpp)
target_link_libraries(all_headers PRIVATE souple::runtime)
add_executable(device device.cpp)
target_link_libraries(device PRIVATE souple::devices)
TEXT
cat >"$work/runtime/device.cpp" <<'TEXT'
#include "runtime/haptics_net/udp_device.hpp"
int main() { return souple::DeviceLink::open(47100).ok() ? 0 : 1; }
TEXT
(cd "$work/moved prefix/include/souple" && find formats/core runtime -name '*.hpp' -not -path 'runtime/load/*' |
  LC_ALL=C sort | sed 's/.*/#include "&"/') >"$work/runtime/all_headers.cpp"
step "find the runtime without HDF5 and zstd" cmake -S "$work/runtime" -B "$work/runtime/build" -G Ninja \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_PREFIX_PATH="$work/moved prefix" \
  -DCMAKE_DISABLE_FIND_PACKAGE_HDF5=ON -DCMAKE_DISABLE_FIND_PACKAGE_zstd=ON
step "compile every installed header of the runtime" cmake --build "$work/runtime/build"
