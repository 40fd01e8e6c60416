#!/usr/bin/env bash
# The package for browsers, on node: compares its reader with octalux, and tests its tiling, its decoder and the
# contents of the published package.
set -euo pipefail
source_dir=${OCTALUX_SOURCE_DIR:?} packages=$(dirname "$PWD")/web-packages/node_modules
for tool in node npm clang wasm-ld; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not here (scripts/install-packages.sh check)"; exit 77; }
done
[ -e "$packages/three/package.json" ] || { echo "skipped: the build could not get three.js from npm"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir "$work/web"
for name in shaders src include LICENSE; do ln -s "$source_dir/$name" "$work/$name"; done
(cd "$source_dir/web" && cp -r src decoder test examples ./*.mjs package.json README.md .npmrc "$work/web")
ln -s "$packages" "$work/web/node_modules"
cd "$work/web"
node build.mjs
node --test test/ >"$work/tests" || { cat "$work/tests"; exit 1; }
node node_modules/typescript/bin/tsc --project test/tsconfig.json
grep -q '^# fail 0$' "$work/tests" && grep -q '^# skipped 0$' "$work/tests"

# The published package has the library and its types, and none of the sources they are made from.
npm pack --silent --dry-run --ignore-scripts --json >"$work/pack.json"
node -e '
  const [pack] = JSON.parse(require("fs").readFileSync(process.argv[1], "utf8")), names = pack.files.map(({ path }) => path);
  const wanted = ["package.json", "README.md", "dist/index.js", "dist/index.d.ts", "dist/download.js", "dist/library.js", "dist/decoder_wasm.js", "dist/LICENSE"];
  const missing = wanted.filter((name) => !names.includes(name)), odd = names.filter((name) => !/^(package.json|README.md|dist\/|examples\/)/.test(name));
  if (missing.length || odd.length) throw new Error(`missing ${missing}, odd ${odd}`);
  if (pack.size > 300000) throw new Error(`${pack.size} bytes`);
' "$work/pack.json"

# The lock file names packages and versions, and leaves the host to npm's settings.
if grep '"resolved"' "$source_dir/web/package-lock.json"; then
  echo "FAILED: the lock file names a host" >&2
  exit 1
fi
