# Bakes that are killed RESUME_KILLS times and more, and go on.
exec bash "$OCTALUX_SOURCE_DIR/tests/test_resume.sh" "${RESUME_KILLS:-200}"
