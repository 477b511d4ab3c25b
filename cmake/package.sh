#!/bin/sh
# package.sh OUT: builds the Debian package of the sources here, OUT/tdpt_VERSION+debRELEASE_ARCH.deb, and
# OUT/tdpt-dbgsym_... with its debug symbols, and checks them with lintian. The same sources give the same bytes: its
# time is that of the last commit, or without git of debian/changelog.
set -eu
out=${1:?usage: package.sh OUT}
cd "$(dirname "$0")/.."
mkdir -p "$out"
out=$(cd "$out" && pwd)
work=$out/package
version=$(sed -n 's/^project(tdpt VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
packaged=$(dpkg-parsechangelog -S Version)
if [ "$version" != "$packaged" ]; then
  echo "package.sh: CMakeLists.txt says version $version, debian/changelog $packaged" >&2
  exit 1
fi

rm -rf "$work"
mkdir -p "$work/tdpt-$version"
if [ -e .git ]; then
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
else
  SOURCE_DATE_EPOCH=$(dpkg-parsechangelog -S Timestamp)
fi
export SOURCE_DATE_EPOCH
if [ -e .git ]; then
  git ls-files -z --cached --others --exclude-standard | xargs -0 sh -c 'for f; do [ ! -e "$f" ] || printf "%s\0" "$f"; done' sh
else
  find . \( -path './build*' -o -path ./demo \) -prune -o ! -type d -print0
fi | tar -c --null --no-recursion --mtime="@$SOURCE_DATE_EPOCH" -T - | tar -x -C "$work/tdpt-$version"
# Packages for two releases have different names.
# shellcheck source=/dev/null
release=$(. /etc/os-release; printf '%s%s' "$(printf %.3s "$ID")" "${VERSION_ID:-}")
sed -i "1s/($version)/($version+$release)/" "$work/tdpt-$version/debian/changelog"
# ccache's objects were compiled in another folder, which shows in the build IDs.
export CCACHE_DISABLE=1
export DEB_BUILD_OPTIONS="parallel=${JOBS:-$(nproc)}"
(cd "$work/tdpt-$version" && dpkg-buildpackage -b -us -uc) >"$work/log" 2>&1 || {
  tail -n 40 "$work/log" | cut -c 1-300 >&2
  echo "package.sh: dpkg-buildpackage fails; all that it said is in $work/log" >&2
  exit 1
}
rm -f "$out"/tdpt_*.deb "$out"/tdpt-dbgsym_*.deb
mv "$work"/tdpt_*.deb "$work"/tdpt-dbgsym_*.deb "$out"
rm -rf "$work/tdpt-$version"
lintian --allow-root --tag-display-limit 0 --fail-on error,warning "$out"/tdpt_*.deb "$out"/tdpt-dbgsym_*.deb
printf '%s\n' "$out"/tdpt_*.deb "$out"/tdpt-dbgsym_*.deb
