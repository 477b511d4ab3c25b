#!/bin/sh
# install-packages.sh [LIST]: installs the missing packages of LIST, by default cmake/packages.txt, with apt-get, as
# root or with sudo. Prints nothing if there is nothing to do.
set -u
list=${1:-$(dirname "$0")/packages.txt}
say() { printf '%s\n' "install-packages: $*" >&2; }

if ! command -v dpkg-query >/dev/null 2>&1; then
  system=$(sed -n 's/^PRETTY_NAME=//p' "${OS_RELEASE:-/etc/os-release}" 2>/dev/null | tr -d '"')
  say "${system:-this system} has no Debian packages: what $list lists must be there already, under the names that" \
    "doc/systems.md has; what is missing is said when the sources are configured"
  exit 0
fi

missing=
for package in $(sed 's/#.*//' "$list"); do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0
say "missing:$missing"

if [ "$(id -u)" = 0 ]; then
  as_root=
elif ! command -v sudo >/dev/null 2>&1; then
  say "only root can install them and there is no sudo; as root: apt-get install$missing"
  exit 1
elif sudo -n true 2>/dev/null; then
  as_root="sudo -n"
elif [ -t 0 ]; then
  as_root=sudo
else
  say "sudo asks for a password; as root: apt-get install$missing"
  exit 1
fi

# shellcheck disable=SC2086  # words of a command, names of packages
$as_root apt-get update &&
  $as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends $missing </dev/null && exit 0
say "apt-get could not install them; nothing goes on without them"
exit 1
