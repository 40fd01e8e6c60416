#!/usr/bin/env bash
# Build the page of `octalux export web`: build_page.sh OUTPUT PACKAGES. three.js is fetched from npm into PACKAGES
# once. Where it is not available the page is left out with a message, and the next build tries again.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
output=$1 packages=$2
mkdir -p "$packages"
if ! cmp -s "$here/package-lock.json" "$packages/package-lock.json" || [ ! -e "$packages/node_modules/three/package.json" ]; then
  cp "$here/package.json" "$here/package-lock.json" "$here/.npmrc" "$packages"
  if ! (cd "$packages" && npm ci --silent --fetch-retries=0 >npm.log 2>&1); then
    rm -rf "$output" "$packages/package-lock.json"
    echo "octalux: three.js cannot be had from npm ($packages/npm.log); building without the page of export web" >&2
    exit 0
  fi
fi
node "$here/build_page.mjs" "$output" "$packages/node_modules"
