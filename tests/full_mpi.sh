# octalux-bake-mpi: ranks of an MPI job make the field of a bake by one process, also after ranks were killed, and
# mistakes are told once. Takes the numbers of ranks and of kills.
set -euo pipefail
ranks=${1:-2} kills=${2:-1}
program=$(dirname "$OCTALUX")/octalux-bake-mpi
[ -x "$program" ] && command -v mpirun >/dev/null || {
  echo "skipped: octalux-bake-mpi is not built, or mpirun is missing (Debian: libopenmpi-dev, openmpi-bin)"
  exit 77
}
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $1"
  exit 1
}
# Open MPI keeps its sockets in TMPDIR, whose name must be short.
mkdir "$work/field"
python3 "$OCTALUX_SOURCE_DIR/tests/ranks.py" "$work/field" "$kills" "${MPI_SEED:-1}" "$OCTALUX" "$ranks" \
  builtin:cornell --grid 3x2x3 --radiance-size 32 --noise 0.1 --relight

cd "$work"
on_ranks() { mpirun --oversubscribe --bind-to none -n 2 "$program" "$@" --threads 1; }
code=0
on_ranks builtin:cornell -o x.olx --part 1/2 >out.txt 2>err.txt || code=$?
[ $code = 2 ] && [ "$(grep -c '^octalux bake: --part: the ranks are the parts' err.txt)" = 1 ] || fail "--part: $code, $(cat err.txt)"
bake=(builtin:cornell --grid 2x1x2 --radiance-size 32 --noise 0.2)
# Another bake's folder is refused, unless --fresh is given; a damaged unit is made again; --keep-work keeps the folder.
on_ranks "${bake[@]}" --seed 1 -o other.olx --work keep --keep-work >out.txt 2>err.txt || fail "a kept folder: $(cat err.txt)"
code=0
on_ranks "${bake[@]}" -o a.olx --work keep >out.txt 2>err.txt || code=$?
[ $code = 1 ] && [ "$(grep -c '^octalux bake: keep: .*another bake' err.txt)" = 1 ] || fail "another bake's folder: $code, $(cat err.txt)"
[ ! -e a.olx ] || fail "a field was written in spite of the refusal"
on_ranks "${bake[@]}" -o a.olx --work keep --keep-work --fresh >out.txt 2>err.txt || fail "--fresh: $(cat err.txt)"
"$OCTALUX" bake "${bake[@]}" -o whole.olx >/dev/null
cmp a.olx whole.olx
rm keep/facts-* keep/light-* keep/direct-*
for unit in keep/cast-0-*.unit keep/probe-0-*1.unit; do printf x | dd of="$unit" bs=1 seek=80 conv=notrunc status=none; done
on_ranks "${bake[@]}" -o b.olx --work keep >out.txt 2>err.txt || fail "damaged units: $(cat err.txt)"
cmp b.olx whole.olx
grep -q 'is damaged; it is made again' err.txt || fail "no word of damaged units"
[ ! -e keep ] || fail "the work folder stays"
