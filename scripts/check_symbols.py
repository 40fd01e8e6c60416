#!/usr/bin/env python3
"""Check what the libraries ask for and what they show.

The shared runtime needs nothing but libc, libm and threads, and exports exactly the functions of its public headers.
Every global symbol of the static libraries begins with olx_, so that they clash with nothing a host links; weak ones, of
C++ templates, clash with nothing. None is defined twice, which a linker of static libraries does not notice. No library
can end its host by an assertion, unless --debug says that this is a debug build.

The shared baker, beside static libraries, exports the functions of all public headers and nothing else.

Usage: check_symbols.py [--debug] INCLUDE-DIR LIBRARY.so RUNTIME.a BAKE.a BAKE.so [HEADER...]; HEADERs are public ones
of the runtime that this build has beside those it always has.
"""

import collections
import pathlib
import re
import subprocess
import sys

NEEDED = re.compile(r"^(libc\.so|libm\.so|libpthread\.so|libdl\.so|librt\.so|ld-linux|ld-musl|libgcc_s\.so)")
RUNTIME_HEADERS = ["base.h", "denoiser.h", "field.h", "light.h", "relight.h", "sample.h", "octalux.h"]
BAKER_HEADERS = ["bake.h", "export.h", "place.h", "render.h", "scene.h"]


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def definitions(library, *options, weak=True):
    lines = output("nm", "--defined-only", "--extern-only", "--format=posix", *options, library).splitlines()
    words = [line.split() for line in lines]
    return [word[0] for word in words if len(word) >= 2 and (weak or word[1] not in "WVu")]


def defined(library, *options, weak=True):
    return set(definitions(library, *options, weak=weak))


def declared(include, more):
    names = set()
    for header in more:
        text = re.sub(r"//[^\n]*", "", (include / header).read_text())
        # A declaration begins in the first column; members of a struct do not.
        names |= set(re.findall(r"^[A-Za-z][\w\s*]*?\b(olx_\w+)\(", text, re.MULTILINE))
    return names


def main():
    debug = sys.argv[1] == "--debug"
    arguments = sys.argv[2:] if debug else sys.argv[1:]
    include, shared, runtime, bake, shared_bake = pathlib.Path(arguments[0]), *arguments[1:5]
    runtime_headers = RUNTIME_HEADERS + arguments[5:]
    faults = []
    for line in output("readelf", "--dynamic", "--wide", shared).splitlines():
        match = re.search(r"\(NEEDED\).*\[(.+)\]", line)
        if match and not NEEDED.match(match.group(1)):
            faults.append(f"the runtime needs {match.group(1)}")
    # Symbols of libc and libm have a version (memcpy@GLIBC_2.14).
    for line in output("nm", "--dynamic", "--undefined-only", "--format=posix", shared).splitlines():
        name, kind = line.split()[:2]
        if kind == "U" and "@" not in name:
            faults.append(f"the runtime does not define {name}")
    for library, headers in ((shared_bake, runtime_headers + BAKER_HEADERS), (shared, runtime_headers)):
        exported, public = defined(library, "--dynamic"), declared(include, headers)
        stem = pathlib.Path(library).name
        faults += [f"exported by {stem}, but in no public header: {name}" for name in sorted(exported - public)]
        faults += [f"in a public header, but not exported by {stem}: {name}" for name in sorted(public - exported)]
    for library in (runtime, bake):
        foreign = sorted(name for name in defined(library, weak=False) if not name.startswith("olx_") and not name.endswith(":"))
        faults += [f"{pathlib.Path(library).name} defines {name}" for name in foreign]
        if not debug and re.search(r"\b__assert", output("nm", "--undefined-only", "--format=posix", library)):
            faults.append(f"{pathlib.Path(library).name} asserts, but this is no debug build")
    own = collections.Counter(definitions(runtime, weak=False) + definitions(bake, weak=False))
    faults += [f"defined {count} times: {name}" for name, count in sorted(own.items()) if count > 1]
    for fault in faults:
        print(fault)
    print(f"{len(exported)} exported functions, {len(public)} declared, {len(faults)} violations")
    return 1 if faults or not public else 0


if __name__ == "__main__":
    sys.exit(main())
