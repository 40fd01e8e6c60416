# The Python package: its structures agree with the headers, and a header that differs is found; its functions work; its
# wheel installs into a fresh environment. Skipped without NumPy; full_python.sh compares its speed with that of C.
set -euo pipefail
build=$(dirname "$OCTALUX")
source=$OCTALUX_SOURCE_DIR
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for python in "${PYTHON:-python3}" /usr/bin/python3 none; do
  [ "$python" != none ] || { echo "skipped: no Python with NumPy here (Debian: python3-numpy)"; exit 77; }
  if "$python" -c 'import numpy' 2>/dev/null; then break; fi
done
export PYTHONPATH=$source/python OCTALUX_LIBRARIES=$build/src PYTHONDONTWRITEBYTECODE=1
fail() { echo "FAILED: $1"; exit 1; }

"$python" "$source/tests/python_layouts.py" "$source/include"
# drifts SED-SCRIPT HEADER PATTERN: checks that a header changed by the script is found to differ.
drifts() {
  rm -rf "$work/include"
  cp -r "$source/include" "$work/include"
  sed -i "$1" "$work/include/octalux/$2"
  cmp -s "$source/include/octalux/$2" "$work/include/octalux/$2" && fail "$1 changes nothing"
  if "$python" "$source/tests/python_layouts.py" "$work/include" >"$work/found.txt"; then fail "not found: $1 in $2"; fi
  grep -q "$3" "$work/found.txt" || fail "$1 in $2: $(cat "$work/found.txt")"
}
drifts 's/^  uint32_t max_probes;/  uint32_t most, max_probes;/' sample.h '^olx_sample_settings.max_probes: (12, 4) where C has (16, 4)'
drifts 's/^  bool emitters; /  bool more, emitters; /' sample.h '^olx_sample_settings: members '
drifts 's/uint32_t cube_size; /uint64_t cube_size; /' field.h '^olx_classic_info.cube_size'
drifts 's/OLX_TRACER_TEXEL = 0,/OLX_TRACER_NEW = 0, OLX_TRACER_TEXEL = 3,/' sample.h '^OLX_TRACER_TEXEL: (0,) where C has (3,)'
drifts 's/^  OLX_GATHER_TRACED /  OLX_GATHER_TRACED, OLX_GATHER_MORE /' bake.h '^olx_bounce_gather: 4 enumerators'
drifts 's/^olx_result olx_field_verify(const olx_field \*field);/olx_result olx_field_verify(const olx_field *field, bool all);/' field.h '^olx_field_verify: '
drifts 's/olx_vec3 olx_field_probe_position(/float olx_field_probe_position(/' field.h '^olx_field_probe_position: another result'

"$python" "$source/tests/python_api.py"

"$OCTALUX" bake builtin:cornell -o "$work/a.olx" --radiance-size 128 --noise 0.2 >/dev/null

# Where the baker's library is missing, the runtime alone works, and a call of the baker says what is missing.
mkdir "$work/runtime"
cp "$build/src/liboctalux.so" "$work/runtime"
OCTALUX_LIBRARIES=$work/runtime "$python" - "$work/a.olx" <<'PYTHON'
import sys, octalux
field = octalux.open(sys.argv[1])
assert field.trace(field.positions[0], (0, -1, 0))["status"] == octalux.FOUND
try:
    octalux.Scene("builtin:cornell")
except octalux.Error as error:
    assert error.result == octalux.Result.UNSUPPORTED and "liboctalux-bake" in str(error), error
else:
    sys.exit("a baker without its library")
PYTHON
OCTALUX_LIBRARIES=$work "$python" -c 'import octalux' 2>"$work/stderr.txt" && fail "imported without libraries"
grep -q "ImportError: Octalux's libraries cannot be loaded" "$work/stderr.txt" || fail "$(cat "$work/stderr.txt")"

# The wheel has the same bytes each time, contains what it should, and installs into an environment of its own.
wheel=$("$python" "$source/python/wheel_backend.py" "$build" "$work/wheel")
[ "$("$python" "$source/python/wheel_backend.py" "$build" "$work/again")" != "" ] && cmp "$wheel" "$work/again/$(basename "$wheel")"
"$python" - "$wheel" <<'PYTHON'
import sys, zipfile
names = set(zipfile.ZipFile(sys.argv[1]).namelist())
info = next(n for n in names if n.endswith("/METADATA")).split("/")[0]
wanted = {"octalux/__init__.py", "octalux/py.typed", "octalux/lib/liboctalux.so", "octalux/lib/liboctalux-bake.so",
          f"{info}/LICENSE", f"{info}/licenses/xxHash.txt", f"{info}/licenses/stb.txt", f"{info}/RECORD", f"{info}/WHEEL"}
assert wanted <= names, wanted - names
for name in sorted(names):  # what only debuggers read is left out
    assert not name.endswith(".so") or b".debug_info" not in zipfile.ZipFile(sys.argv[1]).read(name), name
text = zipfile.ZipFile(sys.argv[1]).read(f"{info}/METADATA").decode()
for word in ("liboctalux-bake.so", "Embree", "MIT", "Requires-Dist: numpy"):
    assert word in text, word
PYTHON
if "$python" -m venv --system-site-packages "$work/fresh" >"$work/venv.txt" 2>&1; then
  (
    unset PYTHONPATH OCTALUX_LIBRARIES
    "$work/fresh/bin/python" -m pip --disable-pip-version-check install --quiet --no-index --no-deps "$wheel"
    cd "$work"
    "$work/fresh/bin/python" -c 'import octalux; assert "/fresh/" in octalux.__file__; print("installed", octalux.__version__, octalux.open("a.olx").info.probes.count)'
    "$work/fresh/bin/python" -m pip --disable-pip-version-check check | grep -v "No broken" | grep octalux && exit 1 || true
  )
else
  echo "not tested: an installation, because this Python makes no environments (Debian: python3-venv)"
fi
echo "python: all sound"
