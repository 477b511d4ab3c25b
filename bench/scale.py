"""How time and memory of the programs grow with the triangles of a scene; see scale.sh.

scale.py run CSV FORM TRIANGLES PROGRAM COMMAND...   runs it and adds a row: CPU seconds, the most memory it held [MiB]
scale.py page CSV                                    the tables of the page
scale.py points CSV FORM PROGRAM                     triangles, CPU seconds, MiB, a line each

What a Python without a library holds, about 10 MiB, is the least memory that it can tell."""
import csv
import math
import os
import sys
from collections import namedtuple

Row = namedtuple("Row", "form triangles program cpu peak")
PROGRAMS = ("ffgraph", "mincut", "lightgrid", "portalfit", "tdpt-render")
MOST_BYTES = 400  # of a triangle
NOISE = 1.3  # times n log n
ENOUGH = 0.2  # CPU seconds
MIB = 2**20


def measure(command):
    """(CPU seconds, peak MiB) of a command; exits as it does where it fails."""
    pid = os.posix_spawnp(command[0], command, os.environ)
    _, status, usage = os.wait4(pid, 0)
    if status:
        sys.exit(os.waitstatus_to_exitcode(status))
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def read(path):
    with open(path, encoding="ascii", newline="") as file:
        return [Row(form, int(n), program, float(cpu), float(peak)) for form, n, program, cpu, peak in csv.reader(file)]


def series(rows, form, program):
    """By triangles, the smallest scene first."""
    return sorted((r for r in rows if (r.form, r.program) == (form, program)), key=lambda r: r.triangles)


def bytes_each(before, last):
    """What each triangle costs that one scene has more than another."""
    return (last.peak - before.peak) * MIB / (last.triangles - before.triangles)


def growth(of):
    """(times the CPU time grew in the last step, times n log n grew); None where a program takes hardly any."""
    before, last = of[-2:]
    n, m = before.triangles, last.triangles
    return (last.cpu / before.cpu, m * math.log(m) / (n * math.log(n))) if last.cpu >= ENOUGH else None


def decade(row):
    return round(math.log10(row.triangles))


def print_table(rows, sizes, cell, last_head, last_cell):
    """`cell` of a row; `last_cell` of a series."""
    print("| scene | program | %s | %s |" % (" | ".join("10^%d" % s for s in sizes), last_head))
    print("|---" * (len(sizes) + 3) + "|")
    for form in dict.fromkeys(r.form for r in rows):
        for program in PROGRAMS:
            of = series(rows, form, program)
            if of:
                cells = {decade(r): cell(r) for r in of}
                shown = [cells.get(s, "-") for s in sizes]
                print("| %s | %s | %s | %s |" % (form, program, " | ".join(shown), last_cell(of)))
    print()


def print_page(rows):
    sizes = sorted({decade(r) for r in rows})

    def verdict(of):
        grown = growth(of)
        if not grown:
            return "too short to tell"
        return "%.1f, of n log n %.1f: %s" % (*grown, "no faster" if grown[0] <= NOISE * grown[1] else "**faster**")

    def each(of):
        step, whole = bytes_each(*of[-2:]), of[-1].peak * MIB / of[-1].triangles
        return "%.0f, %.0f: %s" % (step, whole, "met" if max(step, whole) < MOST_BYTES else "**missed**")

    print("CPU seconds; a growth of up to %.1f times that of n log n counts as noise:\n" % NOISE)
    print_table(rows, sizes, lambda r: "%.2f" % r.cpu, "growth in the last step", verdict)
    print("Peak memory [MiB]:\n")
    print_table(rows, sizes, lambda r: "%.0f" % r.peak,
                "bytes a triangle: of the last step, of the largest scene with all else; below %d" % MOST_BYTES, each)


def main(verb, path, *rest):
    if verb == "run":
        form, triangles, program, *command = rest
        cpu, peak = measure(command)
        with open(path, "a", encoding="ascii") as file:
            print("%s,%s,%s,%.3f,%.1f" % (form, triangles, program, cpu, peak), file=file)
    elif verb == "page":
        print_page(read(path))
    else:
        for r in series(read(path), *rest):
            print(r.triangles, r.cpu, r.peak)


if __name__ == "__main__":
    if len(sys.argv) < 3 or sys.argv[1] not in ("run", "page", "points"):
        sys.exit("usage: scale.py run|page|points CSV ...")
    main(*sys.argv[1:])
