# Limits on the memory of bakes of five scenes: the long form of full_memory.sh.
LIMITED="cornell labyrinth cornell-glossy pillars" exec bash "$OCTALUX_SOURCE_DIR/tests/test_memory.sh" long
