#!/usr/bin/python3
"""python3 bench/stale.py: lists the pages of doc/ whose numbers were measured by sources that have changed since.
python3 bench/stale.py --at COMMIT FOLDER...: the hash of the sources of a commit.

A page holds a line for each benchmark that writes numbers into it:
*Measured by `make bench-NAME SETTINGS` with PROGRAM; sources `FOLDER...`: HASH.*
The hash is of all C++ and GLSL below those folders but tests, without comments and white space, so rewording a comment
or formatting anew makes no page stale. Reads files alone and works without git, but for --at."""
import functools
import hashlib
import io
import re
import subprocess
import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE, TEST = re.compile(r"\.(cpp|h|comp|glsl)$"), re.compile(r"_(test|bench|fuzz)\.|(^|/)(testing|bench)/")
# Strings and characters stay, which may look like comments.
DROPPED = re.compile(r"""(R"(?P<mark>\w*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])')"""
                     r"|//[^\n]*|/\*.*?\*/|\s+", re.S)
MEASURED = re.compile(r"^\*Measured by `(?P<command>[^`]+)`.*; sources `(?P<folders>[^`]+)`: (?P<sum>[0-9a-f]{12})"
                      r"\.\*$", re.M)


def hash_of(files):
    """files: {path: bytes}. Twelve digits."""
    total = hashlib.sha256()
    for path in sorted(p for p in files if SOURCE.search(p) and not TEST.search(p)):
        text = DROPPED.sub(lambda m: m[1] or "", files[path].decode("utf-8", "replace"))
        total.update(f"{path}\0{text}\0".encode())
    return total.hexdigest()[:12]


def sources(folders, root=ROOT):
    """The hash of those folders, as they lie there."""
    return hash_of({str(p.relative_to(root)): p.read_bytes()
                    for folder in folders for p in (root / folder).rglob("*") if SOURCE.search(p.name)})


def sources_at(commit, folders):
    """The same of a commit."""
    packed = subprocess.run(["git", "-C", ROOT, "archive", commit], check=True, capture_output=True).stdout
    with tarfile.open(fileobj=io.BytesIO(packed)) as files:
        return hash_of({m.name: files.extractfile(m).read() for m in files
                        if m.isfile() and m.name.startswith(tuple(f"{folder}/" for folder in folders))})


def stale(doc=ROOT / "doc", root=ROOT):
    """[(page, command)] of what is behind."""
    lines = [(page.name, m) for page in sorted(doc.glob("*.md")) for m in MEASURED.finditer(page.read_text("utf-8"))]
    now = functools.cache(lambda folders: sources(folders.split(), root))
    return [(page, m["command"]) for page, m in lines if now(m["folders"]) != m["sum"]]


def main(*words):
    if words[:1] == ("--at",) and len(words) > 2:
        print(sources_at(words[1], words[2:]))
    elif words:
        print(__doc__, file=sys.stderr)
        return 2
    elif not (found := stale()):
        print("All measured pages are of these sources.")
    for page, command in [] if words else found:
        print(f"doc/{page} is behind: {command}")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
