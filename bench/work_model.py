"""Fits the tables of tools/tdpt-render/plan/work_model.h to what work_model_bench measured."""
import fileinput

import numpy as np

from common import Setting, settings

# Least squares of relative errors: sum over lines of ((terms . costs) / nanoseconds - 1)^2, one fit to the lines with
# portals and one to those without; lines of pt do not count. A term that is 0 in all lines stays 0, unwritten; one that
# is held has that cost where it is not.
KEYS = ("scene", "depth", "integrator", "portals", "nanoseconds")  # before the terms
TABLES = {1: "kWorkWithPortals", 0: "kWorkWithoutPortals"}
DEVICE_TABLES = {1: "kDeviceWorkWithPortals", 0: "kDeviceWorkWithoutPortals"}


def read_work(lines):
    """Names of the terms and, by TABLES' keys, lines as (keys, terms). Throws ValueError."""
    terms, rows = [], {key: [] for key in TABLES}
    for number, fields in enumerate((line.rstrip("\n").split("\t") for line in lines), 1):
        keys, values = dict(zip(KEYS, fields)), fields[len(KEYS) :]
        if tuple(keys.values()) == KEYS:
            terms = values
        elif len(values) != len(terms) or not float(keys["nanoseconds"]) > 0:
            raise ValueError(f"line {number}: expected {len(terms)} terms after positive nanoseconds, as in the header")
        else:
            rows[int(keys["portals"])].append((keys, [float(x) for x in values]))
    return terms, rows


def fit(terms, times, held=np.nan):
    """Costs [ns]; terms[line, term], times[line] in ns. held[term]: its cost where it is known, else nan. Throws
    ValueError where the lines do not determine them."""
    there, costs = np.any(terms != 0, axis=0), np.zeros(terms.shape[1])
    known = there & ~np.isnan(held)
    costs[known] = np.broadcast_to(held, costs.shape)[known]
    there &= ~known
    a = terms[:, there] / times[:, None]
    # Columns of one length: the rank is then about directions and not about units.
    lengths = np.linalg.norm(a, axis=0)
    solution, _, rank, _ = np.linalg.lstsq(a / lengths, 1 - terms @ costs / times, rcond=1e-9)
    if rank < a.shape[1]:
        raise ValueError(f"{len(times)} lines determine {rank} of {a.shape[1]} costs: more scenes are needed")
    costs[there] = solution / lengths
    return costs


def costs_text(name, names, costs):
    """As it stands in work_model.h; whole nanoseconds."""
    lines = [f"    .{n} = {c:.0f}," for n, c in zip(names, costs) if round(c) != 0]
    return "\n".join([f"inline constexpr WorkCosts {name}{{", *lines, "};"])


@settings(FILES=Setting(("/dev/stdin",), "what work_model_bench printed"), DEVICE=Setting(0, "1: tables of a device"),
          HOLD=Setting((), "TERM=COST ..., costs that are known"))
def work_model(bench):
    """Fits the tables of tools/tdpt-render/plan/work_model.h to what work_model_bench measured, headers in between
    allowed, and prints them as they stand there. How far the fit is off goes to standard error."""
    s = bench.settings
    with fileinput.input(s.files, encoding="utf-8") as lines:
        names, rows = read_work(lines)
    held = np.full(len(names), np.nan)
    for name, cost in (word.split("=") for word in s.hold):
        held[names.index(name)] = float(cost)
    for key, of in ((key, [row for row in rows[key] if row[0]["integrator"] != "pt"]) for key in rows if rows[key]):
        terms, times = np.array([row for _, row in of]), np.array([float(keys["nanoseconds"]) for keys, _ in of])
        costs = np.round(fit(terms, times, held))
        print(costs_text((DEVICE_TABLES if s.device else TABLES)[key], names, costs))
        off = np.abs(terms @ costs / times - 1)
        bench.say(f"{len(of)} lines; times are off by {100 * off.mean():.0f} % on average, {100 * off.max():.0f} % at most")
