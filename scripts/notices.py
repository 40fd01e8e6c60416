#!/usr/bin/env python3
"""Write the notices of a package: our licence, the libraries that the package contains, with their notices as Debian has them,
those of the page of `export web`, whose notices lie beside it, and those that it loads.

Usage: notices.py SOURCE-FOLDER PACKAGE OUTPUT. PACKAGE is a column entry of cmake/third_party.tsv.
"""

import pathlib
import sys


def libraries_of(source, package):
    lines = (source / "cmake/third_party.tsv").read_text(encoding="utf-8").splitlines()
    rows = [line.split("\t") for line in lines if not line.startswith("#")]
    return [row[1:] for row in rows if package in row[0].split(",")]


def contained(library, licence, debian):
    notice = pathlib.Path("/usr/share/doc", debian, "copyright").read_text(encoding="utf-8")
    indented = "".join(("  " + line).rstrip() + "\n" for line in notice.splitlines())
    return f"{library}: {licence}. Its notice, which Debian's {debian} has for all of its source:\n\n{indented}\n"


def main():
    source, package, output = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    libraries = libraries_of(source, package)
    text = "Octalux\n\n" + (source / "LICENSE").read_text(encoding="utf-8")
    inside = [(row[0], row[2], row[4]) for row in libraries if row[1] == "contains"]
    paged = [(row[0], row[2], row[4]) for row in libraries if row[1] == "page"]
    loaded = [(row[0], row[2], row[4]) for row in libraries if row[1] == "loads"]
    if inside:
        text += "\nContained libraries of others\n\n" + "".join(contained(*row) for row in inside)
    if paged:
        text += "\nLibraries of others in the page of `octalux export web`, where the package has it\n\n"
        text += "".join(f"{name}: {licence}; /usr/share/octalux/web/{notice}\n" for name, licence, notice in paged)
    if loaded:
        text += "\nLibraries of others that are loaded, or linked by those who link the static libraries\n\n"
        text += "".join(f"{name}: {licence}; /usr/share/doc/{debian}/copyright\n" for name, licence, debian in loaded)
    output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
