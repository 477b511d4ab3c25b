#!/bin/sh
# install-packages_test.sh: install-packages.sh as root, with sudo and without, on a simulated machine: nothing is
# installed.
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0

# A folder of commands that is the whole PATH: some real utilities, and mocks for the rest.
fresh() {
  rm -rf "${work:?}/bin"
  mkdir "$work/bin"
  for real in sh sed dirname env cat tr; do ln -s "$(command -v $real)" "$work/bin/$real"; done
  : >"$work/done"
}
fake() {
  printf '#!/bin/sh\n%s\n' "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}
run() {
  PATH=$work/bin "$work/bin/sh" "$here/install-packages.sh" >"$work/said" 2>&1 </dev/null
  status=$?
  cat "$work/done" >>"$work/said"
}
# expect STATUS NAME PATTERN: exit code, and a line of the output or the log.
expect() {
  run
  if [ "$status" != "$1" ] || ! grep -qE "$3" "$work/said"; then
    echo "$2: exit code $status, expected $1 and a line that matches: $3"
    cat "$work/said"
    failed=1
  fi
}
all_but_cmake='[ "$4" = cmake ] && { echo "no packages found" >&2; exit 1; }; printf installed'
log="echo \"\$0 \$*\" >>$work/done"

fresh
fake dpkg-query 'printf installed'
run
[ "$status" = 0 ] && [ ! -s "$work/said" ] || { echo "all there, but:"; cat "$work/said"; failed=1; }

fresh
fake dpkg-query "$all_but_cmake"
fake id 'echo 0'
fake apt-get "$log"
expect 0 "root" 'apt-get install -y --no-install-recommends cmake$'

fresh
fake dpkg-query "$all_but_cmake"
fake id 'echo 1000'
fake apt-get "$log"
fake sudo '[ "$1" = -n ] && shift; [ "$1" = true ] && exit 0; "$@"'
expect 0 "sudo" 'apt-get install -y --no-install-recommends cmake$'
expect 0 "sudo updates first" 'apt-get update$'

fresh
fake dpkg-query "$all_but_cmake"
fake id 'echo 1000'
expect 1 "no sudo" 'there is no sudo; as root: apt-get install cmake$'
fake sudo 'exit 1'
expect 1 "sudo with a password" 'asks for a password; as root: apt-get install cmake$'

fresh
fake dpkg-query "$all_but_cmake"
fake id 'echo 0'
fake apt-get 'exit 100'
expect 1 "apt-get fails" 'apt-get could not install them'

fresh
printf 'NAME=Other\nPRETTY_NAME="Other Linux 7"\n' >"$work/os-release"
export OS_RELEASE="$work/os-release"
expect 0 "not Debian" 'Other Linux 7 has no Debian packages: what .*packages.txt lists must be there already'
export OS_RELEASE=/nonexistent
expect 0 "unknown" 'this system has no Debian packages'
exit $failed
