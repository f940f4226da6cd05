#!/usr/bin/env bash
# Runs the example of every `pac COMMAND --help`, in the order of `pac --help`, in one folder: later ones use the files of
# earlier ones. Usage: cli_examples.sh PAC
set -euo pipefail
pac=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin"
ln -s "$pac" "$folder/bin/pac"
PATH=$folder/bin:$PATH
cd "$folder"

# The model of one's own that the examples speak of: a pyramid.
cat >model.obj <<'OBJ'
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v 0 1.5 0
f 1 2 3 4
f 2 1 5
f 3 2 5
f 4 3 5
f 1 4 5
OBJ

# And a clip: four gray frames of 32x16.
{
  printf 'YUV4MPEG2 W32 H16 F25:1 C420jpeg\n'
  for _ in 1 2 3 4; do
    printf 'FRAME\n'
    head -c 768 /dev/zero | tr '\0' '\200'
  done
} >clip.y4m

n=0
while IFS= read -r name; do
  example=$(pac $name --help | sed -n '/^example:$/{n;s/^  //;p}')
  [ -n "$example" ] || { echo "pac $name --help has no example"; exit 1; }
  [ "$name" != demo ] || continue  # most of a minute: demo.sh runs the same
  echo "\$ $example"
  bash -c "$example" >output 2>&1 || { cat output; echo "failed: $example"; exit 1; }
  n=$((n + 1))
done < <(pac --help | sed -n 's/^  \([a-z][a-z0-9 ]*[a-z0-9]\)  .*/\1/p')
[ "$n" -ge 15 ] || { echo "only $n examples were found"; exit 1; }
echo "$n examples ran"
