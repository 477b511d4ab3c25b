#!/bin/sh
# target-error_test.sh: what target-error.sh makes of scenes that are measured and of one that fails, by programs that play theirs.
set -u
here=$(cd "$(dirname "$0")" && pwd)
command -v jq >/dev/null || { echo "skipped: jq is missing (cmake/packages-figures.txt)"; exit 77; }
sh "$here/python.sh" -c '' || { echo "skipped: no Python has numpy"; exit 77; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/scenes" "$work/doc"
program() { { echo '#!/bin/sh'; cat; } >"$work/bin/$1" && chmod +x "$work/bin/$1"; }
program tdpt-render <<'PROGRAM'
echo "tdpt-render 0"
PROGRAM
program exrdiff <<'PROGRAM'
echo '{ "relmse": 0.01 }'
PROGRAM
measures='for seed in 1 2; do echo "$seed 16 0.01 0.009 0.011 4 1"; done'
echo "$measures" | program target_bench
for scene in cornell-box kitchen; do echo "$scene" >"$work/scenes/$scene.glb"; done
run() {
  ONLY="cornell-box kitchen" SCENES=$work/scenes DOC=$work/doc SEEDS=2 JOBS=2 sh "$here/target-error.sh" "$work/bin" "$work/cache" \
    >"$work/said" 2>&1
}
failed=0
complain() {
  echo "$*"
  cat "$work/said"
  failed=1
}

run || complain "scenes that are measured: exit $?"
grep -q '^| kitchen | 960 |' "$work/doc/target-error.md" || complain "no row of kitchen"
# What an older program measured is no result of one that fails.
rm "$work/doc/target-error.md"
printf 'case $1 in *kitchen*) exit 3 ;; esac\n%s\n' "$measures" | program target_bench
run && complain "a scene that fails: exit 0"
grep -q '^target-error: kitchen could not be measured$' "$work/said" || complain "a scene that fails: no word"
[ ! -e "$work/doc/target-error.md" ] || complain "a scene that fails: a page"
# Nor is it where a picture cannot be compared.
echo "$measures" | program target_bench
echo 'exit 4' | program exrdiff
run && complain "a picture that cannot be compared: exit 0"
exit $failed
