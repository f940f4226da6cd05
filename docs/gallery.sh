#!/bin/sh
# Draws the pictures of docs/gallery.md again: docs/gallery.sh [PAC [FOLDER]], from the repository's root. Needs ffmpeg,
# which only cuts out, enlarges and places side by side.
set -eu
pac=${1:-build/release/pac}
out=${2:-docs/gallery}
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
mkdir -p "$out"

# side_by_side OUT FILTER PICTURE...: every picture through the filter, in one row.
side_by_side() {
  name=$1
  each=$2
  shift 2
  inputs=""
  graph=""
  row=""
  n=0
  for picture in "$@"; do
    inputs="$inputs -i $tmp/$picture.png"
    graph="$graph[$n]$each[p$n];"
    row="$row[p$n]"
    n=$((n + 1))
  done
  # shellcheck disable=SC2086
  ffmpeg -v error -y $inputs -filter_complex "$graph${row}hstack=inputs=$n" -frames:v 1 -compression_level 100 \
    "$out/$name.png"
}
draw() { # draw NAME SCENE OPTIONS...
  name=$1
  shift
  "$pac" render --quiet "$@" -o "$tmp/$name.png"
}

# A floor of squares, seen from low above; the texture repeats 14 times.
awk 'BEGIN {
  print "P3 64 64 255"
  for (y = 0; y < 64; ++y) for (x = 0; x < 64; ++x)
    print ((x < 32) == (y < 32)) ? "235 230 215" : (x % 8 < 1 || y % 8 < 1) ? "90 120 180" : "40 50 90"
}' > "$tmp/squares.ppm"
cat > "$tmp/floor.mtl" << END
newmtl floor
Ka 1 1 1
Kd 0 0 0
map_Kd squares.ppm
END
cat > "$tmp/floor.obj" << END
mtllib floor.mtl
usemtl floor
v -40 0 -40
v 40 0 -40
v 40 0 40
v -40 0 40
vt 0 0
vt 14 0
vt 14 14
vt 0 14
f 4/4 3/3 2/2 1/1
END

# Five balls on a floor: glossy, bumps, a map of gloss, holes, half transparent.
awk 'BEGIN {
  print "P2 128 64 255"
  for (y = 0; y < 64; ++y) for (x = 0; x < 128; ++x) {
    dx = x % 16 - 7.5; dy = y % 16 - 7.5; r = 1 - (dx * dx + dy * dy) / 49
    print int(r > 0 ? 255 * sqrt(r) : 0)
  }
}' > "$tmp/bumps.pgm"
awk 'BEGIN {
  print "P2 128 64 255"
  for (y = 0; y < 64; ++y) for (x = 0; x < 128; ++x) print ((x + y) % 16 < 8) ? 255 : 20
}' > "$tmp/stripes.pgm"
awk 'BEGIN {
  print "P2 128 64 255"
  for (y = 0; y < 64; ++y) for (x = 0; x < 128; ++x) {
    dx = x % 16 - 7.5; dy = y % 16 - 7.5
    print dx * dx + dy * dy < 30 ? 0 : 255
  }
}' > "$tmp/holes.pgm"
cat > "$tmp/balls.mtl" << END
newmtl ground
Kd 0.75 0.72 0.65
newmtl ball0
Kd 0.7 0.15 0.1
Ks 0.8 0.8 0.8
Ns 60
newmtl ball1
Kd 0.15 0.45 0.7
Ks 0.6 0.6 0.6
Ns 40
map_Bump -bm 1.5 bumps.pgm
newmtl ball2
Kd 0.1 0.4 0.2
Ks 1 1 1
Ns 25
map_Ks stripes.pgm
newmtl ball3
Kd 0.8 0.55 0.1
map_d holes.pgm
newmtl ball4
Kd 0.35 0.3 0.75
Ks 1 1 1
Ns 80
d 0.5
END
awk 'BEGIN {
  pi = 3.14159265358979
  print "mtllib balls.mtl\nusemtl ground"
  c = cos(0.610865); s = sin(0.610865)  # towards the camera that models without one get
  split("-6.2 -1.6 6.2 -1.6 6.2 1.9 -6.2 1.9", ground, " ")
  for (k = 1; k < 8; k += 2) printf "v %.6f 0 %.6f\n", c * ground[k] + s * ground[k + 1], c * ground[k + 1] - s * ground[k]
  print "vt 0 0\nvn 0 1 0\nf 4/1/1 3/1/1 2/1/1 1/1/1"
  v = 4; t = 1; n = 1; columns = 48; rows = 24
  for (ball = 0; ball < 5; ++ball) {
    print "usemtl ball" ball
    for (j = 0; j <= rows; ++j) for (i = 0; i <= columns; ++i) {
      a = 2 * pi * i / columns; b = pi * j / rows
      x = sin(b) * cos(a); y = cos(b); z = -sin(b) * sin(a)
      printf "v %.6f %.6f %.6f\nvt %.6f %.6f\nvn %.6f %.6f %.6f\n", x + c * 2.4 * (ball - 2), y + 1,
        z - s * 2.4 * (ball - 2), i / columns, 1 - j / rows, x, y, z
    }
    for (j = 0; j < rows; ++j) for (i = 0; i < columns; ++i) {
      p = j * (columns + 1) + i + 1; q = p + columns + 1
      printf "f"
      split(p " " q " " (q + 1) " " (p + 1), corner, " ")
      for (k = 1; k <= 4; ++k) printf " %d/%d/%d", v + corner[k], t + corner[k], n + corner[k]
      print ""
    }
    v += (rows + 1) * (columns + 1); t += (rows + 1) * (columns + 1); n += (rows + 1) * (columns + 1)
  }
}' > "$tmp/balls.obj"

small="--width 240 --height 180"
# shellcheck disable=SC2086
for scene in room pin letter cubes; do draw "$scene" "$scene" $small; done
side_by_side scenes null room pin letter cubes

for n in 1 4 16; do draw "samples$n" room --samples "$n" --texture off --width 256 --height 192; done
draw once room --samples 16 --shading-samples 1 --texture off --width 256 --height 192
side_by_side antialiasing "crop=64:64:40:96,scale=iw*4:-1:flags=neighbor" samples1 samples4 samples16 once

floor="$tmp/floor.obj --width 256 --height 144 --samples 1"
# shellcheck disable=SC2086
for filter in nearest bilinear trilinear; do draw "$filter" $floor --filter "$filter"; done
# shellcheck disable=SC2086
draw anisotropic $floor --anisotropy 8
side_by_side filtering "crop=110:60:73:46,scale=iw*3:-1:flags=neighbor" nearest bilinear trilinear anisotropic

draw balls "$tmp/balls.obj" --shading phong --lighting maps --width 1920 --height 640
ffmpeg -v error -y -i "$tmp/balls.png" -vf crop=900:220:510:225 -compression_level 100 "$out/materials.png"
for lighting in local maps full; do
  draw "$lighting" "$tmp/balls.obj" --shading phong --lighting "$lighting" --width 960 --height 320
done
for shading in flat gouraud phong; do
  draw "$shading" "$tmp/balls.obj" --shading "$shading" --lighting local --width 960 --height 320
done
side_by_side shading "crop=72:72:294:122,scale=iw*4:-1:flags=neighbor" flat gouraud phong
side_by_side shadows "crop=200:100:280:118,scale=iw*2:-1:flags=neighbor" local maps full

draw fog0 room $small
draw fog8 room $small --fog 12
draw fog4 room $small --fog 5
side_by_side fog null fog0 fog8 fog4
ls -l "$out"
