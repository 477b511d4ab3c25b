#!/bin/sh
# fuzz.sh BIN TESTDATA WORK [TARGET ...]: runs the libFuzzer targets BIN/TARGET_fuzz, by default all of them, each for
# FUZZ_SECONDS (60), and repeats, up to ROUNDS (1) times, until a round finds no new edge. Inputs:
# TESTDATA/fuzz/TARGET.tar.gz and the files of its format elsewhere in TESTDATA. Inputs that reach new edges are kept in
# WORK/corpus/TARGET, those that break a target in WORK/findings; then the exit code is 1. Prints a line per target: its
# edges, runs and inputs, and the new edges of the last round. MERGE=1 rebuilds that archive instead: the fewest inputs
# of up to 4 KiB that reach all edges, and those whose names have a suffix, which libFuzzer never gives. The same inputs
# give the same bytes.
set -u
bin=${1:?usage: fuzz.sh BIN TESTDATA WORK [TARGET ...]} testdata=${2:?} work=${3:?}
shift 3
# planted: its faults are deliberate.
[ $# -gt 0 ] || for program in "$bin"/*_fuzz; do
  target=$(basename "$program" _fuzz)
  [ "$target" = planted ] || set -- "$@" "$target"
done
seconds=${FUZZ_SECONDS:-60} rounds=${ROUNDS:-1}
testing=$(dirname "$0")
mkdir -p "$work/findings" || exit 2
# Keeps the files of a run in memory if there is room.
files=$(mktemp -d /dev/shm/tdpt-fuzz.XXXXXX 2>/dev/null || mktemp -d) || exit 2
trap 'rm -rf "$files"' EXIT
trap 'exit 2' HUP INT TERM
export TMPDIR="$files"
# The libraries free memory from a target's own operator new with free().
export ASAN_OPTIONS="${ASAN_OPTIONS:-detect_container_overflow=0:alloc_dealloc_mismatch=0}"
export UBSAN_OPTIONS="${UBSAN_OPTIONS:-print_stacktrace=1}"
export LSAN_OPTIONS="${LSAN_OPTIONS:-suppressions=$testing/lsan.supp:print_suppressions=0}"

# Folders of the format's files in TESTDATA.
seeds_of() {
  case $1 in
  scene | portal) echo "$testdata/scenes $testdata/compressed" ;;
  environment) echo "$testdata/environments" ;;
  esac
}

# Figures from the log of a round.
set_round() { edges=$1 brought=$2 runs=$((runs + $3)) inputs=$4; }

failed=0
for target in "$@"; do
  archive=$testdata/fuzz/$target.tar.gz stored=$files/$target corpus=$work/corpus/$target log=$work/$target.log
  seeds=$(seeds_of "$target")
  [ -x "$bin/${target}_fuzz" ] || { echo "fuzz: $bin/${target}_fuzz is missing"; failed=1; continue; }
  rm -rf "$stored" && mkdir -p "$corpus" "$stored/merged" "$stored/in" || exit 2
  [ ! -e "$archive" ] || tar -xzf "$archive" -C "$stored/in" || { echo "fuzz: $archive cannot be read"; exit 2; }
  # No header may cause a larger allocation than this: 2^26 texels of a texture, 2^27 samples of a picture.
  limits="-rss_limit_mb=2048 -malloc_limit_mb=600 -timeout=20"
  asan=$ASAN_OPTIONS
  # Each run forks the process: the less memory it has, the faster.
  [ "$target" = light_grid ] && asan=$asan:quarantine_size_mb=8:detect_leaks=0
  [ -f "$testdata/fuzz/$target.dict" ] && limits="$limits -dict=$testdata/fuzz/$target.dict"
  if [ "${MERGE:-0}" = 1 ]; then
    cp "$stored"/in/*.* "$stored/merged" 2>/dev/null # what once broke the target stays, and what is larger
    # shellcheck disable=SC2086 # limits and seeds are words
    ASAN_OPTIONS=$asan "$bin/${target}_fuzz" -set_cover_merge=1 -max_len=4096 $limits "$stored/merged" "$stored/in" "$corpus" $seeds >"$log" 2>&1 &&
      [ -n "$(ls "$stored/merged")" ] || { echo "fuzz: $target: merging fails, see $log"; failed=1; continue; }
    # Written beside the old one first: whenever this stops, one of the two is there, and whole.
    tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX -C "$stored/merged" -I 'gzip -9n' -cf "$archive.new" . &&
      mv "$archive.new" "$archive" || { echo "fuzz: $archive cannot be written"; exit 2; }
    echo "$target: $(find "$stored/merged" -type f | wc -l) inputs"
    continue
  fi
  runs=0 round=0 brought=1
  while [ "$brought" -gt 0 ] && [ "$round" -lt "$rounds" ]; do
    round=$((round + 1))
    # shellcheck disable=SC2086
    ASAN_OPTIONS=$asan "$bin/${target}_fuzz" -max_total_time="$seconds" -max_len=65536 $limits -print_final_stats=1 \
      -artifact_prefix="$work/findings/$target-" "$corpus" "$stored/in" $seeds >"$log" 2>&1
    status=$?
    # shellcheck disable=SC2046 # four numbers
    set_round $(awk '
      / cov: / { for (i = 1; i < NF; ++i) { if ($i == "cov:") cov = $(i + 1); if ($i == "corp:") split($(i + 1), corp, "/") } }
      $2 == "INITED" { first = cov }
      /number_of_executed_units/ { runs = $2 }
      END { print cov + 0, cov - first, runs + 0, corp[1] + 0 }' "$log")
    [ "$status" = 0 ] || break
  done
  printf '%-12s %6d edges %10d runs %6d inputs, %d new in the last of %s, %s s each%s\n' "$target" "$edges" "$runs" "$inputs" \
    "$brought" "$round round$([ "$round" = 1 ] || echo s)" "$seconds" "$([ "$status" = 0 ] || echo "  FOUND SOMETHING")"
  [ "$status" = 0 ] || { failed=1; grep -aE 'ERROR|runtime error|broken promise|artifact|Test unit' "$log" | head -5; }
done
exit "$failed"
