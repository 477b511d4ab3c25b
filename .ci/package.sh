#!/bin/sh
# package.sh DEB FOLDER: whether the package installs and works where nothing else is: on a bare Debian 12 in FOLDER, made
# by debootstrap if it is empty, from MIRROR, http://deb.debian.org/debian if that is not set. As root.
# Every program says its version, a scene goes through all of them by tdpt.mk, and nothing is left after the package is
# removed, with all that it needed: the system is bare again for the next time.
set -eu
deb=${1:?usage: package.sh DEB FOLDER} root=${2:?usage: package.sh DEB FOLDER}
testdata=$(cd "$(dirname "$0")/../testdata" && pwd)
if [ "$(id -u)" != 0 ]; then
  echo "package.sh: only root can make and enter a bare system" >&2
  exit 1
fi
if [ ! -x "$root/usr/bin/apt-get" ]; then
  debootstrap --variant=minbase bookworm "$root" "${MIRROR:-http://deb.debian.org/debian}"
fi

# The way to the network is that of this machine.
cp /etc/resolv.conf /etc/hosts "$root/etc"
cp /etc/apt/apt.conf.d/* "$root/etc/apt/apt.conf.d"
mkdir -p "$root/proc" "$root/srv/tdpt"
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
trap 'umount "$root/proc"' EXIT
cp "$deb" "$root/srv/tdpt/tdpt.deb"
cp "$testdata/scenes/two-rooms.glb" "$root/srv/tdpt/room.glb"
inside() { chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C sh -euc "$1"; }

inside 'apt-get -q update && apt-get -q -y install /srv/tdpt/tdpt.deb'
for program in ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge tdpt-info tdpt; do
  inside "$program --version"
done
inside 'cd /srv/tdpt
  apt-get -q -y install --no-install-recommends make
  make -f /usr/share/tdpt/tdpt.mk QUALITY=draft PREVIEWS=1 TDPT_RENDER_FLAGS="--spp 1 --width 64" room.exr
  make -f /usr/share/tdpt/tdpt.mk QUALITY=draft PREVIEWS=1 TDPT_RENDER_FLAGS="--spp 1 --width 64" room.exr | grep "up to date"
  exrdiff room.exr room.exr
  ls -l'
for picture in max cut vdb portal.glb exr; do [ -s "$root/srv/tdpt/room.$picture.png" ]; done
# Documents may be left out of a bare system, so what was installed is asked of dpkg.
inside 'dpkg -L tdpt >/srv/tdpt/list
  apt-get -q -y --auto-remove purge tdpt make
  while IFS= read -r path; do
    case $path in */tdpt | */tdpt/* | */bin/*) [ ! -e "$path" ] || { echo "left: $path"; exit 1; } ;; esac
  done </srv/tdpt/list'
rm -r "$root/srv/tdpt"
echo "package.sh: $deb installs, works and goes"
