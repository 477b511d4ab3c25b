#!/bin/sh
# install_test.sh BUILD: the result of `make install` works in any folder, and `make uninstall` removes exactly that,
# without CMake.
build=$(cd "${1:?usage: install_test.sh BUILD}" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
failed=0
complain() {
  echo "$1"
  failed=1
}
all() { (cd "$1" && find . | LC_ALL=C sort); }

# All that uninstall.sh may use.
mkdir "$work/bin"
for tool in sh sort rm rmdir; do ln -s "$(command -v $tool)" "$work/bin/$tool"; done
install() { DESTDIR=$1 sh "$here/install.sh" "$build" "$2" >"$work/log" 2>&1 || complain "install to $1$2: $(cat "$work/log")"; }
uninstall() { DESTDIR=$1 PATH=$work/bin sh "$here/uninstall.sh" "$2" >"$work/log" 2>&1; }

# Into an empty folder whose name contains a blank.
empty=$work/an\ empty\ one
mkdir "$empty"
install "$empty" /opt/tdpt
for program in ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge exrdenoise tdpt-info tdpt-import tdpt; do
  "$empty/opt/tdpt/bin/$program" --version >/dev/null || complain "$program: does not run where it is installed"
  [ -s "$empty/opt/tdpt/share/man/man1/$program.1" ] || complain "$program: its page is not installed"
done
"$empty/opt/tdpt/bin/tdpt" "$here/../testdata/scenes/two-rooms.glb" -o "$work/a.exr" --integrator bdpt --spp 1 --width 8 --quiet \
  --work "$work/cache" || complain "tdpt does not find the programs where it is installed"
for file in share/man/man7/tdpt.7 share/tdpt/tdpt.mk share/doc/tdpt/LICENSE share/doc/tdpt/CHANGELOG.md; do
  [ -s "$empty/opt/tdpt/$file" ] || complain "$file is not installed"
done
# dead FOLDER: the links of its README that lead to no file. Twin: the README of the sources does have such links there.
dead() {
  sed 's/`[^`]*`//g' "$1/README.md" | grep -oE '\]\([^) ]*|(href|src)="[^"]*' | sed 's/^[^("]*[("]//' | grep -v '^[a-z]*:' | while IFS= read -r link; do
    [ -e "$1/${link%%#*}" ] || echo "$link"
  done
}
docs=$empty/opt/tdpt/share/doc/tdpt
[ -z "$(dead "$docs")" ] || complain "links of the installed README lead nowhere: $(dead "$docs" | tr '\n' ' ')"
grep -q '](LICENSE)' "$docs/README.md" || complain "the installed README has lost the link to its licence"
[ -z "$(dead "$here/..")" ] || complain "links of README.md lead nowhere: $(dead "$here/.." | tr '\n' ' ')"
mkdir "$work/twin" && cp "$here/../README.md" "$work/twin"
[ -n "$(dead "$work/twin")" ] || complain "README.md without its sources: all links are well"
install "$empty" /opt/tdpt
uninstall "$empty" /opt/tdpt || complain "uninstall fails: $(cat "$work/log")"
[ "$(all "$empty")" = . ] || complain "uninstall leaves: $(all "$empty")"
if uninstall "$empty" /opt/tdpt; then complain "uninstall of nothing: all is well"; fi
grep -q "there is no $empty/opt/tdpt/share/tdpt/installed" "$work/log" || complain "uninstall of nothing: says not why"

# Beside other files, also in our folder, and over an older version that had one more file.
full=$work/full
mkdir -p "$full/usr/local/bin" "$full/usr/local/share/man/man1"
echo mine >"$full/usr/local/bin/mine"
before=$(all "$full")
install "$full" /usr/local
echo old >"$full/usr/local/bin/oldtool"
echo /usr/local/bin/oldtool >>"$full/usr/local/share/tdpt/installed"
install "$full" /usr/local
uninstall "$full" /usr/local || complain "uninstall fails: $(cat "$work/log")"
[ "$(all "$full")" = "$before" ] || complain "uninstall changes what was there: $(all "$full")"
install "$full" /usr/local
echo mine >"$full/usr/local/share/tdpt/mine.mk"
uninstall "$full" /usr/local || complain "uninstall fails: $(cat "$work/log")"
[ -s "$full/usr/local/share/tdpt/mine.mk" ] || complain "uninstall removes a file that is not ours"
[ "$(find "$full" -type f | wc -l)" -eq 2 ] || complain "uninstall beside a file of another leaves: $(all "$full")"
exit $failed
