#!/usr/bin/env bash
# Looks at the demo's output in headless Chromium. Usage: tests/browser/run.sh OUTDIR [PAC]
# Where chromium or node is missing: a failure with CI=true in the environment, else a message.
set -euo pipefail
out=$(realpath "$1")
pac=$(realpath "${2:-$(dirname "$0")/../../build/release/pac}")
here=$(cd "$(dirname "$0")" && pwd)
chromium=$(command -v chromium || command -v chromium-browser || true)
if [ -z "$chromium" ] || ! command -v node >/dev/null; then
  echo "chromium or node is not installed: the page was not looked at"
  [ "${CI:-}" != true ]
  exit
fi
jpegs=$(mktemp -d)
trap 'rm -rf "$jpegs"' EXIT
cd "$jpegs"
encode() { "$pac" jpeg encode "$out/figure2-h.png" --quiet -o "$1.jpg" "${@:2}" && "$pac" jpeg decode "$1.jpg" --quiet -o "$1.ppm"; }
encode 420 -q 15
encode 422 -q 75 --subsampling 422
encode 444 -q 95 --subsampling 444
encode gray -q 50 --subsampling gray
encode standard -q 30 --huffman standard --tables annex-k --restart 7
encode best -q 50 --effort best
"$pac" render cubes --width 61 --height 47 --samples 1 --quiet -o odd.png
"$pac" jpeg encode odd.png -q 60 --quiet -o odd.jpg
"$pac" jpeg decode odd.jpg --quiet -o odd.ppm
node "$here/check_demo.mjs" "$chromium" "$out" "$jpegs"
