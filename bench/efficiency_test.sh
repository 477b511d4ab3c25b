#!/bin/sh
# efficiency_test.sh BIN: the statistics of efficiency.awk on made-up measurements, and efficiency.sh at the size
# of a stamp. Exit 77, "skipped", where jq or gnuplot is missing.
bin=${1:?usage: efficiency_test.sh BIN}
here=$(cd "$(dirname "$0")" && pwd)
for program in jq gnuplot; do
  command -v $program >/dev/null || { echo "skipped: $program is missing (cmake/packages-figures.txt)"; exit 77; }
done
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
fail() { echo "$1"; failed=1; }
expect() { [ "$2" = "$3" ] || fail "$1: '$2' in place of '$3'"; }

# ---- Statistics ----
# measured FACTOR SPREAD SCENES: bdpt's relMSE is 8 and tdpt's 8 / FACTOR on average over many seeds, of
# eight of which each is off by up to SPREAD of it; tdpt takes half the samples, and 1 s less than bdpt's 4 s.
measured() {
  awk -v factor="$1" -v spread="$2" -v scenes="$3" -v list="$work/scenes.tsv" '
    function rest() { state = state * 48271 % 2147483647; return state / 2147483647 - 0.5 }
    function off() { return 1 + 2 * spread * rest() }
    BEGIN {
      state = 20261121
      print "scene,integrator,seed,seconds,spp,cpu_seconds,relmse,psnr,mape,mean,mse"
      for (s = 1; s <= scenes; ++s) {
        print "room" s "\t5\t9\t0.04\t0.02\t1\t0.0001\t0.001\t80\t0.7\t20\t90\tbdpt\t2000" >list
        for (k = 1; k <= 8; ++k) {
          print "room" s ",bdpt," k ",4,100,4," 8 * off() ",20,50," 1 + 0.001 * rest() ",0.01"
          print "room" s ",tdpt," k ",4,50,3," 8 / factor * off() ",23,40,1,0.005"
        }
      }
    }' >"$work/measured.csv"
}
# table NAME [VARIABLE=VALUE]
table() { awk -v table="$1" -v seconds=4 ${2:+-v "$2"} -f "$here/efficiency.awk" "$work/scenes.tsv" "$work/measured.csv"; }
gain_of() { table gains | sed -n "s/^| $1 | \(.*\) | 5 (9) | tdpt: \(.*\) |/\1 \2/p"; }

measured 6 0 1
expect "six times the efficiency in three quarters of the time" "$(gain_of room1)" '8.0 [8.0, 8.0] met'
expect "its PSNR" "$(table psnr | tail -n 1)" '| room1 | +4.3 [+4.3, +4.3] | tdpt: met |'
measured 3 0 1
expect "a gain below the target" "$(gain_of room1)" '4.0 [4.0, 4.0] missed'
measured 4 0.6 1
case $(gain_of room1) in *' within the noise') ;; *) fail "noise is not said: $(gain_of room1)" ;; esac
table check scene=room1 | grep -q 'they agree' || fail "equal means: $(table check scene=room1)"
awk -F , -v OFS=, '$2 == "bdpt" { $10 *= 1.02 } { print }' "$work/measured.csv" >"$work/bright.csv"
mv "$work/bright.csv" "$work/measured.csv"
table check scene=room1 | grep -q 'THEY DISAGREE' ||
  fail "two per cent too bright: $(table check scene=room1)"
# Errors of means are those that pictures of 100 samples scatter by: 0.0003 of one, 0.0001 of eight.
measured 4 0 1
table scene scene=room1 | grep -q '^| bdpt .* | 1.000[0-2] +- 0.0001 |\|^| bdpt .* | 0.999[89] +- 0.0001 |' ||
  fail "error of the mean: $(table scene scene=room1 | grep '| bdpt')"
measured 4 0.6 1
sed -i 's/,bdpt,1,4,100,4,[^,]*/,bdpt,1,4,100,4,-20/' "$work/measured.csv"
case $(gain_of room1) in *'[0, '*) ;; *) fail "an error below zero: $(gain_of room1)" ;; esac
expect "the best" "$(table best scene=room1)" tdpt
sed 's/,tdpt,\([0-9]*\),4,/,tdpt,\1,60,/' "$work/measured.csv" >"$work/long.csv"
awk -v table=long -v seconds=60 -v scene=room1 -f "$here/efficiency.awk" "$work/scenes.tsv" "$work/long.csv" |
  grep -q '^| tdpt | .* | at most 0.04 (0.02), every seed | missed |$' || fail "a relMSE of 2 is not too much"

# Intervals of 95 % hold the truth in 47 of 50 rooms; 41 is four standard deviations away.
measured 4.5 0.7 50
# held TRUTH: rooms whose interval holds it, and the median of upper over lower ends.
held() {
  table gains | sed -n 's/^| room[0-9]* | [0-9.]* \[\([0-9.]*\), \([0-9.]*\)\].*/\1 \2/p' |
    awk -v t="$1" '{ n += $1 <= t && t <= $2; print $2 / $1 } END { print "held", n }' | sort -g |
    awk '/held/ { n = $2; next } { x[++m] = $1 } END { print n, x[int((m + 1) / 2)] }'
}
set -- $(held 6)
[ "$1" -ge 41 ] || fail "$1 of 50 intervals hold the true gain"
awk -v w="$2" 'BEGIN { exit !(w > 1.3 && w < 3) }' || fail "intervals span a factor of $2"
set -- $(held 10)
[ "$1" -lt 41 ] || fail "$1 of 50 intervals hold a gain that is two thirds too large"

# ---- The whole ----
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
complete() {
  for heading in '## Gain' '## PSNR' '### window' '### veach-ajar' "## Beside the paper" '## relMSE after' 'Check: '; do
    grep -q "^$heading" "$1" || { echo "no $heading"; return; }
  done
  [ "$(grep -cE '^\| (bdpt|tdpt-org|all black)( \| [^| ][^|]*){10} \|$' "$1")" = 6 ] || { echo "rows of scenes"; return; }
  grep -qE '^\| tdpt-org \| [0-9.]+, [0-9.]+ \|' "$1" || { echo "no row after a minute"; return; }
  ! grep -wE 'nan|null|inf' "$1" || return
  [ -s "$work/doc/efficiency.png" ] || echo "no plot"
}
hole=$(complete "$page")
[ -z "$hole" ] || fail "efficiency.md: $hole"
sed '/^| bdpt |/d' "$page" >"$work/cut.md"
[ -n "$(complete "$work/cut.md")" ] || fail "a page without rows for bdpt passes"
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

efficiency unknown ONLY=cellar
[ $? = 2 ] && grep -q 'cellar is none of the scenes' "$work/unknown" || fail "an unknown scene is no error"
efficiency word SEEDS=many
[ $? = 2 ] || fail "a word as a number is no error"
efficiency none ONLY=veach-ajar SCENES="$work/empty"
[ $? = 3 ] || fail "no scene at all is no error"
efficiency wrong INTEGRATORS="bdpt none-such"
[ $? = 2 ] && grep -q none-such "$work/wrong" || fail "an unknown integrator is no error, or not named"
exit $failed
