#!/bin/sh
# figures_test.sh BIN: figures.sh at the size of a stamp, on scenes of testdata that stand in for two of the
# five. Exit 77, "skipped", where jq or gnuplot is missing.
bin=${1:?usage: figures_test.sh BIN}
here=$(cd "$(dirname "$0")" && pwd)
for program in jq gnuplot; do
  command -v $program >/dev/null || { echo "skipped: $program is missing (cmake/packages-figures.txt)"; exit 77; }
done
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
fail() { echo "$1"; failed=1; }

mkdir "$work/scenes" "$work/empty"
cp "$here/../testdata/scenes/two-rooms.glb" "$work/scenes/cornell-box-portal.glb"
cp "$here/../testdata/scenes/door-ajar.glb" "$work/scenes/veach-ajar-flip.glb"
# figures NAME [VARIABLE=VALUE ...]: what is said goes to $work/NAME.
figures() {
  name=$1
  shift
  env SCENES="$work/scenes" DOC="$work/doc" WIDTH=32 HEIGHT=18 SPP=2 FRAMES=3 REF_SPP=4 "$@" \
    sh "$here/figures.sh" "$bin" "$work/cache" >"$work/$name" 2>&1
}

figures first || { cat "$work/first"; exit 1; }
page=$work/doc/figures.md
# What a checker of the page is worth: it must find a hole where there is one.
hole_in() {
  for heading in '## Portals' '## Fig 5' '## Fig 6' '## Fig 7' '### cornell-box-portal' '### veach-ajar-flip'; do
    grep -q "^$heading" "$1" || { echo "no $heading"; return; }
  done
  # One row an integrator in Fig 5 and in each of the two tables of Fig 7; no empty cell.
  for i in pt nee bdpt tdpt-org tdpt; do
    [ "$(grep -cE "^\| $i( \| [^| ][^|]*){7,8} \|$" "$1")" = 3 ] || { echo "rows of $i"; return; }
  done
  ! grep -wE 'nan|null|inf' "$1" || return
  for file in $(sed -n 's/.*!\[.*\](\(figures[^)]*\)).*/\1/p' "$1"); do
    [ -s "$work/doc/$file" ] || { echo "no $file"; return; }
  done
}
hole=$(hole_in "$page")
[ -z "$hole" ] || fail "figures.md: $hole"
sed '/^| nee | [^-]/d' "$page" >"$work/cut.md"
[ -n "$(hole_in "$work/cut.md")" ] || fail "a page without rows for nee passes"
grep -q '</svg>' "$work/doc/figures/fig5.svg" || fail "fig5.svg is not whole"
grep -q '^veach-ajar: there is no veach-ajar.glb in SCENES, left out$' "$work/first" ||
  fail "a missing scene is not named"
psnr=$("$bin/exrdiff" "$work/cache/veach-ajar-flip-tdpt.exr" "$work/cache/veach-ajar-flip-reference.exr" --json |
  jq -r .psnr | awk '{ printf "%.2f", $1 }')
sed -n '/^### veach-ajar-flip/,$p' "$page" | grep -q "^| tdpt | $psnr |" || fail "tdpt's PSNR is not $psnr"

# Nothing is rendered twice, and what changes is rendered again.
figures second || fail "the second run fails"
! grep -e --integrator "$work/second" || fail "the second run renders again"
figures third SPP=3 || fail "the third run fails"
[ "$(grep -ce '--spp 3' "$work/third")" = 10 ] && [ "$(grep -ce --integrator "$work/third")" = 10 ] ||
  fail "with SPP=3 something else than ten pictures is rendered"

figures none SCENES="$work/empty"
[ $? = 3 ] || fail "no scene at all is no error"
exit $failed
