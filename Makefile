# flexbeam: GNU make. Everything is built under build/; `make test` needs a C compiler and make, nothing else.

CC     ?= cc
CFLAGS ?= -O2
CORES := $(shell nproc 2> /dev/null || echo 1)
ON_ALL_CORES = $(MAKE) --no-print-directory $(if $(findstring -j,$(MAKEFLAGS)),,-j$(CORES))

WARNINGS   = -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wundef -Wvla -Werror=unused-function
WARNINGS_C = -Wstrict-prototypes -Wmissing-prototypes
FLAGS      = -std=c99 -I. -ffp-contract=off $(WARNINGS) $(WARNINGS_C)
export WARNINGS WARNINGS_C

LIBRARY  = flexbeam.h flexbeam_impl.h
TESTS    = $(wildcard tests/test_*.c)
EXAMPLES = quickstart spinup table1 assembly firmware spacecraft rotor rotor_flap arm fourbar \
           elastica follower flap whirl wing_goland ground_resonance rotor_flight leigh hil_plant hil_controller \
           tutorial_satellite tutorial_blade tutorial_import tutorial_large tutorial_firmware page
EXAMPLES += $(if $(shell command -v mpicc),campaign_mpi) $(if $(shell command -v $(CXX)),tutorial_filter)
WORDS    = scene campaign reduce fmu elastodyn analyse advise exact
PACKAGES = meson conan vcpkg arduino platformio esp-idf zephyr consumer sbom
# long ones first, so that the two jobs of `make ci` end together
CHECKS   = tidy memory bits code firmware suite sanitize hostile fuzz instructions compile fmu stack faults rom removed coverage code_scene campaign single long rooms parts mismatch \
           advise symbols threads two_precisions jacobian trace python style ids documents quickstart first_build fast_math output hil aero scene curves modes linear import mesh blade packages page hard laws

.DELETE_ON_ERROR:
.PHONY: help run tool table1 leigh scenes blade page python firmware hil campaign campaign-mpi test laws quick quick-double quick-single quick-c++ coverage mutants mutants-laws hard examples bench bench-accuracy bench-advice bench-campaign bench-flags bench-jitter bench-peers sizes fuzz readme format clean ci ci-all seconds install uninstall packages FORCE $(CHECKS:%=check-%) check-tables $(PACKAGES:%=package-%)

