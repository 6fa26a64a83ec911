# Sourced by the other scripts: step TITLE COMMAND... runs a command, a function with `set -e` among them, and prints how
# long it took. A failure ends the script, or, where keep_going is set, is remembered in failed_steps.
failed_steps=()
step() {
  local title=$1 started=$SECONDS status
  shift
  echo "== $title"
  set +e  # not `if ! "$@"`: inside a condition a function's own `set -e` would do nothing
  (set -e; "$@")
  status=$?
  set -e
  if [ $status -eq 0 ]; then
    echo "== $title: $((SECONDS - started)) s"
  else
    echo "== $title: FAILED after $((SECONDS - started)) s"
    [ -n "${keep_going:-}" ] || exit 1
    failed_steps+=("$title")
  fi
}
