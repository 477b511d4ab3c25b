#!/bin/sh
# report_test.sh BIN TESTDATA: makes a tiny room.report.html, and checks its contents, that it loads nothing, that names
# are escaped, and what makes it again. Exit 77 without GNU Make or Python.
bin=$(cd "${1:?usage: report_test.sh BIN TESTDATA}" && pwd) testdata=$(cd "${2:?}" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
make --version 2>/dev/null | grep -q 'GNU Make' || { echo "skipped: GNU Make is missing"; exit 77; }
python3 -c '' 2>/dev/null || { echo "skipped: python3 is missing"; exit 77; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
unset MAKEFLAGS MFLAGS MAKELEVEL
cd "$work" || exit 2
failed=0
complain() {
  echo "$1"
  [ ! -s log ] || sed 's/^/  /' log
  failed=1
}
cat >Makefile <<END
TDPT_BIN = $bin/
FFGRAPH_FLAGS = --set walks=5000 --samples 20000 --set rounds=0
LIGHTGRID_FLAGS = --resolution 32
REPORT_TIME = 0.4
REPORT_WIDTH = 16
REPORT_REFERENCE = 2
QUIET = 1
include $here/../tdpt.mk
END
cp "$testdata/scenes/two-rooms.glb" room.glb
cp "$testdata/scenes/furnace.glb" furnace.glb

# As in tdpt-mk_test.sh: makes WHY TARGETS ARGUMENTS...
targets() { sed -n 's/.* -MQ \([^ ]*\).*/\1/p' log | sort | tr '\n' ' '; }
makes() {
  why=$1 expected=$2
  shift 2
  make "$@" >log 2>&1 || complain "$why: make $* fails"
  [ "$(targets)" = "$expected" ] || complain "$why: made '$(targets)', expected '$expected'"
}
stages='room.cut room.max room.portal.glb '
makes "a report" "${stages}room.report.html room.vdb " room.report.html -j4
makes "a second time" "" room.report.html
makes "a picture after it" "room.exr " TDPT_RENDER_FLAGS='--spp 1 --width 16' -n room.exr
makes "another time" "room.report.html " REPORT_TIME=0.3 -n room.report.html
makes "other flags" "room.report.html " TDPT_RENDER_FLAGS='--set mis=power' -n room.report.html
cp room.report.html first.html
touch room.glb
makes "another scene" "${stages}room.report.html room.vdb " -n room.report.html

# What the page tells of the portals is what was rendered: all was decided once, at the beginning.
cat >verdict.py <<'END'
import json, sys
sys.path.insert(0, sys.argv[1])
import report_page
with open(sys.argv[2]) as stream:
    m = json.load(stream)
first, last, steps = (m["with"][key] for key in ("first", "last", "steps"))
assert first["chosen"] == last["chosen"], (first["chosen"], last["chosen"])
assert last.get("pilot", first["pilot"])["samples"] == first["pilot"]["samples"], "it was decided again"
assert len(steps) > 2 and steps[0]["spp"] == first["spp"], (first["spp"], steps)
assert steps[0]["cpu"] > first["pilot"]["cpu"], "the pilot is not counted"
assert m["with"]["text"].count(": pilot: ") == 1, m["with"]["text"]
# The same with another choice: portals that are left out are worth nothing in any headline, whatever was foretold.
candidates = [{"integrator": "tdpt-guided 0.7", "portals": True, "relmse": 1.0, "work": 1.0, "cost": 1.0},
              {"integrator": "nee", "portals": False, "relmse": 1.0, "work": 1.3, "cost": 1.3}]
for gain, chosen, told, not_told in ((1.3, "nee", "left it out", "worth"), (0.79, "nee", "left it out", "worth"),
                                     (1.3, "tdpt-guided 0.7", "worth 1.3 times", "left it out")):
    first["pilot"].update(portals_gain=gain, candidates=candidates)
    last["chosen"] = chosen
    words = report_page.Verdict(m).sentence()
    assert told in words and not_told not in words and report_page.figure(gain) + " times" in words, words
END
python3 -B verdict.py "$here" .tdpt/room.report.html.parts/measured.json >log 2>&1 || complain "the headline is not what was rendered"

# A scene whose stages ran before: they run again and tell of themselves, and what they made stays, with its time.
makes "stages alone" "furnace.cut furnace.max furnace.portal.glb furnace.vdb " furnace.portal.glb
state() { stat -c '%n %Y' furnace.max furnace.cut furnace.vdb furnace.portal.glb; cat furnace.max furnace.cut furnace.vdb furnace.portal.glb | cksum; }
before=$(state)
sleep 1
makes "a report of them" "furnace.cut furnace.max furnace.portal.glb furnace.report.html furnace.vdb " furnace.report.html
[ "$(state)" = "$before" ] || complain "a report changed the stages' results"
makes "stages after it" "" furnace.portal.glb
grep -q 'No portal was found' furnace.report.html || complain "furnace: that it has no portal is not said"

# A page of names that would be HTML, and without some of the figures.
cp -r .tdpt/room.report.html.parts evil
cat >plant.py <<'END'
import json
BAD = '<script src="http://evil.example/x.js">alert(1)</script>"\'&\u202e\x00'
KEPT = ("portalfit", "mincut", "ffgraph", "lightgrid", "scene")
def plant(value):
    if isinstance(value, dict):
        return {key: plant(v) for key, v in value.items()}
    if isinstance(value, list):
        return [plant(v) for v in value]
    return value + BAD if isinstance(value, str) and value not in KEPT and not value.endswith((".png", ".svg")) else value
with open("evil/measured.json") as stream:
    m = plant(json.load(stream))
m["with"]["last"]["portals"][0]["energy"] = None
m["stages"][0]["json"] = None
m["with"]["steps"][-1]["relmse"] = None
m["black"] = None
with open("evil/measured.json", "w") as stream:
    json.dump(m, stream)
END
python3 plant.py || complain "the hostile names could not be planted"
python3 -B -c 'import sys; sys.path.insert(0, sys.argv[1]); import report_page
with open("evil.html", "w", encoding="utf-8", errors="replace") as stream: stream.write(report_page.page("evil"))' "$here" >log 2>&1 ||
  complain "hostile names: no page"

cat >check.py <<'END'
import html.parser, re, sys
SECTIONS = ["scene", "stages", "portals", "pictures", "error", "decisions", "provenance"]
VOID = {"img", "meta", "br"}
class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.wrong, self.ids, self.tags = [], [], [], []
    def handle_starttag(self, tag, attributes):
        a = dict(attributes)
        self.tags.append(tag)
        if "id" in a:
            self.ids.append(a["id"])
        if tag == "img" and not a.get("alt"):
            self.wrong.append("a picture without words")
        if tag == "script" or any(name.startswith("on") for name in a):
            self.wrong.append("a script")
        for name in ("src", "href"):
            if name in a and not a[name].startswith(("data:image/png;base64,", "data:image/svg+xml;base64,", "#")):
                self.wrong.append(f"{name} {a[name][:60]}")
        if tag not in VOID:
            self.open.append(tag)
    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f"</{tag}> closes another")
wrong = 0
for name in sys.argv[1:]:
    with open(name, encoding="utf-8") as stream:
        source = stream.read()
    page = Page()
    page.feed(source)
    page.close()
    page.wrong += [f"no section {s}" for s in SECTIONS if s not in page.ids]
    page.wrong += [f"two of {i}" for i in set(page.ids) if page.ids.count(i) > 1]
    if page.open:
        page.wrong.append(f"{page.open} stay open")
    if source.count("data:image/svg+xml;base64,") != 1:
        page.wrong.append("there is not one plan")
    if page.tags.count("h1") != 1 or page.tags.count("svg") != 1 or page.tags.count("img") < 5:
        page.wrong.append("a heading, plot or picture is missing")
    if re.search("url\\(|@import|<link|[\x01-\x08\u202e]", re.sub(r"base64,[^\"]*", "", source)) or "\0" in source:
        page.wrong.append("something from outside, or a character that nobody sees")
    for words in page.wrong:
        print(f"{name}: {words}")
        wrong = 1
sys.exit(wrong)
END
: >log
python3 check.py first.html furnace.report.html evil.html || complain "a page is not as it should be"
# The twin that must fail.
sed 's/<main>/<main><script>1<\/script>/' first.html >planted.html
if python3 check.py planted.html >log; then complain "a script was planted, and all is well"; fi
if grep -q "$work" first.html furnace.report.html; then complain "a page names a folder of this machine"; fi
exit $failed
