# More free probes in Sponza: the long form of full_free_probes.sh.
OLX_ALL_FREE_PROBES=1 exec bash "$OCTALUX_SOURCE_DIR/tests/full_free_probes.sh"
