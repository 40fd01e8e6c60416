#!/usr/bin/env bash
# Every check that needs no graphics device: make check-full. CONTRIBUTING.md says how long it takes. Tests on real
# scenes run when OCTALUX_SCENES, or ../shared/scenes beside this checkout, contains them; otherwise they are skipped.
set -uo pipefail
source "$(dirname "$0")/steps.sh"

step "packages" scripts/install-packages.sh full
step "layers, names, words" python3 scripts/check_layers.py
step "tables of docs/results.md" python3 bench/record.py --check
step "build: gcc, release" configure_and_build release &&
  tests release "tests: gcc, release" -L 'check|full'
step "build: clang, release" configure_and_build release-clang &&
  tests release-clang "tests: clang, release" -L check -LE "once|long|script"
step "build: address and undefined sanitizers" configure_and_build asan &&
  tests asan "tests: address and undefined sanitizers" -L 'check|full_sanitized' -LE 'once|script' &&
  tests asan "scripts: address and undefined sanitizers" -L full_sanitized -L script
step "build: thread sanitizer" configure_and_build tsan threads-tests &&
  tests tsan "tests: thread sanitizer" -L threads
guided_fuzzing "coverage-guided fuzzing" guided_full
finish
