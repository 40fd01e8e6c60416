# The long form of test_resume.sh: bakes that are killed at least RESUME_KILLS times, and resumed.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_resume.sh" "${RESUME_KILLS:-200}"
