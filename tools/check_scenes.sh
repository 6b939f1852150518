#!/usr/bin/env bash
# Runs the collision scenes at their full size and holds every frame against the independent checker:
# nothing may cross, and nothing be more than 0.1 mm inside a collider. `garment` is run and told, not judged:
# see "Limits" in README.md.
set -euo pipefail

weft=${1:?"usage: check_scenes.sh path/to/weft"}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

for scene in paper/fig6_ball paper/fig6_ball_real drape_sphere drape_box contact/rotating_ball self_fold two_layers; do
  "$weft" run "$scene" --out "$out/$scene"
  "$weft" verify "$out/$scene"
done
"$weft" run garment --frames 30 --out "$out/garment"
"$weft" verify "$out/garment" || echo "garment: told, not judged"
