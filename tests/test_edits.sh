# A scene is edited between bakes that keep their work folder: each gives the field of a fresh bake, byte for byte, and
# reuses what still holds. test_edits.sh [EDITS].
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 "$OCTALUX_SOURCE_DIR/tests/edits.py" "$work" "${1:-4}" "${SOAK_SEED:-1}" "$OCTALUX"
