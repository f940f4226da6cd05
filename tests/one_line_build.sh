#!/usr/bin/env bash
# The libraries without CMake: one compiler command line over every file that is not of an ISA. Usage: one_line_build.sh CXX
set -euo pipefail
cd "$(dirname "$0")/.."
program=$(mktemp)
trap 'rm -f "$program"' EXIT
"$1" -std=c++20 -O0 -ffp-contract=off -fno-rtti -I. tests/consumer/main.cpp \
  $(ls {base,base/kernels,raster,jpeg,mpeg1,geomcodec,sim}/*.cpp | grep -vE '_(sse41|avx2|neon)\.cpp$') -o "$program"
"$program"
