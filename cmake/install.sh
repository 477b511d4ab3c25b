#!/bin/sh
# install.sh BUILD PREFIX: installs the build in BUILD under PREFIX, inside $DESTDIR if that is set, and writes a list
# for uninstall.sh: PREFIX/share/tdpt/installed, with paths without DESTDIR. Created folders are listed with a trailing
# slash. The entries of an earlier list are kept, so that those files can still be removed.
set -eu
build=${1:?usage: install.sh BUILD PREFIX} prefix=${2:?usage: install.sh BUILD PREFIX}
case $prefix in /*) ;; *) prefix=$PWD/$prefix ;; esac
root=${DESTDIR:-}
list=$prefix/share/tdpt/installed
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Dry run, to learn the names.
DESTDIR=$work/trial cmake --install "$build" --prefix "$prefix" >"$work/log" || { cat "$work/log"; exit 1; }
mkdir -p "$work/trial${list%/*}"
(cd "$work/trial" && find . ! -type d) | sed 's/^\.//' >"$work/list"
(cd "$work/trial" && find . -type d ! -name .) | sed 's/^\.//' | while IFS= read -r folder; do
  [ -d "$root$folder" ] || printf '%s/\n' "$folder"
done >>"$work/list"
printf '%s\n' "$list" >>"$work/list"
if [ -f "$root$list" ]; then cat "$root$list" >>"$work/list"; fi

mkdir -p "$root${list%/*}"
LC_ALL=C sort -u "$work/list" >"$root$list.new"
mv "$root$list.new" "$root$list"
cmake --install "$build" --prefix "$prefix"
