"""work_model.py on made-up measurements."""
import contextlib
import io
import os
import re
import tempfile
import unittest

import numpy as np

import work_model

HEADER = os.path.join(os.path.dirname(__file__), "..", "tools", "tdpt-render", "work_model.h")
NAMES = "sample closest closest_deeper shadow join portal portal_triangle directed facets facet looking_out window".split()


def source_table(name):
    """The text of a table in work_model.h and its numbers in the order of NAMES."""
    with open(HEADER, encoding="utf-8") as file:
        text = re.search(r"inline constexpr WorkCosts %s\{.*?\};" % name, file.read(), re.S).group(0)
    numbers = dict(re.findall(r"\.(\w+) = ([0-9.]+),", text))
    return text, np.array([float(numbers.get(n, 0)) for n in NAMES])


def measured(costs, portals, noise, rng):
    """Lines of work_model_bench: five scenes, three depths, six integrators."""
    lines = ["\t".join([*work_model.KEYS, *NAMES])]
    for scene in range(5):
        deeper = rng.uniform(0, 12)
        triangles, facets = (2 * (scene + 1), 1 + scene % 3) if portals else (0, 0)
        for depth in (3, 6, 12):
            for integrator in ("bdpt", "nee", "tdpt-org", "a", "b", "c"):
                closest, shadow, joins, edges = depth * rng.uniform(0.5, 2, 4)
                edges *= portals
                directed = edges * (integrator in "abc")
                many = directed * (facets > 1)
                out = closest * rng.integers(0, 2)  # under a sky
                terms = np.array([1, closest, closest * deeper, shadow, joins, edges, edges * triangles, directed,
                                  many, many * facets, out, out * rng.integers(1, 5)])
                time = terms @ costs * rng.uniform(1 - noise, 1 + noise)
                fields = [f"room{scene}", depth, integrator, int(portals), f"{time:.9g}", *(f"{t:.9g}" for t in terms)]
                lines.append("\t".join(map(str, fields)))
    return lines


def fitted(lines, portals, hide=None):
    """Costs of the fit and largest error of its ratios; `hide`: a term the fit is not told of."""
    names, rows = work_model.read(lines)
    of = rows[int(portals)]
    if hide is not None:
        of = [(keys, [0 if n == hide else t for n, t in zip(names, terms)]) for keys, terms in of]
    costs = work_model.fit(np.array([t for _, t in of]), np.array([float(k["nanoseconds"]) for k, _ in of]))
    return costs, np.max(np.abs(work_model.ratio_errors({0: of}, {0: costs})))


class Fit(unittest.TestCase):
    def test_finds_the_costs_again(self):
        for portals, name in work_model.TABLES.items():
            _, costs = source_table(name)
            found, worst = fitted(measured(costs, bool(portals), 0, np.random.default_rng(1)), bool(portals))
            np.testing.assert_allclose(found, costs, rtol=1e-6, atol=1e-4)
            self.assertLess(worst, 1e-6)

    def test_noise_averages_out_and_a_missing_term_does_not(self):
        _, costs = source_table("kWorkWithPortals")
        lines = measured(costs, True, 0.02, np.random.default_rng(2))
        _, worst = fitted(lines, True)
        self.assertLess(worst, 0.06)
        _, worst = fitted(lines, True, hide="shadow")
        self.assertGreater(worst, 0.06)

    def test_leaves_what_is_held_and_fits_the_others_beside_it(self):
        lines = measured(np.arange(1.0, len(NAMES) + 1), True, 0, np.random.default_rng(5))
        _, rows = work_model.read(lines)
        terms = np.array([t for _, t in rows[1]])
        times = np.array([float(k["nanoseconds"]) for k, _ in rows[1]])
        costs = work_model.fit(terms, times, work_model.held_costs(["facet=10", "join=5"], NAMES))
        np.testing.assert_allclose(costs, np.arange(1.0, len(NAMES) + 1), rtol=1e-6)
        wrong = work_model.fit(terms, times, work_model.held_costs(["join=9"], NAMES))
        self.assertEqual(wrong[NAMES.index("join")], 9)
        self.assertGreater(np.max(np.abs(wrong - costs)[np.array(NAMES) != "join"]), 0.01)
        with self.assertRaisesRegex(ValueError, "no such term"):
            work_model.held_costs(["roof=1"], NAMES)

    def test_bdpt_may_be_of_the_other_table(self):
        line = lambda name, ns: ({"scene": "a", "depth": "6", "integrator": name, "nanoseconds": ns}, [1.0])
        rows = {0: [line("bdpt", "100")], 1: [line("tdpt-org", "300")]}
        np.testing.assert_allclose(work_model.ratio_errors(rows, {0: [100], 1: [450]}), [0.5])

    def test_weighs_short_and_long_samples_alike(self):
        # Of one cost and two lines that contradict each other: relative errors of 1 / 3 each way,
        # where the plain squares would all but follow the long one.
        terms, times = np.array([[1.0], [1000.0]]), np.array([1.0, 2000.0])
        np.testing.assert_allclose(work_model.fit(terms, times), [1.2])

    def test_asks_for_more_scenes_where_costs_are_not_determined(self):
        lines = measured(np.ones(len(NAMES)), True, 0, np.random.default_rng(3))
        one_scene = [lines[0], *(line for line in lines if line.startswith("room0\t"))]
        with self.assertRaisesRegex(ValueError, "more scenes"):
            fitted(one_scene, True)


class Text(unittest.TestCase):
    def test_is_the_one_in_the_source(self):
        for name in (*work_model.TABLES.values(), *work_model.DEVICE_TABLES.values()):
            text, costs = source_table(name)
            self.assertEqual(work_model.table(name, NAMES, costs + 0.3), text)
            self.assertNotEqual(work_model.table(name, NAMES, costs + 1), text)

    def test_of_both_tables_is_printed_by_the_program(self):
        self.is_printed(work_model.TABLES, [])

    def test_of_those_of_a_device_is_printed_where_asked_for(self):
        self.is_printed(work_model.DEVICE_TABLES, ["--device"])

    def is_printed(self, tables, options):
        rng, lines, wanted = np.random.default_rng(4), [], []
        for portals, name in tables.items():
            text, costs = source_table(name)
            wanted.append(text)
            lines += measured(costs, bool(portals), 0, rng)
        with tempfile.NamedTemporaryFile("w", suffix=".tsv") as file:
            file.write("\n".join(lines) + "\n")
            file.flush()
            out, err = io.StringIO(), io.StringIO()
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                work_model.main([*options, file.name])
        self.assertEqual(out.getvalue(), "\n".join(wanted) + "\n")
        self.assertIn("0.0 % at most", err.getvalue())


class Read(unittest.TestCase):
    def test_names_the_line_that_is_wrong(self):
        header = "\t".join([*work_model.KEYS, "sample"])
        for lines, says in (
            (["room\t6\tbdpt\t1\t100\t1"], "line 1: expected the header"),
            ([header, "room\t6\tbdpt\t1\t100"], "line 2: has 5 fields, expected 6"),
            ([header, "room\t6\tbdpt\t1\t0\t1"], "line 2: nanoseconds"),
            ([header, header + "\tmore"], "line 2: the terms differ"),
        ):
            with self.assertRaisesRegex(ValueError, says):
                work_model.read(lines)


if __name__ == "__main__":
    unittest.main()
