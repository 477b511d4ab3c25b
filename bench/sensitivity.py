"""What hangs on each number of mincut and portalfit, in real buildings with known openings: doc/sensitivity.md."""
import re

import pages
from common import EVERYTHING, Setting, Stop, checked, settings
from houses import Truth, found, right_row, views_of

# Numbers that are varied together first; those that no group names make one of their own.
GROUPS = (
    ("mincut", "rooms", ("least-area", "largest-conductance", "least-carried")),
    ("mincut", "lamps in their own opening", ("straight", "seen")),
    ("mincut", "the sweep", ("hold", "least-drop", "loose", "most-drops")),
    ("portalfit", "openings", ("threshold", "least-edge")),
)
# Settings with a description of their own in --help, in place of a line of names.
WITH_WORDS = re.compile(r"^  (threshold|largest-conductance)=.*?default ([\d.e-]+)", re.M | re.S)


def numbers_of(bench, program):
    """{name: value} of --help."""
    text = checked([bench.store.program(program), "--help"]).said
    listed = text.partition("\nLimits ")[2]
    found_here = WITH_WORDS.findall(text) + re.findall(r"([a-z-]+)=([\d.e+-]+)", listed)
    return {name: float(value) for name, value in found_here}


def groups_of(bench):
    """(program, words, {name: value}), as far as ONLY names them, with what no group names."""
    groups, only = [], bench.settings.only
    for program in ("mincut", "portalfit"):
        numbers = numbers_of(bench, program)
        own = [(words, names) for of, words, names in GROUPS if of == program]
        rest = [name for name in numbers if not any(name in names for _, names in own)]
        for words, names in (*own, ("others", rest)):
            if unknown := [name for name in names if name not in numbers]:
                raise Stop(2, f"{program} --help names no {unknown[0]}")
            if names and (not only or words in only or set(only) & set(names)):
                groups.append((program, words, {name: numbers[name] for name in names}))
    if not groups:
        raise Stop(2, "ONLY names no group and no number")
    return groups


def changed(numbers, by):
    """Words of options. Shares stay shares."""
    return [word for name, value in numbers.items()
            for word in ("--set", f"{name}={min(value * by, 1) if value <= 1 else value * by:.6g}")]


class Count:
    """Of right and covered openings and of portals in no opening, by what is given to which program."""

    def __init__(self, bench, views):
        self.bench, self.truths, self.known = bench, [(view, Truth(bench, view)) for view in views], {}

    def __call__(self, program="", words=()):
        key = program, tuple(words)
        if key not in self.known:
            rows = self.bench.side_by_side([lambda v=view, t=truth: right_row(v, t.score(found(
                self.bench, v, options={program: words}).file)[0]) for view, truth in self.truths])
            big, right, covered, portals, none = (sum(row[k] for row in rows) for k in range(1, 6))
            self.known[key] = (right, covered, none)
            self.bench.say(f"{program} {' '.join(words)}: right {right} of {big}, covered {covered}, {portals} portals, "
                           f"{none} in no opening")
        return self.known[key]


def row_of(count, program, words, value, numbers):
    less, same, more = (count(program, changed(numbers, by)) if by != 1 else count() for by in (0.8, 1, 1.2))
    return [words, value, *(" / ".join(map(str, counts)) for counts in (less, same, more))], {less[0], same[0], more[0]}


@settings(HOUSES=Setting((), "views, or houses; default all", ("five-zone-office",)),
          ALONE=Setting(1, "0: groups as a whole only", 0))
def sensitivity(bench):
    """Groups of numbers of mincut and portalfit are made smaller and larger by a fifth, on networks and grids that are
    kept; where the number of right openings changes, each number of the group alone. ONLY: groups or numbers. Three
    hours on two cores."""
    count, rows = Count(bench, views_of(bench, bench.settings.houses)), []
    for program, words, numbers in groups_of(bench):
        row, right = row_of(count, program, f"**{program}: {words}**", "", numbers)
        rows.append(row)
        alone = bench.settings.alone and len(numbers) > 1 and len(right) > 1
        for name, value in numbers.items():
            rows.append(row_of(count, program, name, f"{value:g}", {name: value})[0] if alone else
                        [name, f"{value:g}", "", "", ""])
    table = pages.table(("number", "value", "at -20 %", "as is", "at +20 %"), rows)
    print(table)
    bench.page("sensitivity", {"numbers": table}, EVERYTHING, "portalfit")
