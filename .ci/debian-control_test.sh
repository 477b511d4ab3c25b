#!/bin/sh
# debian-control_test.sh: debian-control.sh detects planted faults.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
# faulty FILE EDIT PATTERN: with FILE edited in this way, a line of the output matches PATTERN.
faulty() {
  rm -rf "$work/root"
  mkdir -p "$work/root/cmake" "$work/root/debian"
  for file in CMakeLists.txt CITATION.cff CHANGELOG.md cmake/packages.txt debian/control debian/changelog; do
    cp "$here/../$file" "$work/root/$file"
  done
  sed "$2" "$work/root/$1" >"$work/edited" && mv "$work/edited" "$work/root/$1"
  if sh "$here/debian-control.sh" "$work/root" >"$work/said" || ! grep -q "$3" "$work/said"; then
    echo "$1 after $2: not found: $3"
    failed=1
  fi
}
faulty cmake/packages.txt '$a libnew-dev' 'libnew-dev .* is missing'
faulty cmake/packages.txt /libfmt/d 'libfmt-dev .* is not in'
faulty debian/changelog 1s/0/9/ 'debian/changelog'
faulty CITATION.cff 's/^version: /&9/' 'CITATION.cff'
faulty CHANGELOG.md 's/^## .0.*/## Next/' 'CHANGELOG.md'
exit $failed
