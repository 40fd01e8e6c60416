#!/usr/bin/env bash
# Makes Debian packages of a build: make_packages.sh BUILD-FOLDER OUTPUT-FOLDER. Their files have the date of the last
# commit, where git knows it.
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$(dirname "$0")/..")
mkdir -p "$2"
output=$(realpath "$2")
rm -f "$output"/*.deb
if [ -z "${SOURCE_DATE_EPOCH:-}" ] && [ -e "$source/.git" ]; then
  SOURCE_DATE_EPOCH=$(git -C "$source" log -1 --format=%ct)
  export SOURCE_DATE_EPOCH
fi
umask 022
cpack --config "$build/CPackConfig.cmake" -B "$output" >"$output/cpack.log" 2>&1 || { cat "$output/cpack.log" >&2; exit 1; }
rm -r "$output/_CPack_Packages"
ls "$output"/*.deb
