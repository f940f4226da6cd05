#!/usr/bin/env bash
# jsmpeg, the JavaScript decoder that browsers play MPEG-1 with, shows our streams as our decoder does: every frame, at
# more than 50 dB. Usage: tests/jsmpeg/run.sh [PAC]
# The package (npm's @cycjimmy/jsmpeg-player) is fetched by npm. Where ffmpeg or node is missing: a failure with CI=true in
# the environment, else a message. npm, which Debian's nodejs lacks, and a registry are not to be had everywhere: without
# them a message says so.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
pac=$(realpath "${1:-$here/../../build/release/pac}")
if ! command -v ffmpeg >/dev/null || ! command -v node >/dev/null; then
  echo "ffmpeg or node is not installed: jsmpeg was not asked"
  [ "${CI:-}" != true ]
  exit
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
if ! command -v npm >/dev/null || ! npm install --silent --no-audit --no-fund @cycjimmy/jsmpeg-player@6.1.2 >npm.log 2>&1; then
  echo "npm or its package @cycjimmy/jsmpeg-player is not to be had: jsmpeg was not asked"
  exit
fi

# compare NAME ENCODER_OPTION...: of the clip NAME.y4m.
compare() {
  "$pac" mpeg1 encode "$1.y4m" --quiet -o ours.m1v "${@:2}"
  "$pac" mpeg1 decode ours.m1v --quiet -o ours.y4m
  node "$here/../../bench/peers/jsmpeg_decode.mjs" ours.m1v theirs.y4m >/dev/null
  echo "$*:"
  node "$here/least_psnr.mjs" ours.y4m theirs.y4m 50
}
clip() { ffmpeg -v error -y -f lavfi -i "$2" -frames:v 30 -pix_fmt yuv420p "$1.y4m"; }
clip bars testsrc2=size=176x144:rate=25
clip fractal mandelbrot=size=320x240:rate=25
for quantizer in 2 4 8 16; do
  compare bars --quantizer-scale "$quantizer"
  compare fractal --quantizer-scale "$quantizer" --effort fast
done
compare fractal --quantizer-scale 3 --effort best
