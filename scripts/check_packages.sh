#!/usr/bin/env bash
# Checks the contents and dependencies of a build's Debian packages: check_packages.sh BUILD-FOLDER SOURCE-FOLDER. They
# are unpacked, not installed; tests/soak_packages.sh installs them on a bare system.
set -euo pipefail
build=$(realpath "$1") source=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
grep -qs octalux-viewer "$build/CPackConfig.cmake" && grep -qs octalux-mpi "$build/CPackConfig.cmake" || { echo "skipped: this build makes no packages, or not all"; exit 77; }
failed=0

fail() {
  echo "FAILED: $1"
  failed=1
}

bash "$source/scripts/make_packages.sh" "$build" "$work/packages" >/dev/null
package_of() { ls "$work"/packages/"$1"_*.deb; }
field_of() { dpkg-deb -f "$(package_of "$1")" "$2"; }
version=$(field_of octalux Version)
[ "$(ls "$work"/packages/*.deb | sed 's|.*/||; s|_.*||' | LC_ALL=C sort | tr '\n' ' ')" = "liboctalux-dev liboctalux0 octalux octalux-doc octalux-mpi octalux-viewer " ] ||
  fail "other packages than six: $(ls "$work/packages")"

# holds PACKAGE <LIST: checks that the package has these files under /usr and no others.
holds() {
  dpkg-deb -x "$(package_of "$1")" "$work/$1"
  (cd "$work/$1/usr" && find . ! -type d | sed 's|^\./||' | sort) >"$work/$1.found"
  sort >"$work/$1.wanted"
  diff "$work/$1.wanted" "$work/$1.found" || fail "$1 holds other files (< wanted, > found)"
}
listed() { (cd "$source" && find "$@" -type f ! -path '*__pycache__*'); }

# Package octalux has a manual page for each command but view and for each format of export, and the page of export web
# where this build made it.
tools_files() {
  printf '%s\n' bin/octalux bin/octalux-bench bin/octalux-bench-gpu share/bash-completion/completions/octalux share/doc/octalux/copyright
  printf 'share/man/man1/octalux%s.1\n' '' -{scene,place,bake,join,render,compare,audit,info,verify,pack,unpack,export-{exr,gltf,ktx2,web}}
  if [ -e "$build/web/index.html" ]; then (cd "$build" && find web -type f | sed 's|^|share/octalux/|'); fi
}
holds liboctalux0 < <(printf '%s\n' lib/liboctalux.so.0 "lib/liboctalux.so.$version" share/doc/liboctalux0/copyright)
holds octalux < <(tools_files)
holds octalux-mpi < <(printf '%s\n' bin/octalux-bake-mpi share/doc/octalux-mpi/copyright)
holds octalux-viewer < <(printf '%s\n' bin/octalux-view share/doc/octalux-viewer/copyright)
dev_files() {
  listed include
  listed shaders/lib shaders/octalux_shared.h -name '*.[gh]*' | sed 's|^|share/octalux/|'
  printf 'lib/cmake/octalux/octalux%s.cmake\n' Config ConfigVersion {,Bake}Targets{,-release}
  printf 'lib/%s\n' liboctalux{,-bake}.a liboctalux.so pkgconfig/octalux{,-bake}.pc
  echo share/doc/liboctalux-dev/copyright
}
holds liboctalux-dev < <(dev_files)
doc_files() {
  listed docs examples python README.md LICENSE CHANGELOG.md CONTRIBUTING.md | sed 's|^|share/doc/octalux/|'
  echo share/doc/octalux-doc/copyright
}
holds octalux-doc < <(doc_files)

