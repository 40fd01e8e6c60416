# Sourced by tests of the viewer: helpers that check pictures, make calls of Vulkan fail, and start a display of their
# own, so that the user's display is never used.
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
unset DISPLAY WAYLAND_DISPLAY
[ -x "$(dirname "$OCTALUX")/octalux-view" ] || { echo "this build has no viewer"; exit 77; }

program=$OCTALUX
# Under the address sanitizer the drivers stay loaded, so that a leak report can name the memory that they keep
# (leaks.supp).
if ldd "$OCTALUX" | grep -q libasan; then
  printf '#!/bin/sh\nexec env LD_LIBRARY_PATH="%s" LD_PRELOAD=libkeep_drivers.so "%s" "%s" "$@"\n' \
    "$OCTALUX_FAULT_LAYER${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" \
    "ASAN_OPTIONS=${ASAN_OPTIONS:-}:verify_asan_link_order=0" "$OCTALUX" >kept
  chmod +x kept
  OCTALUX=$folder/kept
fi

"$OCTALUX" bake builtin:cornell-glossy -o cornell.olx --radiance-size 64 --irradiance-size 16 --bounces 1 --noise 0.2 \
  --select cage,bricks >stdout.txt 2>stderr.txt
view=(view builtin:cornell-glossy --field cornell.olx --size 96x80)

# check EXPRESSION FILE...: checks that the expression is true of these pictures.
check() { python3 "$OCTALUX_SOURCE_DIR/tests/read_png.py" "$@" || fail "pictures: $*"; }

# fault CALL:NUMBER:RESULT COMMAND...: runs the command with that call of Vulkan failing.
fault() {
  local wish=$1
  shift
  FAULT=$wish VK_LAYER_PATH=$OCTALUX_FAULT_LAYER VK_INSTANCE_LAYERS=VK_LAYER_OCTALUX_fault "$@"
}
lost=-4 out_of_memory=-2 out_of_date=-1000001004 surface_lost=-1000000000

# Starts an X server for this test alone, or ends the test where there is no Xvfb.
start_display() {
  command -v Xvfb >/dev/null || { echo "no Xvfb here: windows are not tested"; finish; }
  Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp 3>display.txt 2>xvfb.txt &
  server=$!
  trap 'kill $server 2>/dev/null; wait $server 2>/dev/null; rm -rf "$folder"' EXIT
  for _ in $(seq 1000); do [ -s display.txt ] && break; sleep 0.1; done
  [ -s display.txt ] || { fail "Xvfb does not start"; cat xvfb.txt; finish; }
  DISPLAY=:$(cat display.txt)
  export DISPLAY
}
