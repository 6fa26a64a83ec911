# Sourced by the other scripts: step TITLE COMMAND... runs a command, or a function as under `set -e`, and prints how
# long it took. A failure ends the script, or, where keep_going is set, is remembered in failed_steps.
failed_steps=()
step() {
  local title=$1 status TIMEFORMAT
  shift
  TIMEFORMAT="== $title: %0R s (%0U s of CPU)"
  echo "== $title"
  set +e  # not `if ! "$@"`: inside a condition a function's own `set -e` would do nothing
  time (set -e; "$@")
  status=$?
  set -e
  if [ $status -ne 0 ]; then
    echo "== $title: FAILED"
    [ -n "${keep_going:-}" ] || exit 1
    failed_steps+=("$title")
  fi
}
