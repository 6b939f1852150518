#!/usr/bin/env bash
# Makes a video of every scene of contact/ for visual checks: nothing should stick, jitter or snap.
#   tools/make_videos.sh PROGRAM FOLDER
set -euo pipefail
weft=$1
videos=$2
mkdir -p "$videos"

# video SCENE [OPTIONS]
video() {
  local scene=$1
  shift
  "$weft" render "contact/$scene" --size 640x400 --every 2 --out "$videos/$scene.mp4" "$@"
}

for scene in needle knife_edge crossed_strips bullet wall funnel table_cloth squeeze garment_body self_crossing_body \
             folded_fall ball_and_floor rotating_ball; do
  video "$scene"
done
video crumple --camera 25,62
# Long scenes: the beginning only.
video stack --frame 40
video twisted_tube --frame 300
