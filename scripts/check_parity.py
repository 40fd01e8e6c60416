#!/usr/bin/env python3
"""Check that every function of shaders/lib is held to its C twin: it has a number in tests/parity_rows.h, a call in a
tests/parity_*.comp and an evaluation in a tests/test_parity_*.c, or, for those of classic.glsl, the same in the files of
parity_classic, and no row is left without its function.

Usage: check_parity.py [ROOT]. Prints every violation and exits with 1 when there is one.
"""

import pathlib
import re
import sys

FUNCTION = re.compile(r"^\w+ (\w+)\(", re.MULTILINE)
NUMBER = re.compile(r"^#define ROW_(\w+) (\d+)$", re.MULTILINE)


def read(root, pattern):
    """All files of that name; those of classic maps only where they are named."""
    paths = [path for path in sorted((root / "tests").glob(pattern)) if "classic" in pattern or "classic" not in path.name]
    return "\n".join(path.read_text(encoding="utf-8") for path in paths)


def check_rows(root, names, files, functions):
    """Faults of the files of a parity test, which hold the rows of these functions."""
    faults = []
    numbers = dict(NUMBER.findall(read(root, f"{names}_rows.h")))
    calls = set(re.findall(r"case ROW_(\w+):", read(root, f"{files}.comp")))
    test = read(root, f"test_{files}.c")
    evaluations = {"olx_" + name for name in re.findall(r"^ +PARITY\((\w+),", test, re.MULTILINE)}
    places = ((f"{names}_rows.h", set(numbers)), (f"{files}.comp", calls), (f"test_{files}.c", evaluations))
    for place, rows in places:
        faults += [f"{functions[name]}: {name} has no row in {place}" for name in functions if name not in rows]
        faults += [f"{place}: {name} is no function of shaders/lib" for name in sorted(rows - set(functions))]
    if sorted(map(int, numbers.values())) != list(range(len(numbers))):
        faults.append(f"{names}_rows.h: the rows are not numbered from 0 without gaps")
    return faults


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    functions, faults = {}, []
    for path in sorted((root / "shaders/lib").glob("*.glsl")):
        for name in FUNCTION.findall(path.read_text(encoding="utf-8")):
            functions[name] = path.name
            if not name.startswith("olx_"):
                faults.append(f"{path.name}: {name} does not begin with olx_, and could clash with a host's names")
    for names, files in (("parity", "parity_*"), ("parity_classic", "parity_classic")):
        rows = [name for name in functions if (functions[name] == "classic.glsl") == (names == "parity_classic")]
        faults += check_rows(root, names, files, {name: functions[name] for name in rows})
    for fault in faults:
        print(fault)
    print(f"{len(functions)} functions, {len(faults)} violations")
    return 1 if faults or not functions else 0


if __name__ == "__main__":
    sys.exit(main())
