#!/usr/bin/env bash
# A part whose tools are missing is left out, and built once they are installed, unless the user left it out.
set -euo pipefail
source_dir=${OCTALUX_SOURCE_DIR:?}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.25)
project(parts NONE)
include("$source_dir/cmake/OctaluxOptional.cmake")
olx_optional_part(PART "a part" \${TOOLS})
message(STATUS "PART=\${PART}")
END

# expect VALUE OPTION...: configures the same build folder again, and checks whether the part is built.
expect() {
  local value=$1
  shift
  cmake -S "$work" -B "$work/build" "$@" | grep -x -- "-- PART=$value" >/dev/null || { echo "not $value with $*"; exit 1; }
}
expect OFF -DTOOLS=OFF
expect ON -DTOOLS=ON
expect OFF -DTOOLS=ON -DPART=OFF
expect OFF -DTOOLS=ON
expect ON -DTOOLS=OFF -DPART=ON
