#!/usr/bin/env bash
# The checks that every change must pass: make check. Takes 16 to 22 minutes of processor time, where 20
# are the aim. Ends with one line that counts everything.
set -uo pipefail
source "$(dirname "$0")/steps.sh"

step "packages" scripts/install-packages.sh check
step "layers, names, words" python3 scripts/check_layers.py
step "tables of docs/results.md" python3 bench/record.py --check
step "build: gcc, release" configure_and_build release && tests release "tests: gcc, release" -L check
step "build: address and undefined sanitizers" configure_and_build asan-core quick-tests &&
  tests asan-core "tests: address and undefined sanitizers" -L check -LE "once|long|script"
finish
