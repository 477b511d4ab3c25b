#!/bin/sh
# run_case.sh BIN TESTDATA CASE: runs one end-to-end case; its format: testdata/cli/README.md. Exit 0: as expected. 77:
# this machine lacks what the case needs. Otherwise prints every difference and both outputs.
set -u
absolute() { case $1 in /*) printf '%s\n' "$1" ;; *) printf '%s/%s\n' "$PWD" "$1" ;; esac; }
bin=$(absolute "$1") TESTDATA=$(absolute "$2") case=$3
export TESTDATA
export LC_ALL=C
PATH=$bin:/usr/local/bin:/usr/bin:/bin
export PATH

work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
mkdir "$work/run"
# All cases share the cache of kernels compiled for a software device, which takes seconds.
export MESA_SHADER_CACHE_DIR="${MESA_SHADER_CACHE_DIR:-${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}}" XDG_CACHE_HOME="$work/cache"
script=$work/script stdout=$work/stdout stderr=$work/stderr wrong=$work/wrong
: >"$wrong"
# What the scripts of cases may call; bodies in parentheses keep their variables to themselves.
cat >"$script" <<END
# refused CODE WORDS COMMAND...: the command ends with this code, prints nothing on stdout and on stderr one line, which
# begins with the program's name and matches WORDS.
refused() (
  code=\$1 words=\$2 status=0
  shift 2
  "\$@" >"$work/out" 2>"$work/err" || status=\$?
  [ \$status = "\$code" ] && [ ! -s "$work/out" ] && [ "\$(wc -l <"$work/err")" = 1 ] &&
    grep -q "^\${1##*/}[a-z-]*: " "$work/err" && grep -Eq -e "\$words" "$work/err" && return
  { echo "exit code \$status, expected \$code and one line with '\$words': \$*"; cat "$work/out" "$work/err"; } >>"$wrong"
)
# not COMMAND...: complains where the command succeeds, which set -e overlooks behind a "!".
not() ( ! "\$@" || echo "has succeeded: \$*" >>"$wrong" )
# stages SCENE STEM [WORD...]: STEM.max, .cut, .vdb and .portal.glb of few walks and lines; words for those that need the light.
stages() (
  scene=\$1 stem=\$2
  shift 2
  ffgraph --quiet "\$scene" --set walks=5000 --samples 20000 --set rounds=0 "\$@" -o "\$stem.max" &&
    mincut --quiet "\$stem.max" -o "\$stem.cut" &&
    lightgrid --quiet "\$scene" "\$stem.cut" --resolution 32 --set lines=1000 "\$@" -o "\$stem.vdb" &&
    portalfit --quiet "\$stem.vdb" -o "\$stem.portal.glb"
)
END
complain() { printf '%s\n' "$*" >>"$wrong"; }

# The value of a "key: value" line.
value_of() { value=${line#*:}; value=${value# }; }

expected=0 commands=0
while IFS= read -r line || [ -n "$line" ]; do
  value_of
  case $line in
  needs:*) (cd "$work/run" && sh -c "$value") >/dev/null 2>&1 </dev/null || { echo "skipped: this fails here: $value"; exit 77; } ;;
  command:*) printf '%s\n' "$value" >>"$script"; commands=$((commands + 1)) ;;
  exit:*) expected=$value ;;
  esac
done <"$case"
[ "$commands" -gt 0 ] || complain "the case has no command: line"

(cd "$work/run" && sh "$script" >"$stdout" 2>"$stderr" </dev/null)
status=$?
[ "$status" = "$expected" ] || complain "exit code is $status, expected $expected"
if missing=$(grep -E '(^|: )[^ :]+: (command )?not found$' "$stderr"); then
  complain "a program is missing: $missing"
fi

# matches FILE NAME PATTERN: some line of FILE matches the extended regular expression.
matches() { grep -E -q -e "$3" "$1" || complain "no line of $2 matches: $3"; }
matches_not() { if grep -E -q -e "$3" "$1"; then complain "a line of $2 matches: $3"; fi; }
count_lines() {
  lines=$(wc -l <"$1" | tr -d ' ')
  [ "$lines" = "$3" ] || complain "$2 has $lines lines, expected $3"
}

number=0
while IFS= read -r line || [ -n "$line" ]; do
  number=$((number + 1))
  value_of
  case $line in
  '' | '#'* | needs:* | command:* | exit:*) ;;
  stdout:*) matches "$stdout" stdout "$value" ;;
  stderr:*) matches "$stderr" stderr "$value" ;;
  not-stdout:*) matches_not "$stdout" stdout "$value" ;;
  not-stderr:*) matches_not "$stderr" stderr "$value" ;;
  stdout-lines:*) count_lines "$stdout" stdout "$value" ;;
  stderr-lines:*) count_lines "$stderr" stderr "$value" ;;
  file:*) [ -s "$work/run/$value" ] || complain "there is no file $value, or it is empty" ;;
  no-file:*) [ ! -e "$work/run/$value" ] || complain "there is a file $value" ;;
  *) complain "line $number of the case is none of the known ones: $line" ;;
  esac
done <"$case"

[ -s "$wrong" ] || exit 0
echo "$case:"
sed 's/^/  /' "$wrong"
echo "--- stdout"
head -c 4000 "$stdout"
echo "--- stderr"
head -c 4000 "$stderr"
exit 1
