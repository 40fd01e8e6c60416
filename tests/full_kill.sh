# The long form of test_kill.sh.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_kill.sh" 40
