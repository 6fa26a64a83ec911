#!/usr/bin/env bash
# Installs all that is needed to build, test and check, on Debian 12, by apt. May be run twice; needs root or sudo only
# where something is missing.
set -euo pipefail

packages=(
  # Build
  ca-certificates g++ make cmake ninja-build ccache git pkg-config python3
  # Libraries
  libeigen3-dev libfmt-dev libopencv-dev libceres-dev libopengv-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev
  libembree-dev libtbb-dev libexpat1-dev
  # Figures of experiments
  gnuplot-nox fonts-dejavu-core
  # Tests, benchmarks, checks
  libgtest-dev libgmock-dev libbenchmark-dev clang-format clang-tidy
)

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "setup.sh: these packages are missing and neither root nor sudo is at hand: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "setup.sh: installing ${missing[*]}" >&2
"${as_root[@]}" apt-get update >&2
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends "${missing[@]}" >&2
