"""Runs of programs, kept by content: the key of a run is what the program is, its arguments and what is in the files
that it reads. A run that is there is not made again, whatever it was made for; one that was cut short leaves nothing.

A folder of the store: FOLDER/<key>/ with `out` (what the program wrote), `said` (its --json), `run.json`: how it went."""
import hashlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
from pathlib import Path


class Failed(Exception):
    """A program that should not have. `status`: its exit code."""

    def __init__(self, words, status):
        super().__init__(words)
        self.status = status


class Run:
    """What is kept of one: `out`, a path; `cpu`, seconds of the process; `said`, a dictionary; `status`."""

    def __init__(self, folder):
        self.out = folder / "out"
        self.said = json.loads((folder / "said").read_text() or "{}")
        facts = json.loads((folder / "run.json").read_text())
        self.cpu, self.status, self.peak = facts["cpu"], facts["status"], facts["peak_mib"]


class Store:
    def __init__(self, folder, programs):
        """programs: the folder that holds them."""
        self.folder, self.programs = Path(folder), Path(programs)
        self.folder.mkdir(parents=True, exist_ok=True)
        self._sums, self._lock = {}, threading.Lock()
        self.made = self.found = 0

    def sum_of(self, path):
        """Of what is in a file. Files of the store never change, so each is read once."""
        with self._lock:
            known = self._sums.get(path)
        if known is None:
            with open(path, "rb") as file:
                known = hashlib.file_digest(file, "sha256").hexdigest() if hasattr(hashlib, "file_digest") \
                    else hashlib.sha256(file.read()).hexdigest()
            with self._lock:
                self._sums[path] = known
        return known

    def key(self, program, arguments):
        """arguments: text, or paths of files that are read."""
        words = [self.sum_of(self.programs / program)]
        words += ["file " + self.sum_of(a) if isinstance(a, Path) else "word " + a for a in arguments]
        return hashlib.sha256("\0".join(words).encode()).hexdigest()[:32]

    def run(self, program, *arguments, may_fail=()):
        """Runs PROGRAM ARGUMENT... --quiet --json -o OUT on one thread, or finds what it made. Exit codes of may_fail are
        kept as results."""
        folder = self.folder / self.key(program, arguments)
        if not (folder / "run.json").exists():
            self._make(folder, program, arguments, may_fail)
            self.made += 1
        else:
            self.found += 1
        return Run(folder)

    def keep(self, words, make, suffix=".kept"):
        """A file that no program makes: make(path) writes it. words: all that it depends on."""
        path = self.folder / (hashlib.sha256("\0".join(words).encode()).hexdigest()[:32] + suffix)
        if not path.exists():
            half = path.with_suffix(".half%d" % threading.get_ident())
            make(half)
            half.rename(path)
        return path

    def _make(self, folder, program, arguments, may_fail):
        half = Path(tempfile.mkdtemp(dir=self.folder, prefix="half-"))
        try:
            command = [str(self.programs / program), *map(str, arguments), "--threads", "1", "--quiet", "--json", "--no-provenance",
                       "-o", str(half / "out")]
            with open(half / "said", "wb") as said, open(half / "errors", "wb") as errors:
                with subprocess.Popen(command, stdout=said, stderr=errors) as child:
                    _, status, usage = os.wait4(child.pid, 0)
                    child.returncode = code = os.waitstatus_to_exitcode(status)
            if code in (-signal.SIGINT, -signal.SIGTERM, 6):
                raise KeyboardInterrupt
            if code != 0 and code not in may_fail:
                raise Failed(f"{' '.join(command)}: exit code {code}: {(half / 'errors').read_text().strip()}", code)
            if code != 0:
                (half / "said").write_text("{}")
            (half / "run.json").write_text(json.dumps({"cpu": usage.ru_utime + usage.ru_stime, "status": code,
                                                       "peak_mib": usage.ru_maxrss / 1024}))
            try:
                half.rename(folder)
            except OSError:  # another thread was faster
                shutil.rmtree(half)
        except BaseException:
            shutil.rmtree(half, ignore_errors=True)
            raise
