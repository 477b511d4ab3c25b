#!/bin/sh
# lasting_test.sh WHAT BIN TESTDATA SPY: long renderings survive interruptions. WHAT:
#   order         a checkpoint is written, flushed and renamed, and its folder flushed, in this order
#   kills         50 kills at random moments: the checkpoint is always whole, and a resumed rendering ends with the
#                 bytes of an uninterrupted one
#   kills-twin    if checkpoints are copied into place instead, kills must be found to damage them
#   parts         shards, merged in any order or as a tree, stopped, resumed and with any number of threads, give the
#                 bytes of the undivided picture; so do samples added later
#   more-parts    the same with lights of several kinds that are selected by their measured contribution, with a target
#                 error, and with a time limit
#   parts-twin    a shard with another seed, another size or a changed byte is refused
#   traps         films of parts in the wrong place, unusual names and sizes
#   full-disk     a full disk damages no existing checkpoint and ends no rendering
set -u
what=$1 bin=$2 testdata=$3 spy=$4
PATH=$bin:$PATH
work=$(mktemp -d) || exit 99
trap 'umount "$work/small" 2>/dev/null; rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$work" || exit 99
scene=$testdata/scenes/two-rooms.glb
fail() { echo "$*"; exit 1; }
# Runs in the background with run=exec, so that a signal reaches the program.
run=
render() { $run tdpt-render "$scene" --quiet --width 48 --height 36 --spp "$spp" "$@"; }
is_whole() { exrmerge --quiet --gaps "$1" -o /dev/null; }

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

# kills ENOUGH: kills renderings until 50 have been killed, or until ENOUGH of them, $spoilt, have left a damaged
# checkpoint. They run for up to $ms, about the time to the next checkpoint: half of them reach it.
kills() {
  spp=65536 killed=0 spoilt=0 seed=$$ changed=0 ms=100 before=none
  while [ $killed -lt 50 ] && [ $spoilt -lt "$1" ]; do
    run="exec" render --integrator bdpt --checkpoint c.exr --resume c.exr --set checkpoint-every=0 -o p.exr &
    pid=$!
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    now=$((seed / 65536 % ms))
    sleep "$((now / 1000)).$(printf %03d $((now % 1000)))"
    kill -KILL $pid 2>/dev/null || break # it had finished
    wait $pid 2>/dev/null
    killed=$((killed + 1))
    now=none
    [ ! -e c.exr ] || now=$(cksum <c.exr)
    if [ "$now" = "$before" ]; then
      ms=$((ms + ms / 4))
      continue
    fi
    changed=$((changed + 1)) before=$now ms=$((ms - ms / 10))
    is_whole c.exr 2>/dev/null && continue
    spoilt=$((spoilt + 1)) before=none
    rm -f c.exr
  done
  [ $spoilt -eq "$1" ] && return
  [ $killed -eq 50 ] || fail "the rendering was done after $killed kills"
  [ $changed -gt 10 ] || fail "only $changed checkpoints were written"
}

