#!/bin/bash
# completion_test.sh bash|installation BUILD: checks what bash completes for every program of the build:
# all options of --help and no others, the words of choices, files with the right suffixes, nothing for a number; and
# that the scripts are installed where bash looks for them. Exit 1 if not.
what=${1:?usage: completion_test.sh bash|installation BUILD}
build=$(cd "${2:?usage: completion_test.sh bash|installation BUILD}" && pwd) || exit 2
tools='ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge exrdenoise tdpt-info tdpt-import tdpt'
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
complain() {
  printf '%s\n' "$*"
  failed=1
}
# expect WHAT WANTED GOT: lists of words, in any order.
expect() {
  local wanted got
  wanted=$(tr ' ' '\n' <<<"$2" | sort -u) got=$(tr ' ' '\n' <<<"$3" | sort -u)
  [ "$wanted" = "$got" ] || complain "$1: $(diff <(echo "$wanted") <(echo "$got") | grep '^[<>]' | tr '\n' ' ')"
}

# "--name VALUE" of every option, from the left half of --help.
options_of() {
  "$build/bin/$1" --help | sed -nE 's/^  (-.,)?(--[a-z-]+) ?([^ ]*).*/\2 \3/p'
}

# check_options TOOL: compares what `offered TOOL WORD ...` prints with --help.
check_options() {
  local tool=$1 name value count=0
  expect "$tool: options" "$(options_of "$tool" | cut -d ' ' -f 1 | tr '\n' ' ')" "$(offered "$tool" -- | tr '\n' ' ')"
  while read -r name value; do
    count=$((count + 1))
    case $value in
    *[a-z]'|'[a-z]*\[*) expect "$tool $name" "cpu gpu" "$(offered "$tool" "$name" '' | tr '\n' ' ' | sed 's/ $//')" ;;
    *[a-z]'|'[a-z]*) expect "$tool $name" "${value//|/ }" "$(offered "$tool" "$name" '' | tr '\n' ' ' | sed 's/ $//')" ;;
    [A-Z] | SHARE | SECONDS | DEG | NAME) expect "$tool $name" "" "$(offered "$tool" "$name" '')" ;;
    esac
  done < <(options_of "$tool")
  [ "$count" -gt 5 ] || complain "$tool: --help names $count options"
}

# check_files: in a folder with files of all kinds; `offered` as above.
check_files() {
  mkdir "$work/files" "$work/files/folder" && cd "$work/files" || exit 2
  touch a.glb b.gltf c.max d.cut e.vdb f.exr 'two words.glb' h.txt
  for wanted in 'ffgraph:a.glb:b.gltf:folder:two words.glb' 'mincut:c.max:folder' 'portalfit:e.vdb:folder' \
    'lightgrid:a.glb:b.gltf:d.cut:folder:two words.glb' 'tdpt-render:a.glb:b.gltf:folder:two words.glb' \
    'tdpt-render --portal:a.glb:b.gltf:folder:two words.glb' 'exrdiff:f.exr:folder' 'mincut --scene a:a.glb' \
    'ffgraph --refine:d.cut:folder' 'tdpt-render --environment:f.exr:folder' 'tdpt-render two:two words.glb' \
    'tdpt-render -o:a.glb:b.gltf:c.max:d.cut:e.vdb:f.exr:folder:h.txt:two words.glb' 'tdpt-render h:h.txt'; do
    command=${wanted%%:*}
    case $command in *' '[a-z]* | *' '*' '*) ;; *) command="$command " ;; esac
    mapfile -t words < <(tr ' ' '\n' <<<"$command")
    got=$(offered "${words[@]}" | sed 's/[/ ]*$//' | sort -u | tr '\n' ':')
    [ "$got" = "${wanted#*:}:" ] || complain "$command: offered $got, expected ${wanted#*:}"
  done
}

case $what in
bash)
  # offered TOOL WORD ...: what bash completes for the last word. bash splits "--name=value" into three words.
  offered() {
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    "_${1//-/_}" "$1" "${*: -1}" "${*: -2:1}"
    [ ${#COMPREPLY[@]} = 0 ] || printf '%s\n' "${COMPREPLY[@]}"
  }
  PATH=$build/bin:$PATH
  for tool in $tools; do
    "$build/bin/$tool" --completion bash >"$work/script" || complain "$tool --completion bash fails"
    cmp "$work/script" "$build/completions/bash/$tool" || failed=1
    # shellcheck disable=SC1091
    . "$work/script"
    complete -p "$tool" | grep -q -- "-F _${tool//-/_} $tool" || complain "$tool: is not completed"
    check_options "$tool"
  done
  expect 'a part of a name' '--max-depth' "$(offered tdpt-render room.glb --max-d)"
  expect 'a part of a word' 'tdpt tdpt-org tdpt-guided' "$(offered tdpt-render --integrator td | tr '\n' ' ' | sed 's/ $//')"
  expect 'a word after =' 'draft normal high' "$(offered tdpt-render --quality = | tr '\n' ' ' | sed 's/ $//')"
  expect 'a part of a word after =' 'high' "$(offered tdpt-render --quality = h)"
  expect 'a part of the name of a setting' 'guide-light= guide-camera=' "$(offered tdpt-render --set guide | tr '\n' ' ' | sed 's/ $//')"
  expect 'the value of a setting' 'power' "$(offered tdpt-render --set mis = p)"
  check_files
  expect 'a file in quotes' 'two words.glb' "$(offered tdpt-render '"two w')"
  expect 'a file with an escaped blank' 'two words.glb' "$(offered tdpt-render 'two\ w')"
  ;;
installation)
  for tool in $tools; do
    DESTDIR=$work cmake -DCMAKE_INSTALL_PREFIX=/usr -P "$build/tools/$tool/cmake_install.cmake" >/dev/null ||
      complain "$tool cannot be installed"
    [ -s "$work/usr/share/bash-completion/completions/$tool" ] || complain "$tool: its completion is not installed"
  done
  ;;
*) echo "$what: expected bash or installation" && exit 2 ;;
esac
exit $failed