# Programs depend on the packages of the libraries that they load, and the runtime on the C library alone.
[[ $(field_of liboctalux0 Depends) =~ ^libc6\ [^,]*$ ]] || fail "the runtime depends on $(field_of liboctalux0 Depends)"
[ "$(field_of liboctalux-dev Depends)" = "liboctalux0 (= $version)" ] || fail "liboctalux-dev depends on $(field_of liboctalux-dev Depends)"
[ "$(field_of octalux-doc Architecture)" = all ] || fail "documents are for one architecture"
for package in octalux octalux-viewer octalux-mpi; do
  for needed in libc6 libembree3-3 libassimp5 libmeshoptimizer2d libopenexr-3-1-30; do
    [[ ", $(field_of $package Depends)" == *", $needed ("* ]] || fail "$package does not depend on $needed"
  done
done
[[ "$(field_of octalux-viewer Depends)," == "octalux (= $version),"* ]] || fail "the viewer takes any version of octalux"
dpkg-deb --ctrl-tarfile "$(package_of liboctalux0)" | tar -xO ./shlibs | grep -q '^liboctalux 0 liboctalux0 (= ' || fail "who links the runtime is not told its package"

# Notices: a package's notice names exactly the libraries that its programs load, and has the text of the licences of
# code that it contains. third_party PACKAGE-COLUMN HOW FIELD prints a field of cmake/third_party.tsv.
third_party() { awk -F '\t' -v p="$1" -v h="$2" -v f="$3" '!/^#/ && index("," $1 ",", "," p ",") && $3 == h { print $f }' "$source/cmake/third_party.tsv"; }
for pair in runtime:liboctalux0 tools:octalux viewer:octalux-viewer mpi:octalux-mpi; do
  package=${pair#*:} column=${pair%:*}
  find "$work/$package" -type f \( -path '*/bin/*' -o -name '*.so.*' \) -exec readelf -d {} + |
    sed -nE 's/.*NEEDED.*\[(.*\.so)(\..*)?\]/\1/p' | sed 's/^\(ld-linux[^.]*\.so\).*/\1/' | sort -u >"$work/needed"
  third_party "$column" loads 5 | tr ',' '\n' | sed 's/^\(ld-linux[^.]*\.so\).*/\1/' | grep -v '^-$' | sort -u >"$work/told"
  diff "$work/needed" "$work/told" >"$work/other" || fail "$package loads other libraries (<) than cmake/third_party.tsv tells (>): $(cat "$work/other")"
done
for pair in runtime:liboctalux0 dev:liboctalux-dev tools:octalux viewer:octalux-viewer mpi:octalux-mpi; do
  package=${pair#*:} column=${pair%:*} notice=$work/${pair#*:}/usr/share/doc/${pair#*:}/copyright
  grep -q '^MIT License' "$notice" || fail "$package has no licence of ours"
  while IFS= read -r library; do grep -q "^$library: " "$notice" || fail "$package does not name $library"; done \
    < <(third_party "$column" loads 2; third_party "$column" contains 2; third_party "$column" page 2)
  [ "$(grep -c 'Its notice' "$notice")" = "$(third_party "$column" contains 2 | wc -l)" ] || fail "$package lacks a notice"
  web=$work/$package/usr/share/octalux/web
  while IFS= read -r notice; do [ ! -e "$web/index.html" ] || [ -e "$web/$notice" ] || fail "$package lacks $notice of its page"; done \
    < <(third_party "$column" page 6)
done

# Programs have no debug symbols, nothing refers to the build folder, and they run where they were unpacked.
for program in octalux/usr/bin/octalux octalux/usr/bin/octalux-bench octalux/usr/bin/octalux-bench-gpu octalux-viewer/usr/bin/octalux-view octalux-mpi/usr/bin/octalux-bake-mpi "liboctalux0/usr/lib/liboctalux.so.$version"; do
  readelf -S "$work/$program" | grep -q '\.debug_info' && fail "$program is not stripped"
  readelf -d "$work/$program" | grep -E 'R(UN)?PATH' && fail "$program looks for libraries in a folder"
done
env -i "$work/octalux/usr/bin/octalux" scene builtin:cornell >/dev/null || fail "the unpacked program does not start"
exit $failed
