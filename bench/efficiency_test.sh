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
    REFERENCE_FOLDER="$work/references" LONG_SECONDS=0.1 LONG_SEEDS=2 ONLY="window veach-ajar veach-ajar-flip" INTEGRATORS="bdpt tdpt-org" "$@" \
    sh "$here/efficiency.sh" "$bin" "$work/cache" >"$work/$name" 2>&1
}
rendered() { grep -c -e --integrator "$work/$1"; }

efficiency first || { cat "$work/first"; exit 1; }
page=$work/doc/efficiency.md csv=$work/doc/efficiency.csv
# What a checker of the page is worth: it must find a hole where there is one.
hole_in() {
  for heading in '## Doors' '## PSNR' '### window' '### veach-ajar' "## Beside the paper" '## relMSE after' 'Check: '; do
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
# Two scenes, two integrators, two seeds, three times; and two long ones of both.
expect "rows of the CSV" "$(sed 1d "$csv" | wc -l)" 28
expect "columns of the CSV" "$(awk -F , '{ print NF }' "$csv" | sort -u)" 12
expect "rows of a program that held 5 to 500 MiB" "$(awk -F , '$12 > 5 && $12 < 500' "$csv" | wc -l)" 28
expect "pictures and halves of references" "$(rendered first)" 32

# The references' noise is taken out, of window for example, by what exrdiff says.
d() { "$bin/exrdiff" --json "$work/cache/$1.exr" "$work/cache/$2.exr" | jq .relmse; }
x=window-bdpt-1-0.02 a=window.reference-1 b=window.reference-2
awk -v xa="$(d $x $a)" -v xb="$(d $x $b)" -v ab="$(d $a $b)" -v ba="$(d $b $a)" -v says="$(
  awk -F , '$1 == "window" && $2 == "bdpt" && $3 == 1 && $4 == 0.02 { print $7 }' "$csv")" 'BEGIN {
    plain = (xa + xb) / 2; noise = (ab + ba) / 4; off = says - (plain - noise)
    # Of six digits. A picture with one bright dot has a thousand times the noise of the references, by luck.
    exit !(off * off < (1e-5 * plain) ^ 2 && noise > 3e-5 * plain) }' ||
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
efficiency whole DEPTH=none ONLY="window veach-ajar-whole" || fail "the run without a limit of depth fails"
expect "without a limit" "$(rendered whole)" 14
expect "options without a limit" "$(grep -c -e --max-depth "$work/whole")" 0
expect "seconds of a half with an aim" "$(grep -c -e 'window.reference.* --time 0.05 ' "$work/first")" 2
expect "options with one" "$(grep -c -e '--max-depth 6 ' "$work/first")" 32
grep -q "one thread's, no limit of depth$" "$page" || fail "the page does not tell of the depth"
grep -q '"max_depth":null' "$work/cache/window-bdpt-1-0.02.json" || fail "DEPTH=none does not reach the renderer"
grep -q veach-ajar-whole "$page" && fail "without a limit a scene comes twice"

# An older program takes turns with this one; a scene without a limit, beside those that have one, has pictures of one
# length, a reference of its own, and nothing of that program.
cat >"$work/older" <<END
#!/bin/sh
echo "\$*" >>"$work/calls"
exec "$bin/tdpt-render" "\$@"
END
chmod +x "$work/older"
efficiency before BASELINE="$work/older" BASELINE_NAME="commit 1234567" ONLY="window veach-ajar-whole" \
  INTEGRATORS="bdpt auto" || fail "the run beside an older program fails"
expect "pictures of the older program" "$(grep -c -e --integrator "$work/calls")" 12
expect "rows of its integrators" "$(cut -d , -f 1,2 "$csv" | grep -c -e '^window,nee-before$' -e '^window,bdpt-before$')" 12
grep -q '^Gain over bdpt of commit 1234567' "$page" || fail "the page does not name the older program"
expect "columns of gains" "$(grep '^| scene' "$page" | head -1)" "| scene | nee-before | bdpt | auto | aim (moonshot) | met |\
 efficiency of bdpt-before [1/s] | efficiency of bdpt [1/s] |"
