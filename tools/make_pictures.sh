#!/usr/bin/env bash
# Makes the pictures of the README and of docs/ (in docs/images) from the shipped scenes.
#   tools/make_pictures.sh PROGRAM FOLDER
set -euo pipefail
weft=$1
images=$2
mkdir -p "$images"

# The paper's Figures 1 and 2: springs of the basic and of the simplified model.
for model in basic simplified; do
  "$weft" render paper/fig3_horizontal --frame 0 --springs --camera 0,70,0.9 --size 640x480 --out "$images/$model.jpg" \
    --set 'cloth[0].grid.cells=[5,4]' --set "cloth[0].model=$model"
done

# Figures 3 to 6, each at the start and twice on the way.
"$weft" render paper/fig3_horizontal --frames 0,22,45 --columns 3 --size 480x360 --out "$images/fig3_horizontal.jpg"
"$weft" render paper/fig4_vertical --frames 0,30,90 --columns 3 --size 480x360 --out "$images/fig4_vertical.jpg"
"$weft" render paper/fig5_falling --frames 0,20,40 --columns 3 --size 480x360 --out "$images/fig5_falling.jpg"
"$weft" render paper/fig6_ball --frames 0,26,120 --columns 3 --size 480x360 --out "$images/fig6_ball.jpg"

# Real fabric with the default integrator.
"$weft" render fabrics/drape --camera 0,16,1.05 --size 1280x480 --out "$images/fabrics.jpg"
"$weft" render fabrics/crease --frames 85,210 --columns 2 --camera 10,20 --look-at 0.01,-0.005,0.015 --distance 0.68 --size 640x400 \
  --out "$images/crease.jpg"
"$weft" render garment_hung --frames 0,30,90 --columns 3 --size 480x360 --out "$images/garment_hung.jpg"

# Flat panels that become a dress.
"$weft" render garments/sewn_dress --frames 0,10,24,170 --columns 4 --size 400x560 --look-at 0,0.95,0.1 --distance 3 \
  --out "$images/sewn_dress.jpg"

# Elastic: a skirt that is shorter at rest around the waist.
"$weft" render garments/elastic_waist --frames 0,100,200 --columns 3 --size 400x560 --look-at 0,0.95,0.1 --distance 3 \
  --out "$images/elastic_waist.jpg"

# Gas in closed cloth.
"$weft" render pressure/cushion --frame 25 --camera 25,8 --look-at 0,0.2,0 --distance 1.2 --size 960x540 --out "$images/pressure.jpg"

# Cloth that tears.
"$weft" render tearing/ball --frames 34,42,50,119 --columns 4 --camera 30,38 --look-at 0,0.8,0 --distance 2.2 --size 400x360 --out "$images/tearing.jpg"

# Values of cloth in colours.
"$weft" render paper/fig6_ball --frame 60 --color strain --size 960x540 --out "$images/strain.jpg"

# Cloth on a rotating ball, as a video.
"$weft" render contact/rotating_ball --every 3 --size 640x400 --camera 20,22 --out "$images/weft.webp"

# Typical user garments on a figure: input, repaired start, during the motion; then the README's first picture.
wardrobe=$(mktemp -d)
trap 'rm -rf "$wardrobe"' EXIT
"$(dirname "$weft")/../tools/make_wardrobe" "$wardrobe" > "$wardrobe/list"
view=(--size 480x560 --camera 25,8,1.35)
as_it_is=(--set solver.untangle=false --set solver.crossed_start=allow)
"$weft" render "$wardrobe/shirt_walk.toml" --frame 0 "${view[@]}" "${as_it_is[@]}" --out "$wardrobe/start.png"
"$weft" render "$wardrobe/shirt_walk.toml" --frames 0,30 "${view[@]}" --columns 2 --out "$wardrobe/walk.png"
ffmpeg -v error -y -i "$wardrobe/start.png" -i "$wardrobe/walk.png" -filter_complex hstack -q:v 3 "$images/garment_start.jpg"
"$weft" run "$wardrobe/dress_kick.toml" --no-pc2 --out "$wardrobe/dress" > /dev/null
view=(--camera 30,8,1.3)
"$weft" render "$wardrobe/dress" --frames 0,20,31,40 --columns 4 --size 400x520 "${view[@]}" --out "$images/dress_kick.jpg"
"$weft" render "$wardrobe/dress" --size 480x560 "${view[@]}" --out "$images/dress_kick.webp"

# The examples of docs/manual/cpp.md.
films=$(mktemp -d)
trap 'rm -rf "$wardrobe" "$films"' EXIT
"$(dirname "$weft")/../tools/film_examples" "$films" > /dev/null
film() { "$weft" render "$films/$1.glb" --frames "$2" --columns 4 --size 320x260 "${@:3}" --out "$images/example_$1.jpg"; }
film hello_cloth 15,40,70,119
film gripper 15,75,130,239
film cape 30,60,90,119 --camera 150,8
film game_loop 20,60,90,118
film contact_forces 5,20,60,239
film batch_of_worlds 5,15,25,59 --camera 25,15,1.2
film rollback 10,25,40,59