help:
	@echo "make run       spin-up of a flexible beam against its reference, time per step, picture if gnuplot is there"
	@echo "make tool      build/flexbeam: $(WORDS)"
	@echo "make blade     Campbell diagram of the NREL 5-MW blade, 0 to 20 rpm: build/campbell.csv, build/campbell.svg"
	@echo "make page      a page to try it on, one file for a browser: build/page/flexbeam.html (clang and lld)"
	@echo "make table1    the forms of the equations of motion, figures and accuracy of D'Eleuterio and Barfoot: build/table1/"
	@echo "make leigh     every case of chapter 4 of Leigh's thesis by the exact beam, beside its figures: build/leigh/"
	@echo "make scenes    every scene of examples/scenes: build/scenes/NAME.csv, curves, pictures and animations as SVG, frames"
	@echo "make python    scenes from Python: a wheel of the package flexbeam (examples/bindings), build/bindings/"
	@echo "make firmware  the attitude loop of examples/firmware/firmware.c on an emulated Cortex-M4F and -M7, against the desktop"
	@echo "make hil       a spacecraft at 1 kHz in real time and its controller, two processes over UDP, 60 s: build/hil.csv"
	@echo "make test      build and run the tests"
	@echo "make laws      random legal models against laws that need no reference, both precisions (LAWS_COUNT=300, LAWS_SEED=days)"
	@echo "make quick     before a commit, two minutes: short tests in both precisions, C++, layout, ids, documents, quick start"
	@echo "make coverage  lines and branches of the library that the tests run, by section; what they leave: build/coverage/"
	@echo "make mutants   200 equations changed one at a time, the tests must notice (SEED=1, COUNT=200; half an hour)"
	@echo "make mutants-laws  the same of what flies, noticed by make laws alone (hours)"
	@echo "make campaign  a spacecraft with scattered stiffness, mass and damping, 200 runs on all cores: build/campaign/"
	@echo "make campaign-mpi  the same for clusters: build/examples/campaign_mpi"
	@echo "make hard      the hard cases in both precisions, beside what a naive treatment gives (2 minutes): build/hard.csv"
	@echo "make examples  $(EXAMPLES:%=build/examples/%)"
	@echo "make bench     time per step by modes and effects, by form and integrator, of systems, of the exact beam: build/bench_*.csv"
	@echo "make bench-accuracy  error and time of eight scenes by effects, modes, integrator and step (6 minutes): build/accuracy/"
	@echo "make bench-advice  what the library advises for those scenes, variations of them and several appendages, against all runs (3 minutes)"
	@echo "make bench-flags  time of a step and code of the library by compiler flags (2 minutes)"
	@echo "make bench-campaign  runs per second of a campaign by number of processes and of MPI ranks"
	@echo "make bench-jitter  instructions of each of 100,000 steps of every stepper, on two emulated boards (2 minutes)"
	@echo "make bench-peers  the LU beside LAPACK's, the integrators beside SUNDIALS', beams and links beside MuJoCo, exudyn, pinocchio and drake: says what it needs (45 minutes)"
	@echo "make sizes     instructions, code, RAM and time of a step by modes and effects on two boards; bytes of all structs; compile time"
	@echo "make fuzz      hostile input at random, by libFuzzer: FUZZ_SECONDS=60 for each of four harnesses (tests/fuzz)"
	@echo "make readme    regenerate the tables, program and pictures of the documents (wants gnuplot, valgrind)"
	@echo "make ci        every check beside make test: compilers, standards, sanitizers, symbols, stack, instructions, style, ..."
	@echo "make ci-all    the same with all random models: make ci takes every fourth of them, others each day"
	@echo "make seconds   of the processor, by every check when it last ran, the slowest first"
	@echo "make check-X   one of them: $(sort $(CHECKS))"
	@echo "make install   headers, build/flexbeam, pkg-config and CMake files into PREFIX=/usr/local (DESTDIR=); make uninstall"
	@echo "make packages  recipes with the headers, build/packages/: $(PACKAGES); make package-X: one of them"
	@echo "make format    clang-format all sources"
	@echo "make clean     remove build/"

# ---- what users run

run: build/examples/spinup
	$< --reference tests/reference/p07C_second_order.csv --out build/spinup.csv

tool:
	@$(ON_ALL_CORES) build/flexbeam

table1: build/examples/table1
	@mkdir -p build/table1
	@$< --out build/table1 > build/table1/tables.txt; status=$$?; cat build/table1/tables.txt; exit $$status

leigh: build/examples/leigh
	@mkdir -p build/leigh
	@$< --out build/leigh > build/leigh/tables.txt; status=$$?; cat build/leigh/tables.txt; exit $$status

