#!/bin/sh
# tarball_test.sh BUILD: the archive of the build in BUILD is complete: its programs run from another folder, using no
# external libraries but the system's, each with its licence; and a removed library is noticed. Exit 77, with a word, if
# tools are missing.
build=${1:?usage: tarball_test.sh BUILD}
here=$(cd "$(dirname "$0")" && pwd)
for tool in patchelf strip dpkg; do
  command -v $tool >/dev/null || { echo "skipped: $tool is missing (cmake/packages-tarball.txt)"; exit 77; }
done
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
wrong() { echo "$*"; failed=1; }

archive=$(GZIP=-1 sh "$here/tarball.sh" "$build" "$work") || exit 1
tar -x -C "$work" -f "$archive" || exit 1
rm "$archive"
top=$(echo "$work"/tdpt-*)

# Libraries loaded from outside of the archive.
outside() {
  find "$top/bin" "$top/lib" -type f -exec sh -c 'for f; do head -c 4 "$f" | grep -q ELF && ldd "$f"; done' sh {} + |
    grep -vE "$work|linux-vdso|/ld-linux|/lib(c|m|dl|rt|pthread|resolv|util|gcc_s|stdc[+][+])[.]so|^[^	]"
}
outside >"$work/said" && { wrong "libraries from outside:"; cat "$work/said"; }
for library in "$top"/lib/tdpt/*; do
  grep -q "^| ${library##*/} | " "$top/share/doc/tdpt/libraries/README.md" || wrong "${library##*/} has no licence"
done
for licence in $(sed -n 's/.*](\(.*[.]txt\)) |$/\1/p' "$top/share/doc/tdpt/libraries/README.md"); do
  [ -s "$top/share/doc/tdpt/libraries/$licence" ] || wrong "$licence is missing"
done
for file in bin/tdpt share/tdpt/tdpt.mk share/man/man1/tdpt.1 share/bash-completion/completions/tdpt share/tdpt/fonts/DejaVuSans.ttf; do
  [ -s "$top/$file" ] || wrong "$file is missing"
done

scene=$here/../testdata/scenes/two-rooms.glb
(cd "$work" && PATH=$top/bin:/usr/bin:/bin tdpt "$scene" --quality draft --width 32 --spp 1 --quiet -o room.exr && [ -s room.exr ]) ||
  wrong "tdpt fails"
printf '<fontconfig></fontconfig>' >"$work/none.conf"
(cd "$work" && FONTCONFIG_FILE=$top/share/tdpt/fonts/fonts.conf "$top/bin/ffgraph" "$scene" --quality draft --quiet -o room.max --preview room.png) ||
  wrong "no picture with the archive's own fonts"
FONTCONFIG_FILE=$work/none.conf "$top/bin/ffgraph" "$scene" --quality draft --quiet -o "$work/room.max" --preview "$work/room.png" \
  2>/dev/null && wrong "twin: a picture without any font"

rm "$top"/lib/tdpt/libembree*
outside >/dev/null || wrong "twin: a missing library is not noticed"
exit $failed
