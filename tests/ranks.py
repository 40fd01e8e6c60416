"""Bakes on ranks of an MPI job: ranks.py FOLDER KILLS SEED OCTALUX RANKS,RANKS... SCENE OPTION...

For each number of ranks octalux-bake-mpi bakes in one go, and then with kills: a rank chosen at random is killed with SIGKILL at a random
moment, which ends the job, and the same command is begun again, until there were KILLS kills. Every field must be that of `octalux bake`,
byte for byte; no unit that a job reported may be made again by a later one before the field is there, so that a kill loses at most the unit
that each rank was at; nothing but the field may be left.

Open MPI 4.1 can miss the end of a rank that is killed while it starts, and then waits for ever. Such a job is ended as a user would: a
mpirun that lives on for a minute while no rank does is killed, too."""
import json
import os
import random
import signal
import subprocess
import sys
import time


def state_of(process):
    """The letter that /proc has for a process: Z for one that has ended and is not yet waited for."""
    try:
        with open("/proc/%d/stat" % process) as file:
            return file.read().rpartition(")")[2].split()[0]
    except OSError:
        return "X"


class Job:
    """octalux-bake-mpi on some ranks."""

    def __init__(self, ranks, command):
        environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        self.ranks = ranks
        self.process = subprocess.Popen(["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), *command], env=environment,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def rank_processes(self):
        """The ranks that live."""
        try:
            with open("/proc/%d/task/%d/children" % (self.process.pid, self.process.pid)) as file:
                return [int(word) for word in file.read().split() if state_of(int(word)) not in "ZX"]
        except OSError:
            return []

    def kill_a_rank(self, chance, seconds):
        """Once all ranks are there and `seconds` have passed, unless the job has ended."""
        while self.process.poll() is None and len(self.rank_processes()) < self.ranks:
            time.sleep(0.01)
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            victims = self.rank_processes()
            if victims:
                os.kill(chance.choice(victims), signal.SIGKILL)

    def end(self):
        """The exit code, the units that were made, and everything else that was said."""
        without_ranks = 0
        while True:
            try:
                errors = self.process.communicate(timeout=10)[1]
                break
            except subprocess.TimeoutExpired:
                without_ranks = 0 if self.rank_processes() else without_ranks + 1
                if without_ranks > 6:
                    self.process.kill()
        lines = errors.split("\n")
        units = [json.loads(line) for line in lines if line.startswith("{") and line.endswith("}")]
        made = {(unit["stage"], unit["round"], unit["unit"]) for unit in units if not unit["found"]}
        return self.process.returncode, made, errors


def read(path):
    with open(path, "rb") as file:
        return file.read()


def check(folder, field, wanted):
    if read(field) != wanted:
        sys.exit("another field")
    if os.listdir(folder) != ["field.olx"]:
        sys.exit("left behind: %s" % os.listdir(folder))


def bake_with_kills(ranks, command, seconds, kills, chance, field, wanted):
    """Bakes, with kills within `seconds` of each start. Returns how many there were, and how long the last job took."""
    made, killed = set(), 0
    while True:
        start, job = time.monotonic(), Job(ranks, command)
        if killed < kills:
            job.kill_a_rank(chance, chance.uniform(0.0, seconds))
        code, now, errors = job.end()
        if code not in (0, 128 + signal.SIGKILL, -signal.SIGKILL):
            sys.exit("exit code %d: %s" % (code, errors))
        if made & now:
            sys.exit("made again: %s" % sorted(made & now))
        made |= now
        if code == 0:
            return killed, time.monotonic() - start
        killed += 1
        if os.path.exists(field):
            if read(field) != wanted:
                sys.exit("another field after kills")
            made.clear()


def main(folder, kills, seed, octalux, ranks, *options):
    chance, field = random.Random(int(seed)), os.path.join(folder, "field.olx")
    subprocess.run([octalux, "bake", *options, "--no-work", "-o", field], check=True, stdout=subprocess.DEVNULL)
    wanted = read(field)
    command = [octalux + "-bake-mpi", *options, "--threads", "1", "--progress=json", "-o", field]
    for count in [int(word) for word in ranks.split(",")]:
        os.remove(field)
        start, job = time.monotonic(), Job(count, command)
        code, made, errors = job.end()
        seconds, left, bakes = time.monotonic() - start, int(kills), 0
        if code != 0:
            sys.exit("exit code %d: %s" % (code, errors))
        check(folder, field, wanted)
        while left > 0:
            os.remove(field)
            killed, last = bake_with_kills(count, command, seconds, left, chance, field, wanted)
            seconds = min(seconds, max(last, 0.1)) if killed == 0 else seconds # it was begun on a busier machine
            left, bakes = left - killed, bakes + 1
            check(folder, field, wanted)
        print("%d ranks: the same bytes, %d units; the same in %d bakes with %s kills" % (count, len(made), bakes, kills), flush=True)


main(*sys.argv[1:])