scenes: build/flexbeam
	@mkdir -p build/scenes
	@status=0; for file in examples/scenes/*.txt; do \
	  name=build/scenes/$$(basename $$file .txt); echo "$$file"; \
	  $< scene $$file --out $$name.csv --picture $${name}_picture.svg --animation $${name}_moves.svg --frames $$name || status=1; \
	done; exit $$status

blade: build/flexbeam
	$< scene examples/scenes/nrel_blade.txt --campbell rpm 0 20 21 --out build/campbell.csv

firmware:
	@echo "two boards, two levels of optimization, 80 s of flight each: some minutes"
	@$(MAKE) -s --no-print-directory check-firmware
	@echo && echo "Cortex-M4F, single precision, -O2:" && cat build/checks/firmware/board_single-O2.txt
	@echo && echo "Cortex-M7, double precision, -O2:" && cat build/checks/firmware/board_double-O2.txt
	@echo && echo "Cortex-M4F, single precision, -O2, the step by reduce --code:" && cat build/checks/firmware/board_generated_single-O2.txt

page: build/page/flexbeam.html

python: build/bindings/libflexbeam_scene.so
	@command -v python3 > /dev/null || { echo "python: no python3 (Debian: apt-get install python3)"; exit 1; }
	@rm -f build/bindings/*.whl; wheel=$$(python3 examples/bindings/python/wheel_of_make.py build/bindings) && \
	echo "pip install build/bindings/$$wheel" && { python3 -c 'import numpy' 2> /dev/null || echo "it wants NumPy, which pip fetches (Debian: apt-get install python3-numpy)"; }

hil: build/examples/hil_plant build/examples/hil_controller
	@rm -f build/hil.key; (umask 077; od -An -N16 -tx1 /dev/urandom | tr -d ' \n' > build/hil.key)
	@build/examples/hil_controller --key build/hil.key > build/hil_controller.txt & \
	build/examples/hil_plant --key build/hil.key --out build/hil.csv; status=$$?; \
	wait $$! || status=1; cat build/hil_controller.txt; exit $$status

campaign: build/flexbeam
	@mkdir -p build/campaign
	$< campaign examples/campaigns/slew.txt --out build/campaign/slew.csv

campaign-mpi:
	@command -v mpicc > /dev/null || { echo "campaign-mpi: no mpicc (Debian: apt-get install openmpi-bin libopenmpi-dev)"; exit 1; }
	@$(MAKE) -s --no-print-directory build/examples/campaign_mpi && echo "mpirun -n N build/examples/campaign_mpi FILE"

# The tests, a part of them on each core, and a few random models against the laws that every model keeps. The last line counts all.
test: check-quickstart
	@$(ON_ALL_CORES) -s build/quick_double build/laws
	@{ build/laws --count 20 --seed 1 & for k in $$(seq $(CORES)); do build/quick_double --part=$$k/$(CORES) & done; wait; } | awk -v parts=$$(($(CORES) + 1)) \
	  '/^[0-9]+ passed, [0-9]+ failed$$/ { passed += $$1; failed += $$3; ends++; next } { print; fflush() } \
	   END { failed += parts - ends; print passed " passed, " failed " failed"; exit failed > 0 }'

laws: check-laws

# The slow ones first; a failed part does not hide what the others say.
quick:
	@$(MAKE) -s -k -j2 --no-print-directory CFLAGS='-O1 -Werror' quick-single quick-double quick-c++ check-style check-ids \
	  check-documents check-quickstart
	@echo "quick: all passed; make test and make ci run the rest"

hard: build/hard_double build/hard_single
	@status=0; for p in double single; do \
	  build/hard_$$p --out build/hard_$$p.csv > build/hard_$$p.txt || status=1; cat build/hard_$$p.txt; \
	done; (cat build/hard_double.csv; tail -n +2 build/hard_single.csv) > build/hard.csv; exit $$status

coverage:
	@$(MAKE) -s --no-print-directory check-coverage && cat build/coverage/table.txt

mutants:
	@CC='$(CC)' sh tests/mutants/mutants.sh $(or $(SEED),1) $(or $(COUNT),200)

mutants-laws:
	@CC='$(CC)' sh tests/laws/mutants.sh $(or $(SEED),1) $(or $(COUNT),200)

examples: tool $(EXAMPLES:%=build/examples/%)

bench: build/bench/bench_step_double build/bench/bench_step_single build/bench/bench_forms_double build/bench/bench_system_double build/bench/bench_exact_double
	@for p in double single; do \
	  echo "$$p:" && build/bench/bench_step_$$p > build/bench_step_$$p.csv && \
	  awk -F, '/^#/ { print; next } { printf "%-9s %5s  %-13s %9s %9s %9s %9s %7s %15s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8, $$9 }' \
	    build/bench_step_$$p.csv || exit 1; \
	done
	@build/bench/bench_forms_double > build/bench_forms.csv && \
	awk -F, '/^#/ { print; next } { printf "%-10s %8s %3s %9s %8s %8s %16s %15s\n", $$1, $$2, $$3, $$4, $$5, $$6, $$7, $$8 }' build/bench_forms.csv
	@build/bench/bench_system_double > build/bench_system.csv && awk -F, -f bench/system.awk build/bench_system.csv
	@build/bench/bench_exact_double > build/bench_exact.csv && awk -F, -f bench/exact.awk build/bench_exact.csv

bench-accuracy: build/bench/bench_accuracy_double
	@mkdir -p build/accuracy
	@$< build/accuracy > build/accuracy/tables.txt; status=$$?; cat build/accuracy/tables.txt; \
	if gnuplot --version > /dev/null 2>&1; then gnuplot -e "folder='build/accuracy'" bench/accuracy.gp; else \
	  echo "no pictures: gnuplot is not installed (Debian: apt-get install gnuplot-nox); build/accuracy/accuracy.csv has the points"; fi; \
	exit $$status

bench-advice: build/bench/bench_advice_double
	@$< > build/bench_advice.txt && cat build/bench_advice.txt

bench-flags:
	@sh bench/flags.sh

bench-campaign: build/flexbeam $(filter %_mpi,$(EXAMPLES:%=build/examples/%))
	@sh bench/campaign.sh

bench-jitter: build/flexbeam
	@sh bench/jitter.sh

bench-peers:
	@CC='$(CC)' MAKE='$(MAKE)' sh bench/peers.sh

sizes: build/flexbeam
	@CC='$(CC)' sh bench/sizes.sh
	@echo && CC='$(CC)' sh bench/compile.sh

fuzz:
	@sh tests/fuzz/fuzz.sh

readme: examples build/bench/bench_exact_double build/bench/bench_system_double build/bench/bench_forms_double build/bench/identities_double build/readme/figures_double build/readme/figures_single
	sh bench/readme.sh

build/readme/figures_double build/readme/figures_single: $(wildcard tests/*.[ch]) $(LIBRARY) | build/readme
	$(CC) $(FLAGS) $(CFLAGS) -DFB_SINGLE=$(if $(findstring single,$@),1,0) -o $@ $(TESTS) -lm

# ---- packages: recipes of examples/packages, laid out under build/packages with the headers

PREFIX ?= /usr/local

install: build/flexbeam
	@DESTDIR='$(DESTDIR)' PREFIX='$(PREFIX)' sh examples/packages/lay_out.sh install

uninstall:
	@DESTDIR='$(DESTDIR)' PREFIX='$(PREFIX)' sh examples/packages/lay_out.sh uninstall

packages: $(PACKAGES:%=package-%)

$(PACKAGES:%=package-%): package-%:
	@sh examples/packages/lay_out.sh $*

format:
	find . -name build -prune -o -name '*.[ch]' -exec clang-format -i {} +

clean:
	rm -rf build

# ---- programs

vpath %.c examples $(wildcard examples/*)

# The library once for each configuration: as it is by default, that of the tool (and of larger examples), that of the
# papers' beams. Examples define FLEXBEAM_IMPLEMENTATION, so that each compiles alone; here that is left to the object.
SHARED   = $(FLAGS) $(CFLAGS) -MMD -MP
LARGER   = assembly elastica flap follower rotor rotor_flap whirl leigh ground_resonance rotor_flight tutorial_import campaign_mpi
PAPERS   = spinup table1
OF_THEIR_OWN = quickstart firmware tutorial_firmware tutorial_filter page # the single file; a model in ROM, or a page, with the smallest library

build/library/double.o build/library/single.o: flexbeam.h build/flags | build/library
	echo '#include "flexbeam.h"' | $(CC) $(SHARED) -MT $@ -MF $(@:.o=.d) -DFB_SINGLE=$(if $(findstring single,$@),1,0) -DFB_WITH_DETAIL=1 -DFLEXBEAM_IMPLEMENTATION -c -o $@ -x c -

build/library/papers.o: flexbeam.h examples/papers/capacities.h build/flags | build/library
	echo '#include "flexbeam.h"' | $(CC) $(SHARED) -MT $@ -MF $(@:.o=.d) -DFLEXBEAM_CONFIG='"examples/papers/capacities.h"' -DFLEXBEAM_IMPLEMENTATION -c -o $@ -x c -

# For FMUs, too, whose symbols are nobody else's.
build/library/tool.o: examples/tools/library.c build/flags | build/library
	$(CC) $(SHARED) -fPIC -fvisibility=hidden -c -o $@ $<

build/examples/%.o: %.c build/flags | build/examples
	$(if $(filter campaign_mpi,$*),mpicc,$(CC)) $(SHARED) -DFLEXBEAM_IMPL_INCLUDED -c -o $@ $<

$(LARGER:%=build/examples/%): build/library/tool.o
$(PAPERS:%=build/examples/%): build/library/papers.o
$(filter-out $(LARGER:%=build/examples/%) $(PAPERS:%=build/examples/%) $(OF_THEIR_OWN:%=build/examples/%),$(EXAMPLES:%=build/examples/%)): build/library/double.o
$(filter-out $(OF_THEIR_OWN:%=build/examples/%),$(EXAMPLES:%=build/examples/%)): build/examples/%: build/examples/%.o
	$(if $(filter campaign_mpi,$*),mpicc,$(CC)) $(CFLAGS) -o $@ $^ -lm

build/examples/quickstart build/examples/page: build/examples/%: %.c build/flags | build/examples
	$(CC) $(SHARED) -MT $@ -MF $@.d -o $@ $< -lm

# The tracer (--code, --jacobian) is C++; without a compiler for it the program says what to install.
TRACE := $(if $(shell command -v $(CXX)),trace trace_single,untraced)
build/flexbeam: build/tool/flexbeam.o $(WORDS:%=build/tool/%.o) $(TRACE:%=build/tool/%.o) build/library/tool.o | build/tool/fmu2.so build/tool/fmu3.so
	$(if $(filter trace,$(TRACE)),$(CXX),$(CC)) $(CFLAGS) -o $@ $^ -lm

build/tool/trace.o build/tool/trace_single.o: examples/tools/trace/trace.cpp build/tool/rows_text.h build/flags | build/tool
	$(CXX) -std=c++11 -O1 -w -I. $(filter -D%,$(CFLAGS)) -DFB_SINGLE=$(if $(findstring single,$@),1,0) -MMD -MP -c -o $@ $<

# What of the library stands in what is written as it is: the choice of independent rows.
build/tool/rows_text.h: flexbeam_impl.h | build/tool
	sed -n '/^\/\* Scales of the pivots/,/^\/\* end of the choice of independent rows/p' $< | sed -e '$$d' -e 's/"/\\"/g' -e 's/.*/"&\\n"/' > $@

