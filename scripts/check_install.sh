#!/usr/bin/env bash
# Installs a build, moves it, and uses it as others will: check_install.sh BUILD-FOLDER SOURCE-FOLDER. The examples are
# built against the CMake package and against pkg-config, and run. The build's libraries may be static or shared.
set -euo pipefail
build=$(realpath "$1") source=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
# A user's paths may have spaces, and letters beyond ASCII.
examples="$work/größere und kleinere"
cp -r "$source/examples" "$examples"

fail() {
  echo "$1" >&2
  exit 1
}

cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$prefix"
pkg_config_file=$(find "$prefix" -name octalux.pc)
export PKG_CONFIG_PATH=${pkg_config_file%/*}
libraries=${PKG_CONFIG_PATH%/pkgconfig}

# Every file that the installed documents link to is installed.
documents=$prefix/share/doc/octalux
[ -e "$documents/README.md" ] || fail "no README is installed"
while IFS= read -r found; do
  document=${found%%:*} link=${found#*:](}
  target=${link%)} target=${target%%#*}
  case $target in '' | http*:*) continue ;; esac
  [ -e "${document%/*}/$target" ] || fail "${document#"$prefix/"} links to $target, which is not installed"
done < <(grep -rHoE '\]\([^)]+\)' --include='*.md' "$documents")

# The shared runtime has a SONAME, and needs no libraries but libc and libm.
readelf -d "$libraries/liboctalux.so" | grep -q 'SONAME.*\[liboctalux\.so\.[0-9]*\]' || fail "liboctalux.so has no SONAME"
# needs_only FILE EXPRESSION: checks that every library that FILE loads matches the expression, or belongs to the C
# library.
needs_only() {
  if ldd "$1" | grep -vE "linux-vdso|lib(c|m)\.so|ld-linux|libpthread|$2"; then fail "${1##*/} needs more than libc and libm"; fi
}
needs_only "$libraries/liboctalux.so" '^$'

# The program finds our libraries in the installation, whatever the environment says, and nothing refers to the build
# folder.
"$prefix/bin/octalux" scene builtin:cornell >/dev/null || fail "the installed program does not start"
for file in "$prefix"/bin/* "$libraries"/*.so; do
  if readelf -d "$file" | grep -E 'R(UN)?PATH' | grep -vE '\[\$ORIGIN[^:]*\]'; then fail "$file looks for libraries elsewhere"; fi
done

cmake -S "$examples" -B "$work/examples" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release
cmake --build "$work/examples"
"$work/examples/bake_and_render" builtin:cornell "$work/cornell.olx" "$work/cornell.png"
head -c 4 "$work/cornell.png" | grep -q PNG
"$work/examples/minimal" "$work/cornell.olx" | tee "$work/package.txt"

# compiled NAME PACKAGE [FLAG...]: compiles an example with the flags that pkg-config gives for a package.
compiled() {
  local name=$1 package=$2 flags
  shift 2
  read -ra flags <<<"$(pkg-config --cflags --libs "$package")"
  cc -std=c17 "$examples/$name.c" "$@" "${flags[@]}" -o "$work/$name-$package"
}
compiled minimal octalux
LD_LIBRARY_PATH=$libraries needs_only "$work/minimal-octalux" 'liboctalux\.so'
LD_LIBRARY_PATH=$libraries "$work/minimal-octalux" "$work/cornell.olx" >"$work/pkg-config.txt"
cmp "$work/package.txt" "$work/pkg-config.txt"
compiled bake_and_render octalux-bake
LD_LIBRARY_PATH=$libraries "$work/bake_and_render-octalux-bake" builtin:cornell "$work/again.olx" "$work/again.png"
cmp "$work/cornell.olx" "$work/again.olx"

# When libraries are static, the CMake package has a target for the shared runtime, too.
if [ -e "$libraries/liboctalux.a" ]; then
  needs_only "$work/examples/minimal" '^$'
  printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(shared LANGUAGES C)' 'find_package(octalux REQUIRED)' \
    "add_executable(minimal \"$examples/minimal.c\")" 'target_link_libraries(minimal octalux::octalux-shared)' \
    >"$work/CMakeLists.txt"
  cmake -S "$work" -B "$work/shared" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
  cmake --build "$work/shared" >/dev/null
  ldd "$work/shared/minimal" | grep liboctalux.so >/dev/null || fail "octalux::octalux-shared is not loaded"
  "$work/shared/minimal" "$work/cornell.olx" | cmp "$work/package.txt" -

  # A program that only unpacks fields, and calls nothing else of the baker, needs no library but zstd.
  printf '%s\n' '#include <octalux/export.h>' 'int main(int argc, char **argv) {' \
    'const olx_unpack_settings settings = olx_unpack_settings_default();' \
    'return argc != 3 || olx_field_unpack(argv[1], &settings, argv[2], 0, 0) != OLX_OK; }' >"$work/unpack.c"
  cc -std=c17 -I"$prefix/include" "$work/unpack.c" "$libraries"/liboctalux{-bake,}.a -lzstd -lm -pthread -o "$work/unpack"
  needs_only "$work/unpack" 'libzstd\.so'
  "$prefix/bin/octalux" pack "$work/cornell.olx" -o "$work/cornell.olxz" --level 1
  "$work/unpack" "$work/cornell.olxz" "$work/unpacked.olx"
  cmp "$work/cornell.olx" "$work/unpacked.olx"
else
  ldd "$work/examples/minimal" | grep liboctalux.so >/dev/null || fail "a shared build's runtime is not loaded"
fi

shaders="$prefix/share/octalux/shaders"
if command -v glslc >/dev/null; then
  printf '%s\n' '#version 460' '#extension GL_GOOGLE_include_directive : require' '#include "lib/octalux.glsl"' \
    'layout(location = 0) out vec3 light;' \
    'void main() { light = olx_irradiance(olx_sample_settings_default(), vec3(0), vec3(0, 1, 0), vec3(0, 1, 0)); }' \
    >"$work/host.frag"
  glslc --target-env=vulkan1.2 -Werror -I "$shaders" "$work/host.frag" -o "$work/host.spv"
fi

"$work/examples/minimal" "$work/cornell.png" && fail "a picture passed for a field"
"$prefix/bin/octalux" info "$work/cornell.olx"
