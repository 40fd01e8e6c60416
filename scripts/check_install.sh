#!/usr/bin/env bash
# Install a build, move it, and use it as others will: check_install.sh BUILD-FOLDER SOURCE-FOLDER. The examples are built
# against the CMake package and against pkg-config, and run.
set -euo pipefail
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/prefix"

cmake -S "$source/examples" -B "$work/examples" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release
cmake --build "$work/examples"
"$work/examples/bake_and_render" builtin:cornell "$work/cornell.olx" "$work/cornell.png"
head -c 4 "$work/cornell.png" | grep -q PNG
"$work/examples/minimal" "$work/cornell.olx" | tee "$work/package.txt"

pkg_config_file=$(find "$work/prefix" -name octalux.pc)
export PKG_CONFIG_PATH=${pkg_config_file%/*}
read -ra flags <<<"$(pkg-config --cflags --libs octalux)"
cc -std=c17 "$source/examples/minimal.c" "${flags[@]}" -o "$work/minimal"
"$work/minimal" "$work/cornell.olx" | tee "$work/pkg-config.txt"
cmp "$work/package.txt" "$work/pkg-config.txt"

shaders="$work/prefix/share/octalux/shaders"
if command -v glslc >/dev/null; then
  printf '%s\n' '#version 460' '#extension GL_GOOGLE_include_directive : require' '#include "lib/octalux.glsl"' \
    'layout(location = 0) out vec3 light;' \
    'void main() { light = olx_irradiance(olx_sample_settings_default(), vec3(0), vec3(0, 1, 0), vec3(0, 1, 0)); }' \
    >"$work/host.frag"
  glslc --target-env=vulkan1.2 -Werror -I "$shaders" "$work/host.frag" -o "$work/host.spv"
fi

if ldd "$work/minimal" | grep -vE 'linux-vdso|lib(c|m)\.so|ld-linux|libpthread'; then
  echo "a program with the runtime needs more than libc and libm" >&2
  exit 1
fi
"$work/minimal" "$work/cornell.png" && { echo "a picture passed for a field" >&2; exit 1; }
"$work/prefix/bin/octalux" info "$work/cornell.olx"
