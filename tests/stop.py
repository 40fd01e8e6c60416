"""Starts a command, sends it a signal, and checks that it stops: stop.py FOLDER SIGNAL SECONDS COMMAND...

The exit code must be 128 + the signal's number, one line on standard error must say "interrupted", and FOLDER, where
the command runs and has its temporary files, must be as before. A second of an idle machine is allowed; on a busy one
ten, as long as the processor's time stays below that of two busy processors in a second and a bit."""
import os, resource, signal, subprocess, sys, time

MOST_SECONDS, MOST_PROCESSOR_SECONDS = 10.0, 2.5


def processor_seconds(process):
    with open("/proc/%d/stat" % process.pid) as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def entries(folder):
    return sorted(os.path.join(path, name) for path, folders, names in os.walk(folder) for name in folders + names)


def main(folder, name, seconds, *command):
    number, before = getattr(signal, "SIG" + name), entries(folder)
    what = "%s after %s s of %s" % (name, seconds, " ".join(command[1:]))
    environment = dict(os.environ, TMPDIR=folder)
    with open(os.devnull, "w") as nowhere:
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=nowhere, stderr=subprocess.PIPE)
    # Waits by processor time, so that a bake gets equally far on a busy machine; work that waits has ten times as long.
    end = time.monotonic() + 10.0 * float(seconds) + 1.0
    while process.poll() is None and processor_seconds(process) < float(seconds) and time.monotonic() < end:
        time.sleep(0.01)
    if process.poll() is not None:
        sys.exit("%s: it ended before: %s" % (what, process.stderr.read().decode()))
    used, start = processor_seconds(process), time.monotonic()
    process.send_signal(number)
    try:
        process.wait(timeout=MOST_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        sys.exit("%s: it still runs %g s later" % (what, MOST_SECONDS))
    waited = time.monotonic() - start
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = usage.ru_utime + usage.ru_stime - used
    print("%s: %.2f s, %.2f s of processors" % (what, waited, spent))
    message = process.stderr.read().decode()
    if process.returncode != 128 + number:
        sys.exit("%s: exit code %d: %s" % (what, process.returncode, message))
    if spent > MOST_PROCESSOR_SECONDS:
        sys.exit("%s: it went on for %.2f s of processors" % (what, spent))
    if not message.strip().endswith("interrupted") and "interrupted, nothing written" not in message:
        sys.exit("%s: it does not say that it was interrupted: %s" % (what, message))
    if entries(folder) != before:
        sys.exit("%s: left behind: %s" % (what, set(entries(folder)) - set(before)))


main(*sys.argv[1:])