build/tool/untraced.o: examples/tools/trace/untraced.c build/flags | build/tool
	$(CC) $(QUICKLY) -c -o $@ $<

# What costs time is the library.
QUICKLY = $(SHARED:-O2=-O1)

build/tool/%.o: %.c build/flags | build/tool
	$(CC) $(QUICKLY) -c -o $@ $<

# The FMU of every scene (examples/fmu/fmu.c).
build/tool/fmu2.so build/tool/fmu3.so: build/tool/fmu%.so: build/tool/fmu%.o build/library/tool.o
	$(CC) $(CFLAGS) -shared -o $@ $^ -lm

build/tool/fmu2.o build/tool/fmu3.o: build/tool/fmu%.o: fmu%.c build/tool/fmu_config.h build/flags | build/tool
	$(CC) $(QUICKLY) -w -fPIC -fvisibility=hidden -DFMU_LINKED -Ibuild/tool -Iexamples/fmu/fmi$* -c -o $@ $<

# The same for other languages (examples/bindings), and Python's wheel of it.
build/bindings/libflexbeam_scene.so: build/bindings/flexbeam_scene.o build/library/tool.o
	$(CC) $(CFLAGS) -shared -o $@ $^ -lm

build/bindings/flexbeam_scene.o: flexbeam_scene.c build/flags | build/bindings
	$(CC) $(QUICKLY) -Wno-unused-function -fPIC -fvisibility=hidden -c -o $@ $<

