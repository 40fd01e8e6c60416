# The long form of test_memory.sh: limits on the memory of more and larger scenes.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_memory.sh" long
