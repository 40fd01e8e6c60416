#!/usr/bin/env python3
"""Check that every function of shaders/lib is held to its C twin: it has a number in tests/parity_rows.h, a call in a
tests/parity_*.comp and an evaluation in a tests/*_parity_*.c, and no row is left without its function. A file of
shaders/lib says in its opening comment of which file of src it is the twin, one with the same stem that names it in
turn, or that it has no twin. Numbers that shaders/octalux_shared.h repeats of an enumeration of C equal it, and shaders
of the library and its passes define no constant that C defines as well: such constants are in octalux_shared.h.

Usage: check_parity.py [ROOT]. Prints every violation and exits with 1 when there is one.
"""

import pathlib
import re
import sys

FUNCTION = re.compile(r"^\w+ (\w+)\(", re.MULTILINE)
# Matches what only WebGL2 compiles of a shader. No parity test runs in WebGL2.
WEB = re.compile(r"^#ifdef GL_ES$.*?^#(else|endif)$", re.MULTILINE | re.DOTALL)
# A twin: one file, or all files of the folder that has the shader's stem for its name.
TWIN = re.compile(r"Twin of (src/\w+/(\w+)\.[ch]|src/(\w+)/\*\.c)\b")
SHARED = re.compile(r"^#define (OLX_\w+) (0x[0-9A-Fa-f]+|\d+)u?\b", re.MULTILINE)
# Constants of a shader at file level, and macros and constants of a file of C; C's names may begin with olx_.
SHADER_CONSTANTS = re.compile(r"^const (?:float|u?int|[iu]?vec[234]) ([^;(]*=[^;]*);", re.MULTILINE)
C_CONSTANT = re.compile(r"^(?:static const \w+|#define) (\w+)(?: = | [-0-9(])", re.MULTILINE)
NUMBER = re.compile(r"^#define ROW_(\w+) (\d+)$", re.MULTILINE)


def read(root, pattern):
    """All files of that name."""
    return "\n".join(path.read_text(encoding="utf-8") for path in sorted((root / "tests").glob(pattern)))


def check_rows(root, functions):
    """Faults of the files of the parity tests, which hold the rows of these functions."""
    faults = []
    numbers = dict(NUMBER.findall(read(root, "parity_rows.h")))
    calls = set(re.findall(r"case ROW_(\w+):", read(root, "parity_*.comp")))
    test = read(root, "*_parity_*.c")
    evaluations = {"olx_" + name for name in re.findall(r"^ +PARITY\((\w+),", test, re.MULTILINE)}
    places = (("parity_rows.h", set(numbers)), ("parity_*.comp", calls), ("*_parity_*.c", evaluations))
    for place, rows in places:
        faults += [f"{functions[name]}: {name} has no row in {place}" for name in functions if name not in rows]
        faults += [f"{place}: {name} is no function of shaders/lib" for name in sorted(rows - set(functions))]
    if sorted(map(int, numbers.values())) != list(range(len(numbers))):
        faults.append("parity_rows.h: the rows are not numbered from 0 without gaps")
    return faults


def opening(path):
    """The words of the comment that a file opens with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    ends = [i for i, line in enumerate(lines) if not line.startswith("//")]
    return " ".join(line[2:].strip() for line in lines[: ends[0]])


def enumerators(text):
    """The values of the enumerators in C: pairs of name and value, where the value is a number or follows one."""
    for body in re.findall(r"\benum\b[^{};]*\{([^}]*)\}", re.sub(r"//[^\n]*", "", text)):
        value = -1
        for entry in filter(None, (part.strip() for part in body.split(","))):
            name, _, given = (word.strip() for word in entry.partition("="))
            if given:
                value = int(given, 0) if re.fullmatch(r"0x[0-9A-Fa-f]+|\d+", given) else None
            elif value is not None:
                value += 1
            if value is not None:
                yield name, value


def check_enumerations(root):
    """Faults of the numbers that octalux_shared.h repeats, because public headers cannot include it."""
    headers = [*(root / "include/octalux").glob("*.h"), *(root / "src").glob("*/*.h")]
    known = dict(pair for path in headers for pair in enumerators(path.read_text(encoding="utf-8")))
    shared = SHARED.findall((root / "shaders/octalux_shared.h").read_text(encoding="utf-8"))
    if not any(name in known for name, _ in shared):
        yield "octalux_shared.h: repeats no enumerator"
    for name, value in shared:
        if known.get(name, int(value, 0)) != int(value, 0):
            yield f"octalux_shared.h: {name} is {value}, but {known[name]} in C"


def c_constants(root):
    """The constants of the files of src, without the prefix of public names."""
    texts = [path.read_text(encoding="utf-8") for path in sorted((root / "src").glob("*/*.[ch]"))]
    names = {name for text in texts for name in C_CONSTANT.findall(text)}
    names |= {name for text in texts for name, _ in enumerators(text)}
    return {name.removeprefix("OLX_") for name in names}


def check_constants(root):
    """Faults of constants that a shader and C both define."""
    known = c_constants(root)
    if not known:
        yield "src: defines no constants"
    for folder in ("lib", "pass"):
        for path in sorted((root / "shaders" / folder).iterdir()):
            for constants in SHADER_CONSTANTS.findall(path.read_text(encoding="utf-8")):
                for name in re.findall(r"(\w+) =", constants):
                    if name.removeprefix("OLX_") in known:
                        yield f"shaders/{folder}/{path.name}: {name} is a constant of C as well, and belongs in octalux_shared.h"


def check_twin(root, path):
    """Faults of what a file of shaders/lib says of its twin."""
    name, words = f"shaders/lib/{path.name}", opening(path)
    if "no twin in C" in words:
        return []
    twin = TWIN.search(words)
    if not twin:
        return [f"{name}: does not say of which file it is the twin, or that it has no twin in C"]
    file, stem, folder = twin.groups()
    if (stem or folder) != path.stem or not list(root.glob(file)):
        return [f"{name}: its twin {file} has another stem, or is not there"]
    return [] if folder or name in opening(root / file) else [f"{file}: does not name its twin {name}"]


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    functions, faults = {}, []
    for path in sorted((root / "shaders/lib").glob("*.glsl")):
        faults += check_twin(root, path)
        for name in FUNCTION.findall(WEB.sub("", path.read_text(encoding="utf-8"))):
            functions[name] = path.name
            if not name.startswith("olx_"):
                faults.append(f"{path.name}: {name} does not begin with olx_, and could clash with a host's names")
    faults += check_rows(root, functions)
    faults += check_enumerations(root)
    faults += check_constants(root)
    for fault in faults:
        print(fault)
    print(f"{len(functions)} functions, {len(faults)} violations")
    return 1 if faults or not functions else 0


if __name__ == "__main__":
    sys.exit(main())
