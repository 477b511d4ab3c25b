"""How right the portals are in generated rooms whose openings are known: doc/portals.md."""
from common import ROOT, Setting, checked, settings

KNOWN = "hole,slit,floor-door,through-floor,ajar-full,ajar,window,two-openings,holes-in-row,doors-in-row,closet"
UNDER_SKY = ("sky-window,sky-windows,corner-windows,skylight,sky-blinds,colonnade,room-behind,deep-facade,landscape,"
             "deep-room")
HEAD = """| rooms | all four | coverage >= 0.98 | tightness >= 0.90 | angle <= 3 | right number | strays | \
median coverage | median tightness | median angle | CPU s |
|---|---|---|---|---|---|---|---|---|---|---|---|"""


def not_all_right(text):
    """What portals_bench prints, without the kinds of which every room is right; these are counted."""
    kept, right = [], 0
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 2 and cells[1].isdigit() and cells[1] == cells[2] and "together" not in cells[0]:
            right += 1
        else:
            kept.append(line)
    return "\n".join(kept) + f"\n\nEvery room is right in {right} other kinds."


@settings(ROOMS=Setting(20, "of each kind", 1),
          SEED=Setting(0, "of the first; if not set, the first seven digits of the commit's hash, so that nobody "
                       "chooses it"))
def portals(bench):
    """How right the portals are, on generated rooms whose openings are known. An hour on two quiet cores. Rows room by
    room stay in the cache."""
    s, seed, whence = bench.settings, bench.settings.seed, ""
    if not seed:
        head = checked(["git", "-C", ROOT, "rev-parse", "HEAD"]).said[:7]
        seed, whence = int(head, 16), f", the first digits of the commit that was measured, {head}"
    few = (s.rooms + 6) // 7  # rooms of each kind in the other tables
    program = bench.store.program("portals_bench")

    def table(name, count, *arguments):
        """Of portals_bench."""
        run = checked([program, bench.programs, "--seed", seed, "--rooms", count, "--jobs", s.jobs, *arguments],
                      may_fail=(1,))
        (bench.cache / f"{name}.rooms").write_text(run.errors, encoding="utf-8")
        return run.said.strip()

    def summary(label, **options):
        """One row over all kinds."""
        arguments = [word for stage, text in options.items() for word in (f"--{stage}", text)]
        rows = table(label.replace(" ", "-").replace("'", ""), few, "--kinds", KNOWN, *arguments).splitlines()
        kinds = "| all kinds together |"
        return "\n".join(f"| {label} |" + row.removeprefix(kinds) for row in rows if row.startswith(kinds))

    triangles, paper = {"ffgraph": "--nodes triangles"}, {"portalfit": "--set method=paper"}
    invariance = checked([bench.store.program("invariance_bench"), bench.programs, few])
    (bench.cache / "invariance.rooms").write_text(invariance.errors, encoding="utf-8")
    bench.page("portals", {
        "kinds": f"The first seed of each kind is {seed}{whence}.\n\n{not_all_right(table('kinds', s.rooms))}",
        "skies": not_all_right(table("skies", few, "--kinds", UNDER_SKY)),
        "rules": "\n".join((f"| method {HEAD}", summary("ours"), summary("triangles, our fit", **triangles),
                            summary("patches, the paper's fit", **paper),
                            summary("triangles, the paper's fit", **triangles, **paper))),
        "invariance": invariance.said.strip()}, "portalfit")
