# SPDX-License-Identifier: Apache-2.0
#
#   make         build the libraries and the command: build/imukit
#   make demo    a first result: simulate a sensor, identify it, see the report
#   make test    build and run every test
#   make check   format, static analysis, sanitizers, portability, byte identity
#   make tidy-deep  what `make check` reads with clang's analyzer, with 75 times its patience
#   make sanitize-all  every test with the sanitizers, of which `make check` runs a part
#   make bench   speed against yardsticks: build/bench.csv
#   make bench-web  speed of the page in Chromium: frames, opening, long logs
#   make experiments  build the long statistical experiments: build/experiments/*
#   make experiments-all  run them all and renew experiments/results
#   make faults  let memory, files and the disk fail, call by call, under every verb: some minutes
#   make fuzz    feed the parsers with random input for a while
#   make octave  build/octave: functions of GNU Octave; runs their tests
#   make web     the page that does it all in a browser: build/web/index.html
#   make test-web  its tests in Chromium, as it is published
#   make mpi     build/imukit-mpi too: campaigns on many machines (Open MPI)
#   make python  the Python package: a wheel in build/dist, and its tests
#   make install-python  install that wheel for this user's /usr/bin/python3
#   make install [PREFIX=/usr/local] [DESTDIR=]
#   make deps    only install the Debian packages that are missing
#   make clean
#
# Each does all its set-up, so any of them may be the first command on a fresh machine.

BUILD  ?= build
PREFIX ?= /usr/local
JOBS   ?= $(shell getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
# Beside each of a thousand compilations make runs a program that says so; ninja says it itself.
export CMAKE_GENERATOR ?= $(if $(shell command -v ninja),Ninja,Unix Makefiles)

# CMake runs a make of its own, which is not a part of this one.
alone = env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL
# Say nothing unless it fails.
quiet = >$(BUILD)/make.log 2>&1 || { cat $(BUILD)/make.log; exit 1; }
configure = mkdir -p $(BUILD) && $(alone) cmake -S . -B $(BUILD) -D CMAKE_BUILD_TYPE=Release
compile = $(alone) cmake --build $(BUILD) -j $(JOBS)

.PHONY: all demo test check tidy-deep sanitize-all bench experiments experiments-all faults fuzz octave web test-web bench-web mpi python install-python install deps clean help

all:
	@tools/install_dependencies.sh build
	@$(configure) $(quiet)
	@$(compile) --target product

demo:
	@tools/install_dependencies.sh build run
	@echo "Building $(BUILD)/imukit…"
	@$(configure) $(quiet)
	@$(compile) --target imukit-command $(quiet)
	@$(alone) BUILD=$(BUILD) tools/demo.sh

test:
	@tools/install_dependencies.sh build run test
	@$(configure) -D IMUKIT_TESTS=ON $(quiet)
	@$(compile)
	@ctest --test-dir $(BUILD) --output-on-failure --no-tests=error -j $(JOBS)

check:
	@tools/install_dependencies.sh build run test check
	@$(alone) BUILD=$(BUILD) tools/check

tidy-deep:
	@tools/install_dependencies.sh build check
	@tools/check_tidy.py --deep

sanitize-all:
	@tools/install_dependencies.sh build run test check
	@tools/check_sanitize.sh --all

bench:
	@tools/install_dependencies.sh build bench
	@$(alone) BUILD=$(BUILD) tools/run_bench

bench-web:
	@tools/install_dependencies.sh build web check
	@$(configure) $(quiet)
	@$(compile) --target imukit-command $(quiet)
	@$(alone) BUILD=$(BUILD) tools/build_web.sh
	@$(alone) BUILD=$(BUILD) node --no-warnings bench/page.mjs

experiments:
	@tools/install_dependencies.sh build
	@$(configure) $(quiet)
	@$(compile) --target experiments

experiments-all: experiments
	@$(compile) --target imukit-command
	@$(alone) BUILD=$(BUILD) experiments/run

faults:
	@tools/install_dependencies.sh build test
	@$(configure) $(quiet)
	@$(compile) --target imukit-command $(quiet)
	@$(alone) BUILD=$(BUILD) tools/run_faults

fuzz:
	@tools/install_dependencies.sh build fuzz
	@$(alone) tools/run_fuzz

octave:
	@tools/install_dependencies.sh build octave
	@mkdir -p build-check
	@$(alone) BUILD=$(BUILD) tools/check_octave.sh

web:
	@tools/install_dependencies.sh web
	@$(alone) BUILD=$(BUILD) tools/build_web.sh
	@ls -l $(BUILD)/web/index.html

test-web:
	@tools/install_dependencies.sh build web check
	@$(configure) $(quiet)
	@$(compile) --target imukit-command $(quiet)
	@$(alone) BUILD=$(BUILD) tools/test_web.sh

mpi:
	@tools/install_dependencies.sh build mpi
	@$(configure) -D IMUKIT_MPI=ON $(quiet)
	@$(compile) --target imukit-mpi

python:
	@tools/install_dependencies.sh build python
	@$(configure) $(quiet)
	@$(alone) BUILD=$(BUILD) tools/build_wheel.sh
	@$(alone) BUILD=$(BUILD) tools/test_wheel.sh

install-python: python
	@/usr/bin/python3 -m pip install --user --force-reinstall --no-deps --break-system-packages $(BUILD)/dist/*.whl

install: all
	@cmake --install $(BUILD) --prefix $(PREFIX)

deps:
	@tools/install_dependencies.sh

clean:
	rm -rf build build-check build-fuzz

help:
	@sed -n '3,/^$$/s/^#//p' Makefile
