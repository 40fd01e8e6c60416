# The long form of test_memory.sh: limits on the memory of larger scenes. soak_memory.sh takes more of them.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_memory.sh" long
