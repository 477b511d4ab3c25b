#!/bin/sh
# Sourced by efficiency.sh, in its folder of results and with its functions and variables: the references,
# SCENE.reference-1.exr and -2.exr with what is known of them in .json beside, and how far apart they are,
# SCENE.reference.json.
# shellcheck disable=SC2154  # variables of efficiency.sh

# stored_fits SCENE: there is a stored one of this scene, depth and size. It may come from any program: all converge to
# the same picture.
stored_fits() {
  [ -s "$stored/$1.json" ] && [ "$references" != render ] &&
    [ "$(jq -r '"\(.scene), \(.max_depth // "none"), --width \(.width) --height \(.height)"' "$stored/$1.json")" = \
      "$(cat "$(file_of "$1").sum"), $(depth_of "$1"), $(size_of "$1")" ]
}
# take SCENE: the stored one.
take() {
  for h in 1 2; do
    key="stored $(cat "$stored/$1.json" "$stored/$1-$h.exr" | cksum)"
    made "$1.reference-$h.exr" "$key" && continue
    jq --argjson i $((h - 1)) '{integrator, width, height, spp: .spp[$i], cpu_seconds: .cpu_seconds[$i],
      stored: .program}' "$stored/$1.json" >"$1.reference-$h.json"
    cp "$stored/$1-$h.exr" "$1.reference-$h.exr"
    keep "$1.reference-$h.exr" "$key"
  done
}
# half_seconds SCENE: CPU seconds of each half.
half_seconds() {
  share=1
  [ "$(about "$1" 2)" -lt 320 ] || share=8
  [ "$(about "$1" 5)" != - ] || share=$(calculate $share 2 a/b)
  calculate "$reference_seconds" "$share" 'a * b / 2'
}
for scene in $there; do
  if stored_fits "$scene"; then take "$scene"; continue; fi
  for h in 1 2; do
    render "$scene.reference-$h" "$scene" "$reference_integrator" $((1000000 + h)) "$(half_seconds "$scene")"
  done
done
finish

if [ "$references" = make ]; then
  for scene in $there; do
    stored_fits "$scene" && continue
    sh "$here/bench/python.sh" "$here/bench/stored_reference.py" "$stored" "$scene" "$(path_of "$scene")" \
      "$scene.reference-1" "$scene.reference-2" "$("$bin/tdpt-render" --version | head -1)${COMMIT:+, $COMMIT}"
    jq -rs --argjson asked "$(half_seconds "$scene")" '(map(.cpu_seconds) | add) as $got |
      "efficiency: \(input_filename | rtrimstr(".reference-2.json")): stored, \($got | round) of \(2 * $asked) CPU seconds" +
      if $got < 1.7 * $asked then ": THE MACHINE WAS BUSY" else "" end' \
      "$scene.reference-1.json" "$scene.reference-2.json"
  done
  exit 0
fi

compare() { "$bin/exrdiff" --quiet --json "$1" "$2"; }
for scene in $there; do
  a=$scene.reference-1 b=$scene.reference-2
  key="$(cat "$a.exr.key") $(cat "$b.exr.key")"
  made "$scene.reference.json" "$key" && continue
  { compare "$a.exr" "$b.exr"; compare "$b.exr" "$a.exr"; } |
    jq -s 'def m(f): map(f) | add / 2; {relmse: m(.relmse), mse: m(.mse), peak: m(.peak), mean: m(.mean),
      half: ((.[0].mean - .[1].mean) / 2 | fabs),
      black: {relmse: m(.black.relmse), psnr: m(.black.psnr), mape: m(.black.mape)}}' >"$scene.reference.json"
  keep "$scene.reference.json" "$key"
done
