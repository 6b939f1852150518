#!/usr/bin/env bash
# Makes build/venv, with what builds and tests the Python package, for the interpreter $WEFT_PYTHON (default python3).
# Prints CMake's options for it; where it cannot be made, the reason to stderr and the option that leaves it out.
set -euo pipefail
cd "$(dirname "$0")/.."

leave_out() {
  echo "Weft's Python package is left out: $1" >&2
  echo "-DWEFT_BUILD_PYTHON=OFF"
  exit 0
}

python=${WEFT_PYTHON:-python3}
venv=$PWD/build/venv
version=$("$python" -c 'import sys; print(sys.version.split()[0] if sys.version_info >= (3, 10) else "")' 2>/dev/null) ||
  leave_out "$python does not run"
[ -n "$version" ] || leave_out "$python is older than 3.10"
wanted="$version $(cksum < python/requirements.txt)"
if [ "$(cat "$venv/weft.txt" 2>/dev/null)" != "$wanted" ]; then
  mkdir -p build
  "$python" -m venv --clear "$venv" > build/venv.log 2>&1 || leave_out "$python has no venv (build/venv.log)"
  "$venv/bin/pip" install --quiet --disable-pip-version-check -r python/requirements.txt >> build/venv.log 2>&1 ||
    leave_out "its build tools cannot be installed (build/venv.log)"
  echo "$wanted" > "$venv/weft.txt"
fi
echo "-DWEFT_BUILD_PYTHON=ON -DPython_EXECUTABLE=$venv/bin/python"
