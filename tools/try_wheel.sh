#!/usr/bin/env bash
# try_wheel.sh PYTHON WHEEL: installs a wheel in a clean environment outside the source tree, and there runs the examples
# and the notebook, and checks the examples against the stubs.
set -euo pipefail
tree=$(cd "$(dirname "$0")/.." && pwd)
wheel=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$1" -m venv "$work/venv"
python=$work/venv/bin/python
"$python" -m pip install --quiet --disable-pip-version-check "$wheel[farm]" scipy matplotlib nbclient ipykernel mypy
cp -r "$tree/python/examples" "$work/examples"
cp "$tree"/docs/manual/*.ipynb "$work"
cd "$work"
unset PYTHONPATH

examples=0
for example in examples/*.py; do
  runs=$([ "$(basename "$example")" = drape_fit.py ] && echo 20 || true)  # of 200
  "$python" "$example" "$work" $runs > log 2>&1 || { echo "$example failed:" >&2; cat log >&2; exit 1; }
  examples=$((examples + 1))
done
notebooks=0
for notebook in *.ipynb; do
  "$work/venv/bin/jupyter-execute" "$notebook" > log 2>&1 || { echo "$notebook failed:" >&2; cat log >&2; exit 1; }
  notebooks=$((notebooks + 1))
done
"$python" -m mypy --strict examples > log || { cat log >&2; exit 1; }
"$python" -c "
import platform, weft
assert weft.__file__.startswith('$work/venv'), weft.__file__
print(f'weft {weft.__version__}, Python {platform.python_version()}: $examples examples, $notebooks notebook, stubs: passed')"
