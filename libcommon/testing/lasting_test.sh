#!/bin/sh
# lasting_test.sh WHAT BIN TESTDATA SPY: long renderings survive interruptions. WHAT:
#   kills   a checkpoint is written, flushed and renamed, and its folder flushed, in this order; killed at random moments, it is
#           always whole, and a resumed rendering ends with the bytes of an uninterrupted one; a full disk damages no checkpoint
#           and ends no rendering. Twin: if checkpoints are copied into place instead, kills are found to damage them
#   parts   shards, merged in any order or as a tree, stopped, resumed and with any number of threads, give the bytes of the
#           undivided picture; so do samples added later, and films that go on with other channels, limits and lights
set -u
what=$1 bin=$2 testdata=$3 spy=$4
PATH=$bin:$PATH
work=$(mktemp -d) || exit 99
trap 'umount "$work/small" 2>/dev/null; rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$work" || exit 99
scene=$testdata/scenes/two-rooms.glb
fail() { echo "$*"; exit 1; }
same() { cmp "$1" "$2" || fail "$3"; }
# Runs in the background with run=exec, so that a signal reaches the program.
run=
render() { $run tdpt-render "$scene" --quiet --width 48 --height 36 --spp "$spp" "$@"; }
few() { $run tdpt-render "$scene" --quiet --width 40 --height 30 --integrator bdpt "$@"; }
# A room with a portal, in parts: films s.I-of-N.exr with T threads; every third is stopped and resumed.
room() { $run tdpt-render "$scene" --quiet --portal portal.glb --width 40 --height 30 --layers --alpha --aov variance,halves "$@"; }

order() {
  spp=64
  SPY_ON_WRITES=$work/log LD_PRELOAD=$spy render --checkpoint c.exr --set checkpoint-every=0 -o p.exr || fail "no picture"
  # The operations on the first checkpoint, repeated ones once.
  got=$(uniq log | sed -n '1,/fsync folder/p' | tr '\n' ';')
  [ "$got" = "write file;fsync file;rename c.exr;fsync folder;" ] || fail "the order is: $got"
  # At the end: the checkpoint with all samples, then the picture.
  got=$(uniq log | tail -n 8 | tr '\n' ';')
  one="write file;fsync file;rename"
  [ "$got" = "$one c.exr;fsync folder;$one p.exr;fsync folder;" ] || fail "the end is: $got"
}

# kills MOST ENOUGH: kills MOST renderings, or until ENOUGH of them, $spoilt, have left a damaged checkpoint. They run for
# up to $ms, about the time to the next checkpoint: half of them reach it.
kills() {
  spp=65536 killed=0 spoilt=0 seed=$$ changed=0 ms=100 before=none
  while [ $killed -lt "$1" ] && [ $spoilt -lt "$2" ]; do
    run="exec" render --integrator bdpt --checkpoint c.exr --resume c.exr --set checkpoint-every=0 -o p.exr &
    pid=$!
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    now=$((seed / 65536 % ms))
    sleep "$((now / 1000)).$(printf %03d $((now % 1000)))"
    kill -KILL $pid 2>/dev/null || fail "the rendering was done after $killed kills"
    wait $pid 2>/dev/null
    killed=$((killed + 1))
    now=none
    [ ! -e c.exr ] || now=$(cksum <c.exr)
    if [ "$now" = "$before" ]; then
      ms=$((ms + ms / 4))
      continue
    fi
    changed=$((changed + 1)) before=$now ms=$((ms - ms / 10))
    exrmerge --quiet --gaps c.exr -o /dev/null 2>/dev/null && continue
    spoilt=$((spoilt + 1)) before=none
    rm -f c.exr
  done
}

# Goes on to the end after KILL and TERM, with other numbers of threads and the integrator chosen.
ends() {
  spp=256
  rm c.exr
  render -o undisturbed.exr || fail "no picture"
  for how in KILL TERM; do
    run="exec" render --checkpoint c.exr --resume c.exr --threads 1 --set checkpoint-every=0 -o p.exr &
    pid=$!
    while [ ! -e c.exr ]; do sleep 0.02; done
    sleep 0.2
    kill -$how $pid
    wait $pid 2>/dev/null
  done
  render --checkpoint c.exr --resume c.exr -o p.exr || fail "it does not go on"
  same p.exr undisturbed.exr "what went on has other bytes"
}

