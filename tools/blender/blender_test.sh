#!/bin/sh
# blender_test.sh blender|PYTHON BIN ZIP SCRIPT: runs a test script in Blender, or in a Python that has the module bpy.
# Exit 77, with a word, where there is none.
with=${1:?usage: blender_test.sh blender|PYTHON BIN ZIP SCRIPT}
bin=$2 zip=$3 script=$4
home=$(mktemp -d) || exit 2
trap 'rm -rf "$home"' EXIT
export TDPT_BIN="$bin" HOME="$home" BLENDER_USER_RESOURCES="$home" BLENDER_USER_CONFIG="$home/config" \
  BLENDER_USER_SCRIPTS="$home/scripts" PYTHONDONTWRITEBYTECODE=1
mkdir "$home/config" "$home/scripts"
case $script in
  *zip_test.py) ;;
  *compare.py) zip=$home/compare.json; export PATH="$bin:$PATH" ;;
  *) zip= ;;
esac
if [ "$with" = blender ]; then
  command -v blender >/dev/null || { echo "skipped: there is no blender"; exit 77; }
  # It takes the first Python on the PATH for its own; the distribution's has numpy.
  PATH=/usr/bin:$PATH blender -b --factory-startup --python-exit-code 1 -P "$script" -- ${zip:+"$zip"}
else
  "$with" -c "import bpy" 2>/dev/null || { echo "skipped: $with has no module bpy"; exit 77; }
  "$with" "$script" ${zip:+"$zip"}
fi
