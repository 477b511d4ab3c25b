"""scale.py: what it measures of a program, and what it says of growth."""
import contextlib
import io
import math
import os
import sys
import tempfile
import unittest

import scale
from scale import Row


def series(time, memory):
    """A program that takes time(n) CPU seconds and memory(n) bytes."""
    return [Row("grid", n, "ffgraph", time(n), memory(n) / scale.MIB) for n in (10**3, 10**5, 10**6, 10**7)]


def page(rows):
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        scale.print_page(rows)
    return text.getvalue()


class Scale(unittest.TestCase):
    def test_n_log_n_is_no_faster_and_a_power_of_one_and_a_half_is(self):
        self.assertIn("no faster", page(series(lambda n: 2 + 1e-7 * n * math.log(n), lambda n: n)))
        self.assertIn("**faster**", page(series(lambda n: 0.1 + 1e-9 * n**1.5, lambda n: n)))
        self.assertIn("up to 1.3 times that of n log n counts as noise", page(series(lambda n: 1e-7 * n, lambda n: n)))
        self.assertIn("too short", page(series(lambda n: 0.02, lambda n: n)))

    def test_bytes_of_a_triangle_are_those_of_the_last_step_and_of_all(self):
        self.assertIn("| 300, 320: met |", page(series(lambda n: 0.1, lambda n: 2e8 + 300 * n)))
        self.assertIn("| 390, 410: **missed** |", page(series(lambda n: 0.1, lambda n: 2e8 + 390 * n)))
        self.assertIn("| 500, 500: **missed** |", page(series(lambda n: 0.1, lambda n: 500 * n)))

    def test_measures_what_a_program_holds_and_takes(self):
        held = lambda bytes_: scale.measure([sys.executable, "-S", "-c", "b = bytearray(b'1' * %d)" % bytes_])
        self.assertAlmostEqual(held(200 * scale.MIB)[1] - held(100 * scale.MIB)[1], 200, delta=5)  # twice: b'1' * n, too
        busy = scale.measure([sys.executable, "-S", "-c", "import time\nwhile time.process_time() < 0.3: pass"])
        self.assertAlmostEqual(busy[0], 0.3, delta=0.2)

    def test_rows_are_read_back_and_failures_are_handed_on(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "scale.csv")
            scale.main("run", path, "grid", "1000", "true", "true")
            self.assertEqual([r[:3] for r in scale.read(path)], [("grid", 1000, "true")])
            with self.assertRaises(SystemExit) as end:
                scale.main("run", path, "grid", "1000", "false", "sh", "-c", "exit 3")
            self.assertEqual(end.exception.code, 3)
            self.assertEqual(len(scale.read(path)), 1)


if __name__ == "__main__":
    unittest.main()
