"""cycles_equal.py LINES: the tables of cycles-equal.sh from what it measured, a line each:
  cell ROOM SKY PORTALS BLACK_RELMSE BLACK_PSNR PEAK OFF      PEAK: squared, that of PSNR; OFF: of Cycles' mean, a share
  run ROOM SKY METHOD SEED SPP CPU RELMSE MSE CHOSEN

efficiency of a method   1 / mean over its seeds of CPU s x relMSE
"""
import collections
import math
import sys

import numpy as np

import intervals

Cell = collections.namedtuple("Cell", "portals black_relmse black_psnr peak off runs")  # runs: {method: [Run]}
Run = collections.namedtuple("Run", "spp cpu relmse mse")
METHODS = {"cycles": "Cycles", "cycles-hand": "Cycles, portals by hand", "cycles-found": "Cycles, portals found",
           "ours-nee": "`nee`", "ours-auto": "`auto`, portals found"}
BASE = "cycles-hand"
SEED = 20261122


def read(lines):
    """{(room, sky): Cell} in the order of the lines. Throws ValueError."""
    cells = {}
    for number, line in enumerate(lines, 1):
        kind, room, sky, *field = line.split()
        try:
            if kind == "cell":
                portals, *numbers = field
                cells[room, sky] = Cell(int(portals), *map(float, numbers), collections.defaultdict(list))
            elif kind == "run":
                method, _, *numbers, _ = field
                cells[room, sky].runs[method].append(Run(*map(float, numbers)))
            else:
                raise ValueError(f"{kind} is neither cell nor run")
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"line {number}: {error}") from error
    return cells


def costs(cell, method):
    return np.array([r.cpu * r.relmse for r in cell.runs[method]])


def gain(cell, method):
    """Efficiency over BASE's, and the ends of its 95 % interval over seeds."""
    base, own = costs(cell, BASE), costs(cell, method)
    return base.mean() / own.mean(), *intervals.ratio_interval(base, own, np.random.default_rng(SEED))


def geometric_mean(cells, method):
    return math.exp(np.mean([math.log(gain(c, method)[0]) for c in cells]))


def psnr(cell, method):
    return 10 * math.log10(cell.peak / np.mean([r.mse for r in cell.runs[method]]))


def gain_table(cells):
    others = [m for m in METHODS if m != BASE]
    rows = ["| room | sky | " + " | ".join(METHODS[m] for m in others) + " |", "|---|---|" + "---|" * len(others)]
    for (room, sky), cell in cells.items():
        of = (gain(cell, m) for m in others)
        rows.append(f"| {room} | {sky} | " + " | ".join(f"{g:.3g} [{low:.3g}, {high:.3g}]" for g, low, high in of) + " |")
    for sky in dict.fromkeys(sky for _, sky in cells):
        of = [c for (_, s), c in cells.items() if s == sky]
        rows.append(f"| geometric mean | {sky} | " + " | ".join(f"{geometric_mean(of, m):.3g}" for m in others) + " |")
    rows.append("| geometric mean | **all** | " +
                " | ".join(f"**{geometric_mean(cells.values(), m):.3g}**" for m in others) + " |")
    return rows


def error_table(cells):
    rows = ["| room | sky | " + " | ".join(METHODS.values()) + " | black | means |", "|---|---|" + "---|" * (len(METHODS) + 2)]
    for (room, sky), c in cells.items():
        of = [(*np.mean([(r.spp, r.cpu, r.relmse) for r in c.runs[m]], 0), psnr(c, m)) for m in METHODS]
        words = [f"{error:.2g}, {p:.1f} ({spp:.0f}; {cpu:.1f} s)" for spp, cpu, error, p in of]
        rows.append(f"| {room} | {sky} | " + " | ".join(words) +
                    f" | {c.black_relmse:.2g}, {c.black_psnr:.1f} | {100 * c.off:+.2f} % |")
    return rows


def main(path):
    with open(path, encoding="utf-8") as file:
        cells = read(file)
    if not cells:
        raise ValueError("no cell, expected what cycles-equal.sh measures")
    print("Efficiency over that of Cycles with portals by hand, 95 % intervals over seeds:\n")
    print("\n".join(gain_table(cells)))
    print("\nrelMSE, PSNR [dB] (samples per pixel; CPU seconds):\n")
    print("\n".join(error_table(cells)))


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except (OSError, ValueError) as error:
        sys.exit(f"cycles_equal.py: {error}")
