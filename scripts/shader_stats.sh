#!/usr/bin/env bash
# What a real compiler makes of each compute pipeline, without a GPU: Mesa's RADV compiles for AMD chips that are not
# there.
#
#   shader_stats.sh [--quick] BENCH_GPU FIELD.olx [CHIP...]
#
# runs octalux-bench-gpu --compile --json for each chip and prints one line for each; default chips: navi21 polaris10.
# With --quick, pipelines of other tracers and selectors than the default are left out.
#
# Exits with 77 where RADV is not installed (Debian: mesa-vulkan-drivers).
set -euo pipefail
quick=
if [ "${1:-}" = --quick ]; then quick=--quick && shift; fi
[ $# -ge 2 ] || { sed -n '2,/^set -e/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
bench=$1 field=$2
shift 2
[ $# -gt 0 ] || set -- navi21 polaris10
driver=
for file in /usr/share/vulkan/icd.d/radeon_icd.*.json /etc/vulkan/icd.d/radeon_icd.*.json; do
  [ -e "$file" ] && driver=$file
done
[ -n "$driver" ] || { echo "shader_stats.sh: RADV is not installed" >&2; exit 77; }
for chip; do
  RADV_FORCE_FAMILY=$chip MESA_SHADER_CACHE_DISABLE=true VK_ICD_FILENAMES=$driver VK_DRIVER_FILES=$driver \
    "$bench" --compile $quick --field "$field" --json
done
