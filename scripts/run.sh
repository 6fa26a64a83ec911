#!/usr/bin/env bash
# Sets up, builds and runs the main job: a metric trajectory from a drive.
#   scripts/run.sh                                          a simulated drive, compared with its truth
#   scripts/run.sh SOURCE [options of `groundscale run`]    a drive of your own
# SOURCE is a KITTI odometry sequence, a folder of images or a video. Results go to ./groundscale-out/NAME unless
# --output says otherwise.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
program=$root/build/release/apps/groundscale/groundscale

build() {
  "$root/scripts/setup.sh"
  mkdir -p "$root/build"
  cmake -S "$root" --preset release >"$root/build/configure.log" 2>&1 || { cat "$root/build/configure.log" >&2; exit 1; }
  cmake --build "$root/build/release" --target groundscale_program --parallel "$(nproc)" >&2
}

# 15 s of a town at 36 km/h: 55 m straight on, a right turn, the next street. The images are kept for the next time.
run_simulated() {
  local drive=groundscale-out/simulated/drive results=groundscale-out/simulated/run
  echo "run.sh: rendering 150 frames (a minute or two, the first time)" >&2
  "$program" simulate --route city --frames 150 --output "$drive" --force >&2
  "$program" run "$drive" --output "$results" --force
  echo
  # The final trajectory's figures; those of the online one and of single measurements follow them.
  "$program" evaluate "$results" --truth "$drive/poses.txt" | sed '/^online scale/,$d'
  echo "trajectory  $results/trajectory.kitti"
  echo "truth       $drive/poses.txt"
  echo "all figures: ${program#"$PWD"/} evaluate $results --truth $drive/poses.txt"
}

if [ $# -eq 0 ]; then
  build
  run_simulated
  exit
fi
if [ "${1#-}" != "$1" ]; then
  echo "usage: scripts/run.sh [SOURCE [options of 'groundscale run']]" >&2
  exit 2
fi
source=$1
shift
if [ ! -e "$source" ]; then
  echo "run.sh: $source is not there; SOURCE is a KITTI sequence folder, an image folder or a video" >&2
  exit 2
fi

output_given=
for argument in "$@"; do
  case "$argument" in --output | --output=*) output_given=yes ;; esac
done
if [ -z "$output_given" ]; then
  name=$(basename "$(realpath "$source")")
  [ -d "$source" ] || name=${name%.*}
  set -- --output "groundscale-out/$name" "$@"
fi

build
# Its summary ends with where the trajectory lies.
exec "$program" run "$source" "$@"
