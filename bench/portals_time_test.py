"""portals_time.py on three runs that take turns."""
import contextlib
import io
import unittest

import portals_time


def runs(split_cpu=12):
    lines = []
    for k in (3, 1, 2):  # the middle one is the second
        lines.append(f"room bdpt {10 * k} {20 * k} 0 0")
        for scene, cpu in (("room", 8), ("room/4", split_cpu)):
            lines += [f"{scene} ffgraph {k} {cpu * k} {k} 100", f"{scene} mincut 1 1 0 50",
                      f"{scene} lightgrid {k} {k} 0.5 {60 * k}", f"{scene} portalfit 1 1 0 0"]
    return lines


def tables(lines):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        portals_time.print_tables("room", portals_time.read(lines))
    return out.getvalue()


class Tables(unittest.TestCase):
    def test_medians_peaks_and_sums(self):
        text = tables(runs())
        for row in ("| room | tdpt-render bdpt, 1 spp, 1280x720 | 20.00 | 40.00 | - | - |",
                    "| room | ffgraph | 2.00 | 16.00 | 2.00 | 100 |",
                    "| room | mincut | 1.00 | 1.00 | - | 50 |",
                    "| room | all four | 6.00 | 20.00 | 2.50 | 180 |",
                    "| room, split in four | all four | 6.00 | 28.00 | 2.50 | 180 |",
                    "| four stages to bdpt, wall | 0.30 | 1 |",
                    "| four stages to bdpt, CPU | 0.50 | 1 |",
                    "| split in four to whole, CPU without loading and BVH | 1.46 | 1.5 |"):
            self.assertIn(row + "\n", text)

    def test_a_slower_split_scene_shows(self):
        self.assertIn("loading and BVH | 2.83 | 1.5 |", tables(runs(split_cpu=24)))


if __name__ == "__main__":
    unittest.main()
