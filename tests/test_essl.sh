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
# Paths may have spaces, and letters beyond ASCII.
mkdir "$work/größer als eins"
cp "$source_dir/web/bundle_shaders.mjs" "$work/größer als eins"
node "$work/größer als eins/bundle_shaders.mjs" "$source_dir/shaders" | cmp - "$work/whole.frag"
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

# WebGL refuses ?: of structures, which the validator accepts.
cat >"$work/structures.py" <<'PYTHON'
import re, sys
text = re.sub(r"//[^\n]*|/\*.*?\*/", "", open(sys.argv[1], encoding="utf-8").read(), flags=re.S)
names = "|".join(re.findall(r"\bstruct\s+(\w+)", text))

def chooses(expression):
    while (outer := re.sub(r"\([^()]*\)", "", expression)) != expression:  # arguments may be chosen
        expression = outer
    return "?" in expression

parts = re.split(r"\n(\w+) \w+\([^()]*\) \{", text)  # the type of each function, and the text up to the next
bodies = [body for kind, body in zip(parts[1::2], parts[2::2]) if re.fullmatch(names, kind)]
statements = [found for body in bodies for found in re.findall(r"return ([^;]*);", body)]
statements += re.findall(r"\b(?:%s) \w+ = ([^;]*);" % names, text)
found = list(filter(chooses, statements))
print(len(statements), "structures are returned or set;", found or "none is chosen by ?:")
sys.exit(not statements or bool(found))
PYTHON
python3 "$work/structures.py" "$work/whole.frag" || { echo "FAILED: a structure is chosen by ?:" >&2; exit 1; }
sed 's/if (!finite) light = \([^;]*\);.*/return finite ? light : \1;/' "$work/whole.frag" >"$work/broken.frag"
if python3 "$work/structures.py" "$work/broken.frag" >/dev/null; then
  echo "FAILED: a structure chosen by ?: passes" >&2
  exit 1
fi
