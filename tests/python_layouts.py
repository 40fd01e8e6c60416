"""Holds the Python package's structures, enumerators and prototypes to the public headers: python_layouts.py INCLUDE-FOLDER.

A C program prints the size of every structure and the place and size of every member that octalux.native declares, and the value of
every enumerator. Names of members, and the parameters of functions, are read from the headers' text.
"""

import ctypes
import pathlib
import re
import subprocess
import sys
import tempfile

from octalux import native

HEADERS = ("octalux.h", "scene.h", "place.h", "bake.h", "render.h")


def c_name(struct):
    return "olx_" + re.sub(r"(?<!^)(?=[A-Z])", "_", struct.__name__).lower()


STRUCTS = {c_name(s): s for s in native.Struct.__subclasses__() if s is not native.Opaque}
NUMBERS = {"float": ctypes.c_float, "double": ctypes.c_double, "bool": ctypes.c_bool, "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64,
           "char": ctypes.c_char, "size_t": ctypes.c_size_t, "olx_result": ctypes.c_int, "void": None}


def program():
    """C that prints a line for each fact."""
    lines = [f"#include <octalux/{header}>" for header in HEADERS] + ["#include <stdio.h>", "int main(void) {"]
    for name, struct in STRUCTS.items():
        lines.append(f'  printf("{name} %zu\\n", sizeof({name}));')
        for member, _ in struct._fields_:
            lines.append(f'  printf("{name}.{member} %zu %zu\\n", offsetof({name}, {member}), sizeof((({name} *)0)->{member}));')
    for prefix, words in native.ENUMERATORS.values():
        for word in words:
            lines.append(f'  printf("{prefix}{word.upper()} %d\\n", {prefix}{word.upper()});')
    for result in native.Result:
        name = "OLX_OK" if result == 0 else f"OLX_ERROR_{result.name}"
        lines.append(f'  printf("{name} %d\\n", {name});')
    lines.append('  printf("OLX_BOUNCES_INFINITE %u\\n", OLX_BOUNCES_INFINITE);')
    return "\n".join(lines + ["}", ""])


def facts_of_c(include):
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / "layouts.c"
        source.write_text(program())
        subprocess.run(["cc", "-std=c17", "-I", include, source, "-o", f"{folder}/layouts"], check=True)
        output = subprocess.run([f"{folder}/layouts"], check=True, capture_output=True, text=True).stdout
    return {line.split()[0]: tuple(int(n) for n in line.split()[1:]) for line in output.splitlines()}


def facts_of_python():
    facts = {}
    for name, struct in STRUCTS.items():
        facts[name] = (ctypes.sizeof(struct),)
        for member, _ in struct._fields_:
            facts[f"{name}.{member}"] = (getattr(struct, member).offset, getattr(struct, member).size)
    for prefix, words in native.ENUMERATORS.values():
        facts.update({prefix + word.upper(): (value,) for value, word in enumerate(words)})
    facts.update({"OLX_OK" if r == 0 else f"OLX_ERROR_{r.name}": (int(r),) for r in native.Result})
    facts["OLX_BOUNCES_INFINITE"] = (native.BOUNCES_INFINITE,)
    return facts


def headers_text(include):
    return re.sub(r"//[^\n]*", "", "\n".join(path.read_text() for path in sorted(pathlib.Path(include, "octalux").glob("*.h"))))


def members(text, struct):
    """Names of a structure's members, in their order."""
    body = re.search(r"typedef struct %s \{(.*?)\n\} %s;" % (struct, struct), text, re.S).group(1)
    names = []
    for declaration in body.split(";"):
        function = re.search(r"\(\*(\w+)\)", declaration)
        listed = [function.group(1)] if function else re.findall(r"(\w+)(?:\[\w+\])?\s*(?:,|$)", declaration.strip())
        names += listed
    return names


def enumerators(text, kind):
    """How many enumerators there are of a kind, those that count the others left out."""
    body = re.search(r"typedef enum olx_%s \{(.*?)\} olx_%s;" % (kind, kind), text, re.S).group(1)
    return len([name for name in re.findall(r"\bOLX_\w+", body) if not name.endswith("_COUNT")])


def agrees(parameter, argument):
    """Whether a parameter or result, as C declares it, is what ctypes was told."""
    words = re.sub(r"\bconst\b", "", parameter).replace("*", " * ").split()
    kind, stars = words[0], words.count("*") + ("[" in parameter)
    if kind == "char" and stars == 1:
        return argument is ctypes.c_char_p
    if stars:
        for _ in range(stars):
            if not hasattr(argument, "_type_") or isinstance(argument._type_, str):
                return False
            argument = argument._type_
        return name_of(argument) == kind or argument is NUMBERS.get(kind)
    return argument is NUMBERS[kind] if kind in NUMBERS else name_of(argument) == kind or argument is ctypes.c_uint32


def name_of(argument):
    if argument is None or not issubclass(argument, native.Struct):
        return None
    return argument.__doc__ if issubclass(argument, native.Opaque) else c_name(argument)


def prototype_faults(text):
    for function, (result, arguments) in {**native.RUNTIME, **native.BAKER}.items():
        declared = re.search(r"^((?:const )?\w+ \*?)%s\(([^)]*)\);" % function, text, re.M)
        if not declared:
            yield f"{function} is in no header"
            continue
        parameters = [" ".join(p.split()) for p in declared.group(2).split(",")] if declared.group(2) != "void" else []
        if len(parameters) != len(arguments) or not agrees(declared.group(1), result):
            yield f"{function}: another result, or {len(arguments)} arguments where there are {len(parameters)}"
        yield from (f"{function}: '{p}' is not {a}" for p, a in zip(parameters, arguments) if not agrees(p, a))


def faults(include):
    ours, theirs, text = facts_of_python(), facts_of_c(include), headers_text(include)
    yield from (f"{name}: {ours[name]} where C has {theirs.get(name)}" for name in ours if ours[name] != theirs.get(name))
    for name, struct in STRUCTS.items():
        if [member for member, _ in struct._fields_] != members(text, name):
            yield f"{name}: members {members(text, name)}"
    for kind, (_, words) in native.ENUMERATORS.items():
        if len(words) != enumerators(text, kind):
            yield f"olx_{kind}: {enumerators(text, kind)} enumerators where Python knows {len(words)}"
    if len(native.Result) != enumerators(text, "result"):
        yield "olx_result: another number of results"
    yield from prototype_faults(text)


def main():
    found = list(faults(sys.argv[1]))
    print("\n".join(found))
    print(f"{len(STRUCTS)} structures, {len(native.ENUMERATORS)} enumerations, {len(native.RUNTIME) + len(native.BAKER)} functions, "
          f"{len(found)} that differ")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
