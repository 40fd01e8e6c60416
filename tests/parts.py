"""Parts of a bake in any order: parts.py FOLDER PARTS SEED PROGRAM SCENE OPTION...

Round after round all parts are called in random order, until each says that it is done. In the first rounds a third of them is killed once
and called again, and two are called twice at the same time. The joined field must be that of a whole bake, byte for byte, and nothing
else may be left. Prints the rounds, and the processor time of all calls beside that of the whole bake."""
import os
import random
import resource
import subprocess
import sys

NOT_READY = 75


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def check(process, allowed):
    errors = process.stderr.read().decode()
    code = process.wait()
    if code not in allowed:
        sys.exit("exit code %d: %s" % (code, errors))
    return code


def start(command):
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def call(command, kill_after=None):
    """Whether the part is done."""
    if kill_after is not None:
        victim = start(command)
        try:
            victim.wait(kill_after)
        except subprocess.TimeoutExpired:
            victim.kill()
        check(victim, (0, NOT_READY, -9))
    return check(start(command), (0, NOT_READY)) == 0


def call_twice(command):
    first, second = start(command), start(command)
    codes = check(first, (0, NOT_READY)), check(second, (0, NOT_READY))
    return 0 in codes


def read(path):
    with open(path, "rb") as file:
        return file.read()


def main(folder, parts, seed, program, *options):
    parts, chance = int(parts), random.Random(int(seed))
    field, work, whole = (os.path.join(folder, name) for name in ("field.olx", "work", "whole.olx"))
    before = processor_seconds()
    check(start([program, "bake", *options, "-o", whole, "--no-work"]), (0,))
    whole_seconds = processor_seconds() - before
    to_kill = set(chance.sample(range(1, parts + 1), parts // 3))
    doubled = set(chance.sample(range(1, parts + 1), min(2, parts)))
    before, rounds, done = processor_seconds(), 0, False
    while not done:
        done = True
        for part in chance.sample(range(1, parts + 1), parts):
            command = [program, "bake", *options, "--work", work, "--part", "%d/%d" % (part, parts)]
            if part in to_kill and chance.random() < 0.5:
                to_kill.remove(part)
                done &= call(command, chance.uniform(0.0, whole_seconds / parts))
            elif part in doubled and rounds < 3:
                done &= call_twice(command)
            else:
                done &= call(command)
        rounds += 1
        if rounds > 50:
            sys.exit("no end after %d rounds" % rounds)
    check(start([program, "join", work, "-o", field]), (0,))
    if read(field) != read(whole):
        sys.exit("%d parts made another field" % parts)
    if sorted(os.listdir(folder)) != ["field.olx", "whole.olx"]:
        sys.exit("left behind: %s" % os.listdir(folder))
    print("%d parts: %d rounds, %.2f s of processors; %.2f s whole" % (parts, rounds, processor_seconds() - before, whole_seconds))


main(*sys.argv[1:])
