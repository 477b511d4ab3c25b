#!/bin/sh
# tdpt SCENE -o PICTURE: from a scene to its picture by the rules of tdpt.mk, and no others.
set -u
tool=tdpt
fail() { # CODE SENTENCE
  printf '%s: %s\n' "$tool" "$2" >&2
  exit "$1"
}
usage() {
  cat <<'END'
Finds the portals of a glTF scene and renders it through them.
Usage: tdpt SCENE -o PICTURE.exr [OPTIONS]

  -o, --output FILE           Picture to write (OpenEXR)
  --work FOLDER               Where the files between the stages are kept;
                              default the folder of the scene
  --report                    Make SCENE.report.html beside these files, too: what
                              the portals are worth, on one page (needs python3)
  --dry-run                   Print the commands that would run, and run none
  --list-devices              List the Vulkan devices for --device gpu:WHICH and
                              exit
  -h, --help                  Print this help and exit
  --version                   Print the version and exit

All other options are those of tdpt-render, and rendering is all that most of
them change. Those of the camera and of the sky, --device, --light-units,
--quality, --seed, --threads, --max-memory and --quiet go to the stages before
it, too: --device gpu has the GPU do all that it can. A stage runs where its result is missing or out of date. The environment variables
FFGRAPH_FLAGS, MINCUT_FLAGS, LIGHTGRID_FLAGS and PORTALFIT_FLAGS have more
options for the stages.
END
}

# The programs and rules lie beside this script, as they are built and as they are installed.
here=$(dirname -- "$(readlink -f -- "$0")")
rules=$here/../share/tdpt/tdpt.mk

# One word for a recipe of Make: quoted for the shell, with dollars that Make leaves alone.
quoted() {
  case $1 in
  *[!A-Za-z0-9_.,:/=+%@-]* | '') printf "'%s' " "$(printf '%s\n' "$1" | sed "s/'/'\\\\''/g; s/\\$/\$\$/g")" ;;
  *) printf '%s ' "$1" ;;
  esac
}
absolute() {
  case $1 in
  /*) printf '%s\n' "$1" ;;
  *) printf '%s/%s\n' "$PWD" "$1" ;;
  esac
}

scene='' picture='' work='' dry='' flags='' camera='' sky='' environment='' quality='' device='' seed='' threads='' memory='' quiet='' report=''
while [ $# -gt 0 ]; do
  word=$1 value='' joined=''
  case $word in
  --*=*) value=${word#*=} word=${word%%=*} joined=1 ;;
  esac
  # Of the options that this front understands, which have a value.
  case $word in
  -o | --output | --work | --camera | --look-from | --look-at | --up | --fov | --environment | --environment-rotation | \
    --environment-scale | --sun-angle | --light-units | --device | --quality | --seed | --threads | \
    --max-memory)
    if [ -z "$joined" ]; then
      [ $# -gt 1 ] || fail 2 "$word: a value is missing; '$tool --help' lists the options"
      shift
      value=$1
    fi
    ;;
  esac
  case $word in
  -h | --help) usage; exit 0 ;;
  --version)
    "$here/tdpt-render" --version | sed '1s/^tdpt-render/tdpt/;1q'
    exit 0
    ;;
  -o | --output) picture=$value ;;
  --work) work=$value ;;
  --dry-run) dry=1 ;;
  --report) report=1 ;;
  --quiet) quiet=1 ;;
  --list-devices) exec "$here/tdpt-render" --list-devices ;;
  --device) device=$value ;;
  --quality) quality=$value ;;
  --seed) seed=$value ;;
  --threads) threads=$value ;;
  --max-memory) memory=$value ;;
  --camera | --look-from | --look-at | --up | --fov) camera="$camera$word $(quoted "$value")" ;;
  --frame | --cull) camera="$camera$word " ;;
  --environment)
    case $value in
    *.exr | *.hdr | *.pic | */*) environment=$(absolute "$value") ;;
    *) environment=$value ;;
    esac
    ;;
  --environment-rotation | --environment-scale | --sun-angle | --light-units) sky="$sky$word $(quoted "$value")" ;;
  --portal) fail 2 "--portal: the portals are found here; tdpt-render takes others" ;;
  --shard | --print-shards | --plan | -MF | -MQ | --dependencies | --dependencies-target)
    fail 2 "$word: is for tdpt-render itself"
    ;;
  --*)
    # Whether there is such an option, and whether it has a value, the renderer says.
    line=$("$here/tdpt-render" --help | grep -E -- "^  (-.,)?$word( |\$)") || exec "$here/tdpt-render" "$word" "$scene"
    flags="$flags$(quoted "$1")"
    case $line in
    *"$word "[A-Za-z]*) ;;
    *) joined=1 ;;
    esac
    if [ -z "$joined" ]; then
      [ $# -gt 1 ] || fail 2 "$word: a value is missing; '$tool --help' lists the options"
      shift
      case $word in
      --checkpoint | --resume | --stats | --nonzero) flags="$flags$(quoted "$(absolute "$1")")" ;;
      *) flags="$flags$(quoted "$1")" ;;
      esac
    fi
    ;;
  -?*) fail 2 "$word: is no option; '$tool --help' lists them" ;;
  *)
    [ -z "$scene" ] || fail 2 "$word: one scene at a time, and $scene is given already"
    scene=$word
    ;;
  esac
  shift
