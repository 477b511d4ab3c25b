#!/bin/sh
# fuzz_test.sh: tests how fuzz.sh handles stored inputs, with mock targets.
set -u
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/bin" "$work/testdata/fuzz" "$work/old"
target() { { echo '#!/bin/sh'; cat; } >"$work/bin/$1_fuzz" && chmod +x "$work/bin/$1_fuzz"; }
target fails <<'TARGET'
exit 1
TARGET
# The merge destination is the first argument that is a folder.
target keeps <<'TARGET'
for argument in "$@"; do [ -d "$argument" ] && { echo fewest >"$argument/fewest"; touch -d @$$ "$argument/fewest"; exit 0; }; done
TARGET
echo old >"$work/old/old"
echo found >"$work/old/found.it"
for target in fails keeps; do tar -czf "$work/testdata/fuzz/$target.tar.gz" -C "$work/old" .; done
target empties <<'TARGET'
TARGET
echo "no archive" >"$work/testdata/fuzz/damaged.tar.gz"
cp "$work/bin/keeps_fuzz" "$work/bin/damaged_fuzz"
cp "$work/bin/keeps_fuzz" "$work/bin/new_fuzz"
mkdir -p "$work/work/corpus/new"
before=$(cksum "$work"/testdata/fuzz/fails.tar.gz "$work"/testdata/fuzz/damaged.tar.gz)
failed=0
# expect STATUS WHAT FILES TARGET...: exit code of a merge, and the inputs that are then stored for the last target.
expect() {
  expected=$1 what=$2 files=$3
  shift 3
  MERGE=1 sh "$here/fuzz.sh" "$work/bin" "$work/testdata" "$work/work" "$@" >"$work/said" 2>&1
  status=$?
  for last in "$@"; do :; done
  stored=$(tar -tf "$work/testdata/fuzz/$last.tar.gz" 2>/dev/null | tr '\n' ' ')
  [ "$status" = "$expected" ] && [ "$stored" = "$files" ] && return
  echo "$what: exit $status, expected $expected; stored $stored, expected $files"
  cat "$work/said"
  failed=1
}

expect 1 "a target that is not there" "" nosuch
grep -q '^fuzz: .*nosuch_fuzz is missing$' "$work/said" || { echo "no word of the target that is not there"; failed=1; }
expect 1 "one fails, the next goes on" "./ ./fewest ./found.it " fails keeps
grep -q '^keeps: 2 inputs$' "$work/said" || { echo "no word of the inputs that are kept"; failed=1; }
first=$(cksum <"$work/testdata/fuzz/keeps.tar.gz")
expect 0 "the same inputs again" "./ ./fewest ./found.it " keeps
[ "$first" = "$(cksum <"$work/testdata/fuzz/keeps.tar.gz")" ] || { echo "the same inputs make another archive"; failed=1; }
expect 0 "a target without an archive" "./ ./fewest " new
expect 1 "no input is left" "" empties
expect 2 "an archive that is damaged" "" damaged
[ "$before" = "$(cksum "$work"/testdata/fuzz/fails.tar.gz "$work"/testdata/fuzz/damaged.tar.gz)" ] ||
  { echo "archives of targets that failed have changed"; failed=1; }

# Rounds end after the first that finds no new edge: this target's third.
target learns <<'TARGET'
rounds=$(cat "$0.rounds" 2>/dev/null || echo 0)
echo $((rounds + 1)) >"$0.rounds"
edges=$((rounds < 2 ? rounds + 1 : 2))
echo "#1 INITED cov: $rounds ft: 9 corp: 1/9b"
[ $rounds = 2 ] || echo "#2 NEW    cov: $edges ft: 9 corp: 2/9b"
echo "stat::number_of_executed_units: 100"
TARGET
learns() {
  rm -f "$work/bin/learns_fuzz.rounds"
  said=$(ROUNDS=$1 sh "$here/fuzz.sh" "$work/bin" "$work/testdata" "$work/work" learns)
  [ "$said" = "$2" ] || { echo "ROUNDS=$1: $said"; failed=1; }
}
learns 1 "learns            1 edges        100 runs      2 inputs, 1 new in the last of 1 round, 60 s each"
learns 9 "learns            2 edges        300 runs      1 inputs, 0 new in the last of 3 rounds, 60 s each"
exit $failed
