# The checks of the house rules find what they are for: each fault, added to a clean tree, is reported; and the counts
# of a test report are right.
set -euo pipefail
check=$OCTALUX_SOURCE_DIR/scripts/check_layers.py
count=$OCTALUX_SOURCE_DIR/scripts/count_tests.py
build_tests=$PWD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
opening='// Says in one whole sentence what this file is for.'

clean_tree() {
  rm -rf "$work/tree"
  mkdir -p "$work"/tree/{include/octalux,src/core,src/trace,src/scene,host,cli}
  cd "$work/tree"
  printf '#include <stdint.h>\n' >include/octalux/base.h
  printf '#include <octalux/base.h>\n' >include/octalux/scene.h
  printf '#include <octalux/base.h>\n#include <math.h>\n' >src/core/vec.h
  printf '#include "core/vec.h"\n' >src/core/way.h
  printf '#include "core/way.h"\n' >src/core/yard.h
  printf '%s\n#include "core/vec.h"\n#include <xxhash.h>\n' "$opening" >src/trace/trace.c
  printf '%s\n#include "trace/x.h"\n#include <embree3/rtcore.h>\n#include <octalux/scene.h>\n' "$opening" >src/scene/bvh.c
  printf '%s\n#include "command.h"\n#include "device.h"\n#include <octalux/scene.h>\n#include <cjson/cJSON.h>\n' "$opening" >cli/main.c
  : >cli/command.h
  : >host/device.h
  printf '# Read me\n[code](src/core), [a file](src/core/vec.h), [here](#read-me), [there](https://example.com/x)\n' >README.md
}

# planted WHERE LINE: checks that the tree with that line added has exactly one violation, in that file.
planted() {
  clean_tree
  printf '%s\n' "$2" >>"$1"
  if python3 "$check" "$work/tree" >"$work/out"; then
    echo "not found in $1: $2"
    failed=1
  elif [ "$(grep -c . "$work/out")" -ne 2 ] || ! grep -q "^$1:" "$work/out"; then
    echo "wrongly reported: $2"
    cat "$work/out"
    failed=1
  fi
}

clean_tree
python3 "$check" "$work/tree" || failed=1
printf '#include <stdint.h>' >src/core/vec.h
python3 "$check" "$work/tree" >"$work/out" && failed=1
grep -q '^src/core/vec.h: does not end with a newline' "$work/out" || failed=1

planted src/core/vec.h '#include "trace/trace.h"'
planted src/trace/trace.c '#include "scene/bvh.h"'
planted src/trace/trace.c '#include <octalux/scene.h>'
planted src/trace/trace.c '#include <embree3/rtcore.h>'
planted src/trace/trace.c '#include "trace.h"'
planted src/trace/trace.c '  #  include   "../scene/bvh.h"'
planted include/octalux/base.h '#include <octalux/scene.h>'
planted include/octalux/base.h '#include <stdio.h>'
planted include/octalux/scene.h '#include "core/vec.h"'
planted cli/main.c '#include "core/vec.h"'
planted cli/main.c '#include "../src/core/vec.h"'
planted host/device.h '#include "command.h"'
planted src/core/vec.h '#include "core/way.h"'
planted src/core/vec.h '#include "core/yard.h"'
planted src/core/new.c '#include "core/vec.h"'
planted src/core/new.c '// Vectors.'
planted src/core/new.c '// what vectors are multiplied and added by'
planted cli/vec.h '// a second file of this name'
planted README.md 'See [what](docs/what.md).'
planted README.md '![a picture](picture.png)'
planted README.md '[beside the tree](../out)'
planted README.md '[a part](#unread)'
planted src/core/vec.h "// TO""DO: finish"
planted src/core/vec.h "// Copy""right somebody else"
planted src/core/vec.h "// see /ho""me/somebody/notes"

cat >"$work/report.xml" <<'XML'
<testsuite>
<testcase name="unit" status="run"><system-out>[  PASSED  ] 12 test(s).</system-out></testcase>
<testcase name="broken" status="fail"><system-out>[  PASSED  ] 3 test(s).
[  SKIPPED ] 1 test(s), listed below:
[  FAILED  ] 2 test(s), listed below:</system-out></testcase>
<testcase name="crashed" status="fail"><system-out>no summary</system-out></testcase>
<testcase name="script" status="run"><system-out>fine</system-out></testcase>
<testcase name="absent" status="notrun"><system-out></system-out></testcase>
</testsuite>
XML
counts=$(python3 "$count" "$work/report.xml" 2>/dev/null)
[ "$counts" = "16 3 2" ] || { echo "counted $counts"; failed=1; }

# The README's program compiles without warnings.
sed -n '/^```c$/,/^```$/{/^```/!p}' "$OCTALUX_SOURCE_DIR/README.md" >"$work/readme.c"
[ -s "$work/readme.c" ] && gcc -std=c17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I"$OCTALUX_SOURCE_DIR/include" "$work/readme.c" || failed=1

