# The source archive builds where there is no git, and its program bakes the same field as this build.
set -euo pipefail
[ -e "$OCTALUX_SOURCE_DIR/.git" ] || { echo "skipped: this is no checkout"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
archive=$(bash "$OCTALUX_SOURCE_DIR/scripts/make_dist.sh" "$work")
tar -xzf "$archive" -C "$work"
mkdir "$work/bin"
printf '#!/bin/sh\necho "git was called: $*" >&2\nexit 1\n' >"$work/bin/git"
chmod +x "$work/bin/git"
export PATH=$work/bin:$PATH
cd "$work"/octalux-*/
cmake --preset release
cmake --build build/release --target octalux-cli octalux-shared
build/release/octalux bake builtin:cornell -o "$work/theirs.olx" --grid 2x2x2 --radiance-size 64
if git -C "$OCTALUX_SOURCE_DIR" status >/dev/null 2>&1; then exit 1; fi
"$OCTALUX" bake builtin:cornell -o "$work/ours.olx" --grid 2x2x2 --radiance-size 64
cmp "$work/ours.olx" "$work/theirs.olx"
