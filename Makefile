# A thin front for CMake's presets: the words people try first. `make help` prints the lines below that are indented.
#   make                builds everything into build/bin; make programs: without tests and benchmarks
#   make demo           installs what is missing, builds the programs, and shows what portals are good for, in demo/
#
#   make check          builds, and runs the quick tests: two minutes on two cores
#   make test           installs what is missing, builds, and runs every test: six minutes
#   make test-long      before a release: sweeps, and the statistical tests with 200 fresh seeds (hours; ONLY=REGEX)
#   make sanitize       builds with the sanitizers into build-sanitize, and runs every test there
#   make fuzz           runs libFuzzer on every reader, with clang (SECONDS=60 TARGETS="scene cut" ROUNDS=N)
#   make test-slurm     doc/farm under Slurm (as root); make test-report: the report page in a browser
#
#   make install        installs under PREFIX (and DESTDIR); make uninstall, with the same, removes it again
#   make package        builds a Debian package for this release, build/tdpt_VERSION_ARCH.deb
#   make tarball        packs build/tdpt-VERSION-linux-MACHINE.tar.gz: programs with their libraries, nothing to install
#   make wheel          packs the same for pip, and Blender's extension with its programs
#   make X-test         X: package, tarball or wheel; tries that on bare Debian systems (as root; BARE=FOLDER)
#
#   make bench          lists the benchmarks; make bench-NAME runs one, which writes its tables in doc/ (QUICK=1: a trial;
#                       settings, as in make bench-regret SEEDS=3: bench/run.py NAME --help)
#   make figures        renders the paper's figures; make stages: what each stage did (SCENE=room.glb DOC=FOLDER)
#   make peers          installs other renderers from PyPI for tests and benchmarks beside them (2 GB; PYTHON=python3.11)
#   make packages, make format, make clean
PREFIX ?= /usr/local
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
# .ci/run names a file here, to learn the exit code of ctest instead of make's.
TEST_STATUS ?=

# All that is there to run; `make build` adds every test and benchmark.
DEMO_PROGRAMS = ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge exrdenoise
PROGRAMS = $(DEMO_PROGRAMS) tdpt-info tdpt-import tdpt

.PHONY: all help build programs demo figures stages bench peers check test test-long test-slurm test-report install uninstall tarball tarball-test wheel wheel-test package package-test sanitize fuzz packages format clean
all: build

help:
	@sed -n '/^PREFIX/q; s/^#   //p; s/^#$$//p' $(firstword $(MAKEFILE_LIST))

build:
	@command -v cmake >/dev/null || { echo "cmake is missing; 'make packages' installs what is needed"; exit 1; }
	@cmake --preset release --log-level=WARNING
	@cmake --build --preset release --parallel $(JOBS)

# Without tests, so that their packages may be missing.
programs:
	@sh cmake/install-packages.sh
	@cmake --preset release -DBUILD_TESTING=OFF --log-level=WARNING
	@cmake --build --preset release --parallel $(JOBS) --target $(PROGRAMS)

packages:
	@sh cmake/install-packages.sh
	@sh cmake/install-packages.sh cmake/packages-test.txt

test:
	@echo "make test: installs the packages that are missing, compiles everything (seven minutes on 2 quiet cores, less what" \
	  "ccache has) and runs every test (six minutes)"
	@$(MAKE) --no-print-directory packages build
	@ctest --preset release --parallel $(JOBS); code=$$?; \
	if [ -n "$(TEST_STATUS)" ]; then echo $$code >"$(TEST_STATUS)"; else exit $$code; fi

# What an editor wants after each change: without pictures that must agree, devices, whole pipelines and installations.
check: packages
	@$(MAKE) --no-print-directory build
	@ctest --preset check --parallel $(JOBS)

test-long: packages
	@$(MAKE) --no-print-directory build
	@ctest --preset long --parallel $(JOBS) $(if $(ONLY),-R "$(ONLY)")

test-slurm: programs
	@sh cmake/install-packages.sh cmake/packages-slurm.txt
	@sh libcommon/testing/slurm_test.sh build/bin testdata doc/farm

