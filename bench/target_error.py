"""target_error.py RUNS: the table of doc/target-error.md from RUNS, a line for each picture: scene, pixels, target, relMSE,
seed, samples fixed, relMSE as the program estimates it (-1: not), the ends of its interval, samples of the pilot, reached
(1) or not (0)."""
import sys
from collections import namedtuple

import numpy as np

MET, BETTER = 0.9, 2.5  # share of pictures at least, median of target / relMSE at most
Run = namedtuple("Run", "pixels target relmse seed fixed told low high pilot reached")


def read(lines):
    """{scene: [Run, ...]}."""
    runs = {}
    for line in lines:
        scene, *numbers = line.split()
        runs.setdefault(scene, []).append(Run(*map(float, numbers)))
    return runs


def wilson(share, n, z=1.96):
    """95 % interval of a share of n."""
    middle, width = share + z * z / 2 / n, z * np.sqrt(share * (1 - share) / n + z * z / 4 / n / n)
    return (middle - width) / (1 + z * z / n), (middle + width) / (1 + z * z / n)


class Summary:
    def __init__(self, runs):
        relmse = np.array([r.relmse for r in runs])
        self.pixels, self.target, self.pictures = int(runs[0].pixels), runs[0].target, len(runs)
        self.met = float(np.mean(relmse <= self.target))
        self.interval = wilson(self.met, len(runs))
        self.better = np.quantile(self.target / relmse, [0.1, 0.5, 0.9])
        self.samples = np.median([r.fixed for r in runs])
        self.pilot = np.median([r.pilot / r.fixed for r in runs])
        self.told = np.median([r.told / r.relmse for r in runs if r.told >= 0])
        self.inside = np.mean([r.low <= r.relmse <= r.high for r in runs if r.told >= 0])
        missed = [r for r in runs if r.relmse > self.target]
        self.known = sum(not r.reached for r in missed)
        self.missed = len(missed)
        self.false_alarms = sum(not r.reached for r in runs) - self.known

    def keeps_its_word(self):
        return self.met >= MET and self.better[1] <= BETTER


def table(runs):
    of = {scene: Summary(r) for scene, r in runs.items()}
    rows = ["| scene | pixels | E | pictures | meet it [95 %] | E / relMSE, median [10 %, 90 %] | samples | of the pilot, all parts | "
            "estimate / relMSE | missed, told as missed | told as missed, not missed | kept |",
            "|" + "---|" * 12]
    for scene, s in of.items():
        low, high = s.interval
        rows.append(f"| {scene} | {s.pixels} | {s.target:g} | {s.pictures} | {100 * s.met:.0f} % [{100 * low:.0f}, {100 * high:.0f}] | "
                    f"{s.better[1]:.2f} [{s.better[0]:.2f}, {s.better[2]:.2f}] | {s.samples:.0f} | {100 * s.pilot:.0f} % | "
                    f"{s.told:.2f} | {s.missed}, {s.known} | {s.false_alarms} | {'yes' if s.keeps_its_word() else 'no'} |")
    pictures = [r for each in runs.values() for r in each]
    share = np.mean([r.relmse <= r.target for r in pictures])
    low, high = wilson(share, len(pictures))
    better = np.median([r.target / r.relmse for r in pictures])
    rows += ["", f"All {len(pictures)} pictures: {100 * share:.1f} % [{100 * low:.1f}, {100 * high:.1f}] meet their target, and the "
             f"median picture is {better:.2f} times too good.", "",
             "Samples are of each pixel, medians; the pilot's are thrown away, and small pictures take more of them than large "
             "ones. The estimate is the program's own, after rendering, from blocks of the picture, a median; it is too high where "
             "the samples of a pixel complement each other across blocks. Pictures miss where bright paths came that the pilot "
             "did not meet."]
    return rows


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        print("\n".join(table(read(file))))
