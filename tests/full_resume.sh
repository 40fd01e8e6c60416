# The long form of test_resume.sh: more bakes that are killed and resumed.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_resume.sh" 20
