#!/bin/sh
# package.sh DEB FOLDER SUITE: checks that the package installs and works on a bare system: by the steps of the
# Containerfile, on a bare Debian in FOLDER, made by debootstrap if it is empty. As root. Every program prints its
# version, a user takes a scene through all of them with tdpt.mk and with tdpt, and nothing remains after the package
# and its dependencies are removed: the system is bare again for the next run.
set -eu
usage='usage: package.sh DEB FOLDER SUITE'
deb=${1:?$usage} folder=${2:?$usage} suite=${3:?$usage}
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=.ci/bare.sh
. "$here/bare.sh"
context=$(mktemp -d)
mkdir "$context/build"
cp "$deb" "$context/build"
bare_system "$folder" "$suite"
trap 'umount "$bare/proc"; rm -rf "$context"' EXIT

container "$here/../Containerfile" "$context"
cp "$here/../testdata/scenes/two-rooms.glb" "$bare/work/room.glb"
inside "chown -R $user /work"
for program in ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge exrdenoise tdpt-info tdpt-import tdpt; do
  as_user "$user" "$program --version"
done
make='make -f /usr/share/tdpt/tdpt.mk QUALITY=draft PREVIEWS=1 TDPT_RENDER_FLAGS="--spp 1 --width 64" room.exr'
as_user "$user" "$make; $make | grep 'up to date'; exrdiff room.exr room.exr; tdpt room.glb --quality draft --spp 1 -o again.exr; ls -l"
for picture in max cut vdb portal.glb exr; do [ -s "$bare/work/room.$picture.png" ]; done
# A bare system may omit documentation, so dpkg is asked what was installed.
inside 'dpkg -L tdpt >/work/list
  apt-get -q -y --auto-remove purge tdpt fonts-dejavu-core make python3
  while IFS= read -r path; do
    case $path in */tdpt | */tdpt/* | */bin/*) [ ! -e "$path" ] || { echo "left: $path"; exit 1; } ;; esac
  done </work/list'
inside "userdel --remove $user"
rm -r "$bare/work"
echo "package.sh: $deb installs, works and goes on $suite"
