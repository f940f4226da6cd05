#!/usr/bin/env bash
# The same 64-bit hash of the pixels from every build, instruction set and thread count that exists here.
set -euo pipefail
cd "$(dirname "$0")/.."
reference=""
check() {
  local hash
  hash=$("$@" --json | grep -oE '"hash": *"[0-9a-f]+"')
  [ -n "$reference" ] || reference=$hash
  printf '%s  %s\n' "$hash" "$*"
  [ "$hash" = "$reference" ]
}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for scene in room pin letter cubes; do
  reference=""
  common=(render "$scene" --width 96 --height 96 --samples 4 -o "$out/a.png")
  for isa in scalar sse41 avx2; do
    for threads in 1 2; do check build/release/pac "${common[@]}" --isa $isa --threads $threads; done
  done
  check build/clang/pac "${common[@]}"
  check build/scalar/pac "${common[@]}"
  check build/asan/pac "${common[@]}"
  check qemu-aarch64-static -L /usr/aarch64-linux-gnu build/aarch64/pac "${common[@]}"
done
