#!/usr/bin/env bash
# Checks that take hours: make soak. SOAK_MINUTES sets how long each fuzzer and each target of coverage-guided fuzzing
# runs (60), SOAK_KILLS how many bakes are killed (200), SOAK_SEED the first seed of the fuzzers (1). Ends with one line
# that counts everything, as the checks do.
set -uo pipefail
source "$(dirname "$0")/steps.sh"

step "packages" scripts/install-packages.sh soak
step "build: gcc, release" configure_and_build release && tests release "soak: gcc, release" -L soak
step "build: address and undefined sanitizers" configure_and_build asan soak-tests &&
  tests asan "soak: address and undefined sanitizers" -L soak
guided_fuzzing "soak: coverage-guided fuzzing" guided_soak
finish
