#!/bin/sh
# tarball.sh TARBALL FOLDER SUITE: checks that the tarball's programs run where nothing is installed: on a bare Debian
# in FOLDER, made by debootstrap if it is empty. As root. A user unpacks it, finds a portal and renders through it, with
# a preview of every stage. Prints how long that took; a missing library must be named in one line.
set -eu
usage='usage: tarball.sh TARBALL FOLDER SUITE'
tarball=${1:?$usage} folder=${2:?$usage} suite=${3:?$usage}
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=.ci/bare.sh
. "$here/bare.sh"
bare_system "$folder" "$suite"

rm -rf "$bare/work"
mkdir -p "$bare/work"
cp "$tarball" "$bare/work/tdpt.tar.gz"
cp "$here/../testdata/scenes/two-rooms.glb" "$bare/work/room.glb"
inside 'chown -R nobody /work'
begun=$(date +%s)
as_user nobody 'tar xf tdpt.tar.gz; mv tdpt-*/ tdpt; PATH=$PWD/tdpt/bin:$PATH; HOME=/work
  ffgraph room.glb -o room.max --preview room.max.png
  mincut room.max -o room.cut --preview room.cut.png --scene room.glb
  lightgrid room.glb room.cut -o room.vdb --preview room.vdb.png
  portalfit room.vdb -o room.portal.glb --preview room.portal.png
  tdpt-render room.glb --portal room.portal.glb --spp 16 --width 160 -o room.exr --preview'
echo "tarball.sh: from the archive to the first picture on $suite: $(($(date +%s) - begun)) s"
as_user nobody 'PATH=$PWD/tdpt/bin:$PATH; HOME=/work
  for program in ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge exrdenoise tdpt-info tdpt-import tdpt; do
    $program --version | head -n 1
  done
  tdpt room.glb --quality draft --spp 1 -o again.exr
  exrdiff room.exr room.exr
  tdpt-info room.vdb
  ls -l *.png'
as_user nobody 'PATH=$PWD/tdpt/bin:$PATH; rm tdpt/lib/tdpt/libembree*; tdpt-render --version 2>said && exit 1
  grep -q "^tdpt-render: error while loading shared libraries: libembree.*: cannot open shared object file" said
  [ "$(wc -l <said)" = 1 ]'
rm -r "$bare/work"
echo "tarball.sh: $tarball runs on $suite"
