#!/bin/sh
# Sourced by efficiency.sh, in its folder of results and with its functions and variables: prints
# efficiency.md.
# shellcheck disable=SC2154  # variables of efficiency.sh

# of SCENE FIELD: of its line in scenes.tsv, three digits.
of() { awk -F '\t' -v s="$1" -v f="$2" '$1 == s { printf "%.3g", $f }' scenes.tsv; }
has() { case " $there " in *" $1 "*) ;; *) return 1 ;; esac; }
# part WORDS TABLE..., section HEADING WORDS TABLE...: nothing where the table is empty.
part() {
  words=$1
  shift
  rows=$(table "$@")
  [ -z "$rows" ] || printf '\n%s\n\n%s\n' "$words" "$rows"
}
section() {
  heading=$1
  shift
  rest=$(part "$@")
  [ -z "$rest" ] || printf '\n## %s\n%s\n' "$heading" "$rest"
}

if [ -n "$baseline" ]; then
  over="bdpt of $baseline_name" better="the better of bdpt and nee of $baseline_name"
else
  over=bdpt better='the better of bdpt and nee'
fi
cat <<EOF
# Efficiency of the integrators

Written by \`make bench-efficiency\` ($("$bin/tdpt-render" --version | head -1), $(nproc 2>/dev/null || echo ?) cores; SECONDS_EACH=$each SEEDS=$seeds
INTEGRATORS="$integrators"; \`bench/efficiency.sh\` tells the rest). Every picture is one thread's, $depth_words
unless said otherwise, \`--time $each\`, the integrators taking turns; portals are found by ffgraph, mincut, lightgrid and
portalfit, none is drawn by hand. [efficiency.csv](efficiency.csv) has a row for each picture.

EOF
[ -z "$baseline" ] || cat <<EOF
* \`bdpt-before\` and \`nee-before\` are bdpt and nee of another program, $baseline_name ($("$baseline" --version | head -1)), in the same run.
EOF
cat <<EOF
* Efficiency = 1 / (relMSE x CPU seconds). **Gain** = efficiency over another's = mean of the other's relMSE x CPU seconds over
  the seeds / the same mean of its own. The mean, not the median: it is what more samples would have to make up for.
* Gains are over $over, in scenes without a door over $better. bdpt's own
  efficiency stands beside, so that no gain comes of a bdpt made worse.
* Brackets: 95 % intervals by bootstrap over the $seeds seeds, widened as the t distribution is for few (expanded percentiles).
  relMSE is heavy-tailed where bdpt is bad: fireflies that no seed met are missing from bdpt's mean and from the interval, so
  gains are more likely too small than too large.
* Aims are asked of \`auto\`, the default, or, where it was not measured, of the best with portals.
* A reference is two halves of different seeds; what they have in common is taken for the truth, so their noise is in no error,
  only in MAPE and, a little, in the squares that relMSE divides by, where it makes all relMSE too large alike. Its own relMSE,
  of both halves together, stands with each scene, beside what it judges: the relMSE that would meet the scene's aim in
  the same time, without an aim that of bdpt. "-": hidden by the reference's noise.
* MiB: the most memory that any seed's run held.
EOF
# shellcheck disable=SC2043  # one word each
for table in busy noisy; do
  words=$(table $table "$each")
  [ -z "$words" ] || printf '\n%s\n' "$words"
done
section 'Doors, holes, windows' "Gain over $over." gains "$each" doors
section 'Furnished rooms, and a box' "No door; portals where the four stages find any. Gain over $better." gains "$each" rooms
section 'No limit of depth' "Gain over bdpt of this program; references of their own. NAME-whole is scene NAME." \
  gains "$each" whole
cat <<EOF

![relMSE against CPU seconds, a panel for each scene](efficiency.png)

*Mean relMSE of $seeds seeds over CPU seconds; bars from the lowest to the highest seed. Dotted: a picture without light.*

## PSNR in the same time

Decibels, of the mean MSE x CPU seconds: pixels count by their light, so that directly lit regions decide.
EOF
part "Over $over." psnr "$each" doors
part "Over $better, that of the smaller relMSE." psnr "$each" rooms
part "No limit of depth, over bdpt of this program." psnr "$each" whole
cat <<EOF

## Scene by scene

*mean / reference*: of the pictures of all lengths together, +- one standard error, the reference's noise included.
EOF
for scene in $there; do
  # shellcheck disable=SC2046  # two words
  set -- $(jq -r '"\(.width) \(.height)"' "$scene.reference-1.json")
  printf '\n### %s\n\n%s x %s pixels; ' "$scene" "$1" "$2"
  [ "$(kind_of "$scene")" != whole ] || printf 'no limit of depth; '
  jq -r 'if .portals == [] then "no portal" + (if .reason then " (\(.reason))" else "" end)
    else "portals of " + ([.portals[].area * 1000 | round | . / 1000 | tostring] | join(" and ")) + " m2" end' \
    "$(file_of "$scene").portal.json" | tr -d '\n'
  jq -r --arg seconds "$(of "$scene" 11)" '". Reference: \($seconds) CPU s of \(.integrator)" +
    if .stored then " (stored, rendered by \(.stored)), " else ", " end' "$scene.reference-1.json" | tr -d '\n'
  table scene "$each" "$scene"
done

# paper SCENE WORDS
paper() {
  if has "$1"; then say "| $1 | $2 | not in the text | $(table paper "$each" "$1") |"; fi
}
if has veach-ajar || has veach-ajar-flip || has bathroom2-channel || has cornell-box-portal; then
  cat <<EOF

## Beside the paper's Fig. 7

The paper compares its TDPT, here \`tdpt\`, with BDPT at 16 samples per pixel and depth 5. It prints PSNR and MAPE inside a
picture, not in its text. Ours are after the same time; after the same samples they are in [figures.md](figures.md).

| scene | the paper's words | the paper's PSNR, MAPE | PSNR, tdpt - bdpt | MAPE, tdpt against bdpt |
|---|---|---|---|---|
EOF
  paper veach-ajar -
  paper veach-ajar-flip '"the metrics of TDPT occupy an overwhelming advantage"'
  paper bathroom2-channel '-; of bathroom2 without the channel "the advantage of TDPT is not apparent"'
  paper cornell-box-portal -
fi

if [ "$long_seeds" -gt 0 ]; then
  section "Gain after $long seconds" "$long_seeds seeds; over $over." gains "$long" doors
  section "Gain after $long seconds in furnished rooms" "$long_seeds seeds; over $better." gains "$long" rooms
fi
if { has veach-ajar || has veach-ajar-flip; } && [ "$long_seeds" -gt 0 ]; then
  cat <<EOF

## relMSE after $long seconds, beside other programs

320 x 180, $depth_words. The other programs' figures are for 60 CPU seconds at depth 6; they were measured outside of
this script, on a like machine. Metropolis light transport is Tungsten's, multiplexed (MMLT); its error differs much from
run to run.
EOF
  for scene in veach-ajar veach-ajar-flip; do
    has $scene || continue
    printf '\n### %s after %s s\n\n| | relMSE, seed by seed | CPU s | wanted (moonshot) | met |\n|---|---|---|---|---|\n' \
      "$scene" "$long"
    case $scene in
      veach-ajar) bdpt=0.20 guiding='path guiding with next-event estimation | 0.23' metropolis='0.06 to 0.30' ;;
      *) bdpt=1.5 guiding='path guiding | 5' metropolis=0.32 ;;
    esac
    say "| Tungsten, BDPT | $bdpt | 60 | - | - |"
    say "| $guiding | 60 | - | - |"
    say "| Tungsten, multiplexed Metropolis | $metropolis | 60 | - | - |"
    table long "$long" "$scene"
    say "| all black | $(of "$scene" 12) | - | - | - |"
  done
fi
