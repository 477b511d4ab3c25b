#!/bin/sh
# power.sh BIN SEEDS PROGRAM FILTER: runs these tests of a GoogleTest program with that many fresh seeds. Prints how
# often each failed (for a test a false alarm, for a twin a missed fault) and how many samples detect each fault
# (power_told.cpp). Exit 1 if one failed for more than one seed in a hundred; a test that misses a fault once in a
# thousand does so with probability 1/1000.
bin=${1:?usage: power.sh BIN SEEDS PROGRAM FILTER} seeds=${2:?} program=${3:?} filter=${4:?}
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
seed=0
while [ $((seed += 1)) -le "$seeds" ]; do
  TDPT_SEED=$seed TDPT_FAILURES=$work/failures "$bin/$program" --gtest_brief=0 --gtest_filter="$filter" >>"$work/told" 2>&1
done
ran=$(grep -c '^\[ RUN      \] ' "$work/told")
[ "$ran" -ge "$seeds" ] || { echo "power: no test is $filter of $program"; tail "$work/told"; exit 2; }
grep '^\[  FAILED  \] .* ([0-9]* ms)$' "$work/told" | sed 's/^\[  FAILED  \] //; s/ ([0-9]* ms)$//; s/, where .*//' |
  sort | uniq -c | sort -rn >"$work/failed"
"$bin/power_told" <"$work/told"
echo "$program, $seeds seeds, $((ran / seeds)) tests; failed:"
cat "$work/failed"
awk -v most="$((seeds / 100))" '$1 > most { bad = 1 } END { exit bad }' "$work/failed"
