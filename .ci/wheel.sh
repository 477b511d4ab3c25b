#!/bin/sh
# wheel.sh WHEEL TARBALL FOLDER SUITE: checks that pip installs the wheel on a bare Debian in FOLDER, made by debootstrap if it is
# empty, and that nothing else is needed. As root. Every program prints its version; the demo's room is rendered within a minute
# of `pip install`, with the bytes of the tarball's picture.
set -eu
usage='usage: wheel.sh WHEEL TARBALL FOLDER SUITE'
wheel=${1:?$usage} tarball=${2:?$usage} folder=${3:?$usage} suite=${4:?$usage}
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=.ci/bare.sh
. "$here/bare.sh"
bare_system "$folder" "$suite"

rm -rf "$bare/work"
mkdir -p "$bare/work"
cp "$wheel" "$here/../testdata/scenes/furnished.glb" "$bare/work"
cp "$tarball" "$bare/work/tdpt.tar.gz"
inside 'chown -R nobody /work; apt-get -q update; apt-get -q -y --no-install-recommends install python3-venv'
as_user nobody 'python3 -m venv venv'
begun=$(date +%s)
as_user nobody 'HOME=/work; PATH=$PWD/venv/bin:$PATH
  pip install --no-index ./*.whl
  tdpt furnished.glb -o wheel.exr --spp 4 --width 160 --preview'
taken=$(($(date +%s) - begun))
echo "wheel.sh: from pip install to the first picture on $suite: $taken s"
as_user nobody 'HOME=/work; PATH=$PWD/venv/bin:$PATH
  for program in ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge exrdenoise tdpt-info tdpt-import tdpt; do
    $program --version | head -n 1
  done
  python -c "import tdpt; print(tdpt.run(\"tdpt-info\", \"wheel.exr\"))"
  mkdir tarball; tar x -C tarball --strip-components 1 -f tdpt.tar.gz
  PATH=$PWD/tarball/bin:$PATH
  tdpt --work fresh furnished.glb -o tarball.exr --spp 4 --width 160
  cmp wheel.exr tarball.exr
  ls -l ./*.exr ./*.png'
[ "$taken" -lt 60 ]
inside 'apt-get -q -y --auto-remove purge python3-venv'
rm -r "$bare/work"
echo "wheel.sh: $wheel installs and runs on $suite"
