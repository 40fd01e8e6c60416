# Many random edits of a scene, each of which must give the field of a fresh bake (test_edits.sh).
exec bash "$OCTALUX_SOURCE_DIR/tests/test_edits.sh" 60