build/tool/fmu_config.h: | build/tool
	@printf '#define FMU_OF_A_SCENE 1\n#define FMU_STATIC 0\n' > $@

# The model in ROM says itself which configuration it takes.
build/examples/satellite_rom.h: examples/satellite.txt build/flexbeam | build/examples
	build/flexbeam reduce $< --single --out $@

build/examples/satellite_true.h: examples/satellite.txt build/flexbeam | build/examples
	build/flexbeam reduce $< --out $@

build/examples/satellite_model.h: examples/satellite.txt build/flexbeam | build/examples
	build/flexbeam reduce $< --jacobian --sensors 0 --name model --out $@

build/examples/tutorial_filter: build/examples/satellite_model.h
build/examples/firmware: examples/firmware/board/desktop.c
build/examples/firmware build/examples/tutorial_firmware: build/examples/satellite_rom.h
build/examples/tutorial_filter: build/examples/satellite_true.h
build/examples/firmware build/examples/tutorial_firmware build/examples/tutorial_filter: build/examples/%: %.c build/flags
	$(CC) $(SHARED) -MT $@ -MF $@.d -Ibuild/examples -ffunction-sections -fdata-sections -Wl,--gc-sections \
	  $$(grep -h -o -e '-DFB_[A-Z_]*=[0-9]*' $(filter %_rom.h %_true.h,$^)) -o $@ $(filter %.c,$^) -lm

