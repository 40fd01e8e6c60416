# Octalux: `make demo` for a picture, `make check` for the tests, `make check-full` and `make soak` for more of them; `make install`,
# or `make packages` for Debian's and `make dist` for the source. JOBS=N limits the processors a build uses.
JOBS ?= $(shell nproc)
PREFIX ?= /usr/local
OCTALUX := build/release/octalux

.PHONY: build demo check check-full soak fuzz bench install wheel packages dist clean tidy format build-packages check-packages

build: build-packages
	@cmake --preset release $(if $(wildcard build/release/CMakeCache.txt),>/dev/null,)
	@cmake --build build/release --parallel $(JOBS)

build-packages:
	@scripts/install-packages.sh build

check-packages:
	@scripts/install-packages.sh check

demo: build
	@scripts/demo.sh $(OCTALUX) build/demo

check:
	@JOBS=$(JOBS) scripts/check.sh

check-full:
	@JOBS=$(JOBS) scripts/check-full.sh

soak:
	@JOBS=$(JOBS) scripts/soak.sh

# Coverage-guided fuzzing of every reader of files, MINUTES (10) each; TARGETS="field gltf" takes some.
MINUTES ?= 10
fuzz: check-packages
	@cmake --preset fuzz >/dev/null && cmake --build build/fuzz --parallel $(JOBS) --target fuzzers
	@scripts/fuzz.sh build/fuzz $$((60 * $(MINUTES))) $(TARGETS)

bench: check-packages build
	@mkdir -p build/bench
	@$(OCTALUX) bake builtin:cornell -o build/bench/speed.olx --grid 4x4x4 --radiance-size 256 --irradiance-size 64
	@build/release/octalux-bench runtime-speed build/bench/speed.olx
	@build/release/octalux-bench all --report build/bench/report
	@python3 bench/studies.py

install: build
	@cmake --install build/release --prefix "$(PREFIX)"

wheel: build
	@python3 python/wheel_backend.py build/release build/wheel

packages: check-packages build
	@scripts/make_packages.sh build/release build/packages

dist:
	@scripts/make_dist.sh build/dist

tidy: check-packages build
	@git ls-files 'src/*.c' 'host/*.c' 'cli/*.c' 'viewer/*.c' 'bench/*.c' | xargs -P $(JOBS) -n 4 clang-tidy --quiet -p build/release

format: check-packages
	@git ls-files '*.c' '*.h' | xargs clang-format -i

clean:
	@rm -rf build
