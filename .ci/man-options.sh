#!/bin/sh
# man-options.sh PROGRAM PAGE: checks that the page explains exactly the long options and settings in `PROGRAM --help`
# (lines `.It Fl -name`, also `.It Fl o , Fl -name`; `.It Cm name Ns =` for a setting). Exit 1 if not.
program=${1:?usage: man-options.sh PROGRAM PAGE} page=${2:?usage: man-options.sh PROGRAM PAGE}
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
[ -r "$page" ] || { echo "$page is missing"; exit 1; }

"$program" --help >"$work/help" || { echo "$program --help fails"; exit 1; }
{
  awk '/^  -/ { print $1; if ($1 ~ /,$/) print $2 }' "$work/help" | tr , '\n' | grep '^--'
  sed -nE 's/^  ([a-z-]+)=.*/--set \1/p' "$work/help"
  sed -n '/^Limits/,$p' "$work/help" | grep -oE '[a-z-]+=' | sed 's/^/--set /; s/=$//'
} | sort -u >"$work/in-help"
{
  grep '^\.It Fl' "$page" | grep -oE 'Fl (-|Fl )[a-z][a-z0-9-]*' | sed -E 's/^Fl (-|Fl )/--/'
  grep '^\.It Cm' "$page" | grep -oE 'Cm [a-z-]+ Ns =' | sed -E 's/^Cm ([a-z-]+) .*/--set \1/'
} | sort -u >"$work/in-page"
[ -s "$work/in-help" ] || { echo "$program --help names no option"; exit 1; }

status=0
comm -23 "$work/in-help" "$work/in-page" >"$work/lacks"
comm -13 "$work/in-help" "$work/in-page" >"$work/more"
[ ! -s "$work/lacks" ] || { status=1; sed "s|\$| stands in --help but not in $page|" "$work/lacks"; }
[ ! -s "$work/more" ] || { status=1; sed "s|\$| stands in $page but not in --help|" "$work/more"; }
exit $status
