# A building of 100 x 100 rooms, one square kilometre, in twenty minutes of processor time and 2 GB: the long form of
# full_place_rooms.sh.
ROOMS=100 SECONDS_ALLOWED=1200 MEGABYTES=2000 exec bash "$OCTALUX_SOURCE_DIR/tests/full_place_rooms.sh"