# What a benchmark says of itself: its flags, its commit.
BUILD_OF_BENCH = -DFBB_FLAGS='"-std=c99 -ffp-contract=off $(CFLAGS)"' -DFBB_COMMIT="\"$$(cat build/commit)\""

build/bench/%_double: bench/%.c $(wildcard bench/*.h) $(wildcard examples/common/*.h) $(LIBRARY) build/flags build/commit | build/bench
	$(CC) $(FLAGS) $(CFLAGS) $(BUILD_OF_BENCH) -o $@ $< $(LIBS) -lm

build/bench/bench_peers_lu_double: LIBS = -llapack -lblas -ldl
build/bench/bench_peers_step_double: LIBS = -lsundials_cvode -lsundials_arkode
MUJOCO = $(abspath $(wildcard build/venv_peers/lib/python3*/site-packages/mujoco))
build/bench/bench_peers_beams_double build/bench/bench_peers_links_double: LIBS = -isystem $(MUJOCO)/include $(wildcard $(MUJOCO)/libmujoco.so.*) -Wl,-rpath,$(MUJOCO)
PINOCCHIO = $(abspath $(wildcard build/venv_peers/lib/python3*/site-packages/cmeel.prefix))
build/bench/peers_links: bench/peers_links.cpp bench/peers_links.h | build/bench # two minutes
	$(CXX) -std=c++17 $(CFLAGS) -DNDEBUG -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS \
	  -I$(PINOCCHIO)/include -I/usr/include/eigen3 -o $@ $< -L$(PINOCCHIO)/lib -lpinocchio_default -Wl,-rpath,$(PINOCCHIO)/lib

