#!/bin/sh
# shell-scripts.sh ROOT: runs shellcheck on every shell script under ROOT; exit 1 if it reports anything, 77, with a
# word, if it is missing.
cd "${1:?usage: shell-scripts.sh ROOT}" || exit 2
command -v shellcheck >/dev/null || { echo "skipped: shellcheck is missing (cmake/packages-test.txt)"; exit 77; }
# Disabled: loops over words (SC2013), A && B || C whose B only prints (SC2015), $ in single quotes (SC2016), which
# other programs read, and tr from one set to a repeated character (SC2020).
find . \( -name .git -o -path './build*' -o -path ./demo \) -prune -o -type f \( -name '*.sh' -o -name '*.sbatch' -o -path ./.ci/run \) \
  -exec shellcheck --external-sources --exclude=SC2013,SC2015,SC2016,SC2020 {} +
