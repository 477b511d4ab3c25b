# A thin front for CMake's presets: the words people try first.
#   make           builds into build/bin
#   make demo      installs what is missing, builds the programs, shows what portals are good for (demo/)
#   make figures   the paper's Figs 5 to 7 from our renders, in doc/ (bench/figures.sh: size, samples)
#   make stages    pictures of what each stage did, in doc/figures/ (bench/stages.sh: another scene)
#   make portals   how right the portals are on rooms with known openings: doc/portals.md (an hour)
#   make regret    what auto loses, and how right it is about portals: doc/regret.md (25 minutes)
#   make tradeoff  speed against accuracy of every knob: doc/tradeoff.md (a night; QUICK=1: three quarters of an hour)
#   make whole-light   what the light beyond six edges costs: doc/whole-light.md (half an hour; BASE=PROGRAM: an older one)
#   make target-error   whether pictures have the error that was asked for: doc/target-error.md (ten minutes)
#   make sky       what the windows found are worth under skies: doc/sky.md (a quarter of an hour)
#   make only-needed   what a scene does not ask for costs how much: doc/only-needed.md (half an hour)
#   make grid-speed   segments per second of lightgrid on each device: doc/light-grid-speed.md (two minutes)
#   make gpu-speed    samples per second of tdpt-render on a device, share and size of each kernel: doc/gpu-speed.md (ten
#                  minutes; DEVICE=gpu:WHICH)
#   make limit     how far rendering is from casting its rays and nothing else, with a profile: doc/limit.md (4 minutes)
#   make scale     time and memory of every program, a thousand to ten million triangles: doc/scale.md (a quarter of an
#                  hour, 5 GiB of memory)
#   make test      installs what is missing, builds, runs every test
#   make test-slurm    the files of doc/farm/ under Slurm, on this machine, as root: a node dies, the bytes stay (three minutes)
#   make test-report   reports of three scenes, opened in a headless Chromium: build/report (five minutes)
#   make bench     speed, and noise after a minute, of every integrator (bench/integrator-speed.sh; 20 minutes)
#   make bench-efficiency   error against time of every integrator, with aims: doc/efficiency.md (an hour on two
#                  cores; BASELINE=PROGRAM BASELINE_NAME=WORDS: gains are over that older one's)
#   make efficiency-references   its references that are missing or out of date, in testdata/references/efficiency
#   make shards    what it costs to render in shards: doc/shards.md (half an hour)
#   make install   programs, man pages, completions, tdpt.mk and doc/farm/ under PREFIX (and DESTDIR), after building what is missing
#   make uninstall takes away what that put there, with the same PREFIX and DESTDIR
#   make package   a Debian package, build/tdpt_VERSION_ARCH.deb, of the sources as they lie here
#   make package-test   installs that on a bare Debian 12, made in BARE=FOLDER, and tries it there; as root
#   make sanitize  builds with the sanitizers into build-sanitize and runs every test there
#   make fuzz      libFuzzer on every reader, SECONDS=60 each, with clang (TARGETS="scene cut": these; ROUNDS=N: N times at
#                  most, until a round brings no new edge): doc/fuzzing.md
#   make packages  installs the Debian packages of cmake/packages*.txt that are missing
#   make format    clang-format over all sources
#   make clean     removes what was built
PREFIX ?= /usr/local
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
# .ci/run names a file here, to learn the exit code of ctest instead of make's.
TEST_STATUS ?=

# All that is there to run; `make build` adds every test and benchmark.
PROGRAMS = ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge tdpt-info tdpt

.PHONY: all build programs demo figures stages portals regret tradeoff whole-light target-error sky only-needed grid-speed gpu-speed scale limit bench bench-efficiency efficiency-references shards test test-slurm test-report install uninstall package package-test sanitize fuzz packages format clean
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
	@echo "make test: installs the packages that are missing, compiles everything (6 minutes on 2 quiet cores, less what" \
	  "ccache has) and runs every test (about as long again)"
	@$(MAKE) --no-print-directory packages build
	@ctest --preset release --parallel $(JOBS); code=$$?; \
	if [ -n "$(TEST_STATUS)" ]; then echo $$code >"$(TEST_STATUS)"; else exit $$code; fi

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
	@$(MAKE) --no-print-directory programs
	@sh bench/demo.sh build/bin demo

figures: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@sh bench/figures.sh build/bin build/figures

portals: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@sh bench/portals.sh build/bin build/portals >build/portals.md
	@mv build/portals.md doc/portals.md

regret: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@sh bench/regret.sh build/bin build/regret doc

tradeoff: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@sh bench/tradeoff.sh build/bin build/tradeoff

whole-light: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@BASE="$(BASE)" sh bench/whole-light.sh build/bin build/whole-light

target-error: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@sh bench/target-error.sh build/bin build/target-error

sky: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@sh bench/sky.sh build/bin build/sky

only-needed: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@cmake --build --preset release --parallel $(JOBS) --target tdpt-render-diffuse
	@INSTRUCTIONS="$(INSTRUCTIONS)" sh bench/only-needed.sh build/bin build/only-needed >build/only-needed.md
	@mv build/only-needed.md doc/only-needed.md

# DEVICE: gpu, or gpu:WHICH of lightgrid --list-devices.
grid-speed: packages
	@$(MAKE) --no-print-directory build
	@sh bench/light-grid-speed.sh build/bin $(DEVICE) >build/light-grid-speed.md
	@mv build/light-grid-speed.md doc/light-grid-speed.md

gpu-speed: packages
	@$(MAKE) --no-print-directory build
	@sh bench/gpu-speed.sh build/bin build/gpu-speed $(DEVICE) >build/gpu-speed.md
	@mv build/gpu-speed.md doc/gpu-speed.md

limit: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@sh bench/limit.sh build/bin build/limit

scale: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory programs
	@sh bench/scale.sh build/bin build/scale

stages: programs
	@sh bench/stages.sh build/bin build/stages

bench: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@build/bin/lights_bench
	@sh bench/integrator-speed.sh build/bin build/bench

bench-efficiency: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@BASELINE="$(BASELINE)" sh bench/efficiency.sh build/bin

efficiency-references: packages
	@sh cmake/install-packages.sh cmake/packages-figures.txt
	@$(MAKE) --no-print-directory build
	@REFERENCES=make COMMIT="$$(git describe --always --dirty 2>/dev/null)" sh bench/efficiency.sh build/bin

shards: programs
	@sh bench/shards.sh build/bin build/shards >build/shards.md
	@mv build/shards.md doc/shards.md

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

package:
	@sh cmake/install-packages.sh
	@sh cmake/install-packages.sh cmake/packages-package.txt
	@JOBS=$(JOBS) sh cmake/package.sh build

# BARE: the folder of the bare system, which stays for the next time.
package-test: package
	@sh cmake/install-packages.sh cmake/packages-package-test.txt
	@sh .ci/package.sh build/tdpt_*.deb "$(or $(BARE),build/bare)"

uninstall:
	@DESTDIR="$(DESTDIR)" sh cmake/uninstall.sh "$(PREFIX)"

format:
	@command -v clang-format >/dev/null || { echo "clang-format is missing"; exit 1; }
	@git ls-files -z '*.h' '*.cpp' | xargs -0 clang-format -i

clean:
	@rm -rf build build-dev build-sanitize build-fuzz demo
