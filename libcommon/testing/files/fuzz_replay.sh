#!/bin/sh
# fuzz_replay.sh REPLAY ARCHIVE FOLDER: runs a target of libFuzzer on the inputs of an archive. They lie in FOLDER, which is made
# anew, and stay there for who looks for the one that broke it. An archive that cannot be read or has no input is a failure.
set -eu
rm -rf "$3"
mkdir -p "$3"
tar -xf "$2" -C "$3"
exec "$1" "$3"
