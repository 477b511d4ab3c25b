#!/bin/sh
# linked.sh BUILD PROGRAM ...: checks that no program is built from a source meant for tests: a test, or one in a folder
# testing/. Reads Ninja's build graph; prints such sources; exit 1 if any.
build=${1:?usage: linked.sh BUILD PROGRAM ...}
shift
status=0
for program; do
  inputs=$(ninja -C "$build" -t inputs "bin/$program") || exit 2
  [ -n "$inputs" ] || { echo "$program is made from nothing"; exit 2; }
  # Sources are compiled several at a time, by files that include them.
  inputs="$inputs
$(echo "$inputs" | grep '/Unity/.*\.cxx$' | xargs -r sed -n 's/^#include "\(.*\)"$/\1/p')"
  if found=$(echo "$inputs" | grep -E '/testing/|_(test|bench|fuzz)\.'); then
    echo "$found" | sed "s|^|$program is made from |"
    status=1
  fi
done
exit $status
