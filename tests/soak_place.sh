# Every method places probes in every scene and every optimizer moves them: the long form of full_place.sh.
OPTIMIZED="cornell temple sponza white-room kitchen small-house pandora" exec bash "$OCTALUX_SOURCE_DIR/tests/full_place.sh"
