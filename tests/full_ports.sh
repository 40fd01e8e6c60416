# The runtime alone, built for other machines and C libraries, gives the same answers as on this machine: for 64-bit ARM
# under an emulator, linked statically with musl, and in C17 without POSIX (OCTALUX_SYSTEM=plain), where it calls no
# functions of threads or of POSIX files.
set -euo pipefail
for tool in aarch64-linux-gnu-gcc qemu-aarch64 musl-gcc; do
  command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# port NAME [CMAKE-ARGUMENT...]: builds the runtime and tests/ports/answers.c in $work/NAME.
port() {
  local name=$1 build=$work/$1
  shift
  cmake -S "$OCTALUX_SOURCE_DIR" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DOCTALUX_BAKER=OFF -DOCTALUX_VULKAN=OFF "$@"
  cmake --build "$build" --target octalux octalux-shared answers
}
# The C compiler for musl does not search the folders of other libraries' headers.
mkdir "$work/headers"
ln -s /usr/include/xxhash.h /usr/include/xxh3.h "$work/headers"
port here
port plain -DOCTALUX_SYSTEM=plain
port musl -DCMAKE_C_COMPILER=musl-gcc "-DCMAKE_C_FLAGS=-isystem \"$work/headers\"" -DCMAKE_EXE_LINKER_FLAGS=-static
port arm64 -DCMAKE_TOOLCHAIN_FILE="$OCTALUX_SOURCE_DIR/cmake/aarch64-linux-gnu.cmake"

"$OCTALUX" bake builtin:cornell -o "$work/cornell.olx" --grid 3x2x2 --radiance-size 64 --irradiance-size 32 --probe-light --relight
for name in here plain musl; do "$work/$name/answers" "$work/cornell.olx" "$work/$name.txt" | tee "$work/$name.said"; done
qemu-aarch64 -L /usr/aarch64-linux-gnu "$work/arm64/answers" "$work/cornell.olx" "$work/arm64.txt"
grep -q 'this build writes no files' "$work/plain.said" || { echo "FAILED: plain C wrote by POSIX"; failed=1; }
[ "$(grep -c '^surface ' "$work/here.txt")" -gt 1000 ] || { echo "FAILED: most rays find nothing"; failed=1; }

# Every build prints the same lines in the same order. Sines and powers of other C libraries differ in their last bits,
# which can decide where a ray at an edge ends: up to one number in 500 may differ by more than a thousandth.
cat >"$work/compare.py" <<'PYTHON'
import sys
here, there = ([line.split() for line in open(name)] for name in sys.argv[1:3])
rays = [[line for line in lines if line[0] in ("ray", "radiance", "relit", "volume")] for lines in (here, there)]
pairs = [(float(x), float(y)) for a, b in zip(*rays) for x, y in zip(a[1:], b[1:])]
other = sum(abs(x - y) > 1e-3 * max(abs(x), abs(y), 1e-3) for x, y in pairs)
print(f"{sys.argv[2].split('/')[-1]}: {other} of {len(pairs)} numbers differ; {'the same' if here == there else 'not the same'} text")
sys.exit(len(rays[0]) != len(rays[1]) or len(pairs) < 8000 or other > len(pairs) / 500)
PYTHON
for name in plain musl arm64; do python3 "$work/compare.py" "$work/here.txt" "$work/$name.txt" || failed=1; done
cmp "$work/here.txt" "$work/plain.txt" || { echo "FAILED: without POSIX it answers otherwise"; failed=1; }

# The plain build may leave only functions of C's standard library undefined, and those that the compiler itself calls.
nm -u "$work/plain/src/liboctalux.a" | awk '/ U / { print $2 }' | sort -u >"$work/undefined.txt"
if grep -E '^(pthread_|thrd_|open|openat|close|read|write|pread|pwrite|mmap|munmap|f?stat|ioctl|poll|sysconf|clock_gettime|fsync|link|rename|unlink|flock|getpid|usleep|nanosleep|dl(open|sym))' \
  "$work/undefined.txt"; then
  echo "FAILED: plain C calls POSIX"
  failed=1
fi
exit $failed
