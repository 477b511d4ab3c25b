#!/bin/sh
# Checks that man-references.sh finds each kind of reference that leads nowhere, and accepts those that do not.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/man" "$work/tools"
touch "$work/tools/one.cpp"
printf '.Sh HERE\n.Xr b 5\n.Sx THERE\n.Pa tools/one.cpp\n' >"$work/man/a.1"
printf '.Sh THERE\n' >"$work/man/b.5"
sh "$here/man-references.sh" "$work" || { echo "good pages are refused"; exit 1; }
for bad in '.Xr c 1' '.Sx NOWHERE' '.Pa tools/two.cpp'; do
  printf '.Sh HERE\n.Xr b 5\n%s\n' "$bad" >"$work/man/a.1"
  sh "$here/man-references.sh" "$work" >/dev/null && { echo "not found: $bad"; exit 1; }
done
exit 0
