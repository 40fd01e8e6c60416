#!/usr/bin/env bash
# The table of McGuire et al. 2017 on a GPU, which may be in another machine, one without packages.
#
#   bench_gpu.sh cook PROGRAM DIR [ROW...]   cook the rows' scenes into DIR; those that are not installed are left out, and named
#   bench_gpu.sh pack BUILD DIR              put the programs, and the libraries that baking loads, into DIR/bin, with this script
#   bench_gpu.sh bake DIR [ROW...]           bake the fields that DIR lacks, with what is in DIR/bin
#   bench_gpu.sh run DIR [OPTION...]         octalux-bench-gpu --data DIR OPTION...
#
# `cook` and `pack` run where Octalux was built (OCTALUX_SCENES names the scenes' folders); DIR then holds all that the
# other machine needs but libc and Vulkan's loader and driver. Carry it there, and run DIR/bench_gpu.sh bake DIR &&
# DIR/bench_gpu.sh run DIR --json.
#
# MAP_DIVISOR=8 makes all maps smaller by that factor, for trying things out. NOISE=0.02 bakes light as `octalux bake`
# does by default; the script's own default is 0.2, because times do not depend on the noise of stored light.
set -euo pipefail
export LC_ALL=C
divisor=${MAP_DIVISOR:-1}
noise=${NOISE:-0.2}

# Each line: row, scene, the model or description to cook, map size, grid.
rows() {
  cat <<'ROWS'
cornell-2048 cornell builtin:cornell 2048 2x2x2
cornell-256 cornell builtin:cornell 256 2x2x2
sponza sponza sponza.json 512 8x2x4
living-room living-room living-room.json 1024 4x4x4
kitchen kitchen kitchen.json 1024 4x4x4
pandora pandora-glossy pandora-glossy.json 1024 8x2x8
ROWS
}

# chosen ROW...: prints the lines of those rows, or of all.
chosen() {
  local row line
  [ $# -gt 0 ] || { rows; return; }
  for row; do
    line=$(rows | grep "^$row ") || { echo "bench_gpu.sh: there is no row $row" >&2; return 2; }
    echo "$line"
  done
}

usage() {
  sed -n '2,/^set -e/s/^# \{0,1\}//p' "$0" >&2
  exit 2
}

cook() {
  local program=$1 dir=$2 scenes row scene source
  shift 2
  scenes=$(dirname "$0")/../scenes
  mkdir -p "$dir"
  chosen "$@" | while read -r row scene source _; do
    [ -e "$dir/$scene.olxs" ] && continue
    [ "$source" = "${source#builtin:}" ] && source=$scenes/$source
    if "$program" scene "$source" --cook "$dir/$scene.olxs" >/dev/null 2>"$dir/cook.log"; then
      echo "$scene.olxs: $(stat -c %s "$dir/$scene.olxs") bytes"
    else
      echo "$scene: left out: $(tail -n 1 "$dir/cook.log")"
    fi
  done
  rm -f "$dir/cook.log"
}

pack() {
  local build=$1 dir=$2 library
  mkdir -p "$dir/bin/lib"
  cp "$build/octalux-bench-gpu" "$build/bench/bake_cooked" "$dir/bin/"
  cp "$0" "$dir/bench_gpu.sh"
  ldd "$build/bench/bake_cooked" | awk '$3 ~ /^\// {print $3}' | grep -v -E '/lib(c|m|dl|pthread|rt)\.so' |
    while read -r library; do
      gzip -9 -c "$(readlink -f "$library")" >"$dir/bin/lib/$(basename "$library").gz"
    done
  du -sh "$dir/bin"
}

bake() {
  local dir=$1 row scene source size grid
  shift
  libraries=$(mktemp -d) # not local, since the script removes it at its end
  trap 'rm -rf "$libraries"' EXIT
  for library in "$dir"/bin/lib/*.gz; do gunzip -c "$library" >"$libraries/$(basename "$library" .gz)"; done
  chosen "$@" | while read -r row scene source size grid; do
    [ -e "$dir/$row.olx" ] && continue
    if [ ! -e "$dir/$scene.olxs" ]; then
      echo "$row: left out: no $scene.olxs"
      continue
    fi
    local start=$SECONDS
    LD_LIBRARY_PATH=$libraries "$dir/bin/bake_cooked" "$dir/$scene.olxs" "$dir/$row.olx" $((size / divisor)) $((128 / divisor)) "$grid" cage,bricks \
      "$noise"
    echo "$row.olx: $(stat -c %s "$dir/$row.olx") bytes, $((SECONDS - start)) s"
  done
}

[ $# -ge 2 ] || usage
verb=$1
shift
case $verb in
cook | pack) [ $# -ge 2 ] || usage; "$verb" "$@" ;;
bake) bake "$@" ;;
run)
  dir=$1
  shift
  program=$dir/bin/octalux-bench-gpu
  [ -x "$program" ] || { echo "bench_gpu.sh: $program is not there" >&2; exit 1; }
  exec "$program" --data "$dir" "$@"
  ;;
*) usage ;;
esac