expect "seconds of a half without an aim" "$(grep -c -e 'whole.reference.* --time 0.025 ' "$work/before")" 2
expect "of veach-ajar-whole" "$(grep -c -e '^veach-ajar-whole.*--integrator' "$work/before")" 6
expect "with a limit" "$(grep -e '^veach-ajar-whole' "$work/before" | grep -c -e --max-depth)" 0
sed -n '/^## No limit of depth/,/^!/p' "$page" | grep -qE '^\| veach-ajar-whole \| [0-9.-]' || fail "no row without a limit"
sed -n '/^## Doors/,/^## No limit/p' "$page" | grep -q veach-ajar-whole && fail "a scene without a limit is among those with one"
for wrong in BASELINE="$work/none-such" REFERENCES=many "DEPTH=none BASELINE=$work/older" LONG_SCENES=cellar; do
  # shellcheck disable=SC2086  # words
  efficiency wrong $wrong
  [ $? = 2 ] || fail "$wrong is no error"
done

# References that are stored: halves of half floats, which fit one scene, depth and size, whatever the program.
rm "$work"/cache/*.reference-?.exr.key
efficiency make REFERENCES=make ONLY="window veach-ajar" || fail "references are not stored"
expect "pictures when storing" "$(rendered make)" 4
expect "words on what is stored" "$(grep -cE '^efficiency: .*: stored, [0-9]+ of 0.[18] CPU seconds' "$work/make")" 2
expect "stored" "$(cd "$work/references" && echo *)" "README.md veach-ajar-1.exr veach-ajar-2.exr veach-ajar.json\
 window-1.exr window-2.exr window.json"
expect "rows of README.md" "$(grep -cE '^\| (veach-ajar|window) \| 32 x 24 \| 6 \|' "$work/references/README.md")" 2
"$bin/exrdiff" --json "$work/references/window-1.exr" "$work/cache/window.reference-1.exr" |
  jq -e '.relmse > 0 and .relmse < 1e-7' >"$work/rounding" || fail "stored references are off"
references() { grep -c "^$1.reference.*--integrator" "$work/$2"; }
efficiency stored REF_SECONDS=0.2 INTEGRATORS=bdpt || fail "the run with stored references fails"
expect "references rendered where some are stored" "$(rendered stored)" 0
expect "stored references that the page tells of" "$(grep -c '(stored, rendered by tdpt-render ' "$page")" 2
expect "pixels of the reference taken" "$(cksum <"$work/cache/window.reference-1.exr")" "$(cksum <"$work/references/window-1.exr")"
efficiency render REF_SECONDS=0.2 REFERENCES=render ONLY=window INTEGRATORS=bdpt || fail "the run without stored references fails"
expect "rendered where stored ones are not wanted" "$(references window render)" 2
efficiency depth REF_SECONDS=0.2 DEPTH=5 ONLY=window INTEGRATORS=bdpt || fail "the run of another depth fails"
expect "rendered for another depth" "$(references window depth)" 2
efficiency size REF_SECONDS=0.2 WIDTH=28 ONLY=window INTEGRATORS=bdpt || fail "the run of another size fails"
expect "rendered for another size" "$(references window size)" 2
cp "$here/../testdata/scenes/small-hole.glb" "$work/scenes/veach-ajar.glb"
efficiency scene REF_SECONDS=0.2 ONLY=veach-ajar INTEGRATORS=bdpt || fail "the run of a changed scene fails"
expect "rendered for another scene" "$(references veach-ajar scene)" 2

# An error below the reference's noise has no PSNR; the other columns stay where they are.
jq '.mse += 1e6' "$work/cache/window.reference.json" >"$work/noisy" && cp "$work/noisy" "$work/cache/window.reference.json"
rm "$work/cache/window-bdpt-1-0.02.row"
efficiency noise REF_SECONDS=0.2 WIDTH=28 ONLY=window INTEGRATORS=bdpt || fail "the run with a noisy reference fails"
expect "PSNR and columns of an unknown one" \
  "$(awk -F , '$2 == "bdpt" && $3 == 1 && $4 == 0.02 { print "[" $8 "]", NF, ($11 < 0), ($12 > 5) }' "$csv")" "[] 12 1 1"

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
