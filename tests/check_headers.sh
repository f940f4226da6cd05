#!/usr/bin/env bash
# Each public header compiles alone. Usage: check_headers.sh CXX SOURCE_DIR
# X.h that X.cpp includes before anything else has been compiled alone there; the others are compiled here.
set -euo pipefail
cd "$2"
export CXX=$1
compile_alone() {
  printf '#include "%s"\n' "$1" | "$CXX" -std=c++20 -fsyntax-only -Wall -Wextra -I. -x c++ - || { echo "$1 does not compile alone"; exit 1; }
}
comes_first_in_its_source() {
  [ -f "${1%.h}.cpp" ] && [ "$(grep -m1 '^#include' "${1%.h}.cpp")" = "#include \"$1\"" ]
}
export -f compile_alone
find base raster jpeg mpeg1 geomcodec sim -name '*.h' | sort |
  while read -r header; do comes_first_in_its_source "$header" || echo "$header"; done | xargs -P "$(nproc)" -I{} bash -c 'compile_alone {}'
echo "every header compiles alone"
