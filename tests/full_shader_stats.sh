# Checks the bounds of tests/shader_bounds.tsv for every pipeline, on navi21 and on an older chip, polaris10, whose
# shaders run in waves of 64.
OLX_CHIPS="navi21 polaris10" exec bash "$(dirname "$0")/test_shader_stats.sh"