# AJAR: a scene of the paper, left out where it is not there.
AJAR ?= ../shared/scenes/veach-ajar.glb
test-report: programs
	@sh cmake/install-packages.sh cmake/packages-report.txt
	@mkdir -p build/report
	@cp testdata/scenes/two-rooms.glb testdata/scenes/furnace.glb $(wildcard $(AJAR)) build/report
	@$(MAKE) --no-print-directory -s -C build/report -f ../../tools/tdpt.mk TDPT_BIN=../bin/ two-rooms.report.html \
	  furnace.report.html $(patsubst %.glb,%.report.html,$(notdir $(wildcard $(AJAR))))
	@python3 -B tools/tdpt/report_browser_test.py build/report/screenshots build/report/*.report.html

demo:
	@echo "make demo: ends on the picture demo/demo.png; first installs the packages that are missing and compiles" \
	  "$(words $(DEMO_PROGRAMS)) programs"
	@$(MAKE) --no-print-directory programs PROGRAMS="$(DEMO_PROGRAMS)"
	@sh cmake/install-packages.sh cmake/packages-demo.txt
	@python3 -B bench/run.py demo --cache demo

figures stages: %: bench-%

bench:
	@python3 -B bench/run.py

peers:
	@sh cmake/install-packages.sh cmake/packages-peers.txt
	@mkdir -p build/peers
	@$(or $(PYTHON),python3.11) -m venv build/peers/venv
	@build/peers/venv/bin/python -m pip install --quiet --requirement bench/peers.txt

bench-%: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@python3 -B bench/run.py $*

sanitize: packages
	@cmake --preset sanitize --log-level=WARNING
	@cmake --build --preset sanitize --parallel $(JOBS)
	@ctest --preset sanitize --parallel $(JOBS)

fuzz:
	@sh cmake/install-packages.sh
	@sh cmake/install-packages.sh cmake/packages-fuzz.txt
	@cmake --preset fuzz --log-level=WARNING
	@cmake --build --preset fuzz --parallel $(JOBS)
	@FUZZ_SECONDS="$(or $(SECONDS),60)" ROUNDS="$(ROUNDS)" MERGE="$(MERGE)" sh libcommon/testing/files/fuzz.sh build-fuzz/bin testdata build-fuzz/fuzz $(TARGETS)

# No test, and whatever is to be installed.
install:
	@sh cmake/install-packages.sh
	@cmake --preset release -DBUILD_TESTING=OFF --log-level=WARNING
	@cmake --build --preset release --parallel $(JOBS)
	@DESTDIR="$(DESTDIR)" sh cmake/install.sh build "$(PREFIX)"

tarball: programs
	@sh cmake/install-packages.sh cmake/packages-tarball.txt
	@sh cmake/tarball.sh build build

tarball-test: tarball
	@sh cmake/install-packages.sh cmake/packages-package-test.txt
	@for suite in bookworm trixie; do \
	  sh .ci/tarball.sh build/tdpt-*-linux-*.tar.gz "$(or $(BARE),build/bare)/$$suite" $$suite || exit 1; done

wheel: tarball
	@python3 -B cmake/wheel.py build/tdpt-*-linux-*.tar.gz build

wheel-test: wheel
	@sh cmake/install-packages.sh cmake/packages-package-test.txt
	@for suite in bookworm trixie; do \
	  sh .ci/wheel.sh build/tdpt_render-*.whl build/tdpt-*-linux-*.tar.gz "$(or $(BARE),build/bare)/$$suite" $$suite || exit 1; done
	@sh tools/blender/blender_test.sh build/peers/venv/bin/python build/bin "$$(echo "$$PWD"/build/tdpt-blender-*.zip)" \
	  tools/blender/zip_test.py || [ $$? = 77 ]

package:
	@sh cmake/install-packages.sh
	@sh cmake/install-packages.sh cmake/packages-package.txt
	@JOBS=$(JOBS) sh cmake/package.sh build

# BARE: the folder of the bare system, which stays for the next time.
package-test: package
	@sh cmake/install-packages.sh cmake/packages-package-test.txt
	@suite=$$(. /etc/os-release; echo "$$VERSION_CODENAME"); \
	sh .ci/package.sh build/tdpt_*.deb "$(or $(BARE),build/bare)/$$suite" "$$suite"

uninstall:
	@DESTDIR="$(DESTDIR)" sh cmake/uninstall.sh "$(PREFIX)"

format:
	@command -v clang-format >/dev/null || { echo "clang-format is missing"; exit 1; }
	@git ls-files -z '*.h' '*.cpp' | xargs -0 clang-format -i

clean:
	@rm -rf build build-dev build-sanitize build-fuzz demo