# A room with a portal, in parts: films s.I-of-N.exr with T threads; every third is stopped and resumed.
portal() {
  ffgraph --quiet --set walks=2000 --samples 10000 --set rounds=0 "$scene" | mincut --quiet |
    lightgrid --quiet --resolution 16 --set lines=500 "$scene" - |
    portalfit --quiet --require-portal -o portal.glb || fail "no portal"
}
room() {
  $run tdpt-render "$scene" --quiet --portal portal.glb --width 40 --height 30 --layers --alpha --aov variance,halves "$@"
}
shards() {
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

merge_backwards() { # PATTERN
  pattern=$1
  set --
  # shellcheck disable=SC2086 # a pattern
  for film in $pattern; do set -- "$film" "$@"; done
  exrmerge --quiet "$@" -o m.exr
}

parts() {
  portal
  room --spp 32 -o whole.exr && room --spp 32 --threads 1 -o w1.exr || fail "no picture"
  cmp whole.exr w1.exr || fail "the picture depends on threads"
  # Every number of threads and of shards occurs, the largest of one also with the smallest and largest of the other.
  for how in '1 1' '2 4' '8 1' '1 16' '8 16'; do
    n=${how#* } t=${how% *}
    shards "$n" "$t"
    merge_backwards "s.*-of-$n.exr" || fail "$n shards do not merge"
    cmp m.exr whole.exr || fail "$n shards of $t threads have other bytes"
  done
  # As a tree, from films of different splits, out of order.
  exrmerge --quiet --film s.3-of-4.exr s.0-of-16.exr s.2-of-16.exr -o a.exr || fail "no film"
  exrmerge --quiet --film s.1-of-16.exr s.1-of-4.exr -o b.exr || fail "no film"
  exrmerge --quiet --film b.exr s.3-of-16.exr s.2-of-4.exr -o c.exr || fail "no film"
  exrmerge --quiet c.exr a.exr -o m.exr || fail "the tree does not merge"
  cmp m.exr whole.exr || fail "a tree has other bytes"
  # Samples added to the merged film, and to a checkpoint.
  exrmerge --quiet --film c.exr a.exr -o all.exr || fail "no film"
  room --resume all.exr --add-samples 32 --no-provenance -o long.exr || fail "no samples are added"
  exrdiff --json long.exr whole.exr | grep -q '"mse":0.0,' && fail "nothing is added"
  # The original command still works; samples are added once even if it is killed on the way.
  room --spp 32 -o began.exr --checkpoint grown.exr || fail "no picture"
  cmp began.exr whole.exr || fail "a checkpoint changes the picture"
  run="exec" room --resume grown.exr --add-samples 32 --set checkpoint-every=0 --threads 1 -o more.exr &
  pid=$!
  while [ "$(exrmerge --quiet --gaps --json grown.exr -o now.exr 2>/dev/null | sed 's/.*"spp":\([0-9]*\).*/\1/')" = 32 ]; do sleep 0.02; done
  kill -KILL $pid
  wait $pid 2>/dev/null
  room --resume grown.exr --add-samples 32 -o more.exr || fail "no samples are added after a kill"
  room --spp 32 --resume grown.exr --no-provenance -o more.exr || fail "what has grown is refused"
  exrdiff --json more.exr long.exr | grep -q '"mse":0.0,' || fail "samples that were added twice, or not"
}

# With lamps and a sky, whose shares are measured; with a target error, whose estimate needs blocks of samples; with a
# limit of depth, of time.
more_parts() {
  window=$testdata/scenes/window.glb
  lit() { $run tdpt-render "$window" --quiet --environment 0.2,0.3,0.4 --width 40 --height 30 "$@"; }
  lit --spp 16 --max-depth 6 -o whole.exr || fail "no picture"
  for i in 0 1 2; do lit --spp 16 --max-depth 6 --shard $i/3 -o s$i.exr || fail "no shard"; done
  exrmerge --quiet s1.exr s2.exr s0.exr -o m.exr || fail "no merge"
  cmp m.exr whole.exr || fail "shards under a sky have other bytes"

  spp=0
  aim() { $run tdpt-render "$scene" --quiet --width 40 --height 30 --integrator bdpt --target-error 0.05 "$@"; }
  aim -o whole.exr || fail "no picture"
  run="exec" aim --checkpoint c.exr --set checkpoint-every=0 -o p.exr &
  pid=$!
  while [ ! -e c.exr ]; do sleep 0.05; done
  kill -TERM $pid
  wait $pid
  [ $? -eq 6 ] || fail "it was not stopped"
  # Until everything is decided, a signal leaves no checkpoint.
  run="exec" aim --checkpoint d.exr -o p.exr &
  pid=$!
  sleep 0.2
  kill -TERM $pid
  wait $pid
  [ ! -e d.exr ] || fail "a checkpoint is kept of what was not decided"
  aim --resume c.exr -o p.exr || fail "it does not go on"
  cmp p.exr whole.exr || fail "a picture of given error that went on has other bytes"

  timed() { $run tdpt-render "$scene" --quiet --width 40 --height 30 --time 1.5 "$@"; }
  run="exec" timed --checkpoint t.exr --set checkpoint-every=0.1 -o p.exr &
  pid=$!
  sleep 0.8
  kill -KILL $pid
  wait $pid 2>/dev/null
  timed --resume t.exr --json -o p.exr >summary || fail "it does not go on"
  # Time spent before counts.
  grep -q '"seconds":[12]\.' summary || { cat summary; fail "the time begins anew"; }
}

parts_twin() {
  portal
  room --spp 8 --shard 0/2 -o a.exr && room --spp 8 --shard 1/2 -o b.exr || fail "no shards"
  exrmerge --quiet a.exr b.exr -o m.exr || fail "they do not merge"
  room --spp 8 --shard 1/2 --seed 2 -o other.exr
  refused 3 'is of another .*seed' exrmerge a.exr other.exr -o x.exr
  tdpt-render "$scene" --quiet --width 40 --height 30 --layers --alpha --spp 8 --shard 1/2 -o other.exr
  refused 3 'is of another .*portal' exrmerge a.exr other.exr -o x.exr
  room --spp 8 --shard 1/2 --integrator bdpt -o other.exr
  refused 3 'is of another .*integrator' exrmerge a.exr other.exr -o x.exr
  tdpt-render "$scene" --quiet --portal portal.glb --width 44 --layers --alpha --spp 8 --shard 1/2 -o other.exr
  refused 3 'is of another' exrmerge a.exr other.exr -o x.exr
  refused 3 'some of which are there already' exrmerge a.exr b.exr a.exr -o x.exr
  refused 3 'samples 4 to 7 of 8 are missing' exrmerge a.exr -o x.exr
  size=$(wc -c <b.exr)
  { head -c $((size / 2)) b.exr; printf x; tail -c +$((size / 2 + 2)) b.exr; } >damaged.exr
  refused 3 'is damaged' exrmerge a.exr damaged.exr -o x.exr
  [ ! -e x.exr ] || fail "something was written"
}

# refused CODE WORDS COMMAND...: the command ends with that code and prints these words.
refused() {
  code=$1 words=$2
  shift 2
  "$@" 2>messages
  [ $? -eq "$code" ] || { cat messages; fail "not refused with $code: $*"; }
  grep -q -e "$words" messages || { cat messages; fail "no word of: $words"; }
}
same() { cmp "$1" "$2" || fail "$3"; }

traps() {
  room="$testdata/scenes/two-rooms.glb"
  few() { $run tdpt-render "$room" --quiet --width 40 --height 30 --integrator bdpt "$@"; }
  few --spp 16 -o whole.exr || fail "no picture"

  # With halves kept, a checkpoint can be resumed; when merged it becomes the picture, including channels that do not
  # depend on samples.
  few --spp 16 --aov all --checkpoint v.exr -o v1.exr && few --spp 16 --aov all --resume v.exr -o v2.exr || fail "variance"
  same v1.exr v2.exr "what kept halves goes on otherwise"
  exrmerge --quiet v.exr -o v3.exr
  same v1.exr v3.exr "a checkpoint with channels is no picture"
  few --spp 5 --aov all --checkpoint w.exr -o w1.exr && few --aov all --resume w.exr --add-samples 11 --no-provenance -o w2.exr || fail "more samples"
  few --spp 16 --aov all --no-provenance -o w3.exr
  same w2.exr w3.exr "added samples are others"
  few --target-error 0.3 --checkpoint t.exr -o t1.exr && exrmerge --quiet t.exr -o t2.exr
  same t1.exr t2.exr "a checkpoint of a given error is no picture"

  # Until everything is decided no checkpoint is written, however short the interval.
  run="exec" few --target-error 0.02 --checkpoint early.exr --set checkpoint-every=0 -o p.exr &
  pid=$!
  sleep 0.15
  kill -TERM $pid
  wait $pid
  [ ! -e early.exr ] || { few --target-error 0.02 --resume early.exr -o p.exr && few --target-error 0.02 -o q.exr && same p.exr q.exr "what was not decided goes on"; }

  # A file that is not resumed is not overwritten.
  few --spp 16 --shard 0/2 -o s0.exr && few --spp 16 --shard 1/2 -o s1.exr || fail "no shards"
  echo precious >precious.exr
  refused 2 'is there already' few --spp 16 --resume v.exr --checkpoint precious.exr -o p.exr
  refused 2 'give --shard as it was begun' few --spp 16 --resume s1.exr -o p.exr
  [ "$(cat precious.exr)" = precious ] || fail "a file is written over"

  # The beginning of a picture can be continued to its end.
  exrmerge --quiet --film s0.exr -o half.exr
  few --spp 16 --resume half.exr --no-provenance -o p.exr && few --spp 16 --no-provenance -o q.exr || fail "half"
  same p.exr q.exr "a merged beginning goes on otherwise"

  # A checkpoint of a shard of another length.
  few --spp 8 --shard 0/2 --checkpoint k.exr -o k0.exr || fail "no shard"
  refused 3 'is to hold' few --spp 16 --shard 1/2 --resume k.exr -o k0.exr

  # A rendering that ended by its time limit is finished.
  few --time 0.5 --checkpoint c.exr -o c1.exr && few --time 0.5 --resume c.exr -o c2.exr || fail "time"
  same c1.exr c2.exr "a picture that ended by the clock goes on"

  # Very wide pictures, names that are not UTF-8, and a film without a name yet.
  tdpt-render "$room" --quiet --width 65536 --height 1 --spp 1 --layers --alpha --integrator pt --checkpoint wide.exr -o w1.exr &&
    exrmerge --quiet wide.exr -o w2.exr || fail "the widest"
  same w1.exr w2.exr "the widest picture is another"
  odd=$(printf 'r\377.glb')
  cp "$room" "$odd" && tdpt-render "$odd" --quiet --width 8 --spp 4 --checkpoint odd.exr -o o1.exr || fail "an odd name"
  exrmerge --quiet odd.exr -o o2.exr
  same o1.exr o2.exr "an odd name makes another picture"
  : >empty.exr
  few --spp 16 --checkpoint empty.exr --resume empty.exr -o p.exr || fail "an empty file is no beginning"
  same p.exr whole.exr "from an empty file the picture is another"

  # The preview is written and refreshed before the picture exists.
  run="exec" few --spp 1000000 --preview -o seen.exr &
  pid=$!
  tries=0
  until [ -s seen.png ] || [ $tries -gt 300 ]; do sleep 0.1; tries=$((tries + 1)); done
  kill -KILL $pid
  wait $pid 2>/dev/null
  [ -s seen.png ] || fail "no preview while rendering"
  [ ! -e seen.exr ] || fail "the picture is there before its end"

  # Excessive nesting crashes no program.
  deep=$(head -c 300000 /dev/zero | tr '\0' '[')
  printf '{"asset": {"x": %s' "$deep" >deep.json
  tdpt-info deep.json 2>messages && fail "it is known"
  [ $? -lt 128 ] || fail "tdpt-info is ended"
  refused 2 'only 16 samples' few --spp 16 --shard 0/17 -o p.exr
  refused 2 'at the most' few --resume whole-film.exr --add-samples 4294967296 -o p.exr
}

case $what in
traps)
  spp=0
  tdpt-render "$scene" --quiet --width 40 --height 30 --integrator bdpt --spp 16 --checkpoint whole-film.exr -o x.exr
  traps
  ;;
order) order ;;
parts) parts ;;
more-parts) more_parts ;;
parts-twin) parts_twin ;;
kills)
  kills 50
  [ $spoilt -eq 0 ] || fail "$spoilt of 50 kills left a checkpoint that is not whole"
  had=$(exrmerge --quiet --json --gaps c.exr -o killed.exr | sed 's/.*"spp":\([0-9]*\).*/\1/')
  echo "50 kills, $changed of them after another checkpoint, $had samples until the last one"
  spp=$had
  render --integrator bdpt -o undisturbed.exr || fail "no picture"
  exrdiff --json killed.exr undisturbed.exr | grep -q '"mse":0.0,' || fail "kills have changed the picture"
  # To the end with `auto`: killed, stopped, with other numbers of threads.
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
  cmp p.exr undisturbed.exr || fail "what went on has other bytes"
  ;;
kills-twin)
  LD_PRELOAD=$spy SPOIL_RENAME=1
  export LD_PRELOAD SPOIL_RENAME
  kills 1
  [ $spoilt -gt 0 ] || fail "no kill was found to spoil a checkpoint that is copied into place"
  ;;
full-disk)
  mkdir small
  mount -t tmpfs -o size=96k tmpfs small 2>/dev/null || { echo "no file system can be mounted"; exit 77; }
  spp=16
  render --checkpoint small/c.exr --set checkpoint-every=0 -o p.exr || fail "there is no room for one checkpoint"
  cp small/c.exr before.exr
  head -c 96k /dev/zero >small/filling 2>/dev/null
  spp=32
  tdpt-render "$scene" --quiet --resume small/c.exr --width 48 --height 36 --add-samples 4096 --set checkpoint-every=0 \
    -o q.exr 2>messages &
  pid=$!
  sleep 1.5
  kill -TERM $pid
  wait $pid
  grep -q 'checkpoint before it is kept' messages || { cat messages; fail "no word of the full disk"; }
  cmp small/c.exr before.exr || fail "the checkpoint before it is lost"
  ;;
*) fail "no such test: $what" ;;
esac
