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

output_given=
for argument in "$@"; do
  case "$argument" in --output | --output=*) output_given=yes ;; esac
done
if [ -z "$output_given" ]; then
  name=$(basename "$(realpath "$source")")
  [ -d "$source" ] || name=${name%.*}
  set -- --output "groundscale-out/$name" "$@"
fi

"$root/scripts/setup.sh"
mkdir -p "$root/build"
cmake -S "$root" --preset release >"$root/build/configure.log" 2>&1 || { cat "$root/build/configure.log" >&2; exit 1; }
cmake --build "$root/build/release" --target groundscale_program --parallel "$(nproc)" >&2

# Its summary ends with where the trajectory lies.
exec "$root/build/release/apps/groundscale/groundscale" run "$source" "$@"
