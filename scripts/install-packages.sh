#!/usr/bin/env bash
# Install the Debian packages that building and checking Octalux needs. Does nothing when all of them are there.
# install-packages.sh full: also those of the full check alone.
set -euo pipefail

packages=(
  gcc g++ clang clang-format clang-tidy libclang-rt-14-dev # compilers, sanitizer runtimes, tools
  cmake ninja-build pkg-config python3 binutils
  libembree-dev libassimp-dev libopenexr-dev libstb-dev libcjson-dev libqhull-dev libxxhash-dev zlib1g-dev
  libcmocka-dev
  glslc libvulkan-dev mesa-vulkan-drivers vulkan-validationlayers # shaders, Vulkan's headers and loader, its CPU device
  libglfw3-dev libimgui-dev libfreetype-dev xvfb # the viewer, and a display for its test
)
[ "${1:-}" = full ] && packages+=(chromium) # looks at reports

if ! command -v dpkg-query >/dev/null; then
  echo "install-packages: no dpkg here; provide these yourself: ${packages[*]}" >&2
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

if [ "$(id -u)" -eq 0 ]; then
  as_root=(env)
elif command -v sudo >/dev/null; then
  as_root=(sudo)
else
  echo "install-packages: these packages are missing and neither root nor sudo is at hand: ${missing[*]}" >&2
  echo "install-packages: as root, run: apt-get install ${missing[*]}" >&2
  exit 1
fi

echo "install-packages: installing ${missing[*]}"
"${as_root[@]}" apt-get -q update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends "${missing[@]}"