full_disk() {
  mkdir small
  mount -t tmpfs -o size=96k tmpfs small 2>/dev/null || { echo "skipped: no file system can be mounted"; return; }
  spp=16
  render --checkpoint small/c.exr --set checkpoint-every=0 -o p.exr || fail "there is no room for one checkpoint"
  cp small/c.exr before.exr
  head -c 96k /dev/zero >small/filling 2>/dev/null
  tdpt-render "$scene" --quiet --resume small/c.exr --width 48 --height 36 --add-samples 4096 --set checkpoint-every=0 -o q.exr 2>messages &
  pid=$!
  sleep 1
  kill -TERM $pid
  wait $pid
  grep -q 'checkpoint before it is kept' messages || { cat messages; fail "no word of the full disk"; }
  same small/c.exr before.exr "the checkpoint before it is lost"
}

shards() { # N THREADS
  i=0
  while [ $i -lt "$1" ]; do
    part=s.$i-of-$1.exr
    if [ $((i % 3)) -eq 0 ]; then
      run="exec" room --spp 32 --shard "$i/$1" --threads "$2" --checkpoint k.exr --set checkpoint-every=0 -o "$part" &
      pid=$!
      sleep 0.15
      kill -KILL $pid 2>/dev/null
      wait $pid 2>/dev/null
      room --spp 32 --shard "$i/$1" --threads "$2" --checkpoint k.exr --resume k.exr -o "$part" || fail "$part"
      rm k.exr
    else
      room --spp 32 --shard "$i/$1" --threads "$2" -o "$part" || fail "$part"
    fi
    i=$((i + 1))
  done
}

