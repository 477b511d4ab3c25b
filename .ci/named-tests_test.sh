#!/bin/sh
# named-tests_test.sh: named-tests.sh accepts existing names and detects each planted fault.
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d) || exit 1
trap 'rm -r "$folder"' EXIT
mkdir -p "$folder/tools" "$folder/libcommon" "$folder/testdata/cli"
printf 'TEST(box, is_closed) {\nTEST_P(rooms, show) {\n{"far", f}\n' > "$folder/tools/box_test.cpp"
: > "$folder/testdata/cli/far.case"
: > "$folder/tools/times_test.py"
status=0
check() { # EXPECTED ROW
  printf '# Page\n\n| extreme | test |\n|---|---|\n%s\n' "$2" > "$folder/page.md"
  sh "$here/named-tests.sh" "$folder" "$folder/page.md" > "$folder/out"
  [ $? -eq "$1" ] || { echo "expected $1: $2"; cat "$folder/out"; status=1; }
}
# shellcheck disable=SC2016  # backquotes of the page
{
  check 0 '| a box | `box.is_closed` `rooms.show` `rooms.show/far` `cli.far` `times_test.py` |'
  check 1 '| a box | `box.is_open` |'
  check 1 '| a box | `rooms.show/near` |'
  check 1 '| a box | `cli.near` |'
  check 1 '| a box | `times_test.sh` |'
  check 1 '| a box | by eye |'
  check 1 'no table any more'
}
exit $status
