"""peak.py FILE PROGRAM ARGUMENT...: runs the program; the most memory that it held, in MiB, goes to FILE. Exits as it
does; SIGTERM is passed on. What a Python without a library holds, about 10 MiB, is the least that it can tell."""
import resource
import signal
import subprocess
import sys


def main(path, *command):
    with subprocess.Popen(command) as child:
        signal.signal(signal.SIGTERM, lambda *_: child.terminate())
        status = child.wait()
    with open(path, "w", encoding="ascii") as file:
        print("%.1f" % (resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024), file=file)
    return status if status >= 0 else 128 - status


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit("usage: peak.py FILE PROGRAM ARGUMENT...")
    sys.exit(main(*sys.argv[1:]))
