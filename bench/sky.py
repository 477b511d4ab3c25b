"""sky.py LINES: the tables of doc/sky.md from what sky.sh measured, a line each:
  cell ROOM GROUP SKY PORTALS BLACK_RELMSE BLACK_PSNR PEAK                  PEAK: squared, that of PSNR
  run ROOM SKY METHOD SEED CPU RELMSE MSE MEAN CHOSEN                       MEAN: over the reference's

cost of a method   mean over its seeds of CPU s x relMSE
gain of a method   cost of the better of WITHOUT over its own
"""
import collections
import math
import sys

import numpy as np

import intervals

Run = collections.namedtuple("Run", "cpu relmse mse mean chosen")
SEED = 20260717
WITHOUT = ("bdpt", "nee")
WITH = {"windows": "`nee` + portals", "aimed": "`nee` 0.4", "guided": "`tdpt-guided`", "auto": "`auto`"}
GROUPS = {"windows": "ordinary windows", "interiors": "interiors", "second": "through a second room"}
NAN = float("nan")


class Cell:
    """A room under a sky."""

    def __init__(self, group, portals, black_relmse, black_psnr, peak):
        self.group, self.portals, self.black_relmse = group, int(portals), float(black_relmse)
        self.black_psnr, self.peak = float(black_psnr), float(peak)
        self.runs = collections.defaultdict(dict)  # method: {seed: Run}

    def of(self, method):
        """Runs in the order of their seeds."""
        return [self.runs[method][seed] for seed in sorted(self.runs[method])]

    def costs(self, method):
        return np.array([r.cpu * r.relmse for r in self.of(method)])

    def base(self):
        """The better method without portals."""
        return min(WITHOUT, key=lambda m: self.costs(m).mean())

    def gain(self, method):
        """nan where an error hides in the noise of the reference."""
        costs = [self.costs(m).mean() for m in (self.base(), method)]
        return costs[0] / costs[1] if min(costs) > 0 else NAN

    def interval(self, method):
        rng = np.random.default_rng(SEED)
        return intervals.ratio_interval(self.costs(self.base()), self.costs(method), rng)

    def psnr(self, method):
        mse = np.mean([r.mse for r in self.of(method)])
        return 10 * math.log10(self.peak / mse) if mse > 0 else NAN


def read(lines):
    """{(room, sky): Cell} in the order of the lines. Throws ValueError."""
    cells = {}
    for number, line in enumerate(lines, 1):
        kind, *field = line.split()
        try:
            if kind == "cell":
                room, group, sky, *numbers = field
                if group not in GROUPS:
                    raise ValueError(f"{group} is no group")
                cells[room, sky] = Cell(group, *numbers)
            elif kind == "run":
                room, sky, method, seed, *numbers, chosen = field
                cells[room, sky].runs[method][int(seed)] = Run(*map(float, numbers), chosen.replace("_", " "))
            else:
                raise ValueError(f"{kind} is neither cell nor run")
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"line {number}: {error}") from error
    return cells


def geometric_mean(cells, method):
    """Of the gains, and the ends of its 95 % interval over seeds; the rooms are what they are."""
    gains = [cell.gain(method) for cell in cells]
    known = [(cell, gain) for cell, gain in zip(cells, gains) if not math.isnan(gain)]
    if not known:
        return NAN, NAN, NAN
    rng = np.random.default_rng(SEED)
    total, least = np.zeros(intervals.DRAWS), min(len(cell.of(method)) for cell, _ in known)
    for cell, _ in known:
        for sign, of in ((1, cell.base()), (-1, method)):
            costs = cell.costs(of)
            means = costs[rng.integers(len(costs), size=(intervals.DRAWS, len(costs)))].mean(1)
            total += sign * np.log(np.maximum(means, 1e-12))
    total.sort()
    value = math.exp(np.mean([math.log(gain) for _, gain in known]))
    if least < 2:
        return value, NAN, NAN
    level = int(intervals.expanded_tail(least) * intervals.DRAWS)
    ends = np.exp(total[[level, intervals.DRAWS - 1 - level]] / len(known))
    return value, ends[0], ends[1]


def number(x):
    return "-" if math.isnan(x) else f"{x:.2f}" if x < 9.95 else f"{x:.1f}" if x < 99.5 else f"{x:.0f}"


def with_interval(value, low, high):
    if math.isnan(value) or math.isnan(low):
        return number(value)
    return f"{number(value)} [{number(low)}, {'-' if high >= intervals.NO_BOUND else number(high)}]"


