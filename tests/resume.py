"""Bakes are killed and go on: resume.py FOLDER KILLS SEED PROGRAM SCENE OPTION...

A bake with a work folder is killed with SIGKILL at random moments, over and over, and begun again until it is done; then the next one
begins, until there were KILLS kills. Every field must be that of a bake without a work folder, byte for byte, no unit may be made to its
end twice before the field is there, and nothing but the field may be left. A kill after the field is written may hit the removal of the
work folder: the field is whole then, and a bake that is begun again makes anew what is removed already."""
import json
import os
import random
import subprocess
import sys
import time


def run(command, seconds=None):
    """Exit code, or None when it was killed after `seconds`; and the units that it reported."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    if seconds is not None:
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
    errors = process.stderr.read().decode()
    code = process.wait()
    lines = [line for line in errors.split("\n")[:-1]]  # text after the last newline was cut off by the kill
    units = [json.loads(line) for line in lines if line.startswith("{")]
    others = [line for line in lines if not line.startswith("{")]
    if others or code not in (0, -9):
        sys.exit("exit code %d: %s" % (code, errors))
    return (None if code == -9 else code), units


def read(path):
    with open(path, "rb") as file:
        return file.read()


def check_field(path, wanted):
    if read(path) != wanted:
        sys.exit("another field after kills")


def bake_with_kills(bake, field, wanted, work, most_seconds, kills, chance):
    """Until it is done, with at most that many kills; how many there were, and how many seconds it took."""
    made, killed, start = {}, 0, time.monotonic()
    while True:
        seconds = chance.uniform(0.0, most_seconds) if killed < kills else None
        code, units = run(bake + ["--work", work, "--progress=json"], seconds)
        for unit in units:
            key = (unit["stage"], unit["round"], unit["unit"])
            if not unit["found"]:
                made[key] = made.get(key, 0) + 1
        if code == 0:
            twice = [key for key, times in made.items() if times > 1]
            if twice:
                sys.exit("made more than once: %s" % twice)
            return killed, time.monotonic() - start
        killed += 1
        if os.path.exists(field):
            check_field(field, wanted)
            made.clear()


def main(folder, kills, seed, program, *options):
    kills, chance = int(kills), random.Random(int(seed))
    field, work = os.path.join(folder, "field.olx"), os.path.join(folder, "work")
    bake = [program, "bake", *options, "-o", field]
    start = time.monotonic()
    run(bake + ["--no-work"])
    seconds, wanted, bakes = time.monotonic() - start, read(field), 0
    while kills > 0:
        os.remove(field)
        killed, took = bake_with_kills(bake, field, wanted, work, seconds, kills, chance)
        kills, bakes = kills - killed, bakes + 1
        if killed == 0:
            seconds = min(seconds, took)  # the machine was busier when the first bake was timed
        check_field(field, wanted)
        if os.listdir(folder) != ["field.olx"]:
            sys.exit("left behind: %s" % os.listdir(folder))
    print("%d bakes of %.2f s each" % (bakes, seconds))


main(*sys.argv[1:])
