#!/bin/sh
# debian-control.sh ROOT: checks that the Debian package's build dependencies are those of cmake/packages.txt, except
# the compiler, which every package has, ccache and fonts, and that its version is the project's, as in CITATION.cff and
# CHANGELOG.md. Exit 1 if not.
cd "${1:?usage: debian-control.sh ROOT}" || exit 2
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
status=0

sed 's/#.*//' cmake/packages.txt | tr -s ' ' '\n' | grep -vE '^(g\+\+|ccache|fonts-.*|)$' | sort >"$work/listed"
awk '/^[^ ]/ { on = /^Build-Depends:/ } on' debian/control | sed 's/^Build-Depends://; s/([^)]*)//g' | tr -d ' ' | tr , '\n' |
  grep -vE '^(debhelper-compat|)$' | sort >"$work/depended"
[ -s "$work/listed" ] && [ -s "$work/depended" ] || { echo "debian-control: nothing to compare"; exit 2; }
for package in $(comm -23 "$work/listed" "$work/depended"); do
  echo "debian/control: $package of cmake/packages.txt is missing in Build-Depends"
  status=1
done
for package in $(comm -13 "$work/listed" "$work/depended"); do
  echo "debian/control: $package in Build-Depends is not in cmake/packages.txt"
  status=1
done

version=$(sed -n 's/^project(tdpt VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
[ -n "$version" ] || { echo "CMakeLists.txt: no version"; exit 2; }
[ "$(sed -n '1s/.*(\(.*\)).*/\1/p' debian/changelog)" = "$version" ] ||
  { echo "debian/changelog: its first version is not $version, as in CMakeLists.txt"; status=1; }
[ "$(sed -n 's/^version: *//p' CITATION.cff)" = "$version" ] ||
  { echo "CITATION.cff: its version is not $version, as in CMakeLists.txt"; status=1; }
[ "$(sed -n 's/^## \[\([0-9.]*\)\] - .*/\1/p' CHANGELOG.md | head -1)" = "$version" ] ||
  { echo "CHANGELOG.md: its newest version is not $version, as in CMakeLists.txt"; status=1; }
exit $status
