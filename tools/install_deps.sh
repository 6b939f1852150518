#!/usr/bin/env bash
# Installs the missing Debian/Ubuntu packages of Weft. --fuzz adds those for `make fuzz`, --bench the other engine of
# `weft bench frontier`, --docs the site generator of `make docs`, --cluster the Slurm of `make cluster`, --blender the
# libraries of Blender's module. No-op, without root rights, if none is missing.
set -euo pipefail

packages=(
  cmake g++ make          # building
  libeigen3-dev           # small vectors and matrices, sparse Cholesky
  libtbb-dev              # threads
  libtinygltf-dev         # glTF files
  libtomlplusplus-dev     # scene files
  libfmt-dev              # text formatting
  nlohmann-json3-dev      # reports
  libcli11-dev            # the command line
  pkg-config libepoxy-dev libegl-dev          # pictures: for the build
  libegl1 libgl1 libgl1-mesa-dri              # pictures: at run time, in software without a graphics card
  libstb-dev              # PNG
  libglfw3-dev libimgui-dev                   # the window
  ffmpeg                  # videos
  python3-dev python3-venv                    # the Python package
  libgtest-dev            # tests
  xvfb xdotool libx11-dev # tests of the window
)
for flag in "$@"; do
  case "$flag" in
    --fuzz) packages+=(clang libclang-rt-dev) ;;
    --bench) packages+=(libbullet-dev) ;;
    --docs) packages+=(mkdocs doxygen) ;;
    --cluster) packages+=(slurm-wlm slurm-client munge) ;;
    --blender) packages+=(libx11-6 libxi6 libgl1 libxfixes3 libxrender1 libxkbcommon0 libsm6 libice6) ;;
    *) echo "install_deps.sh takes --fuzz, --bench, --docs, --cluster and --blender, not $flag" >&2; exit 2 ;;
  esac
done

is_installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q '^install ok installed$'; }

if ! command -v dpkg-query >/dev/null; then
  echo "This is not Debian or Ubuntu: please install what these packages hold by your system's means:" >&2
  echo "  ${packages[*]}" >&2
  exit 0
fi

missing=()
for package in "${packages[@]}"; do is_installed "$package" || missing+=("$package"); done
[ ${#missing[@]} -eq 0 ] && exit 0

if [ "$(id -u)" -eq 0 ]; then
  as_root=()
elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
  as_root=(sudo)
else
  echo "Missing packages: ${missing[*]}" >&2
  echo "Neither root nor sudo is at hand. Ask somebody who is root to run:" >&2
  echo "  apt-get install ${missing[*]}" >&2
  exit 1
fi

echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
