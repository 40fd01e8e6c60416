#!/usr/bin/env bash
# The shader library also compiles as ESSL 3.00, as browsers compile it.
set -euo pipefail
source_dir=${OCTALUX_SOURCE_DIR:?}
for tool in node glslangValidator; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not here (scripts/install-packages.sh check)"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

node "$source_dir/web/bundle_shaders.mjs" "$source_dir/shaders" >"$work/whole.frag"
glslangValidator -S frag "$work/whole.frag" || { echo "FAILED: shaders/lib is not ESSL 3.00" >&2; exit 1; }

# Words that ESSL does not have must not be left in the text that a browser compiles.
glslangValidator -E -S frag "$work/whole.frag" >"$work/compiled.frag"
for word in 'precise' 'buffer ' 'layout *(set' 'constant_id' 'texture('; do
  if grep -n -- "$word" "$work/compiled.frag"; then
    echo "FAILED: '$word' is left in ESSL" >&2
    exit 1
  fi
done

# ESSL has no implicit conversions, and the validator reports one.
glslangValidator -S frag "$work/compiled.frag" >/dev/null
sed 's/uint olx_constant_tracer = 2u/uint olx_constant_tracer = 2/' "$work/compiled.frag" >"$work/broken.frag"
if glslangValidator -S frag "$work/broken.frag" >/dev/null; then
  echo "FAILED: an implicit conversion passes" >&2
  exit 1
fi
