#!/bin/sh
# man-functions.sh ROOT PAGE: checks that every function that PAGE names (a line `.Fn name`, then a line `.Pa file`) is
# in that file, and that every page it refers to exists. Exit 1 if not.
root=${1:?usage: man-functions.sh ROOT PAGE} page=${2:?usage: man-functions.sh ROOT PAGE}
status=0
pairs=$(awk '$1 == ".Fn" { name = $2; next }
             name != "" { print name "," ($1 == ".Pa" ? $2 : "(no file)"); name = "" }' "$page")
[ -n "$pairs" ] || { echo "$page names no function"; exit 1; }
for pair in $pairs; do
  name=${pair%,*} file=${pair#*,}
  if ! grep -qE "(^|[^A-Za-z0-9_])$name\(" "$root/$file"; then
    echo "$page: $name() is not in $file"
    status=1
  fi
done
for other in $(sed -n 's/^\.Xr \([^ ]*\) \([157]\).*/\1.\2/p' "$page"); do
  [ -r "$root/man/$other" ] || { echo "$page refers to $other, which is missing"; status=1; }
done
exit $status
