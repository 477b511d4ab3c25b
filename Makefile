# A thin front for CMake's presets: the words people try first.
#   make           builds into build/bin
#   make demo      installs what is missing, builds the programs, shows what portals are good for (demo/)
#   make figures   the paper's Figs 5 to 7 from our renders, in doc/ (bench/run.py figures --help: size, samples)
#   make stages    pictures of what each stage did, in doc/figures/ (bench/run.py stages --help: another scene)
#   make bench     lists the benchmarks; make bench-NAME builds and runs one, whose page in doc/ it writes
#                  (bench/run.py NAME --help tells its settings: make bench-regret SEEDS=3; QUICK=1: sizes of a trial)
#   make test      installs what is missing, builds, runs every test
#   make test-long what is too much for each run, and before a release: sweeps of portals, rooms and materials, and the statistical
#                  tests with 200 fresh seeds each (hours; ONLY=REGEX: those)
#   make test-slurm    the files of doc/farm/ under Slurm, on this machine, as root: a node dies, the bytes stay (three minutes)
#   make test-report   reports of three scenes, opened in a headless Chromium: build/report (five minutes)
#   make install   programs, man pages, completions, tdpt.mk and scripts of doc/ under PREFIX (and DESTDIR), after building what is missing
#   make uninstall takes away what that put there, with the same PREFIX and DESTDIR
#   make tarball   build/tdpt-VERSION-linux-MACHINE.tar.gz: programs, and the libraries they need beside them, for systems
#                  where nothing is installed
#   make tarball-test   tries that on bare systems, Debian 12 and 13, made in BARE=FOLDER; as root
#   make package   a Debian package for this release, build/tdpt_VERSION_ARCH.deb, of the sources as they lie here
#   make package-test   installs that on a bare system of the same release, made in BARE=FOLDER, as the Containerfile
#                  says, and tries it there; as root
#   make sanitize  builds with the sanitizers into build-sanitize and runs every test there
#   make fuzz      libFuzzer on every reader, SECONDS=60 each, with clang (TARGETS="scene cut": these; ROUNDS=N: N times at
#                  most, until a round brings no new edge): testdata/fuzz/README.md
#   make packages  installs the Debian packages of cmake/packages*.txt that are missing
#   make format    clang-format over all sources
#   make clean     removes what was built
PREFIX ?= /usr/local
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
# .ci/run names a file here, to learn the exit code of ctest instead of make's.
TEST_STATUS ?=

# All that is there to run; `make build` adds every test and benchmark.
DEMO_PROGRAMS = ffgraph mincut lightgrid portalfit tdpt-render exrdiff
PROGRAMS = $(DEMO_PROGRAMS) exrmerge tdpt-info tdpt

.PHONY: all build programs demo figures stages bench test test-long test-slurm test-report install uninstall tarball tarball-test package package-test sanitize fuzz packages format clean
all: build

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
	@echo "make test: installs the packages that are missing, compiles everything (ten minutes on 2 quiet cores, less what" \
	  "ccache has) and runs every test (a quarter of an hour)"
	@$(MAKE) --no-print-directory packages build
	@ctest --preset release --parallel $(JOBS); code=$$?; \
	if [ -n "$(TEST_STATUS)" ]; then echo $$code >"$(TEST_STATUS)"; else exit $$code; fi

test-long: packages
	@$(MAKE) --no-print-directory build
	@ctest --preset long --parallel $(JOBS) $(if $(ONLY),-R "$(ONLY)")

# The last two have planted faults, which must be found.
test-slurm: programs
	@sh cmake/install-packages.sh cmake/packages-slurm.txt
	@for what in kills seed processor; do \
	  sh libcommon/testing/slurm_test.sh build/bin testdata doc/farm $$what || exit 1; done

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
	@echo "make demo: ends on the picture demo/before-after.png; first installs the packages that are missing and compiles" \
	  "six programs"
	@$(MAKE) --no-print-directory programs PROGRAMS="$(DEMO_PROGRAMS)"
	@python3 -B bench/run.py demo --cache demo

figures stages: %: bench-%

bench:
	@python3 -B bench/run.py

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
