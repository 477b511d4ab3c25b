#!/bin/sh
# fuzz_replay_test.sh PLANTED_REPLAY: fuzz_replay.sh detects failures, tested on the target with planted faults.
set -u
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
mkdir "$work/in"
failed=0

# expect STATUS SAYS: whether a run on the inputs exits with 0, and how a line of its output ends.
expect() {
  sh "$(dirname "$0")/fuzz_replay.sh" "$planted" "$work/in.tar.gz" "$work/unpacked" >"$work/said" 2>&1
  status=$?
  [ "$status" = 0 ] || status=fault
  [ "$status" = "$1" ] && grep -q "$2\$" "$work/said" && return
  echo "$status, expected $1 and $2"
  cat "$work/said"
  failed=1
}
pack() { tar -czf "$work/in.tar.gz" -C "$work/in" .; }

planted=$1
echo "no archive" >"$work/in.tar.gz"
expect fault ""
pack
expect fault "0 inputs, each read or refused"
echo "reads" >"$work/in/1"
echo "refuses" >"$work/in/2"
for fault in "throws" "two lines" "breaks"; do
  echo "$fault" >"$work/in/3"
  pack
  expect fault unpacked/3
done
rm "$work/in/3"
pack
expect 0 "2 inputs, each read or refused" # the inputs of the previous run are gone
exit $failed
