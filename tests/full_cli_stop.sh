# Every command stops when a signal comes, at more moments than test_cli_stop.sh has time for.
OLX_ALL_STOPS=1 exec bash "$(dirname "$0")/test_cli_stop.sh"
