#!/usr/bin/env bash
# Makes the pictures of the shipped scenes, which the window's gallery shows (scenes/NAME.jpg beside scenes/NAME.toml).
#   tools/make_gallery.sh PROGRAM [SCENE …]      all scenes without names
set -euo pipefail
weft=$1
shift
scenes=$(cd "$(dirname "$0")/../scenes" && pwd)
cd "$scenes"
if [ $# -eq 0 ]; then
  mapfile -t names < <(find . -name '*.toml' | sed 's|^\./||; s|\.toml$||' | sort)
  set -- "${names[@]}"
fi
for name in "$@"; do
  "$weft" render "$scenes/$name.toml" --frame 45 --size 240x150 --camera 25,18,1.15 --out "$scenes/$name.jpg" || echo "no picture of $name" >&2
done
