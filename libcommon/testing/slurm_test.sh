#!/bin/sh
# slurm_test.sh BIN TESTDATA RECIPE: runs the files of RECIPE (doc/farm) under Slurm: a controller and two nodes on this
# machine, with a configuration and folders of their own, removed afterwards. As root, without systemd and cgroups. A node
# dies in the middle of a shard, which resumes from its checkpoint on the other node; so does a shard that runs out of time;
# the picture has the bytes of the undivided one.
# Exit 77 if Slurm is missing (cmake/packages-slurm.txt).
set -u
bin=$(cd "${1:?usage: slurm_test.sh BIN TESTDATA RECIPE}" && pwd) || exit 2
testdata=$(cd "${2:?usage: slurm_test.sh BIN TESTDATA RECIPE}" && pwd) || exit 2
recipe=$(cd "${3:?usage: slurm_test.sh BIN TESTDATA RECIPE}" && pwd) || exit 2
PATH=$bin:$PATH:/usr/sbin:/sbin
for program in slurmctld slurmd sbatch scontrol pgrep; do
  command -v $program >/dev/null || { echo "skipped: $program is missing (cmake/packages-slurm.txt)"; exit 77; }
done
began=$(date +%s)
work=$(mktemp -d) || exit 2
daemons=''

# family PID: the process and its descendants.
family() {
  ps -e -o pid= -o ppid= | awk -v root="$1" '
    { parent[$1] = $2 }
    END { for (p in parent) { for (q = p; q in parent && q != root;) q = parent[q]; if (q == root) print p } }'
}
# steps FOLDER: the processes of the jobs with scripts there, including those of Slurm that supervise them.
steps() {
  for script in $(pgrep -f "^/bin/sh $1/.*slurm_script"); do
    family "$(ps -o ppid= -p "$script" | tr -d ' ')"
  done
}
# shellcheck disable=SC2086,SC2046 # numbers of processes
end() {
  kill $daemons 2>/dev/null
  wait
  kill -KILL $(steps "$work/spool") 2>/dev/null
  rm -rf "$work"
}
trap end EXIT
trap 'exit 99' HUP INT TERM
cd "$work" || exit 2
mkdir state
fail() {
  echo "$*"
  for log in picture.farm/*.log node?.log; do
    [ ! -e "$log" ] || { echo "-- $log"; tail -n 5 "$log"; }
  done
  echo "-- slurmctld.log"
  tail -n 40 slurmctld.log; squeue
  exit 1
}

port=$((20000 + $$ % 20000))
# cred_expire: how long a requeued job waits; 120 s if not given or below 5.
cat >slurm.conf <<CONF
ClusterName=loopback
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=0
ReturnToService=2
JobRequeue=1
SlurmdTimeout=4
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool.%n
SlurmctldLogFile=$work/slurmctld.log
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/%n.pid
NodeName=node1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1
NodeName=node2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1
PartitionName=farm Nodes=node1,node2 Default=YES State=UP
CONF
export SLURM_CONF="$work/slurm.conf"
slurmctld -D -i 2>/dev/null &
daemons=$!
slurmd -D -N node1 >node1.log 2>&1 &
node1=$!
slurmd -D -N node2 >node2.log 2>&1 &
daemons="$daemons $node1 $!"

# until_so SECONDS WHY COMMAND...: waits until the command succeeds; fails after that time.
until_so() {
  seconds=$1 why=$2
  shift 2
  deadline=$(($(date +%s) + seconds))
  until "$@"; do
    [ "$(date +%s)" -lt $deadline ] || fail "after $seconds s: $why"
    sleep 0.2
  done
}
idle() { [ "$(sinfo -h -t idle -o %D 2>/dev/null)" = 2 ]; }
until_so 30 "two nodes are not idle" idle

cp "$testdata/scenes/two-rooms.glb" .
cp -r "$recipe" recipe
tdpt two-rooms.glb --quiet --work work -o portal.glb || fail "no portals"
n=4
set -- --portal portal.glb --width 96 --height 72 --spp 256
said=$(sh recipe/submit.sh two-rooms.glb picture.exr $n "$@" --set checkpoint-every=0.2) || fail "nothing is submitted"
echo "$said"
shards=$(echo "$said" | sed 's/^jobs \([0-9]*\) .*/\1/')

# has_checkpoint WORD...: whether a shard, among those that squeue lists with these words, runs and has a checkpoint;
# sets $task.
has_checkpoint() {
  task=$(squeue -h -t RUNNING -o %K "$@" 2>/dev/null | head -n 1)
  [ -n "$task" ] && [ -s "picture.farm/checkpoint.$task.exr" ]
}
samples() { exrmerge --json --gaps "$1" -o /dev/null 2>/dev/null | sed 's/.*"spp":\([0-9]*\).*/\1/'; }
until_so 120 "no shard on node1 has a checkpoint" has_checkpoint -j "$shards" -w node1
killed=$task
# shellcheck disable=SC2086,SC2046 # numbers of processes; all at once, as by a power cut
kill -KILL $node1 $(steps "$work/spool.node1")
had=$(samples "picture.farm/checkpoint.$killed.exr")
echo "node1 is dead; its shard $killed had $had of $((256 / n)) samples"
[ "$had" -lt $((256 / n)) ] || fail "it was done: nothing was in the middle"
# The last one, whose job has the number of the array: requeueing it must not restart the others.
until_so 120 "the last shard has no checkpoint" has_checkpoint -j "${shards}_$((n - 1))" -w node2
stopped=$task
# What Slurm does a minute before the time limit. The signal is sent again, without effect, while the shard already
# waits for its next turn.
scancel --batch --signal=USR1 "${shards}_$stopped" 2>scancel.log &
scancel=$!
until_so 60 "shard $stopped does not stop" grep -q 'the time is up' "picture.farm/shard.$stopped.log"
kill $scancel 2>/dev/null
echo "the time of shard $stopped on node2 is up"
gone() { [ -z "$(squeue -h -o %i)" ]; }
until_so 300 "jobs are left" gone
for log in picture.farm/shard.?.log; do grep "^shard" "$log"; done
for shard in $killed $stopped; do
  grep -A 3 "on node2, turn 2" "picture.farm/shard.$shard.log" | grep -q "goes on from" || fail "shard $shard did not go on"
done
[ "$(cat picture.farm/shard.?.log | grep -c '^shard.* turn')" = $((n + 2)) ] || fail "others began again"
tdpt-render two-rooms.glb --quiet "$@" -o undivided.exr || fail "no undivided picture"
cmp picture.exr undivided.exr || fail "the picture has other bytes than the undivided one"
echo "slurm_test: $n shards on two nodes: the picture has the bytes of the undivided one; $(($(date +%s) - began)) s"
