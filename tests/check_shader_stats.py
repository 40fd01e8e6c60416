#!/usr/bin/env python3
"""Hold what a compiler made of each pipeline against tests/shader_bounds.tsv.

Usage: check_shader_stats.py BOUNDS STATISTICS, the latter a line of JSON for each chip as scripts/shader_stats.sh prints them. Prints what
is above its bound, and exits with 1 when anything is, or when a pipeline is missing on either side.
"""

import json
import sys

LIMITS = {"Spilled VGPRs": 0, "Scratch size": 0, "Spilled SGPRs": 32, "Code size": 32768}
CHIPS = ("NAVI21", "POLARIS10")  # chips in the order of the table's columns
DEFAULT_FRAME = ("irradiance", "glossy", "dim", "accumulate", "filter", "composite")


def read_bounds(path):
    """Name of a pipeline to its bounds, one dictionary a chip."""
    bounds = {}
    for line in open(path, encoding="utf-8"):
        if line.startswith("#"):
            continue
        name, *numbers = line.rstrip("\n").split("\t")
        chips = [numbers[i : i + 2] for i in range(0, len(numbers), 2)]
        bounds[name] = [{"VGPRs": int(registers), "Code size": int(code)} for registers, code in chips]
    return bounds


def faults_of(chip, device, bounds, found, quick):
    """What one chip's pipelines have too much of. A quick report leaves out variants and the baseline."""
    if quick:
        bounds = {name: limits for name, limits in bounds.items() if "," not in name and name != "classic"}
    for name in sorted(set(bounds) ^ set(found)):
        yield f"{device}: {name} is in the table or among the pipelines, but not in both"
    for name in sorted(set(bounds) & set(found)):
        for limits in (LIMITS, bounds[name][chip]):
            for what, most in limits.items():
                if found[name][what] > most:
                    yield f"{device}: {name}: {what} is {found[name][what]}, at most {most} allowed"


def main():
    bounds = read_bounds(sys.argv[1])
    faults = []
    for line in open(sys.argv[2], encoding="utf-8"):
        report = json.loads(line)
        found = report["pipelines"]
        chip = next(i for i, name in enumerate(CHIPS) if name in report["device"].upper())
        faults += faults_of(chip, report["device"], bounds, found, report["quick"])
        seconds = sum(found[name]["processor seconds"] for name in DEFAULT_FRAME if name in found)
        print(f"{report['device']}: {len(found)} pipelines; those of the default frame took {seconds:.2f} s")
    print(*faults, sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
