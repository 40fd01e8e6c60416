#!/usr/bin/env bash
# Makes the source archive of the last commit, octalux-VERSION.tar.gz: make_dist.sh OUTPUT-FOLDER. The same commit gives
# the same bytes: files are sorted, have no owner, and the commit's date. Uncommitted changes are left out.
set -euo pipefail
source=$(realpath "$(dirname "$0")/..")
mkdir -p "$1"
output=$(realpath "$1")
[ -e "$source/.git" ] || { echo "make_dist: this is no checkout; the source you have is the one there is" >&2; exit 1; }
version=$(sed -nE 's/^project\(octalux VERSION ([0-9.]+).*/\1/p' "$source/CMakeLists.txt")
git -C "$source" diff --quiet HEAD || echo "make_dist: changes that are not committed are left out" >&2
git -C "$source" -c tar.umask=0022 archive --format=tar --prefix="octalux-$version/" HEAD | gzip -n -9 >"$output/octalux-$version.tar.gz"
echo "$output/octalux-$version.tar.gz"
