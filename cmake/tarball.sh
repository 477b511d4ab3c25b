#!/bin/sh
# tarball.sh BUILD OUT: packs the build in BUILD as OUT/tdpt-VERSION-linux-MACHINE.tar.gz, which runs where nothing is
# installed: programs, man pages, completions, tdpt.mk, the scripts for farms, a font, and the libraries that they need
# except those of the system (libc, libstdc++) or of a driver (Vulkan's loader is opened at run time).
# share/doc/tdpt/libraries/ has the licence of each. The same build gives the same bytes: its time is that of the last
# commit, or without git of debian/changelog.
set -eu
build=${1:?usage: tarball.sh BUILD OUT} out=${2:?usage: tarball.sh BUILD OUT}
sources=$(cd "$(dirname "$0")/.." && pwd)
version=$(sed -n 's/^project(tdpt VERSION \([0-9.]*\).*/\1/p' "$sources/CMakeLists.txt")
name=tdpt-$version-linux-$(uname -m)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
stage=$work/$name
libraries=$stage/lib/tdpt
say() { printf '%s\n' "tarball.sh: $*" >&2; }
for tool in patchelf strip dpkg; do
  command -v $tool >/dev/null || { say "$tool is missing (cmake/packages-tarball.txt)"; exit 1; }
done

cmake --install "$build" --prefix "$stage" --strip >"$work/log" || { cat "$work/log" >&2; exit 1; }
mkdir -p "$libraries" "$stage/share/tdpt/fonts" "$stage/share/doc/tdpt/libraries"

# Libraries of the system, on every machine that can run the programs.
of_the_system='^(linux-vdso|ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util|gcc_s|stdc[+][+]))[.]so'
programs=$(for file in "$stage"/bin/*; do head -c 4 "$file" | grep -q ELF && printf '%s\n' "$file"; done)
# shellcheck disable=SC2086  # programs: one word each, the folder is of mktemp
ldd $programs >"$work/needed"
if grep 'not found' "$work/needed" >&2; then exit 1; fi
awk '$2 == "=>" { print $1, $3 }' "$work/needed" | sort -u | grep -vE "$of_the_system" >"$work/bundled"
while read -r soname path; do
  cp -L "$path" "$libraries/$soname"
  strip --strip-unneeded "$libraries/$soname"
  # shellcheck disable=SC2016  # $ORIGIN is the loader's
  patchelf --set-rpath '$ORIGIN' "$libraries/$soname"
done <"$work/bundled"
# shellcheck disable=SC2016,SC2086
patchelf --set-rpath '$ORIGIN/../lib/tdpt' $programs
chmod 644 "$libraries"/*

# Fonts for the previews on a system without any.
fonts=$(dpkg -L fonts-dejavu-core | grep -E '/DejaVuSans(-Bold)?[.]ttf$')
# shellcheck disable=SC2086
cp $fonts "$sources/cmake/fonts.conf" "$stage/share/tdpt/fonts"

# The package and licence of each library. dpkg may list files of /usr/lib as in /lib.
package_of() {
  file=$(readlink -f "$1")
  { dpkg -S "$file" || dpkg -S "${file#/usr}"; } 2>/dev/null | sed 's/:.*//; q'
}
while read -r soname path; do
  printf '%s %s\n' "$(package_of "$path")" "$soname"
done <"$work/bundled" | sort >"$work/packages"
printf 'fonts-dejavu-core DejaVuSans.ttf, DejaVuSans-Bold.ttf\n' >>"$work/packages"
list=$stage/share/doc/tdpt/libraries/README.md
{
  echo "# Libraries and fonts in this archive"
  echo
  echo "They are Debian's, unchanged but for where they look for one another. The sources of each are at"
  echo "https://sources.debian.org under the name and version of its source package; its licence lies beside this page."
  echo
  echo "| file | package | version | source package | licence |"
  echo "|---|---|---|---|---|"
} >"$list"
while read -r package file; do
  [ -n "$file" ] || { say "no package has $package: its licence is not known"; exit 1; }
  cp -L "/usr/share/doc/$package/copyright" "$stage/share/doc/tdpt/libraries/$package.txt"
  # shellcheck disable=SC2016
  dpkg-query -W -f '| '"$file"' | ${Package} | ${Version} | ${source:Package} ${source:Version} | ['"$package"'.txt]('"$package"'.txt) |\n' \
    "$package" | head -n 1 >>"$list"
done <"$work/packages"

if [ -e "$sources/.git" ]; then
  time=$(git -C "$sources" log -1 --format=%ct)
else
  time=$(cd "$sources" && sed -n 's/^ -- .*>  //p' debian/changelog | head -n 1 | xargs -0 date +%s -d)
fi
mkdir -p "$out"
rm -f "$out"/tdpt-*-linux-*.tar.gz  # of other versions
tar -c --sort=name --mtime="@$time" --owner=0 --group=0 --numeric-owner --mode=go-w -C "$work" "$name" | gzip -9n >"$out/$name.tar.gz.new"
mv "$out/$name.tar.gz.new" "$out/$name.tar.gz"
echo "$out/$name.tar.gz"
