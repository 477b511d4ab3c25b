#!/bin/sh
# submit.sh SCENE PICTURE.exr N [OPTION...]: renders SCENE with the OPTIONs of tdpt-render in N shards by Slurm. Submits
# three jobs, each after the one before it: portals and plan, an array of N shards, their merge into PICTURE.exr. All that
# they write beside it is in PICTURE.farm/, which every node must see under the same name, as it must see the scene.
# Submitted again after a failure, it goes on from what is there. With --portal in OPTIONs no portals are looked for.
# The environment may set
#   CPUS          processors of each shard, and of the job before them (1)
#   SBATCH_*      what sbatch(1) is told of all jobs: SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT ...
set -eu
[ $# -ge 3 ] || { echo "usage: submit.sh SCENE PICTURE.exr N [OPTION of tdpt-render]..." >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
scene=$1 picture=$2 n=$3
shift 3
farm=${picture%.exr}.farm
case " $* " in
  *" --portal"[\ =]*) ;;
  *) set -- "$@" --portal "$farm/portal.glb" ;;
esac
mkdir -p "$farm"

# job LOG WORD...: submits, and prints its number.
job() {
  log=$1
  shift
  sbatch --parsable --kill-on-invalid-dep=yes --output="$farm/$log" "$@" | cut -d ';' -f 1
}
portal=$(job portal.log --cpus-per-task="${CPUS:-1}" "$here/portal.sbatch" "$farm" "$scene" "$@")
shards=$(job shard.%a.log --cpus-per-task="${CPUS:-1}" --dependency="afterok:$portal" --array="0-$((n - 1))" \
  "$here/shards.sbatch" "$farm" "$scene" "$n" "$@")
merge=$(job merge.log --dependency="afterok:$shards" "$here/merge.sbatch" "$farm" "$picture" "$n")
echo "jobs $portal (portals and plan), $shards ($n shards), $merge (merge); their words go to $farm/*.log"
