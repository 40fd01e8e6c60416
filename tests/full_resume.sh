# The long form of test_resume.sh.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_resume.sh" 20
