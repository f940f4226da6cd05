#!/usr/bin/env bash
# Each public header compiles alone. Usage: check_headers.sh CXX SOURCE_DIR
set -euo pipefail
cd "$2"
export CXX=$1
compile_alone() {
  printf '#include "%s"\n' "$1" | "$CXX" -std=c++20 -fsyntax-only -Wall -Wextra -I. -x c++ - || { echo "$1 does not compile alone"; exit 1; }
}
export -f compile_alone
find base raster jpeg mpeg1 geomcodec sim -name '*.h' | sort | xargs -P "$(nproc)" -I{} bash -c 'compile_alone {}'
echo "every header compiles alone"
