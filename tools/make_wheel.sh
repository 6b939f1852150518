#!/usr/bin/env bash
# make_wheel.sh PYTHON…: the source distribution and a wheel for each interpreter, in dist/, each tried in a clean
# environment outside the source tree. Wheels link the libraries of the release build. Interpreters that are missing are
# named; the first must have the packages of python/requirements.txt.
set -euo pipefail
cd "$(dirname "$0")/.."

tools=$(realpath -s "$1")
set -- "$tools" "${@:2}"
prefix=$PWD/build/prefix
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install build/release --prefix "$prefix" > /dev/null
mkdir -p dist
"$tools" -m build --sdist --no-isolation --outdir dist . > "$work/log" || { cat "$work/log" >&2; exit 1; }
ls dist/*.tar.gz

made=" "  # versions
for python in "$@"; do
  if ! version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2> /dev/null); then
    echo "skipped: $python is not at hand"
    continue
  fi
  case $made in *" $version "*) continue ;; esac
  made="$made$version "
  if [ "$python" = "$tools" ]; then
    builder=$tools
  else
    "$python" -m venv "$work/builder"
    builder=$work/builder/bin/python
    "$builder" -m pip install --quiet --disable-pip-version-check --upgrade pip nanobind scikit-build-core
  fi
  rm -rf "$work/wheel"
  "$builder" -m pip wheel --quiet --disable-pip-version-check --no-build-isolation --no-deps -w "$work/wheel" \
    -C cmake.define.WEFT_PREFIX="$prefix" .
  PATH=$(dirname "$tools"):$PATH "$tools" -m auditwheel repair -w "$work/repaired" "$work"/wheel/*.whl > "$work/log" 2>&1 ||
    { cat "$work/log" >&2; exit 1; }
  wheel=$(ls "$work"/repaired/*.whl)
  tools/third_party.py "$wheel"
  mv "$wheel" dist/
  wheel=dist/$(basename "$wheel")
  echo "$wheel, $(du -k "$wheel" | cut -f1) kB"
  tools/try_wheel.sh "$python" "$wheel"
  case $wheel in *abi3*)  # Blender takes wheels with the tag of its own interpreter only
    mkdir -p dist/blender
    cp "$wheel" dist/blender
    "$tools" -m wheel tags --remove --python-tag cp313 --abi-tag cp313 "dist/blender/$(basename "$wheel")" > /dev/null
    ls dist/blender/*cp313*
  esac
  rm -rf "$work/builder" "$work/repaired"
done
