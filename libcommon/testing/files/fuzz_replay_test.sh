#!/bin/sh
# fuzz_replay_test.sh PLANTED_REPLAY: fuzz_replay.sh detects failures, tested on the target with planted faults.
planted=$1
replay=$(dirname "$0")/fuzz_replay.sh
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
export LC_ALL=C # for the messages of tar

# expect STATUS SAYS: whether a run on $work/in.tar.gz exits with 0, and how a line of its output ends.
expect() {
  sh "$replay" "$planted" "$work/in.tar.gz" "$work/unpacked" >"$work/said" 2>&1
  status=$?
  [ "$status" = 0 ] || status=fault
  [ "$status" = "$1" ] && grep -q "$2\$" "$work/said" && return
  echo "$status, expected $1 and $2"
  cat "$work/said"
  failed=1
}
pack() { tar -czf "$work/in.tar.gz" -C "$work/in" .; }

mkdir "$work/in"
expect fault "in.tar.gz: Cannot open: No such file or directory"
: >"$work/in.tar.gz"
expect fault "not look like a tar archive"
pack
expect fault "0 inputs, each read or refused"
echo "reads" >"$work/in/1"
echo "refuses" >"$work/in/2"
pack
expect 0 unpacked/2
for fault in "throws" "two lines" "breaks"; do
  echo "$fault" >"$work/in/3"
  pack
  expect fault unpacked/3
done
rm "$work/in/3"
pack
expect 0 "2 inputs, each read or refused" # the inputs of the previous run are gone
head -c 100000 /dev/urandom >"$work/in/3"
tar -czf "$work/whole" -C "$work/in" 1 2 3
head -c 50000 "$work/whole" >"$work/in.tar.gz"
expect fault "unexpected end of file"
exit $failed
