#!/usr/bin/env bash
# Everything that is checked besides the tests of the release build: format, what the files say, include order, names,
# warnings, docs in step with the code, headers that compile alone, clang-tidy, the sanitizers' build with its tests.
# Without arguments all of it; else the steps named: `scripts/check.sh format tidy`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/steps.sh
keep_going=yes
jobs=$(nproc)

sources() { find src apps tests benchmarks examples -name '*.cpp' -o -name '*.hpp' | sort; }

check_format() {
  sources | xargs clang-format --dry-run --Werror
}

check_text() { scripts/check_text.py; }

check_includes() {
  python3 scripts/check_includes_test.py --quiet
  scripts/check_includes.py
}

check_names() {
  python3 scripts/check_names_test.py --quiet
  scripts/check_names.py
}

check_warnings() {
  cmake --preset release >/dev/null
  cmake --build --preset release --parallel "$jobs"
}

check_headers() {
  cmake --preset tidy >/dev/null
  scripts/check_headers.py build/tidy/compile_commands.json
}

check_tidy() {
  cmake --preset tidy >/dev/null
  scripts/tidy.py build/tidy/compile_commands.json --jobs "$jobs"
}

check_sanitizers() {
  local log=build/asan-ubsan/ctest.log
  cmake --preset asan-ubsan >/dev/null
  cmake --build --preset asan-ubsan --parallel "$jobs"
  if ! ctest --preset asan-ubsan --parallel "$jobs" >"$log" 2>&1; then
    cat "$log"
    return 1
  fi
  echo "with sanitizers: $(grep -E 'tests passed' "$log")"
}

check_docs() {
  local program=build/release/apps/groundscale/groundscale same=yes
  in_step() {  # FILE, then the arguments of the program that makes it
    local file=$1
    shift
    diff <($program "$@") "$file" && return
    echo "$file is not what the code says; renew it: $program $* > $file"
    same=no
  }
  in_step docs/configuration.md config --markdown
  in_step docs/simulation-options.md config --simulation --markdown
  scripts/check_doc_code.py docs/adding-a-method.md examples/own_plane_method.cpp || same=no
  [ $same = yes ]
}

steps=("$@")
[ $# -gt 0 ] || steps=(format text includes names warnings docs headers tidy sanitizers)
for name in "${steps[@]}"; do
  step "$name" "check_$name"
done
if [ ${#failed_steps[@]} -gt 0 ]; then
  echo "check.sh: failed: ${failed_steps[*]}"
  exit 1
fi
