#!/usr/bin/env bash
# fuzz.sh SECONDS: builds the fuzz targets with clang and runs each for so long. Fails on the first input that crashes,
# hangs or breaks a sanitizer's rule; that input is kept in build/fuzz/found. The corpus is kept in build/fuzz/corpus.
set -euo pipefail
seconds=${1:?usage: tools/fuzz.sh SECONDS}
cd "$(dirname "$0")/.."

cmake --preset fuzz > /dev/null
cmake --build --preset fuzz -j "$(nproc)" \
  --target weft_{scene,obj,ply,stl,glb,gltf,world}_fuzzer

# fuzz NAME SEEDS…
fuzz() {
  local corpus=build/fuzz/corpus/$1 found=build/fuzz/found
  mkdir -p "$corpus" "$found"
  echo "Fuzzing $1 for $seconds s"
  "build/fuzz/bin/weft_$1_fuzzer" -max_total_time="$seconds" -timeout=10 -max_len=4096 -verbosity=0 \
    -print_final_stats=1 -artifact_prefix="$found/$1-" "$corpus" "${@:2}"
}
fuzz scene scenes tests/scene/broken
fuzz obj scenes/garments tests/fuzz/obj_seeds
fuzz ply tests/fuzz/ply_seeds
fuzz stl tests/fuzz/stl_seeds
fuzz glb tests/fuzz/glb_seeds
fuzz gltf tests/fuzz/gltf_seeds
fuzz world
