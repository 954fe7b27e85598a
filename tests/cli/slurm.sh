#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The recipe of docs/farm.md on a real Slurm, controller and node on this machine: an array of 4 tasks over 16 frames,
# of which one is killed at work and queued again. All frames must be those of an undisturbed run.
# Usage: slurm.sh PROGRAM SOURCE_ROOT. Exits with 77, skipped, without Slurm or without the right to run it.
. "$(dirname "$0")/../support/check.sh"
program=$(absolute "$1")
source_root=$(absolute "$2")
PATH=$PATH:/usr/sbin:/sbin
for tool in slurmctld slurmd sbatch squeue scontrol; do
    command -v $tool >/dev/null || { echo "skipped: there is no $tool (Debian: slurm-wlm)"; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "skipped: a node's daemon needs root"; exit 77; }

chmod 755 "$dir"
cd "$dir" || exit 1
controller= node=
stop() {
    [ -z "$node" ] || kill "$node" 2>/dev/null
    [ -z "$controller" ] || kill "$controller" 2>/dev/null
    wait 2>/dev/null
    rm -rf "$dir"
}
trap stop EXIT

host=$(uname -n | cut -d. -f1)
port=$((20000 + $$ % 20000))
mkdir state spool in out good
cat >slurm.conf <<C
ClusterName=hyperfocal
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
KillWait=2
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:2
C
export SLURM_CONF="$dir/slurm.conf"
slurmctld -D >slurmctld.log 2>&1 &
controller=$!
slurmd -D >slurmd.log 2>&1 &
node=$!
i=0
until sinfo -h -o %T 2>/dev/null | grep -q idle; do
    i=$((i + 1))
    if [ $i -gt 60 ] || ! kill -0 $controller 2>/dev/null; then
        echo "skipped: Slurm does not start here"
        tail -n 5 slurmctld.log slurmd.log
        exit 77
    fi
    sleep 0.5
done

for i in 01 02 03 04 05 06 07 08 09 10 11 12 13 14 15 16; do
    case $i in *[147]) p=lights ;; *[258]) p=fence ;; *) p=foliage ;; esac
    ln -s "$source_root/images/$p.exr" "in/shot.00$i.exr"
done
cat >shot.sbatch <<C
#!/bin/sh
#SBATCH --array=1-4 --requeue --cpus-per-task=1 --output=$dir/task-%a.log --open-mode=append
exec "$program" "$dir/in/shot.####.exr" -o "$dir/out/shot.####.exr" --engine gather --focus 5 --range 3 \\
    --frames 1-16 --chunk auto --resume --threads 1
C
job=$(sbatch --parsable shot.sbatch) || exit 1
echo "job $job"
# Frames 5 to 8 are the second task's: when the first of them is there, it is at work on the next.
i=0
until [ -e out/shot.0005.exr ] || [ $i -gt 400 ]; do
    i=$((i + 1))
    sleep 0.05
done
scontrol requeue "${job}_2" && requeued=1
i=0
while squeue -h -j "$job" 2>/dev/null | grep -q . && [ $i -lt 400 ]; do
    # Slurm lets a job that was queued again wait for two minutes.
    scontrol update JobId="${job}_2" StartTime=now >/dev/null 2>&1
    i=$((i + 1))
    sleep 0.5
done

"$program" in/shot.####.exr -o good/shot.####.exr --engine gather --focus 5 --range 3 2>good.log
explain() {
    tail -n 6 task-*.log
}
check "a task was queued again" test "${requeued:-0}" = 1
check "and began twice" test "$(grep -c 'frames/s' task-2.log)" -ge 1 -a "$(grep -c '^hyperfocal: 1/4' task-2.log)" = 2
check "16 frames" test "$(ls -A out | wc -l)" = 16
check "all as in an undisturbed run" diff -r good out
finish
