#!/bin/sh
# uninstall.sh PREFIX: removes what install.sh installed there, inside $DESTDIR if that is set, and nothing else: the
# listed files, and the listed folders that are then empty.
set -eu
prefix=${1:?usage: uninstall.sh PREFIX}
case $prefix in /*) ;; *) prefix=$PWD/$prefix ;; esac
root=${DESTDIR:-}
list=$root$prefix/share/tdpt/installed
if [ ! -r "$list" ]; then
  echo "uninstall: there is no $list: nothing was installed there by 'make install'" >&2
  exit 1
fi

# The list itself is removed last but for the folders, which are listed from the innermost.
LC_ALL=C sort -r "$list" | {
  folders='' failed=0
  while IFS= read -r path; do
    case $path in
    */) folders="$folders$path
" ;;
    *)
      if [ "$root$path" != "$list" ]; then
        echo "removing $root$path"
        rm -f "$root$path" || failed=1
      fi
      ;;
    esac
  done
  if [ $failed = 0 ]; then rm -f "$list" || failed=1; fi
  printf '%s' "$folders" | while IFS= read -r folder; do
    rmdir "$root${folder%/}" 2>/dev/null || :
  done
  exit $failed
}
