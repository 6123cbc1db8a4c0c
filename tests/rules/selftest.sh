#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Proves that the rule checkers refuse what they must: each breach is planted in a small tree of its own.
# Usage: selftest.sh [CXX_COMPILER]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
compiler=${1:-c++}
work=$(mktemp -d "${TMPDIR:-/tmp}/souple rules.XXXXXX")
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

# expect STATUS TEXT COMMAND…: the command ends with that status and its output holds the text.
expect() {
  local status=$1 text=$2 output actual=0
  shift 2
  output=$("$@" 2>&1) || actual=$?
  if [ "$actual" -eq "$status" ] && grep -qF -- "$text" <<<"$output"; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    printf 'expected status %s and "%s" from: %s\ngot status %s and:\n%s\n' \
      "$status" "$text" "$*" "$actual" "$output"
  fi
}

# A tree of one harmless file in each kind of folder.
fresh_tree() {
  rm -rf "$work/tree"
  mkdir -p "$work/tree"/{formats/core,formats/read,runtime/fem,runtime/load,tools/surface,tools/volume,tests}
  cd "$work/tree"
  printf '// SPDX-License-Identifier: MIT\n#include <vector>\n' >formats/core/mesh.hpp
  printf '// SPDX-License-Identifier: MIT\n#include "formats/core/mesh.hpp"\n' >runtime/fem/model.hpp
  printf '// SPDX-License-Identifier: MIT\n#include "formats/core/mesh.hpp"\n' >runtime/load/load.hpp
  printf '// SPDX-License-Identifier: GPL-3.0-or-later\n' >tools/surface/import_surface.hpp
  printf '// SPDX-License-Identifier: GPL-3.0-or-later\n' >tools/surface/soup.hpp
  printf 'text\n' | tee LICENSE formats/LICENSE runtime/LICENSE >tools/LICENSE
}

# breach FILE LINE MESSAGE: adding the line to the file breaks the include rules.
breach() {
  fresh_tree
  printf '%s\n' "$2" >>"$1"
  expect 1 "$3" "$here/check_includes.sh" "$work/tree"
}

fresh_tree
expect 0 'includes keep the rules' "$here/check_includes.sh" "$work/tree"
expect 0 'name the licence' "$here/check_licences.sh" "$work/tree"
breach formats/core/mesh.hpp '#include <Eigen/Core>' 'formats/core must not include <Eigen/Core>'
breach formats/core/mesh.hpp '#include "runtime/fem/model.hpp"' 'must not include runtime/fem/model.hpp'
breach formats/read/a.hpp '#include <hdf5.h>' 'belongs into a .cpp'
breach runtime/fem/model.cpp '  #  include <hdf5.h>' 'runtime must not include <hdf5.h>'
breach runtime/fem/model.cpp '#include <CGAL/Mesh_3.h>' 'runtime must not include <CGAL/Mesh_3.h>'
breach runtime/fem/model.cpp '#include "runtime/load/load.hpp"' 'must not include runtime/load/load.hpp'
breach tools/surface/a.cpp '#include <CLI/CLI.hpp>' 'must not include <CLI/CLI.hpp>'
breach tools/surface/a.hpp '#include <CGAL/Surface_mesh.h>' 'belongs into a .cpp'
breach tools/volume/a.cpp '#include "tools/surface/soup.hpp"' 'must not include tools/surface/soup.hpp'
breach tools/surface/a.cpp '#include "soup.hpp"' 'is not a file of the tree'
breach tools/surface/a.cpp '#include <surprise.h>' 'belongs to no package'
fresh_tree
mkdir -p tools/commands
printf '#include "tools/surface/soup.hpp"\n' >tools/commands/bake.cpp
expect 1 'is internal to tools/surface' "$here/check_includes.sh" "$work/tree"
fresh_tree
printf '// SPDX-License-Identifier: GPL-3.0-or-later\n' >runtime/fem/stolen.cpp
expect 1 'runtime/fem/stolen.cpp' "$here/check_licences.sh" "$work/tree"
fresh_tree
rm runtime/LICENSE
expect 1 'runtime/LICENSE is missing' "$here/check_licences.sh" "$work/tree"

# A program that links zstd through a static library, and one that does without.
mkdir -p "$work/links"
cd "$work/links"
cat >CMakeLists.txt <<'TEXT'
cmake_minimum_required(VERSION 3.25)
project(links CXX)
add_library(packer STATIC packer.cpp)
target_link_libraries(packer PRIVATE zstd)
add_executable(with main.cpp)
target_link_libraries(with packer)
add_executable(without empty.cpp)
TEXT
printf '#include <zstd.h>\nunsigned version() { return ZSTD_versionNumber(); }\n' >packer.cpp
printf 'unsigned version();\nint main() { return version() == 0; }\n' >main.cpp
printf 'int main() { return 0; }\n' >empty.cpp
cmake -S . -B build -G Ninja -DCMAKE_CXX_COMPILER="$compiler" >configure.log
cmake --build build >build.log
expect 0 'without has nothing of: zstd' "$here/check_link_line.sh" build without zstd hdf5 cgal
expect 0 'with has nothing of: hdf5' "$here/check_link_line.sh" build with hdf5 cgal gmp blas tbb cli11
expect 1 'the link line names zstd' "$here/check_link_line.sh" build with zstd
expect 1 'compiled with the headers of zstd' "$here/check_link_line.sh" build with zstd
expect 1 'the program asks for zstd' "$here/check_link_line.sh" build with zstd
expect 1 'its libraries call zstd' "$here/check_link_line.sh" build with zstd

echo "$passed checks of the checkers passed, $failed failed"
[ "$failed" -eq 0 ]
