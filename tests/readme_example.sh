#!/usr/bin/env bash
# The README's C++ example compiles against the release build and prints three frames.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
awk '/^```cpp/ {inside = 1; next} /^```/ {inside = 0} inside' README.md >"$work/example.cpp"
libraries=()
for library in sim raster geomcodec mpeg1 jpeg base; do libraries+=("build/release/libpac_$library.a"); done
g++ -std=c++20 -O1 -Wall -Wextra -I. "$work/example.cpp" "${libraries[@]}" -pthread -o "$work/example"
"$work/example" | tee "$work/output"
[ "$(grep -c 'bytes' "$work/output")" -eq 3 ]
