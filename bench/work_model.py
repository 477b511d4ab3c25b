"""The costs of the model of work, tools/tdpt-render/plan/work_model.h, by least squares of relative errors: sum over
lines of ((terms . costs) / nanoseconds - 1)^2, one fit to the lines with portals and one to those without; lines of pt
do not count. A term that is 0 in all lines stays 0, unwritten; one that is held has that cost where it is not."""
import fileinput

import numpy as np

from common import Setting, settings

KEYS = ("scene", "depth", "integrator", "portals", "nanoseconds")  # before the terms
TABLES = {1: "kWorkWithPortals", 0: "kWorkWithoutPortals"}
DEVICE_TABLES = {1: "kDeviceWorkWithPortals", 0: "kDeviceWorkWithoutPortals"}


def read(lines):
    """Names of the terms and, by TABLES' keys, lines as (keys, terms). Throws ValueError."""
    terms, rows = None, {key: [] for key in TABLES}
    for number, line in enumerate(lines, 1):
        fields = line.rstrip("\n").split("\t")
        if tuple(fields[: len(KEYS)]) == KEYS:
            if terms not in (None, fields[len(KEYS) :]):
                raise ValueError(f"line {number}: the terms differ from those before")
            terms = fields[len(KEYS) :]
            continue
        if terms is None:
            raise ValueError(f"line {number}: expected the header of work_model_bench")
        if len(fields) != len(KEYS) + len(terms):
            raise ValueError(f"line {number}: has {len(fields)} fields, expected {len(KEYS) + len(terms)}")
        keys = dict(zip(KEYS, fields))
        row = [float(x) for x in fields[len(KEYS) :]]
        if not float(keys["nanoseconds"]) > 0:
            raise ValueError(f"line {number}: nanoseconds must be positive")
        rows[int(keys["portals"])].append((keys, row))
    return terms, rows


def fit(terms, times, held=np.nan):
    """Costs [ns] that least squares of relative errors give; terms[line, term], times[line] in ns. held[term]: its
    cost where it is known, else nan; nan: none is.

    Throws ValueError where the lines do not determine them."""
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


def ratio_errors(rows, costs):
    """By line: the model's ratio to bdpt's time, of the same scene and depth, over the measured one, less 1. `rows`,
    `costs`: by TABLES' keys; bdpt's line may have the other table's."""
    lines = [(keys, np.dot(terms, costs[key]), float(keys["nanoseconds"])) for key in rows for keys, terms in rows[key]]
    place = lambda keys: (keys["scene"], keys["depth"])
    bdpt = {place(keys): (model, measured) for keys, model, measured in lines if keys["integrator"] == "bdpt"}
    return np.array([(model / bdpt[place(keys)][0]) / (measured / bdpt[place(keys)][1]) - 1
                     for keys, model, measured in lines if keys["integrator"] != "bdpt" and place(keys) in bdpt])


def table(name, names, costs):
    """As it stands in work_model.h; whole nanoseconds."""
    lines = [f"    .{n} = {c:.0f}," for n, c in zip(names, costs) if round(c) != 0]
    return "\n".join([f"inline constexpr WorkCosts {name}{{", *lines, "};"])


def held_costs(costs, names):
    """held[term] of fit(); costs: TERM=COST. Throws ValueError."""
    held = np.full(len(names), np.nan)
    for name, cost in (word.split("=") for word in costs):
        if name not in names:
            raise ValueError(f"HOLD: {name}: there is no such term")
        held[names.index(name)] = float(cost)
    return held


@settings(FILES=Setting(("/dev/stdin",), "what work_model_bench printed"), DEVICE=Setting(0, "1: tables of a device"),
          HOLD=Setting((), "TERM=COST ..., costs that are known"))
def work_model(bench):
    """Fits the tables of tools/tdpt-render/plan/work_model.h to what work_model_bench measured, headers in between
    allowed, and prints them as they stand there. How far the fit is off goes to standard error."""
    s = bench.settings
    with fileinput.input(s.files, encoding="utf-8") as lines:
        names, rows = read(lines)
    held = held_costs(s.hold, names)
    rows = {key: [row for row in rows[key] if row[0]["integrator"] != "pt"] for key in rows if rows[key]}
    costs = {}
    for key, of in rows.items():
        terms = np.array([row for _, row in of])
        costs[key] = np.round(fit(terms, np.array([float(keys["nanoseconds"]) for keys, _ in of]), held))
        print(table((DEVICE_TABLES if s.device else TABLES)[key], names, costs[key]))
    errors = np.abs(ratio_errors(rows, costs))
    if errors.size:
        bench.say(f"{sum(map(len, rows.values()))} lines; ratios to bdpt are off by {100 * errors.mean():.1f} % on "
                  f"average, {100 * errors.max():.1f} % at most")
