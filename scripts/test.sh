#!/usr/bin/env bash
# Sets up, builds (release) and runs all tests. Arguments go to ctest, for example `scripts/test.sh -R geometry`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/steps.sh

step "set up" scripts/setup.sh
step "configure" cmake --preset release
step "build" cmake --build --preset release --parallel "$(nproc)"
step "tests" ctest --preset release --parallel "$(nproc)" "$@"