# install-packages.sh on an imitated system: which packages are missing, which user runs it, and the commands that it
# runs.
install=$OCTALUX_SOURCE_DIR/scripts/install-packages.sh
bash=$(command -v bash)
mkdir "$work/bin"
printf '#!%s\nfor p in "${@:4}"; do [ "$p" = "$MISSING" ] || echo "installed $p"; done\n' "$bash" >"$work/bin/dpkg-query"
printf '#!%s\necho "$USER_ID"\n' "$bash" >"$work/bin/id"
printf '#!%s\necho "apt-get $*" >>"$CALLS"\n' "$bash" >"$work/bin/apt-get"
printf '#!%s\nwhile [[ $1 == *=* ]]; do shift; done\n"$@"\n' "$bash" >"$work/bin/env"
chmod +x "$work"/bin/*

# installs MISSING USER-ID [LIST]: runs the script, with its messages in $work/out and the calls of apt-get in
# $work/calls.
installs() {
  : >"$work/calls"
  MISSING=$1 USER_ID=$2 CALLS=$work/calls PATH=$work/bin "$bash" "$install" ${3:+"$3"} >"$work/out" 2>&1
}
# complain WORDS: reports a failure, with the messages and the calls.
complain() {
  echo "$1: $(cat "$work/out" "$work/calls")"
  failed=1
}

for list in build check full soak; do
  installs none 1000 $list && [ ! -s "$work/calls" ] && [ ! -s "$work/out" ] || complain "$list, with all packages"
done
installs none 1000 everything && complain "took a list that is none"
installs libembree-dev 1000 && complain "went on without a package"
grep -q 'apt-get install libembree-dev$' "$work/out" || complain "unclear"
[ ! -s "$work/calls" ] || complain "a user ran apt-get"
installs libembree-dev 0 || complain "root could not install"
[ "$(sed 's/.* update/update/; s/.* install .* /install /' "$work/calls" | tr '\n' ';')" = "update;install libembree-dev;" ] ||
  complain "root ran something else"

# Building needs no package that only tests and tools need, and continues without a package whose part can be left out.
for package in clang clang-tidy clang-format libcmocka-dev python3 python3-numpy python3-venv vulkan-validationlayers mesa-vulkan-drivers xvfb chromium \
  nodejs npm lld glslang-tools; do
  installs $package 0 build && [ ! -s "$work/calls" ] || complain "building wants $package"
  installs $package 1000 full && complain "the full check goes on without $package"
done
installs chromium 1000 check || complain "the check wants a browser"
installs mmdebstrap 1000 full || complain "the full check wants a bare system"
installs mmdebstrap 1000 soak && complain "the soak goes on without a bare system"
for list in check full soak; do installs dpkg-dev 1000 $list && complain "$list goes on without what makes packages"; done
installs glslc 1000 check && complain "the check goes on without glslc"
installs glslc 1000 build && grep -q "without what needs glslc" "$work/out" || complain "a user cannot build without glslc"
printf '#!%s\necho "apt-get $*" >>"$CALLS"\n[ "${!#}" != "$MISSING" ]\n' "$bash" >"$work/bin/apt-get" # it cannot be had
installs glslc 0 build && grep -q "glslc cannot be had" "$work/out" || complain "building stops at glslc"
installs libembree-dev 0 build && complain "went on without Embree"

# A limit counts processor time, not the clock's, and every test has one.
limited=$OCTALUX_SOURCE_DIR/scripts/limited.sh
[ "$(bash "$limited" 1 bash -c 'sleep 2; echo slept')" = slept ] || { echo "a limit counts time asleep"; failed=1; }
if { bash "$limited" 1 bash -c 'while :; do :; done'; } 2>/dev/null; then echo "a limit does not hold"; failed=1; fi
if [ -e "$build_tests/CTestTestfile.cmake" ]; then
  ctest --test-dir "$build_tests" --show-only=json-v1 >"$work/tests.json"
  python3 - "$work/tests.json" <<'PYTHON' || failed=1
import json, sys
for test in json.load(open(sys.argv[1]))["tests"]:
    command = [*test.get("command", []), "", "", "1e9"]
    clock = {p["name"]: p["value"] for p in test["properties"]}.get("TIMEOUT", 0)
    if not command[1].endswith("limited.sh") or clock < 10 * float(command[2]):
        sys.exit("no limit of processor time, or one of the clock's below ten times that: " + test["name"])
PYTHON
fi

# The gate's last line and exit status are those of the check, whatever runs it.
mkdir -p "$work"/gate/{.ci,scripts}
cp "$OCTALUX_SOURCE_DIR/.ci/run" "$work/gate/.ci"
cp "$OCTALUX_SOURCE_DIR/Makefile" "$work/gate"
printf '#!%s\necho "3 passed, 1 failed"\nexit 1\n' "$bash" >"$work/gate/scripts/check.sh"
chmod +x "$work"/gate/*/*
MAKELEVEL=1 "$work/gate/.ci/run" >"$work/out" && { echo "the gate hides a failure"; failed=1; }
[ "$(tail -n 1 "$work/out")" = "3 passed, 1 failed" ] || { echo "the gate ends with: $(tail -n 1 "$work/out")"; failed=1; }

# `make install` takes a prefix with spaces as one word.
printf '#!%s\nprintf "<%%s>" "$@"\n' "$bash" >"$work/bin/cmake"
chmod +x "$work/bin/cmake"
installed=$(PATH=$work/bin:$PATH make --silent --no-print-directory --old-file build -C "$OCTALUX_SOURCE_DIR" install \
  PREFIX="/opt/my programs")
[ "$installed" = "<--install><build/release><--prefix></opt/my programs>" ] ||
  { echo "make install: $installed"; failed=1; }

# The README's PATH line names the folder that `make build` leaves the program in.
path_line=$(grep -m1 '^export PATH=' "$OCTALUX_SOURCE_DIR/README.md" || true)
[ "$(cd "$OCTALUX_SOURCE_DIR" && eval "$path_line" && echo "${PATH%%:*}")" = "$OCTALUX_SOURCE_DIR/build/release" ] ||
  { echo "the README does not say where the program is: $path_line"; failed=1; }
grep -q '^OCTALUX := build/release/octalux$' "$OCTALUX_SOURCE_DIR/Makefile" || { echo "make builds elsewhere"; failed=1; }
exit "$failed"
