#!/usr/bin/env bash
# Checks the source archive: check_dist.sh SOURCE-FOLDER. It contains the files that git tracks and no others, has the
# same bytes twice, and its files have no owner. tests/soak_dist.sh builds it.
set -euo pipefail
source=$(realpath "$1")
[ -e "$source/.git" ] || { echo "skipped: this is no checkout"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "FAILED: $1"
  exit 1
}

archive=$(bash "$source/scripts/make_dist.sh" "$work/one" 2>/dev/null)
cmp "$archive" "$(bash "$source/scripts/make_dist.sh" "$work/two" 2>/dev/null)" || fail "made twice, it differs"
name=$(basename "$archive" .tar.gz)
git -C "$source" ls-tree -r --name-only HEAD | sed "s|^|$name/|" | sort >"$work/tracked"
tar -tzf "$archive" | grep -v '/$' | sort >"$work/listed"
diff "$work/tracked" "$work/listed" || fail "it holds other files than git tracks (< tracked, > in the file)"
[ "$(tar --numeric-owner -tvzf "$archive" | awk '{ print $2 }' | sort -u)" = "0/0" ] || fail "files belong to somebody"
[ "$(tar --full-time -tvzf "$archive" | awk '{ print $4, $5 }' | sort -u | wc -l)" = 1 ] || fail "files are of several ages"
tar -xzf "$archive" -C "$work" && [ -x "$work/$name/scripts/check.sh" ] || fail "scripts cannot be run"
python3 "$work/$name/scripts/check_layers.py" "$work/$name" || fail "the unpacked source is not in order"
