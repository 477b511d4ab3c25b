#!/bin/sh
# missing_test.sh: what scripts say, and exit 5, where a program that they need is not there.
set -u
here=$(cd "$(dirname "$0")" && pwd)
sh "$here/python.sh" -c '' || { echo "skipped: no Python has numpy"; exit 77; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
# Programs of the system, but for those whose lack is tested.
mkdir "$work/path" "$work/bin"
IFS=:
for folder in $PATH; do ln -s "$folder"/* "$work/path/" 2>/dev/null; done
unset IFS
rm -f "$work/path/jq" "$work/path/valgrind" "$work/path/perf"
failed=0
# expect WORDS SCRIPT: exit 5, and those words.
expect() {
  PATH=$work/path sh "$here/$2" "$work/bin" "$work/out" >/dev/null 2>"$work/said"
  status=$?
  [ "$status" = 5 ] && grep -qF "$1" "$work/said" && [ "$(wc -l <"$work/said")" = 1 ] && return
  echo "$2: exit $status, expected 5 and '$1'"
  cat "$work/said"
  failed=1
}

expect "only-needed: jq is missing" only-needed.sh
expect "limit: perf does not work and valgrind is missing" limit.sh
expect "target-error: jq is missing" target-error.sh
printf '#!/bin/sh\nexit 0\n' >"$work/path/jq" && chmod +x "$work/path/jq"
expect "tdpt-render-diffuse is missing" only-needed.sh
INSTRUCTIONS=1 expect "only-needed: valgrind is missing" only-needed.sh
exit $failed