done
[ -n "$scene" ] || fail 2 "no scene is given; '$tool --help' tells how"
[ -n "$picture" ] || fail 2 "-o is missing: the picture to write; '$tool --help' tells how"
case $scene in
*.glb | *.gltf) ;;
*) fail 2 "$scene: is no .glb or .gltf" ;;
esac
case $picture in
*.exr) ;;
*) fail 2 "-o $picture: the picture is OpenEXR, name it .exr" ;;
esac
case $scene in
*.gltf) [ ! -e "${scene%.gltf}.glb" ] || fail 2 "$scene: ${scene%.gltf}.glb is there, too; name one of them otherwise" ;;
esac
[ -d "$(dirname -- "$picture")" ] || fail 4 "$picture: its folder is not there"
[ -e "$scene" ] || fail 3 "$scene: cannot be opened: No such file or directory"
[ -d "${work:=$(dirname -- "$scene")}" ] || mkdir -p -- "$work" || fail 4 "$work: cannot be made"
command -v make >/dev/null || fail 1 "GNU Make is missing, whose package is called make"

# A device that is not there is told before the stages that need none.
if [ -n "$device" ] && [ -z "$dry" ]; then
  "$here/tdpt-render" --device "$device" --spp 1 --print-shards 1 --quiet "$scene" -o "$picture" >/dev/null || exit
fi

scene=$(absolute "$scene") picture=$(absolute "$picture") work=$(cd -- "$work" && pwd)
# Make takes names apart at these.
for path in "$scene" "$picture" "$work"; do
  case $path in
  *[[:space:]:\;\#%\$=\\\'\"\*\?\[]*) fail 2 "$path: a name that Make cannot write; link it under another" ;;
  esac
done
name=$(basename -- "${scene%.gl*}")
stem=${scene%.gl*}
target=$picture
[ "$(dirname -- "$picture")" != "$work" ] || target=$(basename -- "$picture")

status=$(mktemp) || fail 1 "no temporary file"
trap 'rm -f "$status"' EXIT
set -- -C "$work" -f "$rules" --no-print-directory TDPT_BIN="$here/" \
  "SCENE.$name=$stem" "SCENE.${target%.exr}=$stem" "PORTALS=$name.portal.glb" "DEVICE=$device" "QUALITY=$quality" "SEED=$seed" \
  "THREADS=$threads" "MAX_MEMORY=$memory" "QUIET=$quiet" "ENVIRONMENT=$environment" "ENVIRONMENT_FLAGS=$sky" \
  "CAMERA_FLAGS=$camera" "FFGRAPH_FLAGS=${FFGRAPH_FLAGS-}" "MINCUT_FLAGS=${MINCUT_FLAGS-}" "LIGHTGRID_FLAGS=${LIGHTGRID_FLAGS-}" \
  "PORTALFIT_FLAGS=${PORTALFIT_FLAGS-}" "TDPT_RENDER_FLAGS=$flags" "$target" \
  ${report:+"$name.report.html"}
unset MAKEFLAGS MFLAGS MAKELEVEL
if [ -n "$dry" ]; then
  make -n "$@" | grep -v '^mkdir -p \|^mv -f \|^printf \|^make: ' | sed 's/  */ /g'
  exit 0
fi
export TDPT_STATUS="$status"
if make -s -q "$@" 2>/dev/null; then
  [ -n "$quiet" ] || printf '%s: %s is up to date\n' "$tool" "$picture" >&2
  exit 0
fi
make -s "$@" && exit 0
code=$(cat "$status")
exit "${code:-1}"
