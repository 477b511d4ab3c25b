#!/bin/sh
# efficiency_test.sh BIN: efficiency.sh at the size of a stamp. Exit 77, "skipped", where jq, gnuplot or numpy is
# missing.
bin=${1:?usage: efficiency_test.sh BIN}
here=$(cd "$(dirname "$0")" && pwd)
for program in jq gnuplot; do
  command -v $program >/dev/null || { echo "skipped: $program is missing (cmake/packages-figures.txt)"; exit 77; }
done
sh "$here/python.sh" -c '' || exit
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
fail() { echo "$1"; failed=1; }
expect() { [ "$2" = "$3" ] || fail "$1: '$2' in place of '$3'"; }

mkdir "$work/scenes" "$work/empty"
cp "$here/../testdata/scenes/two-rooms.glb" "$work/scenes/veach-ajar.glb"
# efficiency NAME [VARIABLE=VALUE ...]: what is said goes to $work/NAME.
efficiency() {
  name=$1
  shift
  env SCENES="$work/scenes" DOC="$work/doc" WIDTH=32 HEIGHT=24 SECONDS_EACH=0.02 SEEDS=2 REF_SECONDS=0.1 \
    LONG_SECONDS=0.1 LONG_SEEDS=2 ONLY="window veach-ajar veach-ajar-flip" INTEGRATORS="bdpt tdpt-org" "$@" \
    sh "$here/efficiency.sh" "$bin" "$work/cache" >"$work/$name" 2>&1
}
rendered() { grep -c -e --integrator "$work/$1"; }

efficiency first || { cat "$work/first"; exit 1; }
page=$work/doc/efficiency.md csv=$work/doc/efficiency.csv
# What a checker of the page is worth: it must find a hole where there is one.
hole_in() {
  for heading in '## Gain' '## PSNR' '### window' '### veach-ajar' "## Beside the paper" '## relMSE after' 'Check: '; do
    grep -q "^$heading" "$1" || { echo "no $heading"; return; }
  done
  [ "$(grep -cE '^\| (bdpt|tdpt-org|all black)( \| [^| ][^|]*){10} \|$' "$1")" = 6 ] || { echo "rows of scenes"; return; }
  grep -qE '^\| tdpt-org \| [0-9.]+, [0-9.]+ \|' "$1" || { echo "no row after a minute"; return; }
  ! grep -wE 'nan|null|inf' "$1" || return
  [ -s "$work/doc/efficiency.png" ] || echo "no plot"
}
hole=$(hole_in "$page")
[ -z "$hole" ] || fail "efficiency.md: $hole"
sed '/^| bdpt |/d' "$page" >"$work/cut.md"
[ -n "$(hole_in "$work/cut.md")" ] || fail "a page without rows for bdpt passes"
grep -q '^veach-ajar-flip: there is no veach-ajar-flip.glb in SCENES, left out$' "$work/first" ||
  fail "a missing scene is not named"
# Two scenes, two integrators, two seeds, three times, and two long ones.
expect "rows of the CSV" "$(sed 1d "$csv" | wc -l)" 26
expect "columns of the CSV" "$(awk -F , '{ print NF }' "$csv" | sort -u)" 11
expect "pictures and halves of references" "$(rendered first)" 30

# The references' noise is taken out, of window for example, by what exrdiff says.
d() { "$bin/exrdiff" --json "$work/cache/$1.exr" "$work/cache/$2.exr" | jq .relmse; }
x=window-bdpt-1-0.02 a=window.reference-1 b=window.reference-2
awk -v xa="$(d $x $a)" -v xb="$(d $x $b)" -v ab="$(d $a $b)" -v ba="$(d $b $a)" -v says="$(
  awk -F , '$1 == "window" && $2 == "bdpt" && $3 == 1 && $4 == 0.02 { print $7 }' "$csv")" 'BEGIN {
    plain = (xa + xb) / 2; free = plain - (ab + ba) / 4
    exit !(says / free > 0.9999 && says / free < 1.0001 && says / plain < 0.99) }' ||
  fail "relMSE against the reference holds the reference's own noise, or is wrong"

# Nothing is rendered twice; what is missing, broken off or changed is rendered.
efficiency second || fail "the second run fails"
expect "the second run renders" "$(rendered second)" 0
efficiency more SEEDS=3 ONLY=window || fail "the run with one more seed fails"
expect "with one more seed" "$(rendered more)" 6
rm "$work/cache/window-tdpt-org-3-0.02.exr.key"
efficiency again SEEDS=3 ONLY=window || fail "the run after one that was stopped fails"
expect "after a run that was stopped" "$(rendered again)" 1

# Without a limit all is rendered anew: depth is part of the key.
efficiency whole DEPTH=none ONLY=window || fail "the run without a limit of depth fails"
expect "without a limit" "$(rendered whole)" 14
expect "options without a limit" "$(grep -c -e --max-depth "$work/whole")" 0
expect "options with one" "$(grep -c -e '--max-depth 6 ' "$work/first")" 30
grep -q "one thread's, no limit of depth, " "$page" || fail "the page does not tell of the depth"
grep -q '"max_depth":null' "$work/cache/window-bdpt-1-0.02.json" || fail "DEPTH=none does not reach the renderer"
efficiency deep DEPTH=deep
[ $? = 2 ] || fail "a word as a depth is no error"

efficiency unknown ONLY=cellar
[ $? = 2 ] && grep -q 'cellar is none of the scenes' "$work/unknown" || fail "an unknown scene is no error"
efficiency word SEEDS=many
[ $? = 2 ] || fail "a word as a number is no error"
efficiency none ONLY=veach-ajar SCENES="$work/empty"
[ $? = 3 ] || fail "no scene at all is no error"
efficiency wrong INTEGRATORS="bdpt none-such"
[ $? = 2 ] && grep -q none-such "$work/wrong" || fail "an unknown integrator is no error, or not named"
exit $failed
