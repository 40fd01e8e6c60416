# A room in centimetres and in hundreds of metres gives the same picture as in metres. These scales are not powers of
# two, so light is solved at other points, and pictures may differ by less than the noise of a bake, 2 %: a relative MSE
# of 4e-4.
SCALES="0.01 100" MAP=512 IRRADIANCE=32 IRRADIANCE_GRID=3x3x5 SIZE=256x192 SPP=16 BOUND=4e-4 \
  exec bash "$OCTALUX_SOURCE_DIR/tests/test_scale.sh"
