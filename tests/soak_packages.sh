# Debian packages on a bare system: Debian's minimal packages, then ours and their dependencies, then scene, bake,
# render and compare, and a program that is built against the development package. Needs mmdebstrap, the network, and
# root or user namespaces.
set -euo pipefail
command -v mmdebstrap >/dev/null || { echo "skipped: no mmdebstrap"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
build=$(dirname "$OCTALUX")
[ -e "$build/CPackConfig.cmake" ] || { echo "skipped: this build makes no packages"; exit 77; }
bash "$OCTALUX_SOURCE_DIR/scripts/make_packages.sh" "$build" "$work/packages"
SOURCE_DATE_EPOCH=1000000000 bash "$OCTALUX_SOURCE_DIR/scripts/make_packages.sh" "$build" "$work/once" >/dev/null
SOURCE_DATE_EPOCH=1000000000 bash "$OCTALUX_SOURCE_DIR/scripts/make_packages.sh" "$build" "$work/again" >/dev/null
for package in "$work"/once/*.deb; do cmp "$package" "$work/again/${package##*/}"; done
mkdir "$work/files"
cp "$work"/packages/*.deb "$OCTALUX_SOURCE_DIR/examples/minimal.c" "$work/files"
cat >"$work/files/try.sh" <<'SCRIPT'
set -eux
export DEBIAN_FRONTEND=noninteractive
cd /files
apt-get -q update
apt-get -q -y --simulate --install-recommends install ./*.deb >recommended.txt # all recommended packages are available
grep 'Inst libembree-dev' recommended.txt || { cat recommended.txt; exit 1; }
apt-get -q -y --no-install-recommends install ./*.deb
cd /tmp
octalux scene builtin:cornell
octalux bake builtin:cornell -o cornell.olx --grid 2x2x2 --radiance-size 64
octalux render builtin:cornell --method field --field cornell.olx --size 64x64 -o field.exr
octalux render builtin:cornell --method path --field cornell.olx --size 64x64 --spp 16 -o path.exr
octalux compare field.exr path.exr
octalux-view --help >/dev/null
octalux-bench --help >/dev/null
octalux-bench-gpu --help >/dev/null
octalux-bake-mpi --help >/dev/null # as a job of one rank
apt-get -q -y --no-install-recommends install gcc libc6-dev pkg-config
gcc -std=c17 /files/minimal.c $(pkg-config --cflags --libs octalux) -o minimal
ldd ./minimal | grep /liboctalux.so.0
./minimal cornell.olx
apt-get -q -y purge octalux octalux-viewer octalux-mpi octalux-doc liboctalux-dev liboctalux0
[ -z "$(find /usr -name '*octalux*')" ]
echo everything worked
SCRIPT
mmdebstrap --variant=minbase --customize-hook="copy-in $work/files /" --customize-hook='chroot "$1" sh /files/try.sh' \
  bookworm /dev/null 2>&1 | tee "$work/said.txt"
grep -q '^everything worked$' "$work/said.txt"
