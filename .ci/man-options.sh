#!/bin/sh
# man-options.sh PROGRAM PAGE: the long options in `PROGRAM --help` are those that the page's lists
# explain (lines `.It Fl -name`, also `.It Fl o , Fl -name`), no more and no fewer. Exit 1 if not.
program=${1:?usage: man-options.sh PROGRAM PAGE} page=${2:?usage: man-options.sh PROGRAM PAGE}
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
[ -r "$page" ] || { echo "$page is missing"; exit 1; }

"$program" --help >"$work/help" || { echo "$program --help fails"; exit 1; }
awk '/^  -/ { print $1; if ($1 ~ /,$/) print $2 }' "$work/help" | tr , '\n' |
  grep '^--' | sort -u >"$work/in-help"
grep '^\.It .*Fl' "$page" | grep -oE 'Fl (-|Fl )[a-z][a-z0-9-]*' | sed -E 's/^Fl (-|Fl )/--/' |
  sort -u >"$work/in-page"
[ -s "$work/in-help" ] || { echo "$program --help names no option"; exit 1; }

status=0
for option in $(comm -23 "$work/in-help" "$work/in-page"); do
  echo "$option stands in --help but not in $page"
  status=1
done
for option in $(comm -13 "$work/in-help" "$work/in-page"); do
  echo "$option stands in $page but not in --help"
  status=1
done
exit $status
