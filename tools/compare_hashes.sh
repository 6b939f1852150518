#!/usr/bin/env bash
# Runs the shipped scenes with two programs and compares the hashes of their last states.
#   tools/compare_hashes.sh OLD NEW [FRAMES [SCENE …]]      20 frames and all scenes without names
# Exit code 1 if one differs, which needs an entry under [numerics] in CHANGELOG.md.
set -euo pipefail
old=$1 new=$2 frames=${3:-20}
shift $(($# < 3 ? $# : 3))
export WEFT_SCENES
WEFT_SCENES=$(cd "$(dirname "$0")/../scenes" && pwd)
if [ $# -eq 0 ]; then
  mapfile -t names < <(cd "$WEFT_SCENES" && find . -name '*.toml' | sed 's|^\./||; s|\.toml$||' | sort)
  set -- "${names[@]}"
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
hash_of() {  # PROGRAM SCENE: "failed" where the program fails
  "$1" run "$2" --frames "$frames" --no-glb --no-pc2 --no-passages --fresh --out "$folder" > "$folder/log" 2>&1 ||
    { echo failed; return; }
  sed -n 's/.*"state_hash": "\([0-9a-f]*\)".*/\1/p' "$folder/report.json"
}
differ=0
for name in "$@"; do
  before=$(hash_of "$old" "$name") after=$(hash_of "$new" "$name")
  [ "$before" = "$after" ] && continue
  echo "$name: $before, $after"
  differ=$((differ + 1))
done
echo "$differ of $# scenes differ after $frames frames"
[ "$differ" -eq 0 ]
