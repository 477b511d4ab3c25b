"""What becomes of glTF files as they come: doc/scenes.md, "Public files"."""
import functools
import hashlib
import os
import resource
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

import pages
from common import Setting, Stop, settings
from formats import exr_read

SECONDS, BYTES = 30, 4 << 30  # that a program may take of time and of address space
POINTER = b"version https://git-lfs"
SKY = ["--frame", "--environment", "1,1,1", "--threads", "1", "--quiet"]
PROGRAMS = {"tdpt-render": [*SKY, "--width", "64", "--height", "48", "--spp", "4", "-o"],
            "ffgraph": [*SKY, "--samples", "20000", "--set", "walks=5000", "--set", "rounds=0", "-o"],
            "tdpt-info": []}
WRONG = ("crash", "hang", "not finite")  # and must not be


def scenes(folder):
    """The files to try: one of those of the same bytes, and no pointer of Git LFS."""
    found = {}
    for path in sorted(p for p in Path(folder).rglob("*") if p.suffix.lower() in (".glb", ".gltf") and p.is_file()):
        data = path.read_bytes()
        if not data.startswith(POINTER):
            found.setdefault(hashlib.sha256(data).digest(), str(path))
    return list(found.values())


def attempt(folder, program, path):
    """(what became of it, the last line of what it said)."""
    options = PROGRAMS[program]
    with tempfile.TemporaryDirectory() as scratch:
        out = os.path.join(scratch, "out")
        command = [os.path.join(folder, program), path, *options, *([out] if options else [])]
        try:
            run = subprocess.run(command, capture_output=True, timeout=SECONDS, check=False, preexec_fn=lambda:
                                 resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES)))
        except subprocess.TimeoutExpired:
            return "hang", ""
        words = run.stderr.decode("utf-8", "replace")
        told = (words.strip().split("\n") or [""])[-1]
        if run.returncode:
            return "refused" if run.returncode == 3 else "crash", told
        if program == "tdpt-render" and not np.isfinite(exr_read(out)).all():
            return "not finite", told
        return "read with warnings" if "warning: " in words else "read", told


@settings(FOLDER=Setting("", "that of the files"))
def public_files(bench):
    """Tries tdpt-render, ffgraph and tdpt-info on every glTF file below FOLDER, as it comes, and tells what became of
    them. Files with the same bytes are tried once, pointers of Git LFS not at all."""
    if not os.path.isdir(bench.settings.folder):
        raise Stop(2, "FOLDER=FOLDER: expected the folder of the files")
    jobs = [(program, path) for path in scenes(bench.settings.folder) for program in PROGRAMS]
    results = bench.side_by_side([functools.partial(attempt, bench.programs, *job) for job in jobs])
    for (_, path), (of, told) in zip(jobs, results):
        if of not in ("read", "read with warnings"):
            print(f"{of}: {path}: {told}")
    counts = Counter((program, of) for (program, _), (of, _) in zip(jobs, results))
    kinds = ["read", "read with warnings", "refused", *WRONG]
    print("\n" + pages.table(("program", *kinds), [[p, *(counts[p, k] for k in kinds)] for p in PROGRAMS]))
    if any(of in WRONG for of, _ in results):
        raise Stop(1, "something went wrong")