build/bench/%_single: bench/%.c $(wildcard bench/*.h) $(wildcard examples/common/*.h) $(LIBRARY) build/flags build/commit | build/bench
	$(CC) $(FLAGS) $(CFLAGS) $(BUILD_OF_BENCH) -DFB_SINGLE=1 -o $@ $< -lm

-include $(wildcard build/*/*.d build/tests/*/*.d)

build/hard_double build/hard_single: $(wildcard tests/hard/*.[ch] examples/common/*.h) $(LIBRARY) build/flags
	$(CC) $(FLAGS) $(CFLAGS) -DFB_SINGLE=$(if $(findstring single,$@),1,0) -o $@ $(filter tests/hard/%.c,$^) -lm

build/page/flexbeam.html: $(wildcard examples/page/*) bench/case.h bench/check.h $(wildcard examples/common/*.h) $(LIBRARY) | build/page
	@sh examples/page/pack.sh $@

LAWS = $(notdir $(basename $(wildcard tests/laws/*.c)))
build/laws: $(LAWS:%=build/laws_of_double/%.o) build/library/double.o
build/laws_single: $(LAWS:%=build/laws_of_single/%.o) build/library/single.o
build/laws build/laws_single:
	$(CC) $(CFLAGS) -o $@ $^ -lm

build/laws_of_double/%.o: tests/laws/%.c build/flags | build/laws_of_double
	$(CC) $(SHARED) -DFB_WITH_DETAIL=1 -c -o $@ $<

build/laws_of_single/%.o: tests/laws/%.c build/flags | build/laws_of_single
	$(CC) $(SHARED) -DFB_WITH_DETAIL=1 -DFB_SINGLE=1 -c -o $@ $<

build/quick_double: build/tests/double/test_main.o $(TESTS:tests/%.c=build/tests/double/%.o) # the library first, it takes longest
build/quick_single: build/tests/single/test_main.o $(TESTS:tests/%.c=build/tests/single/%.o)
build/quick_double build/quick_single:
	$(CC) $(CFLAGS) -o $@ $^ -lm

# What calls the library at -O0, which compiles in a third of the time; long runs are brief (check-suite has them whole).
OF_QUICK = $(SHARED) $(if $(filter tests/test_main.c,$<),,-O0) -DFBT_SHORT=1

build/tests/double/%.o: tests/%.c build/flags | build/tests/double
	$(CC) $(OF_QUICK) -c -o $@ $<

build/tests/single/%.o: tests/%.c build/flags | build/tests/single
	$(CC) $(OF_QUICK) -DFB_SINGLE=1 -c -o $@ $<

quick-double quick-single: quick-%: build/quick_%
	@$< --brief > build/quick_$*.txt || { grep -v '^ok ' build/quick_$*.txt; exit 1; }
	@echo "ok   tests in $* precision: $$(tail -n 1 build/quick_$*.txt)"

quick-c++: | build
	@printf '#define FLEXBEAM_IMPLEMENTATION\n#include "flexbeam.h"\n' > build/quick.c
	@$(CXX) -x c++ -std=c++11 -I. -ffp-contract=off $(WARNINGS) $(CFLAGS) -c -o build/quick.o build/quick.c
	@echo "ok   the library as C++11, all warnings"

build build/tests/double build/tests/single build/tool build/examples build/bench build/readme build/page build/sanitized build/library build/bindings build/seconds build/laws_of_double build/laws_of_single:
	@mkdir -p $@

# Changes only when the compiler or its flags do.
build/flags: FORCE | build
	@echo '$(CC) $(FLAGS) $(CFLAGS)' | cmp -s - $@ || echo '$(CC) $(FLAGS) $(CFLAGS)' > $@

# Changes only when another commit is checked out, or the first file is changed.
build/commit: FORCE | build
	@commit=$$(git describe --always --dirty 2> /dev/null || echo unknown); echo "$$commit" | cmp -s - $@ || echo "$$commit" > $@

# ---- checks: each is a script that prints one line of ok or FAIL, and why

ci: | build/seconds # folders and objects first: what waits for one is put behind all others
	@$(MAKE) -s -k -j2 --no-print-directory CFLAGS='$(filter-out -Werror,$(CFLAGS)) -Werror' build/flexbeam \
	  build/library/double.o build/sanitized/single.o build/sanitized/double.o || true
	@$(MAKE) -s -k -j2 --output-sync=target --no-print-directory CFLAGS='$(filter-out -Werror,$(CFLAGS)) -Werror' \
	  $(CHECKS:%=check-%) examples build/quick_double
	@echo "ci: none of $(words $(CHECKS)) checks failed"

ci-all:
	@CHECK_ALL=1 $(MAKE) -s --no-print-directory ci

check-laws: build/laws build/laws_single

check-hil: build/examples/hil_plant build/examples/hil_controller

check-aero: build/examples/wing_goland build/examples/ground_resonance build/examples/rotor_flight

# The library of check-hostile and check-faults, under sanitizers.
check-hostile check-faults: build/sanitized/single.o build/sanitized/double.o

SANITIZE = gcc $(FLAGS) -Werror -O1 -fsanitize=address,undefined -fno-sanitize-recover=all

build/sanitized/%.o: tests/checks/hostile_sizes.h $(LIBRARY) | build/sanitized
	echo '#include "flexbeam.h"' | $(SANITIZE) -include $< -DFLEXBEAM_IMPLEMENTATION $(if $(findstring single,$@),-DFB_SINGLE=1) -c -o $@ -x c -

check-linear check-long check-scene check-hil check-aero: build/library/double.o

check-page: build/examples/page

check-python: build/flexbeam build/bindings/libflexbeam_scene.so

check-trace: build/examples/tutorial_filter

check-output: build/flexbeam $(EXAMPLES:%=build/examples/%)

$(addprefix check-,advise bits code code_scene compile curves firmware fmu import linear mesh modes packages parts rom scene trace): build/flexbeam

check-campaign: build/flexbeam $(filter %_mpi,$(EXAMPLES:%=build/examples/%))

# tables: not among CHECKS, for it fails until a quiet machine has measured all of them again: sh bench/readme.sh NAME...
$(CHECKS:%=check-%) check-tables: check-%: tests/checks/%.sh | build/seconds
	@sh $<; status=$$?; times > build/seconds/$*; exit $$status

# Of the processor, by every check when it last ran, the slowest first.
seconds:
	@awk 'FNR == 2 { gsub(/[ms]/, " "); sub(/.*\//, "", FILENAME); print 60 * $$1 + $$2 + 60 * $$3 + $$4, FILENAME }' build/seconds/* | sort -rn | \
	  awk '{ printf "%7.0f s  %s\n", $$1, $$2; sum += $$1 } END { printf "%7.0f s of the processor, by %d checks\n", sum, NR }'
