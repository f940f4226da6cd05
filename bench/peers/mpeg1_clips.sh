#!/bin/sh
# Clips for mpeg1_peers, 30 frames each, 640x480 and 1280x720:  mpeg1_clips.sh FOLDER [VIDEO...]
# From ffmpeg's generators: a zoom into a fractal, a test card with moving parts, cells that live and die behind a still
# frame, a slow gradient. From each VIDEO (Debian's opencv-doc has vtest.avi): its first frames, scaled.
set -eu
[ $# -ge 1 ] || { sed -n 2,4p "$0"; exit 0; }
folder=$1
shift
mkdir -p "$folder"
make() {  # name size input-options...
  name=$1 size=$2
  shift 2
  ffmpeg -v error -y "$@" -frames:v 30 -vf "scale=$size:flags=lanczos,fps=30,format=yuv420p" -f yuv4mpegpipe \
    "$folder/$name-$size.y4m"
}
for size in 640x480 1280x720; do
  make fractal $size -f lavfi -i "mandelbrot=size=$size:rate=30:end_scale=0.02:end_pts=60"
  make card $size -f lavfi -i "testsrc2=size=$size:rate=30"
  make cells $size -f lavfi -i "life=size=160x120:rate=30:seed=1:ratio=0.2:mold=10:life_color=#C83232:death_color=#101040,pad=320:240:80:60:gray"
  make gradient $size -f lavfi -i "gradients=size=$size:rate=30:seed=1:speed=0.01"
  for video in "$@"; do
    make "$(basename "${video%.*}")" $size -i "$video"
  done
done
