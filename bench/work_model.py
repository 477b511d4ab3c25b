#!/usr/bin/python3
"""work_model.py [FILE...]: fits the tables of tools/tdpt-render/work_model.h to what work_model_bench
measured (files or standard input, headers in between allowed) and prints them as they stand there.

Least squares of relative errors: sum over lines of ((terms . costs) / nanoseconds - 1)^2, one fit to the
lines with portals and one to those without. A term that is 0 in all lines stays 0, unwritten. How far the
fit is off goes to standard error.
"""
import sys

import numpy as np

KEYS = ("scene", "depth", "integrator", "portals", "nanoseconds")  # before the terms
TABLES = {1: "kWorkWithPortals", 0: "kWorkWithoutPortals"}


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


def fit(terms, times):
    """Costs [ns] that least squares of relative errors give; terms[line, term], times[line] in ns.

    Throws ValueError where the lines do not determine them."""
    there = np.any(terms != 0, axis=0)
    a = terms[:, there] / times[:, None]
    # Columns of one length: the rank is then about directions and not about units.
    lengths = np.linalg.norm(a, axis=0)
    solution, _, rank, _ = np.linalg.lstsq(a / lengths, np.ones(len(times)), rcond=1e-9)
    if rank < a.shape[1]:
        raise ValueError(f"{len(times)} lines determine {rank} of {a.shape[1]} costs: more scenes are needed")
    costs = np.zeros(terms.shape[1])
    costs[there] = solution / lengths
    return costs


def ratio_errors(rows, costs):
    """By line: the model's ratio to bdpt's time, of the same scene and depth, over the measured one, less 1."""
    times = {}
    for keys, terms in rows:
        times[keys["scene"], keys["depth"], keys["integrator"]] = (np.dot(terms, costs), float(keys["nanoseconds"]))
    errors = []
    for (scene, depth, integrator), (model, measured) in times.items():
        bdpt = times.get((scene, depth, "bdpt"))
        if bdpt and integrator != "bdpt":
            errors.append((model / bdpt[0]) / (measured / bdpt[1]) - 1)
    return np.array(errors)


def table(name, names, costs):
    """As it stands in work_model.h; whole nanoseconds."""
    lines = [f"    .{n} = {c:.0f}," for n, c in zip(names, costs) if round(c) != 0]
    return "\n".join([f"inline constexpr WorkCosts {name}{{", *lines, "};"])


def main(paths):
    lines = []
    for path in paths or ["/dev/stdin"]:
        with open(path, encoding="utf-8") as file:
            lines += file.readlines()
    names, rows = read(lines)
    for key, name in TABLES.items():
        if not rows[key]:
            continue
        terms = np.array([row for _, row in rows[key]])
        times = np.array([float(keys["nanoseconds"]) for keys, _ in rows[key]])
        costs = fit(terms, times)
        print(table(name, names, costs))
        errors = np.abs(ratio_errors(rows[key], np.round(costs)))
        if errors.size:
            print(
                f"{name}: {len(times)} lines; ratios to bdpt are off by {100 * errors.mean():.1f} % on average, "
                f"{100 * errors.max():.1f} % at most",
                file=sys.stderr,
            )


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (OSError, ValueError) as error:
        sys.exit(f"work_model.py: {error}")
