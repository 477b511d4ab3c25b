#!/bin/sh
# Sourced by figures.sh, in its folder of results and with its functions and variables: prints
# figures.md.
# shellcheck disable=SC2154  # variables of figures.sh

# percent SHARE-FILTER FILE
percent() { of "$2" "100 * $1" '%.3g %%'; }
size_of() { jq -r '"\(.width) x \(.height)"' "$1"; }

cat <<EOF
# The paper's figures from our renders

Written by \`make figures\` ($("$bin/tdpt-render" --version | head -1), $(nproc 2>/dev/null || echo ?) cores), which
finds the portals of the scenes in \`SCENES\`, renders, compares and draws. The same at another size:

    make figures HEIGHT=360 SPP=$spp FRAMES=$frames REF_SPP=$reference_spp SCENES=FOLDER

Times are CPU seconds of rendering alone. \`tdpt\` is the paper's TDPT-REF. The paper's own numbers stand
beside ours where its text gives them; "not in the text" means that they are in a picture of the paper or
nowhere. Its scenes, portals and machine are not ours, so compare rows rather than digits.

## Portals

| scene | portals | area [m2] | share of the light | support |
|---|---|---|---|---|
EOF
for scene in $there; do
  jq -r --arg scene "$scene" 'def round(d): . * pow(10; d) + 0.5 | floor | . / pow(10; d);
    .portals as $p | "| \($scene) | \($p | length)" +
    if $p == [] then (if .reason then " (\(.reason))" else "" end) + " | - | - | - |"
    else " | " + ([$p[] | .area | round(3) | tostring] | join(", ")) + " | "
      + ([$p[] | .flux_share * 100 | round(1) | "\(.) %"] | join(", ")) + " | "
      + ([$p[] | .support | round(2) | tostring] | join(", ")) + " |" end' "$scene.portal.json"
done
for scene in $there; do
  [ "$(jq '.portals | length' "$scene.portal.json")" = 0 ] || continue
  printf '\nNo portal in %s: there tdpt-org is bdpt, and tdpt is left with camera, direct and light.\n' "$scene"
done

if has cornell-box-portal; then
  cat <<EOF

## Fig 5: Cornell with a hole, depth 6, $frames samples per pixel, $(size_of fig5-pt.json)

![Non-zero share, mean and CPU seconds per frame over samples per pixel](figures/fig5.svg)

| integrator | non-zero at 1 spp | the paper | at $frames spp | mean at $frames spp | the paper | CPU s per frame | the paper |
|---|---|---|---|---|---|---|---|
EOF
  for i in $integrators; do
    case $i in
      pt) share='0.00619 %' time='not in the text' ;;
      nee) share='0.382 %' time='not in the text' ;;
      bdpt) share='4.79 %' time='not in the text' ;;
      tdpt-org) share='27.6 %' time='3.1 s' ;;
      tdpt) share='24.4 %' time='2.5 s' ;;
    esac
    s=fig5-$i.json
    printf '| %s | %s | %s | %s | %s | about 0.02 | %s | %s |\n' "$i" \
      "$(percent '.frames[0].nonzero' "$s")" "$share" "$(percent .nonzero "$s")" \
      "$(of "$s" '.mean | add / 3')" "$(of "$s" '.cpu_seconds / .spp')" "$time"
  done
  awk -v org="$(of fig5-tdpt-org.json .cpu_seconds %.6g)" -v ref="$(of fig5-tdpt.json .cpu_seconds %.6g)" 'BEGIN {
    change = 100 * (1 - ref / org)
    printf "\nA frame of tdpt takes %.0f %% %s CPU time than one of tdpt-org; the paper: about 20 %% less.\n",
      change < 0 ? -change : change, change < 0 ? "more" : "less" }'
fi

if has veach-ajar-flip; then
  cat <<EOF

## Fig 6: veach-ajar-flip, 1 sample per pixel, depth 5, $(size_of fig6-bdpt.json)

Red: some light arrived. Green: none.

| bdpt | tdpt-org | tdpt |
|---|---|---|
| ![bdpt](figures/fig6-bdpt.png) | ![tdpt-org](figures/fig6-tdpt-org.png) | ![tdpt](figures/fig6-tdpt.png) |
EOF
  printf '|'
  for i in bdpt tdpt-org tdpt; do printf ' %s non-zero |' "$(percent .nonzero fig6-$i.json)"; done
  printf '\n|'
  for i in bdpt tdpt-org tdpt; do printf ' mean %s |' "$(of fig6-$i.json '.mean | add / 3')"; done
  printf '\n\nThe paper: mean 0.044 for all three; the shares are not in the text.\n'
fi

cat <<EOF

## Fig 7: $spp samples per pixel, depth 5

Against tdpt-org with $reference_spp samples per pixel and another seed, whose own noise counts against everyone:
$(awk -v a="$spp" -v b="$reference_spp" 'BEGIN { printf "%.2g %%", 100 * a / b }') of tdpt-org's relMSE. *Trimmed* is relMSE without the worst thousandth of the pixels; *all black* is the
score of a picture of no light. *Efficiency* is 1 / (relMSE x CPU s), bdpt's being 1; it stays open ("-") where
the mean is a fifth or more off, since then too few paths were found to judge by.
The paper prints its PSNR and MAPE inside a picture: not in the text.
EOF
row() { printf '| %s | %s | %s | %s | %s | %s | %s | %s | %s |\n' "$@"; }
for scene in $there; do
  printf '\n### %s\n\n%s pixels\n\n' "$scene" "$(size_of "$scene-bdpt.json")"
  row integrator 'PSNR [dB]' 'MAPE [%]' relMSE trimmed 'non-zero' mean 'CPU s' efficiency
  row --- --- --- --- --- --- --- --- ---
  for i in $integrators; do
    e=$scene-$i.error.json s=$scene-$i.json
    row "$i" "$(of "$e" .psnr %.2f)" "$(of "$e" .mape)" "$(of "$e" .relmse)" \
      "$(of "$e" .relmse_trimmed)" "$(percent .nonzero "$e")" "$(of "$e" .mean)" \
      "$(of "$s" .cpu_seconds)" \
      "$(awk -v e="$(of "$e" .relmse %.9g)" -v t="$(of "$s" .cpu_seconds %.9g)" \
        -v e0="$(of "$scene-bdpt.error.json" .relmse %.9g)" \
        -v t0="$(of "$scene-bdpt.json" .cpu_seconds %.9g)" \
        -v m="$(of "$e" '.mean / .reference_mean' %.9g)" \
        'BEGIN { if (e * t > 0 && m > 0.8 && m < 1.2) printf "%.2g", e0 * t0 / (e * t); else printf "-" }')"
  done
  e=$scene-bdpt.error.json
  row 'all black' "$(of "$e" .black.psnr %.2f)" "$(of "$e" .black.mape)" "$(of "$e" .black.relmse)" \
    - - 0 - -
  row reference - - - - "$(percent .nonzero "$scene-reference.json")" "$(of "$e" .reference_mean)" \
    "$(of "$scene-reference.json" .cpu_seconds)" -
  case $scene in
    veach-ajar-flip) says='no direct light; "the metrics of TDPT occupy an overwhelming advantage"' ;;
    bathroom2) says='a large window; "the advantage of TDPT is not apparent"' ;;
    *) says='not in the text' ;;
  esac
  printf '\nThe paper: %s. ' "$says"
  jq -rs '"\(.[0].psnr) \(.[1].psnr) \(.[0].mape) \(.[1].mape) \(.[0].relmse) \(.[1].relmse)"' \
    "$scene-tdpt.error.json" "$scene-bdpt.error.json" | awk '{
      printf "Here tdpt has %+.1f dB of PSNR against bdpt, ", $1 - $2
      printf "a MAPE of %.3g %% against %.3g %%, a relMSE of %.3g against %.3g.\n", $3, $4, $5, $6 }'
  for i in bdpt tdpt; do
    printf '\n![%s left, reference right](figures/fig7-%s-%s.png)\n*%s, reference*\n' "$i" "$scene" "$i" "$i"
  done
  warnings=$(sed -n 's/^tdpt-render: warning: //p' "$scene-reference.log" "$scene-bdpt.log" |
    grep -v '^there is no portal in\|^no portal is given' | sort -u)
  if [ -n "$warnings" ]; then
    printf '\nThe renderer warns:\n\n'
    printf '%s\n' "$warnings" | sed 's/^/- /'
  fi
done
