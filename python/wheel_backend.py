#!/usr/bin/env python3
"""Makes the wheel: wheel_backend.py BUILD-FOLDER OUTPUT-FOLDER, or as what pyproject.toml names, with the build folder in OCTALUX_BUILD
(default: build/release of the checkout). Nothing but Python is needed. The same libraries make the same bytes.
"""

import base64
import hashlib
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
LIBRARIES = ("liboctalux.so", "liboctalux-bake.so")
# Libraries whose sources are compiled into ours, and where Debian keeps their licences.
COMPILED_IN = {"xxHash": "/usr/share/doc/libxxhash-dev/copyright", "stb": "/usr/share/doc/libstb-dev/copyright"}
DATE = (1980, 1, 1, 0, 0, 0)


def version():
    text = (HERE.parent / "include/octalux/base.h").read_text()
    return ".".join(re.search(rf"OLX_VERSION_{part} (\d+)", text).group(1) for part in ("MAJOR", "MINOR", "PATCH"))


def tag():
    return f"py3-none-linux_{platform.machine()}"


def info_folder():
    return f"octalux-{version()}.dist-info"


def metadata():
    return (f"Metadata-Version: 2.1\nName: octalux\nVersion: {version()}\n"
            "Summary: Real-time global illumination from precomputed light field probes\nLicense: MIT\n"
            "License-File: LICENSE\nRequires-Python: >=3.9\nRequires-Dist: numpy\n"
            "Description-Content-Type: text/markdown\n\n" + (HERE / "README.md").read_text())


def library_bytes(folder, name):
    """A library of the build, without what only debuggers read."""
    found = next((path for path in (folder / "src" / name, folder / name) if path.exists()), None)
    if found is None:
        raise SystemExit(f"wheel_backend: {folder}: no {name}; build it first, or name its build folder")
    with tempfile.TemporaryDirectory() as place:
        stripped = pathlib.Path(place, name)
        if shutil.which("strip"):
            subprocess.run(["strip", "--strip-debug", "-o", stripped, found], check=True)
        return (stripped if stripped.exists() else found).read_bytes()


def contents(folder):
    """Names in the wheel, and what they hold."""
    files = {f"octalux/{path.name}": path.read_bytes() for path in sorted((HERE / "octalux").iterdir()) if path.suffix in (".py", ".typed")}
    files.update({f"octalux/lib/{name}": library_bytes(folder, name) for name in LIBRARIES})
    info = info_folder()
    files[f"{info}/LICENSE"] = (HERE.parent / "LICENSE").read_bytes()
    for name, path in COMPILED_IN.items():
        if not pathlib.Path(path).exists():
            raise SystemExit(f"wheel_backend: {path}: missing; the wheel must contain the notice of {name}")
        files[f"{info}/licenses/{name}.txt"] = pathlib.Path(path).read_bytes()
    files[f"{info}/METADATA"] = metadata().encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: octalux\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode()
    return files


def record_line(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def write_wheel(folder, output):
    """Writes the wheel beside its name, then puts it there; returns its path."""
    files = contents(pathlib.Path(folder))
    record = f"{info_folder()}/RECORD"
    files[record] = ("".join(record_line(name, data) for name, data in files.items()) + f"{record},,\n").encode()
    path = pathlib.Path(output) / f"octalux-{version()}-{tag()}.whl"
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".part")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, DATE)
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    partial.replace(path)
    return path


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """PEP 517."""
    folder = os.environ.get("OCTALUX_BUILD", HERE.parent / "build/release")
    return write_wheel(folder, wheel_directory).name


def build_sdist(sdist_directory, config_settings=None):
    """PEP 517: there is none, because the libraries are built by CMake from the whole checkout."""
    raise SystemExit("wheel_backend: no source distribution; build a wheel")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: wheel_backend.py BUILD-FOLDER OUTPUT-FOLDER")
    print(write_wheel(sys.argv[1], sys.argv[2]))
