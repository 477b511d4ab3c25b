"""limit.py: factors, shares, and what it refuses."""
import unittest

import limit

HEAD = "scene\tintegrator\tthreads\tseed\tsamples\tclosest\tshadow\trays\tother\tframe_cpu\traw_cpu\tframe_wall\traw_wall"


def line(threads=1, seed=1, other=0, rays=1200, frame=3.0, raw=1.5, wall=3.0, integrator="bdpt"):
    return "\t".join(str(x) for x in ("scenes/a.glb", integrator, threads, seed, 100, 700, 500, rays, other, frame, raw, wall,
                                      raw))


PROFILE = ["profile a bdpt perf", "50|libembree3.so.3|[.] 0x00000000021f4686",
           "  30|tdpt-render|[.] tdpt::Path::weight_by_products", "15|tdpt-render|[.] tdpt::Few::choose",
           "5|[kernel.kallsyms]|[k] exc_page_fault"]


class Limit(unittest.TestCase):
    def test_the_factor_is_the_median_over_seeds(self):
        frames = limit.read([HEAD, line(seed=1, frame=3.0), line(seed=2, frame=6.0), line(seed=3, frame=4.5)])[1]
        row = limit.factor_rows(frames)[0]
        self.assertEqual(row, ("a", "`bdpt`", "12.0", "42 %", "45000000", "1250000", "3.00 (2.00 to 4.00)", "1.6: **missed**"))

    def test_the_median_is_held_against_what_is_wanted(self):
        def verdicts(integrator, *factors):
            return [row[-1] for row in limit.factor_rows(limit.read(
                [line(seed=i, frame=f, raw=1.0, integrator=integrator) for i, f in enumerate(factors)])[1])]

        self.assertEqual(verdicts("bdpt", 1.5, 1.6, 9.0), ["1.6: met"])
        self.assertEqual(verdicts("bdpt", 1.0, 1.61, 1.7), ["1.6: **missed**"])
        self.assertEqual(verdicts("tdpt-guided", 2.1), ["2.2: met"])
        self.assertEqual(verdicts("nee", 9.0), ["-"])

    def test_threads_are_compared_seed_by_seed(self):
        frames = limit.read([line(), line(threads=2, frame=3.2, raw=1.5, wall=1.6), line(seed=2, frame=8.0),
                             line(threads=2, seed=2, frame=8.0, wall=4.0)])[1]
        row = limit.thread_rows(frames)[0]
        self.assertEqual(row[3:], ("1.94 (1.88 to 2.00)", "2.00 (2.00 to 2.00)", "1.31 (0.75 to 1.88)"))

    def test_shares_of_a_profile(self):
        profiles = limit.read(PROFILE)[2]
        shares = limit.shares(profiles["a", "bdpt"])
        self.assertAlmostEqual(sum(shares.values()), 100)
        self.assertAlmostEqual(shares["Embree"], 50)
        self.assertAlmostEqual(shares["weights, densities of paths"], 30)
        self.assertAlmostEqual(shares["joins and their choice"], 15)
        self.assertAlmostEqual(shares["memory, files, system"], 5)

    def test_every_function_has_a_part(self):
        self.assertEqual(limit.part_of("tdpt-render", "main"), "other")

    def test_twin_rays_that_end_otherwise_are_refused(self):
        with self.assertRaisesRegex(ValueError, "3 rays ended otherwise"):
            limit.read([line(other=3)])

    def test_twin_rays_that_are_missing_are_refused(self):
        with self.assertRaisesRegex(ValueError, "missing from the record"):
            limit.read([line(rays=1199)])

    def test_a_page_says_how_it_was_profiled_and_whether_the_machine_was_idle(self):
        busy = limit.page(*limit.read(["load 3.1 2", HEAD, line(), line(threads=2), *PROFILE]))
        self.assertIn("up to 3 processes", busy)
        self.assertIn("perf", busy)
        self.assertIn("as wanted: 0 of the 1 that have an aim.", busy)
        self.assertIn("as wanted: 1 of the 1 that", limit.page(*limit.read([line(frame=1.5, raw=1.0), *PROFILE])))
        self.assertNotIn("not idle", limit.page(*limit.read(["load 0.5 2", line(), line(threads=2), *PROFILE])))


if __name__ == "__main__":
    unittest.main()
