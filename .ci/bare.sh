# Runs things on a system where nothing is installed; as root. To be sourced by sh with -eu.
# shellcheck shell=sh

# bare_system FOLDER SUITE: a bare Debian in FOLDER, made by debootstrap if there is none, from MIRROR (default
# http://deb.debian.org/debian). Its /proc is mounted until the script ends.
bare_system() {
  bare=$1
  if [ "$(id -u)" != 0 ]; then
    echo "$0: only root can make and enter a bare system" >&2
    exit 1
  fi
  if [ ! -x "$bare/usr/bin/apt-get" ]; then
    debootstrap --variant=minbase "$2" "$bare" "${MIRROR:-http://deb.debian.org/debian}"
  fi
  # Uses this machine's network configuration.
  cp /etc/resolv.conf /etc/hosts "$bare/etc"
  find /etc/apt/apt.conf.d -type f -exec cp {} "$bare/etc/apt/apt.conf.d" \;
  mkdir -p "$bare/proc"
  mountpoint -q "$bare/proc" || mount -t proc proc "$bare/proc"
  trap 'umount "$bare/proc"' EXIT
}

# inside COMMANDS: runs them with sh -eu, as root, in the bare system.
inside() {
  chroot "$bare" env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C \
    DEBIAN_FRONTEND=noninteractive sh -euc "$1"
}

# as_user USER COMMANDS: the same as a user of the bare system, in /work.
as_user() {
  chroot "$bare" su -s /bin/sh "$1" -c "set -eu; cd /work; $2"
}

# container FILE CONTEXT: executes the instructions of a Containerfile in the bare system, ignoring FROM. Sets `user`.
container() {
  user=root
  lines=$(sed -e ':a' -e '/\\$/{N;s/\\\n//;ba' -e '}' "$1")
  while IFS= read -r line; do
    case $line in
    '' | '#'* | 'FROM '* | 'LABEL '*) ;;
    'COPY '*)
      set -f  # patterns are those of the context's folder
      # shellcheck disable=SC2086  # words
      set -- "$2" ${line#COPY }
      set +f
      context=$1 to=${line##* }
      shift
      while [ $# -gt 1 ]; do
        # shellcheck disable=SC2086
        cp $context/$1 "$bare$to"
        shift
      done
      set -- "" "$context"
      ;;
    'RUN '*) inside "${line#RUN }" </dev/null ;;
    'USER '*)
      # shellcheck disable=SC2034  # for scripts that source this
      user=${line#USER }
      ;;
    'WORKDIR '*) mkdir -p "$bare${line#WORKDIR }" ;;
    *) echo "$0: what is this in $1: $line" >&2; exit 1 ;;
    esac
  done <<EOF
$lines
EOF
}
