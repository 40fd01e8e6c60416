#!/usr/bin/env python3
"""Check the order of the house: who may include whom, openings, file names, links, and words that do not belong here.

Folders under src form a ladder; a file may include its own folder and those before it:
core < block < field < select < trace < shade < relight < vulkan (the runtime) < scene < place < work < light < bake < render < export (the baker).
Folders under src/light form one of their own: surfels < links < solution < files beside them.
Public headers stand on the same ladder. cli, viewer, host, capture, bench and examples see public headers only; cli,
viewer, capture and bench those of host as well, cli and bench those of capture, viewer and bench what programs share
of cli, bench/gpu the viewer's rasteriser, and bench/studies what is inside the libraries. Public headers see public headers only, and the runtime knows no library but libc, libm, POSIX
threads and xxHash, which is inlined. Files, a file being a .c and a .h of one name, do not include each other in
circles. Every .c opens with a comment that says in a sentence what it is for. Links in Markdown files lead to files of
the tree, and to headings that are there.

Usage: check_layers.py [ROOT]. Prints every violation and exits with 1 when there is one.
"""

import collections
import pathlib
import re
import subprocess
import sys

RUNTIME = ["core", "block", "field", "select", "trace", "shade", "relight", "vulkan"]
LADDER = RUNTIME + ["scene", "place", "work", "light", "bake", "render", "export"]
LIGHT_ROOMS = ["surfels", "links", "solution"]

# The layer from which on a public header may be seen.
PUBLIC = {"base.h": "core", "limits.h": "core", "light.h": "core", "field.h": "field", "sample.h": "select", "denoiser.h": "shade", "relight.h": "relight",
          "octalux.h": "relight", "vulkan.h": "vulkan", "scene.h": "scene", "place.h": "place", "bake.h": "bake",
          "render.h": "render", "export.h": "export"}

SYSTEM = set("""assert.h complex.h ctype.h errno.h fcntl.h fenv.h float.h inttypes.h limits.h locale.h math.h pthread.h
sched.h setjmp.h signal.h stdalign.h stdarg.h stdatomic.h stdbool.h stddef.h stdint.h stdio.h stdlib.h stdnoreturn.h
string.h strings.h tgmath.h time.h unistd.h dirent.h poll.h sys/file.h sys/mman.h sys/stat.h sys/types.h sys/time.h
sys/resource.h sys/wait.h xxhash.h""".split())

SAME_NAME_ALLOWED = {"CMakeLists.txt", "README.md", "SOURCE.md", ".gitignore"}
CODE = {".c", ".h", ".cpp", ".hpp", ".glsl", ".comp", ".frag", ".vert"}
TEXT = CODE | {".md", ".txt", ".cmake", ".json", ".py", ".sh", ".in", ".yml", ""}

OWN_LICENCE = "// SPDX-License-Identifier: MIT"  # licence of files that are copied out of the repository
LICENCE_MARKS = re.compile(r"copyright|spdx-license|all rights reserved|licensed under|permission is hereby granted|"
                           r"@author|public domain", re.IGNORECASE)
UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK|stub|not implemented|placeholder)\b")
MACHINE_PATH = re.compile(r"(?<![\w.$}])/(home|root|Users|work|mnt)/[A-Za-z.]")

# Headers that programs share: those of octalux-console in cli.
CONSOLE = {"bake_options.h", "clock.h", "companion.h", "html_report.h", "options.h", "plot.h", "report.h",
           "sample_options.h", "scene_options.h", "stop.h"}

LINK = re.compile(r"\]\(([^)\s]*)\)")

