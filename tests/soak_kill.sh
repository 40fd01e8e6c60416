# Bakes that are killed and interrupted, SOAK_KILLS times: the long form of test_kill.sh.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_kill.sh" $(((${SOAK_KILLS:-200} + 2) / 3)) # each round sends three signals
