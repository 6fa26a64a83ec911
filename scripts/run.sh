#!/usr/bin/env bash
# Sets up, builds and runs the main job: a metric trajectory from a drive.
#   scripts/run.sh SOURCE [options of `groundscale run`]
# SOURCE is a KITTI odometry sequence, a folder of images or a video. Results go to ./groundscale-out/NAME unless
# --output says otherwise.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

if [ $# -lt 1 ] || [ "${1#-}" != "$1" ]; then
  echo "usage: scripts/run.sh SOURCE [options of 'groundscale run']" >&2
  exit 2
fi
source=$1
shift
if [ ! -e "$source" ]; then
  echo "run.sh: $source is not there; SOURCE is a KITTI sequence folder, an image folder or a video" >&2
  exit 2
fi

output=
previous=
for argument in "$@"; do
  [ "$previous" = --output ] && output=$argument
  case "$argument" in --output=*) output=${argument#--output=} ;; esac
  previous=$argument
done
if [ -z "$output" ]; then
  name=$(basename "$(realpath "$source")")
  [ -d "$source" ] || name=${name%.*}
  output=groundscale-out/$name
  set -- --output "$output" "$@"
fi

"$root/scripts/setup.sh"
mkdir -p "$root/build"
cmake -S "$root" --preset release >"$root/build/configure.log" 2>&1 || { cat "$root/build/configure.log" >&2; exit 1; }
cmake --build "$root/build/release" --target groundscale_program --parallel "$(nproc)" >&2

"$root/build/release/apps/groundscale/groundscale" run "$source" "$@"
echo "trajectory: $output/trajectory.kitti, $output/trajectory.tum (world_from_cam, metres)"
