#!/bin/sh
# sizes_test.sh: sizes.sh accepts what fits and detects each planted fault. Exit 77 without git.
here=$(cd "$(dirname "$0")" && pwd)
command -v git >/dev/null || { echo "skipped: git is missing"; exit 77; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null GIT_CEILING_DIRECTORIES="$work"
unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE
mkdir -p "$work/root/.ci" "$work/root/tools/a/testing" "$work/root/doc"
cd "$work/root" || exit 2
status=0
# expect STATUS WORD PRODUCT ALL: with these ceilings.
expect() {
  printf 'product %s\nall %s\n' "$3" "$4" >.ci/sizes
  sh "$here/sizes.sh" . >"$work/said"
  got=$?
  [ "$got" = "$1" ] && { [ -z "$2" ] || grep -q -e "$2" "$work/said"; } && return
  echo "ceilings $3 and $4: exit code $got, expected $1 and: $2"
  cat "$work/said"
  status=1
}
commit() { git add . && git -c user.name=a -c user.email=a@example.org commit -qm a; }

seq 1000 >tools/a/main.cpp
for file in tools/a/main_test.cpp tools/a/testing/oracle.h tools/a/a_bench.cpp doc/page.md; do seq 100 >$file; done
seq 5000 >tools/a/data.exr
expect 77 'no checkout' 1000 1400
rm .ci/sizes && git init -q . && commit || exit 2
expect 0 '' 1000 1400
expect 0 '' 1005 1400
expect 1 'product has 1,000 lines and a ceiling of 1,006: lower' 1006 1400
expect 1 'product has 1,000 lines, at most 999: take away' 999 1400
expect 1 'all has 1,400 lines, at most 1,399: take away' 1000 1399
expect 1 'no line of all' 1000 ''
expect 0 '' 1002 1402 && commit
expect 0 '' 1001 1402 && commit
expect 1 'product rose from 1,001 to 1,002 in the file' 1002 1402 && commit
expect 1 'product rose from 1,001 to 1,002 in' 1000 1400
exit $status
