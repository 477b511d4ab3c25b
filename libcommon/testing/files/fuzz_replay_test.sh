#!/bin/sh
# fuzz_replay_test.sh PLANTED_REPLAY: what fuzz_replay notices, on the target with planted faults.
planted=$1
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0

# expect STATUS NAME: exit code 0 or not of a run on $work/in; it names the last input.
expect() {
  "$planted" "$work/in" >"$work/said" 2>&1
  status=$?
  [ "$status" = 0 ] || status=fault
  if [ "$status" != "$1" ] || { [ "$1" = fault ] && [ -n "$2" ] && ! grep -q "in/$2\$" "$work/said"; }; then
    echo "${2:-no input}: $status, expected $1"
    cat "$work/said"
    failed=1
  fi
}

mkdir "$work/in"
expect fault ""
echo "reads" >"$work/in/1"
echo "refuses" >"$work/in/2"
expect 0 2
for fault in "throws" "two lines" "breaks"; do
  echo "$fault" >"$work/in/3"
  expect fault 3
done
exit $failed
