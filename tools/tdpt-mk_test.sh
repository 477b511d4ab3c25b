#!/bin/sh
# tdpt-mk_test.sh BIN TESTDATA: what tdpt.mk makes, and what it does not make again; exit 77 without GNU Make.
bin=$(cd "${1:?usage: tdpt-mk_test.sh BIN TESTDATA}" && pwd) testdata=$(cd "${2:?}" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
make --version 2>/dev/null | grep -q 'GNU Make' || { echo "skipped: GNU Make is missing"; exit 77; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
unset MAKEFLAGS MFLAGS MAKELEVEL
LC_ALL=C
export LC_ALL
cd "$work" || exit 2
failed=0
complain() {
  echo "$1"
  [ ! -s log ] || sed 's/^/  /' log
  failed=1
}

cat >Makefile <<END
TDPT_BIN = $bin/
FFGRAPH_FLAGS = --set walks=2000 --samples 10000 --set rounds=0
LIGHTGRID_FLAGS = --resolution 16 --set lines=200
TDPT_RENDER_FLAGS = --spp 1 --width 16
QUIET = 1
include $here/tdpt.mk
all: \$(TDPT_PICTURES)
SCENE.night = loose
SCENE.hidden = loose
night.exr: private ENVIRONMENT = sky.exr
hidden.exr: PORTALS =
END
cp "$testdata/scenes/two-rooms.glb" whole.glb
cp "$testdata/environments/clear.exr" sky.exr
sh "$here/../libcommon/testing/files/loose_scene.sh" whole.glb loose || exit 2

# What make says that it makes, in a line: its commands name it after -MQ.
targets() { sed -n 's/.* -MQ \([^ ]*\).*/\1/p' log | sort | tr '\n' ' '; }
# makes WHY TARGETS ARGUMENTS...: make ARGUMENTS makes TARGETS (sorted), each once, and no other.
makes() {
  why=$1 expected=$2
  shift 2
  make "$@" >log 2>&1 || complain "$why: make $* fails"
  [ "$(targets)" = "$expected" ] || complain "$why: made '$(targets)', expected '$expected'"
}
of() { for end in cut exr max portal.glb vdb; do printf '%s.%s ' "$1" "$end"; done; }

makes "two scenes at once" "$(of loose)$(of whole)" -j4
for name in loose.max loose.cut loose.vdb loose.portal.glb loose.exr whole.exr; do
  [ -s $name ] || complain "$name is missing"
done
makes "a second time" ""
grep -q "Nothing to be done for 'all'" log || complain "a second time: not silent"
makes "what shapes nothing" "" THREADS=1 MAX_MEMORY=8G QUIET= TDPT_BIN="$bin/"
SEED=x THREADS=x DEVICE=x ENVIRONMENT=production makes "variables of the shell" ""

# What is to be made where something else is asked for or has changed.
makes "other flags of the grid" "whole.exr whole.portal.glb whole.vdb " LIGHTGRID_FLAGS='--resolution 40' -n whole.exr
makes "another seed" "$(of whole)" SEED=2 -n whole.exr
makes "another quality" "$(of whole)" QUALITY=draft -n whole.exr
makes "another device" "whole.exr whole.portal.glb whole.vdb " DEVICE=gpu -n whole.exr
makes "another mincut" "whole.cut whole.exr whole.portal.glb whole.vdb " MINCUT=my-mincut -n whole.exr
makes "another camera for all" "$(of whole)" CAMERA_FLAGS=--frame -n whole.exr
printf ' ' >>loose.bin
makes "another buffer" "$(of loose)" -n
touch loose.max loose.cut loose.vdb loose.portal.glb loose.exr
makes "other flags of the renderer" "whole.exr " TDPT_RENDER_FLAGS="--spp 2 --width 16 --integrator 'bdpt' --preview" whole.exr
makes "the same other flags" "" TDPT_RENDER_FLAGS="--spp 2 --width 16 --integrator 'bdpt' --preview" whole.exr
[ -s whole.png ] && [ ! -e whole.partial.png ] || complain "a preview asked of the renderer lies elsewhere"

makes "pictures of one scene" "hidden.exr night.exr " night.exr hidden.exr
touch sky.exr
makes "another sky" "night.exr " -n night.exr hidden.exr loose.exr
if grep -q portal .tdpt/hidden.exr.d; then complain "hidden.exr: has portals"; fi

# Portals belong to a camera: pictures through others have their own. Found for several cameras together, they are shared.
cameras="SCENE.above=whole"
above='CAMERA.above=--look-from 1,5,3 --look-at 1,1,0 --cull'
makes "a picture through another camera" "$(of above)" $cameras "$above" above.exr
makes "that again" "" $cameras "$above" above.exr
makes "elsewhere" "$(of above)" $cameras "$above --fov 30" -n above.exr
"$bin/tdpt-info" above.portal.glb | grep -q 'camera: --look-from: eye 1 5 3 m, .*(--cull)' || complain "above.portal.glb: of another camera"
"$testdata/cli/cameras.py" whole.glb corner=1,1.2,0.9 >house.gltf
cameras="SCENE.corner=house CAMERA.corner=corner SCENE.eye=house CAMERA.eye=camera CAMERAS.house=all"
# shellcheck disable=SC2086 # words
makes "pictures with shared portals" "corner.exr eye.exr house.cut house.max house.portal.glb house.vdb " $cameras corner.exr eye.exr
# shellcheck disable=SC2086
makes "portals for others" "corner.exr house.cut house.max house.portal.glb house.vdb " $cameras CAMERAS.house=corner -n corner.exr
[ "$(grep -c '^c camera' house.max)" = 2 ] || complain "house.max: not of two cameras"

before=$(cksum <sky.exr)
if make SCENE.sky=whole ENVIRONMENT=sky.exr PORTALS= -W whole.glb sky.exr >log 2>&1; then complain "a picture over its own sky was made"; fi
grep -q 'sky.exr would replace its own sky' log || complain "a picture over its own sky: make says not why"
[ "$(cksum <sky.exr)" = "$before" ] || complain "a picture replaced its own sky"

makes "previews" "$(of whole)" PREVIEWS=1 whole.exr
for name in max cut vdb portal.glb exr; do [ -s whole.$name.png ] || complain "whole.$name.png is missing"; done

# A file of portals is no scene, and one that was drawn by hand is nobody's result.
if make whole.portal.max >log 2>&1 || ! grep -q "No rule to make target 'whole.portal.max'" log; then complain "whole.portal.max was tried"; fi
cp whole.glb drawn.glb
sed 's/"generator":"tdpt /"generator":"mine /' whole.portal.glb >drawn.portal.glb
touch -d '1 hour ago' drawn.portal.glb
before=$(cksum <drawn.portal.glb)
makes "portals drawn by hand" "drawn.exr " drawn.exr
[ "$(cksum <drawn.portal.glb)" = "$before" ] || complain "portals drawn by hand were replaced"

# A buffer that is gone is the program's to tell, and what is there stays. A texture that is gone is told, and done without.
before=$(cksum <loose.exr)
mv loose.bin away.bin
if make loose.exr >log 2>&1; then complain "a buffer is gone, and all is well"; fi
grep -q 'ffgraph: .*loose.bin' log || complain "a buffer is gone: ffgraph does not say so"
[ "$(cksum <loose.exr)" = "$before" ] || complain "a buffer is gone: the picture changed"
mv away.bin loose.bin
mv loose.png away.png
make loose.exr >log 2>&1 || complain "a texture is gone, and nothing is done"
grep -q ': warning: .*loose.png' log || complain "a texture is gone: not told"
mv away.png loose.png
touch loose.gltf
make loose.exr >log 2>&1 || complain "the texture is back, and nothing is done"
before=$(cksum <loose.exr)

# Stopped in the middle: the picture so far is there, under another name, and the next make makes the whole. Make tells
# the programs of the signal; a second one would kill them.
timeout --foreground -s TERM 2 make TDPT_RENDER_FLAGS='--spp 100000000 --width 32' loose.exr hidden.exr -j2 >log 2>&1 &&
  complain "stopped: make says that all is well"
[ "$(cksum <loose.exr)" = "$before" ] || complain "stopped: the picture is another"
[ -s loose.partial.exr ] || complain "stopped: what was rendered is gone"
makes "after that" "hidden.exr loose.exr " TDPT_RENDER_FLAGS="--spp 1 --width 17" loose.exr hidden.exr
[ ! -e loose.partial.exr ] || complain "after that: a partial picture lies there"

# A program that leaves half a file changes no result.
before=$(cksum <whole.max)
printf 'while [ "$1" != -o ]; do shift; done\necho half >"$2"\nexit 1\n' >half
if make FFGRAPH="sh half" whole.max >log 2>&1; then complain "half a file: make says that all is well"; fi
[ "$(cksum <whole.max)" = "$before" ] || complain "half a file: the network is another"
exit $failed