divided() {
  ffgraph --quiet --set walks=2000 --samples 10000 --set rounds=0 "$scene" | mincut --quiet |
    lightgrid --quiet --resolution 16 --set lines=500 "$scene" - |
    portalfit --quiet --require-portal -o portal.glb || fail "no portal"
  room --spp 32 -o whole.exr && room --spp 32 --threads 1 -o w1.exr || fail "no picture"
  same whole.exr w1.exr "the picture depends on threads"
  for how in '4 2' '8 1'; do
    n=${how% *} t=${how#* }
    shards "$n" "$t"
    set --
    for film in s.*-of-"$n".exr; do set -- "$film" "$@"; done # backwards
    exrmerge --quiet "$@" -o m.exr || fail "$n shards do not merge"
    same m.exr whole.exr "$n shards of $t threads have other bytes"
  done
  # As a tree, from films of different splits, out of order.
  exrmerge --quiet --film s.3-of-4.exr s.0-of-8.exr s.1-of-4.exr -o a.exr && exrmerge --quiet --film s.1-of-8.exr s.2-of-4.exr -o b.exr &&
    exrmerge --quiet b.exr a.exr -o m.exr || fail "the tree does not merge"
  same m.exr whole.exr "a tree has other bytes"
  # Samples added to the merged film, and once only to a checkpoint, even if it is killed on the way.
  exrmerge --quiet --film b.exr a.exr -o all.exr && room --resume all.exr --add-samples 32 --no-provenance -o long.exr || fail "no samples are added"
  exrdiff --json long.exr whole.exr | grep -q '"mse":0.0,' && fail "nothing is added"
  room --spp 32 -o began.exr --checkpoint grown.exr || fail "no picture"
  same began.exr whole.exr "a checkpoint changes the picture"
  run="exec" room --resume grown.exr --add-samples 32 --set checkpoint-every=0 --threads 1 -o more.exr &
  pid=$!
  while [ "$(exrmerge --quiet --gaps --json grown.exr -o now.exr 2>/dev/null | sed 's/.*"spp":\([0-9]*\).*/\1/')" = 32 ]; do sleep 0.02; done
  kill -KILL $pid
  wait $pid 2>/dev/null
  room --resume grown.exr --add-samples 32 -o more.exr || fail "no samples are added after a kill"
  room --spp 32 --resume grown.exr --no-provenance -o more.exr || fail "what has grown is refused"
  exrdiff --json more.exr long.exr | grep -q '"mse":0.0,' || fail "samples that were added twice, or not"
}

# Lamps under a sky, whose shares are measured; halves; a target error, whose estimate needs blocks of samples; limits of
# depth, of time; the beginning of a picture; an empty film, and names that are not UTF-8.
goes_on() {
  lit() { tdpt-render "$testdata/scenes/window.glb" --quiet --environment 0.2,0.3,0.4 --width 40 --height 30 --spp 16 --max-depth 6 "$@"; }
  lit -o whole.exr || fail "no picture"
  for i in 0 1 2; do lit --shard $i/3 -o s$i.exr || fail "no shard"; done
  exrmerge --quiet s1.exr s2.exr s0.exr -o m.exr && same m.exr whole.exr "shards under a sky have other bytes"
  few --spp 16 --aov all --checkpoint v.exr -o v1.exr && few --spp 16 --aov all --resume v.exr -o v2.exr && exrmerge --quiet v.exr -o v3.exr || fail "halves"
  same v1.exr v2.exr "what kept halves goes on otherwise"
  same v1.exr v3.exr "a checkpoint with channels is no picture"
  aim() { few --target-error 0.05 "$@"; }
  aim -o whole.exr || fail "no picture"
  run="exec" aim --checkpoint c.exr --set checkpoint-every=0 -o p.exr &
  pid=$!
  while [ ! -e c.exr ]; do sleep 0.05; done
  kill -TERM $pid
  wait $pid
  [ $? -eq 6 ] || fail "it was not stopped"
  aim --resume c.exr -o p.exr || fail "it does not go on"
  same p.exr whole.exr "a picture of given error that went on has other bytes"
  run="exec" few --time 1.5 --checkpoint t.exr --set checkpoint-every=0.1 -o p.exr &
  pid=$!
  sleep 0.8
  kill -KILL $pid
  wait $pid 2>/dev/null
  few --time 1.5 --resume t.exr --json -o p.exr >summary || fail "it does not go on"
  grep -q '"seconds":[12]\.' summary || { cat summary; fail "the time begins anew"; }
  few --spp 16 --shard 0/2 -o s0.exr && exrmerge --quiet --film s0.exr -o half.exr && few --spp 16 -o whole.exr || fail "half"
  few --spp 16 --resume half.exr --no-provenance -o p.exr && few --spp 16 --no-provenance -o q.exr && same p.exr q.exr "a merged beginning goes on otherwise"
  : >empty.exr
  few --spp 16 --checkpoint empty.exr --resume empty.exr -o p.exr && same p.exr whole.exr "from an empty file the picture is another"
  odd=$(printf 'r\377.glb')
  cp "$scene" "$odd" && tdpt-render "$odd" --quiet --width 8 --spp 4 --checkpoint odd.exr -o o1.exr && exrmerge --quiet odd.exr -o o2.exr || fail "an odd name"
  same o1.exr o2.exr "an odd name makes another picture"
  # The preview is written before the picture exists.
  run="exec" few --spp 1000000 --preview -o seen.exr &
  pid=$!
  tries=0
  until [ -s seen.png ] || [ $tries -gt 300 ]; do sleep 0.1; tries=$((tries + 1)); done
  kill -KILL $pid
  wait $pid 2>/dev/null
  [ -s seen.png ] && [ ! -e seen.exr ] || fail "no preview while rendering, or a picture before its end"
}

case $what in
kills)
  (order) || exit 1
  rm c.exr
  kills 12 12
  [ $spoilt -eq 0 ] || fail "$spoilt of 12 kills left a checkpoint that is not whole"
  [ $changed -gt 2 ] || fail "only $changed checkpoints were written"
  spp=$(exrmerge --quiet --json --gaps c.exr -o killed.exr | sed 's/.*"spp":\([0-9]*\).*/\1/')
  render --integrator bdpt -o undisturbed.exr || fail "no picture"
  exrdiff --json killed.exr undisturbed.exr | grep -q '"mse":0.0,' || fail "kills have changed the picture"
  ends
  full_disk
  rm -f c.exr
  LD_PRELOAD=$spy SPOIL_RENAME=1
  export LD_PRELOAD SPOIL_RENAME
  kills 50 1
  [ $spoilt -gt 0 ] || fail "twin: no kill was found to spoil a checkpoint that is copied into place"
  ;;
parts)
  divided
  goes_on
  ;;
*) fail "no such test: $what" ;;
esac
