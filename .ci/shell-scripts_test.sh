#!/bin/sh
# shell-scripts_test.sh: shell-scripts.sh detects a planted fault, also in .ci/run, and accepts good scripts.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
# expect STATUS FILE COMMAND
expect() {
  rm -rf "$work/root"
  mkdir -p "$work/root/$(dirname "$2")"
  printf '#!/bin/sh\n%s\n' "$3" >"$work/root/$2"
  sh "$here/shell-scripts.sh" "$work/root" >"$work/said" 2>&1
  status=$?
  [ $status != 77 ] || { cat "$work/said"; exit 77; }
  if [ "$status" != "$1" ]; then
    echo "$2 with $3: exit code $status, expected $1"
    cat "$work/said"
    failed=1
  fi
}
expect 0 bench/a.sh 'rm -r "$1"'
expect 1 bench/a.sh 'rm -r $1'
expect 1 .ci/run 'rm -r $1'
expect 0 build/a.sh 'rm -r $1'
exit $failed
