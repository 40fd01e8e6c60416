# Bakes in one part and in 64 parts make the same field as a whole bake, as test_parts.sh checks for seven.
OLX_PARTS="1 64" exec bash "$(dirname "$0")/test_parts.sh"
