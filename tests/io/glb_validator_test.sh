#!/bin/sh
# glb_validator_test.sh GLB_FOLDER BUILD_FOLDER
# The .glb files in GLB_FOLDER pass the Khronos validator without errors and warnings. The validator is installed
# once, to BUILD_FOLDER/node. Exit status 77 (skipped) where it cannot be had.

set -u
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
glb_folder=$1
node_folder=$2/node

skip() {
  echo "skipped: $1"
  exit 77
}

command -v node >/dev/null || skip "node is not installed"
if [ ! -d "$node_folder/node_modules/gltf-validator" ]; then
  command -v npm >/dev/null || skip "npm is not installed"
  mkdir -p "$node_folder"
  npm install --prefix "$node_folder" --no-audit --no-fund gltf-validator || skip "npm could not install gltf-validator"
fi

set -- "$glb_folder"/*.glb
if [ ! -e "$1" ]; then
  echo "there are no .glb files in $glb_folder; expected those that glb_writer_test writes"
  exit 1
fi
WEFT_NODE_MODULES=$node_folder/node_modules exec node "$here/validate_glb.mjs" "$@"
