# for_minutes.sh BUILD-FOLDER TARGET: coverage-guided fuzzing of one target for SOAK_MINUTES (60).
exec bash "$(dirname "$0")/../../scripts/fuzz.sh" "$1" $((60 * ${SOAK_MINUTES:-60})) "$2"
