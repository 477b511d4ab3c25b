#!/bin/sh
# fuzz_replay.sh REPLAY ARCHIVE FOLDER: runs a libFuzzer target on the inputs of an archive. They are unpacked into
# FOLDER, which is recreated, and stay there for inspection. An archive that cannot be read or has no input is a
# failure.
set -eu
rm -rf "$3"
mkdir -p "$3"
tar -xf "$2" -C "$3"
exec "$1" "$3"
