#!/usr/bin/env python3
"""Check that every function of shaders/lib is held to its C twin: it has a number in tests/parity_rows.h, a call in a
tests/parity_*.comp and an evaluation in a tests/test_parity_*.c, and no row is left without its function.

Usage: check_parity.py [ROOT]. Prints every violation and exits with 1 when there is one.
"""

import pathlib
import re
import sys

FUNCTION = re.compile(r"^\w+ (\w+)\(", re.MULTILINE)
# The parts of a shader for WebGL2, up to those for Vulkan in their place: no parity test runs in WebGL2.
WEB = re.compile(r"^#ifdef GL_ES$.*?^#(else|endif)$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"^#define ROW_(\w+) (\d+)$", re.MULTILINE)


def read(root, pattern):
    """All files of that name."""
    return "\n".join(path.read_text(encoding="utf-8") for path in sorted((root / "tests").glob(pattern)))


def check_rows(root, functions):
    """Faults of the files of the parity tests, which hold the rows of these functions."""
    faults = []
    numbers = dict(NUMBER.findall(read(root, "parity_rows.h")))
    calls = set(re.findall(r"case ROW_(\w+):", read(root, "parity_*.comp")))
    test = read(root, "test_parity_*.c")
    evaluations = {"olx_" + name for name in re.findall(r"^ +PARITY\((\w+),", test, re.MULTILINE)}
    places = (("parity_rows.h", set(numbers)), ("parity_*.comp", calls), ("test_parity_*.c", evaluations))
    for place, rows in places:
        faults += [f"{functions[name]}: {name} has no row in {place}" for name in functions if name not in rows]
        faults += [f"{place}: {name} is no function of shaders/lib" for name in sorted(rows - set(functions))]
    if sorted(map(int, numbers.values())) != list(range(len(numbers))):
        faults.append("parity_rows.h: the rows are not numbered from 0 without gaps")
    return faults


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    functions, faults = {}, []
    for path in sorted((root / "shaders/lib").glob("*.glsl")):
        for name in FUNCTION.findall(WEB.sub("", path.read_text(encoding="utf-8"))):
            functions[name] = path.name
            if not name.startswith("olx_"):
                faults.append(f"{path.name}: {name} does not begin with olx_, and could clash with a host's names")
    faults += check_rows(root, functions)
    for fault in faults:
        print(fault)
    print(f"{len(functions)} functions, {len(faults)} violations")
    return 1 if faults or not functions else 0


if __name__ == "__main__":
    sys.exit(main())
