# The same room in centimetres and hundreds of metres: scales that round, on a picture large enough that a ray or two which
# falls on another texel does not count.
SCALES="0.01 100" MAP=512 IRRADIANCE=32 IRRADIANCE_GRID=3x3x5 SIZE=256x192 SPP=16 BOUND=1e-4 \
  exec bash "$OCTALUX_SOURCE_DIR/tests/test_scale.sh"
