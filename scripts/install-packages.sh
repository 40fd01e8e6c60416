#!/usr/bin/env bash
# Install the Debian packages that Octalux needs: install-packages.sh [build|check|full|soak]. Does nothing when all of
# them are there.
#   build   what building needs (the default), and what it leaves parts out without
#   check   also what `make check` needs
#   full    also what `make check-full` needs
#   soak    what `make check` and `make soak` need
set -euo pipefail
list=${1:-build}

needed=(gcc g++ cmake ninja-build pkg-config
  libembree-dev libassimp-dev libdraco-dev libopenexr-dev libstb-dev libcjson-dev libqhull-dev libxxhash-dev libmeshoptimizer-dev libwebp-dev libzstd-dev zlib1g-dev)
# Without these packages the build leaves out the Vulkan runtime, the viewer or octalux-bake-mpi, with a message;
# without those of the check, the page of export web.
wanted=(glslc libvulkan-dev libglfw3-dev libimgui-dev libfreetype-dev libopenmpi-dev)
case $list in
  build) ;;
  check | full | soak)
    needed+=(clang clang-format clang-tidy libclang-rt-14-dev python3 python3-numpy python3-venv binutils libcmocka-dev
      dpkg-dev # finds which packages a package depends on
      gltfpack # makes compressed models to read
      nodejs lld glslang-tools # for the browser package and the page of export web, with their decoder and shaders
      mesa-vulkan-drivers vulkan-validationlayers xvfb # Vulkan's CPU device, its layers, and a display
      "${wanted[@]}")
    command -v npm >/dev/null || needed+=(npm) # other sources' nodejs contains npm, and excludes Debian's
    wanted=()
    [ "$list" != soak ] || needed+=(mmdebstrap) # makes a bare system to install packages on
    [ "$list" != full ] || needed+=(chromium # shows reports
      gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user musl-tools) # for builds for other machines and C libraries
    [ "$list" = check ] || needed+=(openmpi-bin slurmctld slurmd slurm-client) # run bakes in parts
    ;;
  *)
    echo "install-packages: '$list' is not one of build, check, full, soak" >&2
    exit 2
    ;;
esac

if ! command -v dpkg-query >/dev/null; then
  echo "install-packages: no dpkg here; provide these yourself: ${needed[*]}${wanted[*]:+; and, to leave nothing out: ${wanted[*]}}" >&2
  exit 0
fi

# missing_of PACKAGE...: prints those that are not installed, one a line.
missing_of() {
  [ $# -gt 0 ] || return 0
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)
  local package
  for package; do
    [[ $'\n'$installed$'\n' == *$'\n'"installed $package"$'\n'* ]] || echo "$package"
  done
}
mapfile -t missing < <(missing_of "${needed[@]}")
mapfile -t missing_wanted < <(missing_of "${wanted[@]}")
[ $((${#missing[@]} + ${#missing_wanted[@]})) -eq 0 ] && exit 0

if [ "$(id -u)" -eq 0 ]; then
  as_root=(env)
elif command -v sudo >/dev/null; then
  as_root=(sudo)
elif [ ${#missing[@]} -eq 0 ]; then
  echo "install-packages: building without what needs ${missing_wanted[*]}; as root, apt-get installs them" >&2
  exit 0
else
  echo "install-packages: these packages are missing and neither root nor sudo is at hand: ${missing[*]}" >&2
  echo "install-packages: as root, run: apt-get install ${missing[*]}" >&2
  exit 1
fi

apt_get() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q "$@"; }
echo "install-packages: installing ${missing[*]} ${missing_wanted[*]}"
apt_get update || [ ${#missing[@]} -eq 0 ]
[ ${#missing[@]} -eq 0 ] || apt_get -y install --no-install-recommends "${missing[@]}"
for package in "${missing_wanted[@]}"; do
  apt_get -y install --no-install-recommends "$package" ||
    echo "install-packages: $package cannot be had; building without what needs it" >&2
done
