#!/bin/sh
# man-references.sh ROOT: checks that what the manual pages refer to is there: pages of ours (.Xr), sections (.Sx) of the
# page itself or of a page that it refers to, and files of the sources (.Pa). Exit 1 if not.
root=${1:?usage: man-references.sh ROOT}
cd "$root/man" || exit 2
status=0
complain() {
  echo "$1"
  status=1
}
words() { grep -oE "(^\.| )$1 [^ ]+( [157])?" "$2" | awk '{ print $2 ($3 ? "." $3 : "") }' | sort -u; }

for page in *.[157]; do
  others=$(words Xr "$page" | grep -vxE '(make|nohup)\.1')
  for other in $others; do
    [ -r "$other" ] || complain "$page refers to $other, which is missing"
  done
  grep -oE '(^\.|P[oq] )Sx [A-Za-z ]+' "$page" | sed -E 's/.*Sx //; s/ No in.*//; s/ +$//' | sort -u | while read -r section; do
    # shellcheck disable=SC2086
    grep -qsE "^\.S[hs] $section\$" "$page" $others || echo "$page refers to $section, which no page has that it names"
  done | grep . && status=1
  files=$(grep -oE '(tools|shaders|libcommon|doc)/[A-Za-z0-9_./-]*[a-z]' "$page" | sort -u)
  for file in $files; do
    [ -e "../$file" ] || complain "$page refers to $file, which is missing"
  done
done
exit $status
