#!/bin/sh
# stages_test.sh BIN: stages.sh on a scene of testdata; every picture of doc/stages.md is made.
bin=${1:?usage: stages_test.sh BIN}
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
sh "$here/python.sh" "$here/sky_rooms.py" "$work" >&2 || exit
SCENE="$here/../testdata/scenes/two-rooms.glb" INTERIOR="$here/../testdata/scenes/window.glb" DOC="$work/doc" \
  WINDOWS="$work/skylight.gltf" SKY=1,1,1 sh "$here/stages.sh" "$bin" "$work/cache" \
  >"$work/said" 2>&1 || { cat "$work/said"; exit 1; }
# missing PAGE: pictures that the page shows and the script did not make.
missing() {
  for file in $(sed -n 's/.*!\[.*\](\(figures[^)]*\)).*/\1/p' "$1"); do
    [ -s "$work/doc/$file" ] || echo "$file"
  done
}
failed=0
[ -z "$(missing "$here/../doc/stages.md")" ] || { missing "$here/../doc/stages.md"; failed=1; }
[ "$(sed -n '/!\[/p' "$here/../doc/stages.md" | wc -l)" = 9 ] || { echo "stages.md has not nine pictures"; failed=1; }
rm "$work/doc/figures/stage-mincut.png"
[ -n "$(missing "$here/../doc/stages.md")" ] || { echo "a missing picture passes"; failed=1; }
SCENE="$work/none.glb" DOC="$work/doc" sh "$here/stages.sh" "$bin" "$work/cache" 2>"$work/none"
[ $? = 3 ] && grep -q 'there is no scene' "$work/none" || { echo "no scene is no error"; failed=1; }
exit $failed
