# Every method places probes in every scene and every optimizer moves them: the long form of full_place.sh.
PLACED="cornell temple sponza white-room kitchen small-house pandora"
SPONZA_COUNTS="0.988 --count 16
0.996 --count 32
0.998 --count 64"
export PLACED SPONZA_COUNTS
OPTIMIZED=$PLACED exec bash "$OCTALUX_SOURCE_DIR/tests/full_place.sh"
