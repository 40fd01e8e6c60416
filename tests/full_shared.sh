# BUILD_SHARED_LIBS makes both libraries shared, an installation of them works after it was moved, and cmocka is not
# needed to build.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# This folder holds every pkg-config file but cmocka's.
mkdir "$work/pkgconfig"
for folder in $(pkg-config --variable pc_path pkg-config | tr : ' '); do
  find "$folder" -maxdepth 1 -name '*.pc' ! -name 'cmocka.pc' -exec ln -sf -t "$work/pkgconfig" {} + 2>/dev/null || true
done
export PKG_CONFIG_LIBDIR=$work/pkgconfig
cmake -S "$OCTALUX_SOURCE_DIR" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS_DEBUG=-O0 -DBUILD_SHARED_LIBS=ON >"$work/configure.txt"
grep "Without the tests" "$work/configure.txt"
cmake --build "$work/build"
for library in octalux octalux-bake; do
  readelf -d "$work/build/src/lib$library.so" | grep "SONAME.*lib$library\.so\.0"
done
[ -z "$(find "$work/build/src" -name '*.a')" ]
bash "$OCTALUX_SOURCE_DIR/scripts/check_install.sh" "$work/build" "$OCTALUX_SOURCE_DIR"
