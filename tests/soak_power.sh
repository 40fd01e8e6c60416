# The long form of full_power.sh: the power goes at every call of fsync.
exec bash "$OCTALUX_SOURCE_DIR/tests/full_power.sh" 1
