#!/usr/bin/env bash
# Runs the collision scenes at their full size and checks every frame with the independent checker. Errors are
# intersections in any frame, passages within any step, and depths of more than 0.1 mm inside a collider
# (a hundredth of that in the scenes of contact/, which use the CCD fail-safe). `garment` is run and reported only: see
# "Limits" in README.md.
set -euo pipefail

weft=${1:?"usage: check_scenes.sh path/to/weft"}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# check SCENE TOLERANCE [FRAMES]: all frames without FRAMES
check() {
  "$weft" run "$1" --out "$out/$1" ${3:+--frames "$3"}
  "$weft" verify "$out/$1" --tolerance "$2"
  grep -q '"passages": 0,' "$out/$1/report.json" || { echo "$1: something passed through something within a step"; exit 1; }
}

for scene in paper/fig6_ball paper/fig6_ball_real drape_sphere drape_box contact/rotating_ball self_fold two_layers; do
  check "$scene" 0.0001
done

for scene in needle knife_edge bullet wall ball_and_floor crossed_strips table_cloth crumple squeeze garment_body self_crossing_body; do
  check "contact/$scene" 0.000001
done
# The beginning of long scenes.
check contact/folded_fall 0.000001 100
check contact/funnel 0.000001 120
check contact/twisted_tube 0.000001 100
check contact/stack 0.000001 15

# Flat panels that are sewn on a walking body.
check garments/sewn_dress 0.000001 45
check garments/elastic_waist 0.000001 30

# A skinned body and cloth that holds on to it. A run of it that is killed five times ends with the same bytes.
check garments/walk 0.000001 150
"$weft" run garments/walk --frames 90 --out "$out/whole"
arguments=(garments/walk --frames 90 --out "$out/killed" --checkpoint-every 5)
for seconds in 2 3 4 5 6; do
  "$weft" run "${arguments[@]}" &
  sleep "$seconds"
  kill -KILL $! 2> /dev/null || true
  wait $! || true  # timeout would not wait for the process that it kills
  [ -e "$out/killed/unfinished/checkpoint" ] && arguments=(--resume "$out/killed")
done
"$weft" run "${arguments[@]}"
for file in animation.glb skirt.pc2 shirt.pc2; do
  cmp "$out/whole/$file" "$out/killed/$file"
done

"$weft" run garment --frames 30 --out "$out/garment"
"$weft" verify "$out/garment" || echo "garment: reported only"

# Random cloths on random bodies.
"$weft" bench random --contact --scenes 20 --out "$out/random"

# Typical input: garments that intersect the figure at the start, in several pieces, in another unit.
"$weft" bench garments --garments shirt,dress,scarf --motions kick --frames 20 --cell 0.012 --out "$out/garments"
