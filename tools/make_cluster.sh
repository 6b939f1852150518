#!/usr/bin/env bash
# make_cluster.sh PYTHON PACKAGE: a farm on a real Slurm on this machine; a node dies on the way and returns. PYTHON: of
# build/venv; PACKAGE: the folder with the built package. Needs root. Leaves Slurm's logs in build/cluster.
set -euo pipefail
cd "$(dirname "$0")/.."

[ "$(id -u)" -eq 0 ] || { echo "make cluster starts Slurm's daemons, and has to be run by root" >&2; exit 1; }
work=$PWD/build/cluster
mkdir -p "$work"
if [ ! -d "$work/packages/dask_jobqueue" ]; then  # beside the environment of the tests, which has dask
  "$1" -m pip install --quiet --disable-pip-version-check --no-deps --target "$work/packages" dask-jobqueue
fi
rm -rf "$work/run"
PYTHONPATH=$2:$work/packages PATH=$PATH:/usr/sbin "$1" tests/cluster/farm_on_slurm.py "$work/run"