def of_cell(cell, method):
    ends = cell.interval(method) if len(cell.of(method)) > 1 else (NAN, NAN)
    return with_interval(cell.gain(method), *ends)


def skies_of(cells):
    return list(dict.fromkeys(sky for _, sky in cells))


def select(cells, group, sky=None):
    return [c for (_, s), c in cells.items() if c.group == group and sky in (None, s)]


def mean_table(cells):
    rows = ["| lit through | sky | rooms | " + " | ".join(WITH.values()) + " |", "|---|---|---|" + "---|" * len(WITH)]
    for group, words in GROUPS.items():
        for sky in (*skies_of(cells), None):
            of = select(cells, group, sky)
            if of:
                gains = " | ".join(with_interval(*geometric_mean(of, m)) for m in WITH)
                rows.append(f"| {words} | {sky or '**all**'} | {len(of)} | {gains} |")
    return rows


def least(cells, value):
    """The key for which value is least, and the value; nan counts for nothing."""
    known = {key: v for key, v in ((key, value(cell)) for key, cell in cells.items()) if not math.isnan(v)}
    key = min(known, key=known.get)
    return key, known[key]


def beside_best(cell):
    """Gain of auto over the greatest of a single method, 1 of the better without among them."""
    return cell.gain("auto") / max(1, *(cell.gain(m) for m in WITH if m != "auto"))


def aim_table(cells):
    rows = ["| aim, for `auto` | measured | met |", "|---|---|---|"]

    def row(words, aim, value, shown):
        if not math.isnan(value):
            rows.append(f"| {words}: {aim} | {shown} | {'yes' if value >= aim else '**no**'} |")

    for words, aim, group, sky in (("ordinary windows, geometric mean", 5, "windows", None),
                                   ("the same under overcast", 1.5, "windows", "overcast"),
                                   ("through a second room, geometric mean", 20, "second", None)):
        mean = geometric_mean(select(cells, group, sky), "auto")
        row(words, aim, mean[0], with_interval(*mean))
    for words, value in (("the least gain", lambda c: c.gain("auto")), ("the least beside the best single choice", beside_best)):
        (room, sky), low = least(cells, value)
        below = sum(value(c) < 0.95 for c in cells.values())
        row(words, 0.95, low, f"{low:.2f} ({room}, {sky}); below 0.95 in {below} of {len(cells)}")
    return rows


def room_table(cells):
    rows = ["| room | sky | portals | without | " + " | ".join(WITH.values()) + " | `auto` chose |",
            "|---|---|---|---|" + "---|" * (len(WITH) + 1)]
    for (room, sky), c in cells.items():
        gains = " | ".join(of_cell(c, m) for m in WITH)
        chosen = collections.Counter(r.chosen for r in c.of("auto")).most_common()
        words = ", ".join(name + (f" ({n} of {len(c.of('auto'))})" if len(chosen) > 1 else "") for name, n in chosen)
        rows.append(f"| {room} | {sky} | {c.portals or 'none found'} | {c.base()} | {gains} | {words} |")
    return rows


def error_table(cells):
    methods = {**{m: f"`{m}`" for m in WITHOUT}, **WITH}
    rows = ["| room | sky | " + " | ".join(methods.values()) + " | black |", "|---|---|" + "---|" * (len(methods) + 1)]
    for (room, sky), c in cells.items():
        errors = [(np.mean([r.relmse for r in c.of(m)]), c.psnr(m)) for m in methods] + [(c.black_relmse, c.black_psnr)]
        rows.append(f"| {room} | {sky} | " + " | ".join(f"{e:.2g}, {p:.1f}" for e, p in errors) + " |")
    return rows


def main(path):
    with open(path, encoding="utf-8") as file:
        cells = read(file)
    if not cells:
        raise ValueError("no cell, expected what sky.sh measures")
    print("## Gains\n\nGeometric means over rooms.\n")
    print("\n".join(mean_table(cells)))
    print("\n## Aims\n")
    print("\n".join(aim_table(cells)))
    print("\n## Room by room\n\nwithout: which of `bdpt` and `nee` is the better without portals.\n")
    print("\n".join(room_table(cells)))
    print("\n## Errors\n\nrelMSE, PSNR [dB] with equally many samples, not in equal time; black: of a picture of no light.\n")
    print("\n".join(error_table(cells)))


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except (OSError, ValueError) as error:
        sys.exit(f"sky.py: {error}")
