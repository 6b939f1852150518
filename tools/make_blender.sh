#!/usr/bin/env bash
# make_blender.sh: the Blender extension from blender/ and the wheels in dist/, as build/blender/weft-VERSION.zip, and its tests
# in the newest Blender (the module bpy of PyPI) for each Python at hand. Fails when none can be installed, unless
# WEFT_BLENDER_MAY_SKIP=1; a skip is counted and printed last.
set -euo pipefail
cd "$(dirname "$0")/.."

work=$PWD/build/blender
stage=$work/weft
bpy_versions='bpy>=4.2,<5.3'

rm -rf "$stage"
mkdir -p "$stage/wheels"
cp blender/*.py blender/*.md blender/*.toml blender/LICENSE "$stage"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' blender/blender_manifest.toml)
wheels=""
for tag in cp311 cp313; do
  wheel=$(ls -t dist/weft-"$version"-$tag-$tag-*.whl dist/blender/weft-"$version"-$tag-$tag-*.whl 2> /dev/null | head -1 || true)
  if [ -z "$wheel" ]; then
    echo "left out: the wheel of $tag is not in dist/ (make wheel-all)"
    continue
  fi
  newer=$(find python/weft python/src include src -type f -newer "$wheel" ! -name '*.pyc' | head -1)
  [ -z "$newer" ] || { echo "$wheel is older than $newer: make wheel" >&2; exit 1; }
  cp "$wheel" "$stage/wheels"
  wheels="$wheels\"./wheels/$(basename "$wheel")\", "
done
[ -n "$wheels" ] || { echo "There is no wheel of Weft $version in dist/: make wheel" >&2; exit 1; }
sed -i "s|^platforms = .*|&\nwheels = [${wheels%, }]|" "$stage/blender_manifest.toml"

zip=$work/weft-$version.zip
built=no
failed=0
ran=0
skipped=()
for python in python3.11 python3.13; do
  if ! number=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2> /dev/null); then
    skipped+=("$python is not at hand")
    continue
  fi
  tag=cp${number/./}
  case $wheels in *-$tag-*) ;; *) skipped+=("$python: no wheel of $tag"); continue ;; esac
  venv=$work/venv-$number
  if [ "$(cat "$venv/weft.txt" 2> /dev/null)" != "$bpy_versions" ]; then
    "$python" -m venv --clear "$venv"
    if ! "$venv/bin/pip" install --quiet --disable-pip-version-check "$bpy_versions" pytest > "$work/pip-$number.log" 2>&1; then
      skipped+=("$python: bpy cannot be fetched (build/blender/pip-$number.log)")
      continue
    fi
    echo "$bpy_versions" > "$venv/weft.txt"
  fi
  if [ $built = no ]; then
    extensions=$(ls "$venv"/lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py)
    "$venv/bin/python" "$extensions" build --source-dir "$stage" --output-filepath "$zip" > "$work/build.log" ||
      { cat "$work/build.log" >&2; exit 1; }
    "$venv/bin/python" "$extensions" validate "$zip" > "$work/build.log" || { cat "$work/build.log" >&2; exit 1; }
    echo "build/blender/$(basename "$zip"), $(du -k "$zip" | cut -f1) kB, valid"
    built=yes
  fi
  log=$work/tests-$number.log
  if WEFT_BLENDER_ZIP=$zip "$venv/bin/python" -m pytest -q -rs -p no:cacheprovider tests/blender > "$log" 2>&1; then
    ran=$((ran + 1))
  else
    failed=1
    cat "$log" >&2
  fi
  blender=$("$venv/bin/pip" list --disable-pip-version-check 2> /dev/null | sed -n 's/^bpy  *//p')
  echo "Blender $blender: $(tail -1 "$log")"
done
[ ${#skipped[@]} = 0 ] || printf '%d skipped:\n' ${#skipped[@]}
[ ${#skipped[@]} = 0 ] || printf '  %s\n' "${skipped[@]}"
[ $failed = 0 ] || exit 1
[ $ran != 0 ] || [ "${WEFT_BLENDER_MAY_SKIP:-}" = 1 ] || { echo "No Blender was tested." >&2; exit 1; }
