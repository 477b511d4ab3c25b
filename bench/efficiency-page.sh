#!/bin/sh
# Sourced by efficiency.sh, in its folder of results and with its functions and variables: prints
# efficiency.md.
# shellcheck disable=SC2154  # variables of efficiency.sh

# of SCENE FIELD: of its line in scenes.tsv, three digits.
of() { awk -F '\t' -v s="$1" -v f="$2" '$1 == s { printf "%.3g", $f }' scenes.tsv; }
has() { case " $there " in *" $1 "*) ;; *) return 1 ;; esac; }

cat <<EOF
# Efficiency of the integrators

Written by \`make bench-efficiency\` ($("$bin/tdpt-render" --version), $(nproc 2>/dev/null || echo ?) cores; SECONDS_EACH=$each SEEDS=$seeds
REF_INTEGRATOR=$reference_integrator REF_SECONDS=$reference_seconds; \`bench/efficiency.sh\` tells the rest). Every picture is one thread's, $depth_words, \`--time $each\`,
the integrators taking turns; portals are found by ffgraph, mincut, lightgrid and portalfit, none is drawn by hand.
[efficiency.csv](efficiency.csv) has a row for each picture.

* Efficiency = 1 / (relMSE x CPU seconds). **Gain** = efficiency over bdpt's = mean of bdpt's relMSE x CPU seconds over the
  seeds / the same mean of the other's. The mean, not the median: it is what more samples would have to make up for.
* Brackets: 95 % intervals by bootstrap over the $seeds seeds, widened as the t distribution is for few (expanded percentiles).
  relMSE is heavy-tailed where bdpt is bad: fireflies that no seed met are missing from bdpt's mean and from the interval, so
  gains are more likely too small than too large.
* A reference is two halves of different seeds; what they have in common is taken for the truth, so their noise is in no error,
  only in MAPE and, a little, in the squares that relMSE divides by, where it makes all relMSE too large alike. Its own relMSE,
  of both halves together, stands with each scene. "-": hidden by the reference's noise.

EOF
busy=$(table busy "$each")
[ -z "$busy" ] || printf '%s\n\n' "$busy"
say '## Gain over bdpt'
say
table gains "$each"
cat <<EOF

![relMSE against CPU seconds, a panel for each scene](efficiency.png)

*Mean relMSE of $seeds seeds over CPU seconds; bars from the lowest to the highest seed. Dotted: a picture without light.*

## PSNR in the same time

Decibels over bdpt's, of the mean MSE x CPU seconds: pixels count by their light, so that directly lit regions decide.

EOF
table psnr "$each"
cat <<EOF

## Scene by scene

*mean / reference*: of the pictures of all lengths together, +- one standard error, the reference's noise included.
EOF
for scene in $there; do
  # shellcheck disable=SC2046  # two words
  set -- $(jq -r '"\(.width) \(.height)"' "$scene.reference-1.json")
  printf '\n### %s\n\n%s x %s pixels; ' "$scene" "$1" "$2"
  jq -r 'if .portals == [] then "no portal" + (if .reason then " (\(.reason))" else "" end)
    else "portals of " + ([.portals[].area * 1000 | round | . / 1000 | tostring] | join(" and ")) + " m2" end' \
    "$scene.portal.json" | tr -d '\n'
  printf '. Reference: %s CPU s of %s, relMSE %s.\n' "$(of "$scene" 9)" "$reference_integrator" "$(of "$scene" 8)"
  table check "$each" "$scene"
  say
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

if { has veach-ajar || has veach-ajar-flip; } && [ "$long_seeds" -gt 0 ]; then
  cat <<EOF

## relMSE after $long seconds, beside other programs

320 x 180, $depth_words. The other programs' figures are after 60 CPU seconds, at depth 6.
EOF
  for scene in veach-ajar veach-ajar-flip; do
    has $scene || continue
    printf '\n### %s after %s s\n\n| | relMSE, seed by seed | CPU s | wanted (moonshot) | met |\n|---|---|---|---|---|\n' \
      "$scene" "$long"
    case $scene in
      veach-ajar) bdpt=0.20 guiding='path guiding with next-event estimation | 0.23' metropolis=0.06-0.30 ;;
      *) bdpt=1.5 guiding='path guiding | 5' metropolis=0.32 ;;
    esac
    say "| Tungsten, BDPT | $bdpt | 60 | - | - |"
    say "| $guiding | 60 | - | - |"
    say "| multiplexed Metropolis | $metropolis | 60 | - | - |"
    table long "$long" "$scene"
    say "| all black | $(of "$scene" 10) | - | - | - |"
  done
fi
