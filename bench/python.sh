#!/bin/sh
# python.sh SCRIPT ARGUMENT...: runs it with a Python that has numpy, the distribution's before another that comes
# first on PATH. Exit 77, with a word, where there is none.
for python in /usr/bin/python3 python3; do
  if "$python" -c 'import numpy' 2>/dev/null; then exec "$python" -B "$@"; fi
done
echo "no python3 here has numpy (Debian: python3-numpy)" >&2
exit 77