OPENING_WORDS = 6  # least number of words of a source file's opening comment

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def tracked_files(root):
    listing = subprocess.run(["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                             capture_output=True)
    if listing.returncode == 0:
        names = [n for n in listing.stdout.decode().split("\0") if n]
    else:  # an unpacked release
        names = [str(p.relative_to(root)) for p in root.rglob("*") if p.is_file()]
        names = [n for n in names if not n.startswith(("build/", ".git/"))]
    return sorted(n for n in set(names) if (root / n).is_file() and not (root / n).is_symlink())


def includes(root, name):
    for number, line in enumerate((root / name).read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1) == "<", match.group(2)


def room_of(name):
    """The place in LIGHT_ROOMS of a file under src/light, given relative to src."""
    return LIGHT_ROOMS.index(name.split("/")[1]) if name.count("/") > 1 else len(LIGHT_ROOMS)


def check_source(name, angled, target):
    """An include in src/LAYER/..., or None when it is in order."""
    layer = name.split("/")[1]
    if layer not in LADDER:
        return f"src/{layer} is not a layer"
    if target.startswith("octalux/"):
        header = target[len("octalux/"):]
        if header not in PUBLIC:
            return f"<{target}> is not a known public header"
        if LADDER.index(PUBLIC[header]) > LADDER.index(layer):
            return f"{layer} may not include <{target}>, which belongs to {PUBLIC[header]}"
        return None
    if angled:
        if layer in RUNTIME and target not in SYSTEM and not (layer == "vulkan" and target.startswith("vulkan/")):
            return f"the runtime may not include <{target}>"
        return None
    other = target.split("/")[0]
    if target.endswith("octalux_shared.h") and target.count("/") <= 1:
        return None
    if layer == "vulkan" and target.endswith(".spv.inc"):  # shaders, compiled by the build
        return None
    if "/" not in target or other not in LADDER:
        return f'"{target}" is not relative to src'
    if LADDER.index(other) > LADDER.index(layer):
        return f'{layer} may not include "{target}"'
    if other == layer == "light" and room_of(target) > room_of(name.removeprefix("src/")):
        return f'{"/".join(name.split("/")[1:-1])} may not include "{target}"'
    return None


def check_public(name, angled, target):
    if target.startswith("octalux/"):
        header, own = target[len("octalux/"):], name.split("/")[-1]
        if header not in PUBLIC or own not in PUBLIC:
            return f"<{target}> is not a known public header"
        if LADDER.index(PUBLIC[header]) > LADDER.index(PUBLIC[own]):
            return f"may not include <{target}>"
        return None
    if angled and target in {"stdbool.h", "stddef.h", "stdint.h"}:
        return None
    if angled and name.endswith("/vulkan.h") and target.startswith("vulkan/"):
        return None
    return f"a public header may not include {target}"


def check_client(root, name, angled, target):
    if angled:
        return None
    folders = [(root / name).parent, root / name.split("/")[0]]  # the folders of the file itself and of its client
    if name.startswith(("cli/", "viewer/", "capture/", "bench/")):
        folders.append(root / "host")
    if name.startswith(("cli/", "bench/")):
        folders.append(root / "capture")
    for client, other in (("bench/gpu/", "viewer"), ("bench/studies/", "src")):
        if name.startswith(client):
            folders.append(root / other)
    if ".." not in target and any(folder.joinpath(target).is_file() for folder in folders):
        return None
    if name.startswith(("viewer/", "bench/")) and target in CONSOLE:
        return None
    if target.endswith(".spv.inc") or target == "lib/octalux.glsl":  # compiled shaders, or the shader library
        return None
    return f'"{target}" is neither a public header nor a neighbour'


def check_includes(root, names):
    for name in names:
        if pathlib.PurePath(name).suffix not in CODE:
            continue
        top = name.split("/")[0]
        for number, angled, target in includes(root, name):
            fault = None
            if top == "src":
                fault = check_source(name, angled, target)
            elif top == "include":
                fault = check_public(name, angled, target)
            elif top in ("host", "capture", "cli", "viewer", "bench", "examples"):
                fault = check_client(root, name, angled, target)
            if fault:
                yield f"{name}:{number}: {fault}"


def opening(path):
    """The words of the comment that a file opens with."""
    words = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("//"):
            break
        words += line[2:].split()
    return words


def check_openings(root, names):
    for name in names:
        if not name.endswith(".c"):
            continue
        words = opening(root / name)
        if len(words) < OPENING_WORDS or not any(word.endswith(".") for word in words):
            yield f"{name}:1: does not open with a sentence that says what the file is for"


def check_ends(root, names):
    for name in names:
        if pathlib.PurePath(name).suffix not in CODE:
            continue
        code = (root / name).read_bytes()
        if code and not code.endswith(b"\n"):
            yield f"{name}: does not end with a newline, without which clang refuses it"


def find_included(names, name, target):
    """The file of the tree that a quoted include means, or None."""
    here, top = pathlib.PurePosixPath(name).parent, name.split("/")[0]
    for folder in (here, top, "src", "host", "capture", "cli", "viewer"):
        found = str(pathlib.PurePosixPath(folder, target))
        if found in names:
            return found
    return None


def include_graph(root, names):
    """What each file, a .c and a .h of one name, includes: {stem: {stem: "FILE:LINE"}}."""
    known, graph = set(names), collections.defaultdict(dict)
    for name in names:
        if not name.endswith((".c", ".h")):
            continue
        for number, angled, target in includes(root, name):
            found = None if angled else find_included(known, name, target)
            if found and found[:-2] != name[:-2]:
                graph[name[:-2]].setdefault(found[:-2], f"{name}:{number}")
    return graph


def find_circle(graph, start, allowed):
    """The shortest way from a file back to itself by way of files of `allowed`, or None."""
    came_from, queue = {}, collections.deque([start])
    while queue:
        file = queue.popleft()
        for other in sorted(graph.get(file, {})):
            if other == start:
                way = [start, file]
                while way[-1] != start:
                    way.append(came_from[way[-1]])
                return way[::-1]
            if other in allowed and other not in came_from:
                came_from[other] = file
                queue.append(other)
    return None


def check_circles(root, names):
    graph = include_graph(root, names)
    left = set(graph)
    for start in sorted(graph):
        left.discard(start)  # so that circles through it are reported once
        way = find_circle(graph, start, left)
        if way:
            yield f"{graph[way[0]][way[1]]}: includes in a circle: {' -> '.join(way)}"


def check_names(names):
    places = collections.defaultdict(list)
    for name in names:
        if name.startswith("docs/"):
            continue
        places[pathlib.PurePath(name).name].append(name)
    for base, where in sorted(places.items()):
        if len(where) > 1 and base not in SAME_NAME_ALLOWED:
            yield f"{where[0]}: the name {base} is taken more than once: {', '.join(where[1:])}"


def headings(path):
    """The anchors of a Markdown file's headings, as GitHub makes them."""
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            yield re.sub(r"[^\w\- ]", "", line.lstrip("# ").strip().lower()).replace(" ", "-")


def check_links(root, names):
    known = {root / n for n in names}
    known |= {folder for file in known for folder in file.parents}
    for name in names:
        if not name.endswith(".md"):
            continue
        for number, line in enumerate((root / name).read_text(encoding="utf-8").splitlines(), 1):
            for link in LINK.findall(line):
                if re.match(r"[a-z]+:", link):
                    continue
                file, _, heading = link.partition("#")
                target = (root / name).parent.joinpath(file).resolve() if file else root / name
                if target not in known or (heading and heading not in headings(target)):
                    yield f"{name}:{number}: a link to {link}, which is not there"


def check_words(root, names):
    own = "scripts/" + pathlib.Path(__file__).name
    for name in names:
        if pathlib.PurePath(name).suffix not in TEXT or name == own:
            continue
        try:
            lines = (root / name).read_text(encoding="utf-8").splitlines()
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(lines, 1):
            if pathlib.PurePath(name).suffix in CODE and line != OWN_LICENCE and LICENCE_MARKS.search(line):
                yield f"{name}:{number}: a licence mark: is this code from elsewhere?"
            if UNFINISHED.search(line):
                yield f"{name}:{number}: unfinished by its own words: {line.strip()}"
            if MACHINE_PATH.search(line):
                yield f"{name}:{number}: a path of one machine: {line.strip()}"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    names = tracked_files(root)
    faults = [*check_includes(root, names), *check_openings(root, names), *check_ends(root, names),
              *check_circles(root, names), *check_names(names), *check_links(root, names), *check_words(root, names)]
    for fault in faults:
        print(fault)
    print(f"{len(names)} files, {len(faults)} violations")
    return 1 if faults or not names else 0


if __name__ == "__main__":
    sys.exit(main())
