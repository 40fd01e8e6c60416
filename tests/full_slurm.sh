# The Slurm templates of docs/farm.md on a real slurmctld with two slurmd, which this test starts and ends: an array
# with more tasks than fit at once, one of which is requeued while it runs, and the job that joins, make the field of a
# bake by one process.
set -euo pipefail
for program in slurmctld slurmd sbatch scontrol; do
  command -v $program >/dev/null || {
    echo "skipped: $program is missing (Debian: slurmctld, slurmd, slurm-client)"
    exit 77
  }
done
[ "$(id -u)" = 0 ] || {
  echo "skipped: Slurm's daemons are started as root"
  exit 77
}
work=$(mktemp -d)
daemons=()
finish() {
  for daemon in "${daemons[@]}"; do kill "$daemon" 2>/dev/null || true; done
  wait
  rm -rf "$work"
}
trap finish EXIT
fail() {
  echo "FAILED: $1"
  tail -n 20 "$work"/slurmctld.log "$work"/slurm-*.out 2>/dev/null || true
  exit 1
}
# until_true SECONDS COMMAND...: repeats the command until it succeeds.
until_true() {
  local left=$((2 * $1))
  shift
  until "$@"; do
    ((left-- > 0)) || fail "in vain: $*"
    sleep 0.5
  done
}

cd "$work"
host=$(hostname -s)
read -r ports < <(python3 -c '
import socket
sockets = [socket.socket() for _ in range(3)]
for s in sockets: s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))')
read -r control first second <<<"$ports"
cat >slurm.conf <<CONF
ClusterName=sandbox
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$control
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1
SlurmdParameters=config_overrides
MpiDefault=none
KillWait=2
SlurmctldPidFile=$work/slurmctld.pid
SlurmctldLogFile=$work/slurmctld.log
StateSaveLocation=$work/state
SlurmdPidFile=$work/%n.pid
SlurmdLogFile=$work/%n.log
SlurmdSpoolDir=$work/%n
NodeName=node1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$first CPUs=8 RealMemory=1000
NodeName=node2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$second CPUs=8 RealMemory=1000
PartitionName=all Nodes=node[1-2] Default=YES MaxTime=INFINITE State=UP
CONF
echo CgroupPlugin=cgroup/v1 >cgroup.conf
mkdir state
export SLURM_CONF=$work/slurm.conf
slurmctld -D 2>control.txt >&2 &
daemons+=($!)
for node in node1 node2; do
  slurmd -D -N $node 2>$node.txt >&2 &
  daemons+=($!)
done
two_idle() { [ "$(sinfo -h -N -t idle -o %N 2>/dev/null | wc -l)" = 2 ]; }
until_true 30 two_idle

page=$OCTALUX_SOURCE_DIR/docs/farm.md
export PATH=$(dirname "$OCTALUX"):$PATH SCRATCH=$work
scene="builtin:cornell --grid 2x1x2 --radiance-size 32 --noise 0.2"
octalux bake $scene --isa avx2 -o whole.olx >/dev/null
# The script with a quick scene and short sleeps.
sed -n '/^#!\/bin\/bash$/,/^```$/{/^```/!p}' "$page" |
  sed "s/builtin:temple --grid 8x8x8/$scene/; s/sleep [0-9]*/sleep 0.2/" >part.sh
sed -n '/^parts=$(sbatch/,/^```$/{/^```/!p}' "$page" >submit.sh
[ -s part.sh ] && [ "$(wc -l <submit.sh)" = 2 ] || fail "docs/farm.md: its templates are not where this test looks for them"
export DIR=$work/temple.work
. ./submit.sh >/dev/null
# A task that was requeued is held back for two minutes; others do its share, and it finds nothing left to do.
task_runs() { squeue -h -t running -j "${parts}_1" 2>/dev/null | grep -q .; }
until_true 60 task_runs
scontrol requeue "${parts}_1" || fail "requeue of a task"
all_done() { [ -z "$(squeue -h 2>/dev/null || echo later)" ] || squeue -h -o %r | grep -q DependencyNeverSatisfied; }
until_true 300 all_done
cmp temple.olx whole.olx || fail "another field, or none"
[ ! -e temple.work ] || fail "the work folder stays"
grep -q 'Requeuing JobId' slurmctld.log || fail "no task was requeued"
echo "16 tasks on 2 nodes with room for 4, one of them requeued: the same bytes"
