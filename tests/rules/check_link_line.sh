#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fails if a program was compiled or linked with a package it must do without. Looks at the commands
# that Ninja would run for the target and all it depends on, at the libraries the program asks for, and
# at the symbols that static libraries leave open.
# Usage: check_link_line.sh BUILD_DIR TARGET PACKAGE…   (names of package_pattern below)
set -euo pipefail

# The basenames of libraries (without lib and suffix), and folders of headers, that betray a package.
package_pattern() {
  case "$1" in
    hdf5) echo 'hdf5[a-z_0-9]*' ;;
    zstd) echo 'zstd' ;;
    cgal) echo 'cgal[a-z_0-9]*' ;;
    gmp) echo '(gmp|gmpxx|mpfr)' ;;
    assimp) echo 'assimp' ;;
    suitesparse) echo '(cholmod|suitesparse[a-z]*|amd|camd|colamd|ccolamd|umfpack|metis|spqr)' ;;
    blas) echo '(openblas[a-z0-9]*|blas|lapack|lapacke|cblas)' ;;
    tbb) echo 'tbb[a-z0-9]*' ;;
    cli11) echo 'cli11' ;;
    *) echo "check_link_line: unknown package $1" >&2; return 1 ;;
  esac
}

package_symbols() {
  case "$1" in
    hdf5) echo '(H5[A-Z][a-z]|H5[A-Z]+open)' ;;
    zstd) echo 'ZSTD_' ;;
    cgal) echo '_ZNK?4CGAL' ;;
    gmp) echo '(__gmp|mpfr_)' ;;
    assimp) echo '(_ZNK?6Assimp|aiImport)' ;;
    suitesparse) echo '(cholmod_|SuiteSparse_|amd_l?_?order)' ;;
    blas) echo '(cblas_|openblas_|d(gemm|syrk|potrf|trsm)_$)' ;;
    tbb) echo '_ZNK?3tbb' ;;
    cli11) echo '_ZNK?3CLI' ;;
  esac
}

build_dir=$1
target=$2
shift 2
failures=0
newline=$'\n'

fail() {
  echo "$target: $1: $(head -n 5 <<<"$2" | tr '\n' ' ')"
  failures=$((failures + 1))
}

# The words of all commands behind the target, one a line.
command_words=$(ninja -C "$build_dir" -t commands "$target" | tr -s ' \t"' '\n' | LC_ALL=C sort -u)
if [ -z "$command_words" ]; then
  echo "check_link_line: $build_dir has no commands for $target" >&2
  exit 1
fi
# Libraries without prefix and suffix, and folders of headers.
words=$(sed -n \
  -e 's/^-l\(.*\)$/library \1/p' \
  -e 's#^\(.*/\)\{0,1\}lib\([^/]*\)\.\(a\|so\)[.0-9]*$#library \2#p' \
  -e 's#^-\(I\|isystem\)\{0,1\}\(/.*include.*\)$#folder \2#p' <<<"$command_words")
# The headers that the objects of the target were really compiled with (known once they are built);
# Eigen has files named like the packages it wraps.
headers=$({
  grep -E '\.o$' <<<"$command_words" || true
  echo '---'
  ninja -C "$build_dir" -t deps 2>/dev/null || true
} | awk '$0 == "---" {in_deps = 1; next} !in_deps {objects[$1 ":"] = 1; next}
         /^[^ ]/ {wanted = $1 in objects; next}
         wanted && NF == 1 && !/\/Eigen\// {print "folder " $1}' | LC_ALL=C sort -u)

program=$build_dir/$(ninja -C "$build_dir" -t query "$target" | awk 'NR == 2 {is_alias = $2 == "phony"} NR == 3 && is_alias {print $1}')
if [ ! -f "$program" ]; then program=$build_dir/$target; fi
# Its own wishes only: what Debian's HDF5 drags in behind it is not ours.
needed=''
if [ -f "$program" ]; then needed=$(objdump -p "$program" | awk '$1 == "NEEDED" {print $2}'); fi

open_symbols=''
while IFS= read -r archive; do
  if [ -f "$build_dir/$archive" ]; then
    open_symbols+=$(nm --undefined-only "$build_dir/$archive" 2>/dev/null | awk 'NF == 2 {print $2}')$newline
  fi
done < <(grep -E '^[^/].*\.a$' <<<"$command_words" || true)

for package in "$@"; do
  pattern=$(package_pattern "$package")
  if found=$(grep -iE "^library $pattern(-[0-9.]+)?\$" <<<"$words"); then
    fail "the link line names $package" "$found"
  fi
  if found=$(grep -iE "^folder .*/$pattern(\\.h|/|\$)" <<<"$words$newline$headers"); then
    fail "compiled with the headers of $package" "$found"
  fi
  if found=$(grep -iE "^lib$pattern([-_.][^/]*)?\.so" <<<"$needed"); then
    fail "the program asks for $package" "$found"
  fi
  if found=$(grep -E "^$(package_symbols "$package")" <<<"$open_symbols"); then
    fail "its libraries call $package" "$found"
  fi
done

if [ "$failures" -gt 0 ]; then exit 1; fi
echo "$target has nothing of: $*"
