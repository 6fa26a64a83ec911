# Sourced by the other scripts: step TITLE COMMAND... runs a command and prints how long it took.
step() {
  local title=$1 started=$SECONDS
  shift
  echo "== $title"
  if ! "$@"; then
    echo "== $title: FAILED after $((SECONDS - started)) s"
    return 1
  fi
  echo "== $title: $((SECONDS - started)) s"
}
