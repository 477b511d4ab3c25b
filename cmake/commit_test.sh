#!/bin/sh
# commit_test.sh: tdpt_commit() finds the commit of a checkout or a worktree, again after a new commit, and none for a
# folder that is not a checkout itself. Exit 77 without git, CMake or Ninja.
here=$(cd "$(dirname "$0")" && pwd)
for tool in git cmake ninja; do
  command -v $tool >/dev/null || { echo "skipped: $tool is missing"; exit 77; }
done
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE
failed=0
git_in() { folder=$1; shift; git -C "$folder" -c user.name=a -c user.email=a@example.org "$@" >"$work/log" 2>&1 || { cat "$work/log"; exit 2; }; }
commit() { git_in "$1" commit --allow-empty -m "$2"; }
# tells WHY FOLDER EXPECTED: checks what is built in the folder now.
tells() {
  { [ -d "$2.build" ] || cmake -G Ninja -S "$2" -B "$2.build"; } >"$work/log" 2>&1 && ninja -C "$2.build" >>"$work/log" 2>&1 || { cat "$work/log"; exit 2; }
  if [ "$(cat "$2.build/told")" != "$3" ]; then
    echo "$1: '$(cat "$2.build/told")' is told, expected '$3'"
    failed=1
  fi
}
head_of() { git -C "$1" rev-parse --short=7 HEAD; }

mkdir "$work/a"
cat >"$work/a/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.25)
project(a LANGUAGES NONE)
include($here/commit.cmake)
tdpt_commit(\${CMAKE_SOURCE_DIR} commit)
file(WRITE \${CMAKE_BINARY_DIR}/told "\${commit}")
END
cp -r "$work/a" "$work/tarball"
tells "no checkout" "$work/tarball" ""
git_in "$work/a" init -q
tells "no commit yet" "$work/a" ""
rm -r "$work/a.build"
git_in "$work/a" add .
commit "$work/a" one
tells "a checkout" "$work/a" "$(head_of "$work/a")"
commit "$work/a" two
tells "another commit" "$work/a" "$(head_of "$work/a")"
git_in "$work/a" checkout -q HEAD~1
tells "an earlier one" "$work/a" "$(head_of "$work/a")"
git_in "$work/a" worktree add -b b "$work/b"
tells "a worktree" "$work/b" "$(head_of "$work/b")"
commit "$work/b" three
tells "another commit there" "$work/b" "$(head_of "$work/b")"
mkdir "$work/a/unpacked"
cp "$work/a/CMakeLists.txt" "$work/a/unpacked"
tells "a tarball within a checkout" "$work/a/unpacked" ""
exit $failed
