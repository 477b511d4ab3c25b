"""liars_test.py BIN TESTDATA: no file makes a program take far more memory or time than its size is worth, where
--max-memory is small; it is read, or refused with one line and exit code 3."""
import os
import resource
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import liars  # noqa: E402

BIN, TESTDATA = (os.path.abspath(path) for path in (sys.argv.pop(1), sys.argv.pop(1)))
LIMIT = 64  # --max-memory [MiB]
MOST_MEMORY, MEMORY_EACH = 3 * LIMIT, 20  # beyond what the program holds before it reads [MiB], and for each byte of the file
MOST_SECONDS, SECONDS_EACH = 1.5, 4e-6  # of the processor, and for each byte, of which deflate makes a thousand
ROOM = os.path.join(TESTDATA, "scenes", "furnace.glb")
FEW = ["--spp", "1", "--width", "8", "--height", "8", "--integrator", "nee"]

# What reads a file of a kind beside tdpt-info, and where it stands on the command line.
READERS = {".exr": [["exrdiff", "{}", "{}"], ["exrmerge", "{}", "-o", "o"], ["exrdenoise", "{}", "-o", "o"],
                    ["tdpt-render", ROOM, *FEW, "--environment", "{}", "-o", "o.exr"],
                    ["tdpt-render", ROOM, *FEW, "--resume", "{}", "-o", "o.exr"]],
           ".hdr": [["tdpt-render", ROOM, *FEW, "--environment", "{}", "-o", "o.exr"]],
           ".glb": [["ffgraph", "{}", "--set", "walks=100", "--samples", "1000", "-o", "o.max"]],
           ".portal.glb": [["tdpt-render", ROOM, *FEW, "--portal", "{}", "-o", "o.exr"]],
           ".max": [["mincut", "{}", "-o", "o.cut"], ["lightgrid", ROOM, "{}", "-o", "o.vdb"]],
           ".vdb": [["portalfit", "{}", "-o", "o.glb"]],
           ".csv": [["portalfit", "{}", "-o", "o.glb"]]}


def measured(command, folder):
    """(exit code, most memory [MiB], seconds of the processor, lines on standard error) of a run; what it takes is bounded
    for the sake of the machine."""
    errors = os.path.join(folder, "errors")
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
        resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
        os.chdir(folder)
        os.dup2(os.open(os.devnull, os.O_RDWR), 1)
        os.dup2(os.open(errors, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), 2)
        os.execv(command[0], command)
    _, status, used = os.wait4(child, 0)
    with open(errors, encoding="utf-8", errors="replace") as file:
        lines = file.read().splitlines()
    return os.waitstatus_to_exitcode(status), used.ru_maxrss / 1024, used.ru_utime + used.ru_stime, lines


def takes_too_much(before, memory, seconds, size):
    """Words; none where all is well. before: what the program holds before it reads [MiB]."""
    most = before + MOST_MEMORY + MEMORY_EACH * size / (1 << 20)
    longest = MOST_SECONDS + SECONDS_EACH * size
    return " ".join(["%.0f MiB, expected %.0f" % (memory, most)] * (memory > most)
                    + ["%.2f s, expected %.2f" % (seconds, longest)] * (seconds > longest))


def suffix_of(name):
    return ".portal.glb" if name.endswith(".portal.glb") else os.path.splitext(name)[1]


class Liars(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.before = {}

    def judged(self, command, size):
        """What is wrong with a run."""
        program = os.path.join(BIN, command[0])
        if program not in self.before:
            self.before[program] = measured([program, "--version"], self.folder.name)[1]
        quiet = [] if command[0] in ("exrdiff", "tdpt-info") else ["--quiet"]  # they have no notes
        code, memory, seconds, lines = measured([program, *command[1:], "--max-memory", "%dM" % LIMIT, *quiet],
                                                self.folder.name)
        wrong = takes_too_much(self.before[program], memory, seconds, size)
        errors = [line for line in lines if " warning: " not in line]
        if code not in (0, 3) or len(errors) != (1 if code else 0):
            wrong += " exit code %d, %s" % (code, lines)
        if os.environ.get("SHOW"):
            print("%4d MiB %5.2f s  %d  %s  %s" % (memory - self.before[program], seconds, code, " ".join(command), lines[-1:]))
        return wrong

    def test_take_no_more_than_they_are_worth(self):
        faults = []
        for name, data in liars.all_of(TESTDATA):
            with open(os.path.join(self.folder.name, name), "wb") as file:
                file.write(data)
            for reader in [["tdpt-info", "{}"]] + READERS[suffix_of(name)]:
                command = [word.replace("{}", name) for word in reader]
                wrong = self.judged(command, len(data))
                if wrong:
                    faults.append("%s: %s" % (" ".join(command), wrong))
            os.remove(os.path.join(self.folder.name, name))
        self.assertEqual(faults, [])

    def test_twin_a_program_that_takes_too_much_is_caught(self):
        def run(text):
            _, memory, seconds, _ = measured([sys.executable, "-S", "-c", text], self.folder.name)
            return takes_too_much(before, memory, seconds, 1000)

        before = measured([sys.executable, "-S", "-c", ""], self.folder.name)[1]
        self.assertEqual(run("b = bytearray(%d << 20)" % (MOST_MEMORY // 2)), "")
        self.assertIn("MiB, expected", run("b = bytearray(%d << 20)" % (2 * MOST_MEMORY)))
        self.assertIn("s, expected", run("import time\nwhile time.process_time() < 2.5: pass"))


if __name__ == "__main__":
    unittest.main()
