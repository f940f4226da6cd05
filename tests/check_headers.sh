#!/usr/bin/env bash
# Each public header compiles alone. Usage: check_headers.sh CXX SOURCE_DIR
set -euo pipefail
cd "$2"
headers=$(find base raster jpeg mpeg1 geomcodec sim -name '*.h' | sort)
for header in $headers; do printf '#include "%s"\n' "$header" | "$1" -std=c++20 -fsyntax-only -Wall -Wextra -I. -x c++ - || { echo "$header does not compile alone"; exit 1; }; done
echo "$(wc -w <<<"$headers") headers compile alone"
