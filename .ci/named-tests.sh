#!/bin/sh
# named-tests.sh ROOT PAGE: checks that the last cell of every row in PAGE's tables names tests, `suite.test` or
# `suite.test/row` of a *_test.cpp, `cli.case`, or the file of a shell or Python test, and that all of them exist. Exit
# 1 if not.
root=${1:?usage: named-tests.sh ROOT PAGE} page=${2:?usage: named-tests.sh ROOT PAGE}
status=0
complain() {
  echo "$page: $1"
  status=1
}

there() {
  case $1 in
    cli.*) [ -r "$root/testdata/cli/${1#cli.}.case" ] ;;
    *.sh | *.py) find "$root" -path "$root/build*" -prune -o -name "$1" -print | grep -q . ;;
    *.*/*)
      test=${1%%/*}
      file=$(grep -rlE --include='*_test.cpp' "^TEST_P\(${test%.*}, ${test#*.}\)" "$root/tools" "$root/libcommon")
      [ -n "$file" ] && grep -qF "\"${1#*/}\"" "$file"
      ;;
    *.*) grep -rqE --include='*_test.cpp' "^TEST(_F|_P)?\(${1%.*}, ${1#*.}\)" "$root/tools" "$root/libcommon" ;;
    *) false ;;
  esac
}

# Output "line,names": the names in the last cell of a table's row, below its head.
rows=$(awk -F'|' '/^\|/ { if (++row > 2) { n = split($(NF - 1), part, "`"); names = ""
                            for (i = 2; i <= n; i += 2) names = names " " part[i]
                            gsub(/ +/, ",", names); print NR names } next }
                  { row = 0 }' "$page")
[ -n "$rows" ] || complain "has no table"
for row in $rows; do
  line=${row%%,*}
  [ "$row" != "$line" ] || { complain "line $line names no test"; continue; }
  for name in $(echo "${row#*,}" | tr , ' '); do
    there "$name" || complain "line $line: there is no test $name"
  done
done
exit $status
