# The long form of full_mpi.sh: 1, 2, 4 and 7 ranks, each killed MPI_KILLS times.
exec bash "$OCTALUX_SOURCE_DIR/tests/full_mpi.sh" 1,2,4,7 "${MPI_KILLS:-50}"
