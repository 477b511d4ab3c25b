#!/bin/sh
# sizes.sh ROOT: holds the lines of tracked files against the ceilings in ROOT/.ci/sizes:
#   product   sources of tools, libcommon and shaders, without tests, fuzz targets and benchmarks
#   all       all sources, scripts, CMake files, pages and cases
# Exit 1 if there are more lines, if a ceiling is more than 0.5 % above them, or if a commit has raised one; 77, with a
# word, outside of a checkout.
cd "${1:?usage: sizes.sh ROOT}" || exit 2
top=$(git rev-parse --show-toplevel 2>/dev/null)
[ -n "$top" ] && [ "$top" = "$(pwd -P)" ] || { echo "skipped: this is no checkout of git"; exit 77; }
status=0
complain() {
  echo "$1"
  status=1
}
grouped() { echo "$1" | sed ':again; s/^\([0-9]*[0-9]\)\([0-9]\{3\}\)/\1,\2/; t again'; }

counted() {
  case $1 in
    product)
      git -c core.quotePath=false ls-files tools libcommon shaders | grep -E '\.(cpp|h|comp|glsl|py|sh)$' |
        grep -vE '_test\.|(^|/)testing/|fuzz|bench'
      ;;
    all) git -c core.quotePath=false ls-files | grep -E '\.(cpp|h|comp|glsl|py|sh|cmake|md|[1-9]|case)$|(^|/)CMakeLists\.txt$' ;;
  esac | tr '\n' '\0' | xargs -0 cat 2>/dev/null | wc -l
}

# Commits that changed the file, the oldest first, then the file as it is now.
for commit in $(git log --first-parent --reverse --format=%h -- .ci/sizes) ''; do
  now=$(if [ -n "$commit" ]; then git show "$commit:.ci/sizes" 2>/dev/null; else cat .ci/sizes; fi)
  for kind in product all; do
    value=$(echo "$now" | sed -n "s/^$kind //p") before=$(echo "$past" | sed -n "s/^$kind //p")
    [ "${value:-0}" -le "${before:-${value:-0}}" ] ||
      complain "$kind rose from $(grouped "$before") to $(grouped "$value") in ${commit:-the file as it is now}: ceilings only fall"
  done
  past=$now
done

for kind in product all; do
  lines=$(counted $kind) ceiling=$(sed -n "s/^$kind //p" .ci/sizes)
  if [ -z "$ceiling" ]; then
    complain ".ci/sizes has no line of $kind"
  elif [ "$lines" -gt "$ceiling" ]; then
    complain "$kind has $(grouped "$lines") lines, at most $(grouped "$ceiling"): take away before you add"
  elif [ $((ceiling * 200)) -gt $((lines * 201)) ]; then
    complain "$kind has $(grouped "$lines") lines and a ceiling of $(grouped "$ceiling"): lower the ceiling"
  fi
done
exit $status
