#!/bin/sh
# submit.sh SCENE PICTURE.exr N OPTION...: renders SCENE in N shards by Slurm: an array of N jobs, then one that merges
# them into PICTURE.exr. The OPTIONs are those of tdpt-render, --spp among them. Shards, checkpoints and logs are in
# PICTURE.farm/, which every node must see under the same name, as it must see the scene. Submitted again after a
# failure, it continues from what is there. The environment may set
#   CPUS          processors of each shard (1)
#   SBATCH_*      what sbatch(1) is told of all jobs: SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT ...
set -eu
[ $# -ge 4 ] || { echo "usage: submit.sh SCENE PICTURE.exr N OPTION of tdpt-render..." >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
scene=$1 picture=$2 n=$3 farm=${2%.exr}.farm
shift 3
mkdir -p "$farm"
shards=$(sbatch --parsable --array="0-$((n - 1))" --cpus-per-task="${CPUS:-1}" --output="$farm/shard.%a.log" \
  "$here/shards.sbatch" "$farm" "$n" "$scene" "$@" | cut -d ';' -f 1)
merge=$(sbatch --parsable --dependency="afterok:$shards" --kill-on-invalid-dep=yes --output="$farm/merge.log" \
  --wrap "exrmerge '$farm'/shard.*.exr -o '$picture'" | cut -d ';' -f 1)
echo "jobs $shards ($n shards), $merge (merge); their logs are $farm/*.log"
