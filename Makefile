# Impakt. `make help` lists what there is to make.
#
# Every make first checks the set-up (.setup/: Debian packages, PETSc, Python; a fraction of a second when all is there),
# then runs itself again with what it found: PETSC_ROOT, the directory of PETSc's libraries, and PYTHON, an interpreter.
#   PETSC_DIR, PETSC_ARCH   your own PETSc, 3.21 or newer, instead of the private build
#   DEBUG=1                 unoptimised, in build/debug          ASAN=1   address and undefined-behaviour checks, in build/asan
#   INDICES=64              PETSc with indices of 64 bits, for more than 2^31 unknowns, in build/indices-64 (.setup/petsc --indices-64)
#   COVERAGE=1              counts the lines that run, in build/coverage
#   TESTS="tests/contact -k x"  what `make test` hands to pytest  V=1      show whole commands
#   PREFIX=/usr/local       where `make install` puts program, library, headers, plots and options; DESTDIR=stage puts them under a stage

# nproc alone would tell the threads of OpenMP where OMP_NUM_THREADS is set, as it often is beside MPI
cores := $(shell env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc)

ifneq ($(origin PETSC_ROOT),command line)

goals := $(if $(MAKECMDGOALS),$(filter-out help clean,$(MAKECMDGOALS)),all)
without_petsc := format lint bench-compare %.json

.PHONY: made help clean $(goals)
$(goals): made ; @:

made: $(filter clean,$(MAKECMDGOALS))
	@.setup/debian
	@petsc=$(if $(filter-out $(without_petsc),$(goals)),$$(.setup/petsc$(if $(filter 64,$(INDICES)), --indices-64)),none) && python=$$(.setup/python) && \
	$(MAKE) --no-print-directory $(if $(filter -j%,$(MAKEFLAGS)),,-j$(cores)) PETSC_ROOT="$$petsc" PYTHON="$$python" $(goals)

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 18
	@sed -n 's/^#   /  /p' Makefile

clean: ## remove build/; what runs wrote to out/ stays
	rm -rf build

else

# PETSc's own account of itself: CC, MPIEXEC, PETSC_CC_INCLUDES, PETSC_LIB, with HDF5's among them
ifneq ($(PETSC_ROOT),none)
include $(PETSC_ROOT)/lib/petsc/conf/petscvariables
endif

BUILD    := build
OPTIMISE := -O3 -fno-math-errno
ifeq ($(DEBUG),1)
BUILD    := build/debug
OPTIMISE := -O0 -g3
endif
ifeq ($(ASAN),1)
BUILD    := build/asan
OPTIMISE := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
export ASAN_OPTIONS := detect_leaks=1:fast_unwind_on_malloc=0
export LSAN_OPTIONS := suppressions=$(CURDIR)/tests/asan-suppressions.txt:print_suppressions=0
export UBSAN_OPTIONS := print_stacktrace=1
endif
ifeq ($(INDICES),64)
BUILD    := build/indices-64
endif
ifeq ($(COVERAGE),1)
BUILD    := build/coverage
OPTIMISE := -O1 -g --coverage -fprofile-update=atomic -Wno-maybe-uninitialized # which between counters is a wrong guess
endif
ifeq ($(FUZZ),1) # by `make fuzz`: libFuzzer is clang's
BUILD    := build/fuzz
OPTIMISE := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer \
            -Wno-pass-failed # loops that vectorise when optimised
export OMPI_CC := clang-19
export MPICH_CC := clang-19
endif

# vectors are handed over within a file alone: it is no matter how they are between compilers
WARNINGS := -Wall -Wextra -Werror -Wno-psabi
CFLAGS   := -std=c11 -fopenmp-simd $(WARNINGS) $(OPTIMISE)
# One set of objects serves the program and the shared library, which shows nothing but what is PETSC_EXTERN
SHARED   := -fPIC -fvisibility=hidden -fno-semantic-interposition
# Where elements and materials multiply and add, processors that can may round once: -std=c11 alone keeps GCC from it
KERNELS  := -ffp-contract=fast
# Other people's headers are system headers: their warnings are not ours to mend.
CPPFLAGS := -Iinclude -Isrc $(patsubst -I%,-isystem %,$(filter-out -I/usr/include,$(PETSC_CC_INCLUDES) $(shell pkg-config --cflags jansson muparser netcdf-mpi))) \
            -isystem $(shell pkg-config --variable=prefix netcdf-mpi)/include # Debian's netcdf-mpi.pc does not name it
LIBS     := -Wl,--as-needed $(PETSC_LIB) $(shell pkg-config --libs jansson muparser netcdf-mpi) -lpthread -lm

members   := $(patsubst %.c,$(BUILD)/%.o,$(filter-out src/main.c,$(sort $(shell find src -name '*.c' -not -path '*/tutorials/*'))))
units     := $(patsubst %.c,$(BUILD)/%,$(filter-out tests/scaling/% tests/library/% tests/fuzz/%,$(sort $(shell find tests -name '*.c'))))
targets   := $(filter-out replay,$(patsubst tests/fuzz/%.c,%,$(sort $(wildcard tests/fuzz/*.c))))
replays   := $(targets:%=$(BUILD)/tests/fuzz/%)
c_files    = $(shell find src include tests -name '*.[ch]')
sh_files  := .setup/common .setup/debian .setup/petsc .setup/python .ci/run
TESTS     ?= tests
bin       := $(dir $(PYTHON))
# A line for each folder, or for what else is named, when the first file there is made. With V=1 make shows whole commands instead.
say        = $(if $(V),,@$(call once,$(1),$(or $(2),$@)))
once       = $(if $(filter $(1):$(2),$(said)),,$(eval said += $(1):$(2))$(info $()  $(1) $(2)))

# Runs on one machine, also as root in a container, and with more ranks than cores. Parallelism is MPI's.
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
export OMPI_MCA_rmaps_base_oversubscribe := 1
export OMPI_MCA_hwloc_base_binding_policy := none
export OMPI_MCA_mpi_yield_when_idle := 1
export OMPI_MCA_btl_vader_single_copy_mechanism := none
# Messages within one machine: else MPI loads the drivers of networks too, one of which takes 0.2 s to calibrate a clock.
export OMPI_MCA_pml := ob1
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export MPLBACKEND := Agg

# The version is written once, in include/impakt/version.h
version_of = $(shell sed -n 's/^\#define IMPAKT_VERSION_$(1) *\([0-9]*\)$$/\1/p' include/impakt/version.h)
interface := $(call version_of,MAJOR).$(call version_of,MINOR)
version   := $(interface).$(call version_of,SUBMINOR)
PREFIX    ?= /usr/local
prefix    := $(abspath $(PREFIX))
stage      = $(DESTDIR)$(prefix)
# What a plain C compiler has to be told of PETSc, and of MPI where PETSc's own compiler is a wrapper that knows it
mpi_flags  = $(shell $(CC) -show 2>/dev/null)
pc_cflags  = $(filter-out -I/usr/include,$(PETSC_CC_INCLUDES)) $(filter -I%,$(mpi_flags))
pc_libs    = -Wl,-rpath,$(PETSC_ROOT)/lib -L$(PETSC_ROOT)/lib -lpetsc $(filter -L% -l% -Wl%,$(mpi_flags)) -lm

# Tools that look at the code, in an environment of their own that only these goals make
ifneq ($(filter analyse coverage,$(MAKECMDGOALS)),)
analysis := $(dir $(shell .setup/python --analysis))
endif

.PHONY: all run paper test test-all validate mutants bench bench-compare scaling docs format lint analyse coverage fuzz fuzzers install force
.DELETE_ON_ERROR:
.SECONDARY: $(addsuffix .o,$(units) $(replays))

all: $(BUILD)/impakt ## the program, build/impakt (the default)

install: $(BUILD)/impakt $(BUILD)/libimpakt.so ## program, shared library, headers, impakt.pc, programs of plots/ and options files, below PREFIX
	@mkdir -p $(stage)/bin $(stage)/lib/pkgconfig $(stage)/include/impakt/private $(stage)/share/impakt/plots $(stage)/share/impakt/options
	install -m 755 $(BUILD)/impakt $(stage)/bin
	install -m 755 $(BUILD)/libimpakt.so $(stage)/lib/libimpakt.so.$(version)
	ln -sf libimpakt.so.$(version) $(stage)/lib/libimpakt.so.$(interface)
	ln -sf libimpakt.so.$(interface) $(stage)/lib/libimpakt.so
	install -m 644 include/impakt.h $(stage)/include
	install -m 644 $(wildcard include/impakt/*.h) $(stage)/include/impakt
	install -m 644 $(wildcard include/impakt/private/*.h) $(stage)/include/impakt/private
	@echo "plots/*.py and options/*.opts to $(stage)/share/impakt"
	@install -m 644 plots/*.py $(stage)/share/impakt/plots
	@install -m 644 options/*.opts $(stage)/share/impakt/options
	@echo "impakt.pc to $(stage)/lib/pkgconfig"
	@printf '%s\n' 'prefix=$(prefix)' 'libdir=$${prefix}/lib' 'includedir=$${prefix}/include' '' 'Name: Impakt' \
	  'Description: dynamic contact by the Schwarz alternating method' 'Version: $(version)' 'Cflags: -I$${includedir} $(pc_cflags)' \
	  'Libs: -L$${libdir} -Wl,-rpath,$${libdir} -limpakt $(pc_libs)' >$(stage)/lib/pkgconfig/impakt.pc

run: $(BUILD)/impakt ## the paper's high-speed impact: results table, history, summary and plot in out/
	@mkdir -p out
	$(BUILD)/impakt -options_file options/impact-high-speed.opts
	@$(PYTHON) plots/impact.py out/impact-high-speed.h5 out/impact-high-speed.png
	@printf '%s\n' 'history  out/impact-high-speed.h5' 'summary  out/impact-high-speed.json' 'plot     out/impact-high-speed.png'

# No test may hang for ever: one that does not end within 1500 s fails, and shows where it was
pytest := IMPAKT=$(CURDIR)/$(BUILD)/impakt IMPAKT_BUILD=$(CURDIR)/$(BUILD) MPIEXEC="$(MPIEXEC)" $(PYTHON) -m pytest -q -n $(cores) --dist worksteal --durations 10 \
  --timeout 1500 -p no:cacheprovider --rootdir=.
report := PYTHONPATH=plots $(PYTHON) -m paper --program $(BUILD)/impakt --out out/paper

paper: $(BUILD)/impakt ## all figures and tables of the paper, and a report, in out/paper/
	@status=0; $(report) || status=$$?; $(pytest) tests/paper/golden.py || status=$$?; exit $$status

# Three tiers. What TESTS names runs with both of the first two, for what is left to `make validate` with that alone.
test: ## after every change: unit tests and short runs, 5 minutes; or what TESTS names
test-all: ## what CI runs: those and the long ones, 20 minutes with make analyse
test: marked := $(if $(filter file,$(origin TESTS)),not long and not validate,not validate)
test-all: marked := not validate
test test-all: $(BUILD)/impakt $(units) $(replays)
	@$(pytest) $(TESTS) -m "$(marked)"

validate: $(BUILD)/impakt $(units) ## theory, peers and the paper at full length, random variants: before an issue about physics is called done
	@status=0; $(if $(filter file,$(origin TESTS)),$(report) || status=$$?;) \
	$(pytest) $(TESTS) $(if $(filter file,$(origin TESTS)),-o "python_files=test_*.py golden.py") -m validate || status=$$?; exit $$status

# Each fault of tests/mutants/faults.json: MUTANTS="name other-name" names some of them
mutants: $(BUILD)/impakt $(units) ## deliberate faults in src, one after the other: does a test find each of them?
	@$(PYTHON) tests/mutants/run.py --build $(BUILD) --petsc "$(PETSC_ROOT)" --python "$(PYTHON)" --mpiexec "$(MPIEXEC)" $(MUTANTS)

# BENCH="--largest 10000" makes it shorter
bench: $(BUILD)/impakt $(BUILD)/yardstick $(BUILD)/yardstick_hex8 $(BUILD)/yardstick_solids ## time and memory, beside plain C yardsticks: a report in out/bench
	$(PYTHON) tests/scaling/bench.py --build $(BUILD) --json out/bench/bars.json
	$(PYTHON) tests/scaling/solids.py --build $(BUILD) --json out/bench/solids.json $(BENCH)
	$(PYTHON) tests/scaling/shapes.py --build $(BUILD) --json out/bench/shapes.json $(BENCH)
	$(PYTHON) tests/scaling/formulations.py --build $(BUILD) --json out/bench/formulations.json
	$(PYTHON) tests/scaling/contact.py --build $(BUILD) --json out/bench/contact.json $(BENCH)
	$(PYTHON) tests/scaling/discs.py --build $(BUILD) --json out/bench/discs.json
	$(PYTHON) tests/scaling/benchreport.py --program $(BUILD)/impakt --out out/bench out/bench/bars.json out/bench/solids.json out/bench/shapes.json out/bench/formulations.json out/bench/contact.json out/bench/discs.json

bench-compare: ## what got slower since an earlier report: make bench-compare OLD.json, a copy of its out/bench/report.json
	@$(PYTHON) tests/scaling/benchreport.py --out out/bench --compare $(or $(firstword $(filter %.json,$(MAKECMDGOALS))),OLD.json)

# RANKS="--ranks 16 --size 12 --only counts" makes it shorter
scaling: $(BUILD)/impakt $(BUILD)/yardstick_memory $(BUILD)/yardstick_mpi ## counts on up to 64 ranks, one rank against two, the same results: a report in out/scaling
	$(PYTHON) tests/scaling/ranks.py --build $(BUILD) --mpiexec "$(MPIEXEC)" $(RANKS)

docs: $(BUILD)/impakt ## the table of options in options/README.md, as the program prints it
	@$(BUILD)/impakt -help markdown >$(BUILD)/options.md
	@sed -i -e '/^<!-- what lies between/,/^<!-- end of what/{/^<!--/!d}' -e '/^<!-- what lies between/r $(BUILD)/options.md' options/README.md

format: ## clang-format over all C
	@$(bin)clang-format -i $(c_files)

lint: ## clang-format, ruff, shellcheck where there is one, subjects of commits, lines of Markdown
	@$(bin)clang-format --dry-run -Werror $(c_files)
	$(bin)ruff check --no-cache plots tests
	@if [ -x $(bin)shellcheck ]; then set -x; $(bin)shellcheck -x $(sh_files); fi
	@$(PYTHON) tests/analysis/wording.py

analyse: $(members:.o=.tidy) $(BUILD)/src/main.tidy ## clang-tidy and cppcheck over src, which have to find nothing
	@$(analysis)cppcheck --quiet -j $(cores) --std=c11 --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
	  --suppressions-list=tests/analysis/cppcheck.txt --include=tests/analysis/petsc.h -Iinclude -Isrc src

# An object is older than its clang-tidy if nothing that it is made of has changed since
$(BUILD)/%.tidy: $(BUILD)/%.o .clang-tidy
	$(call say,TIDY,$(*D)) $(analysis)clang-tidy --quiet $*.c -- $(CPPFLAGS) -I$(BUILD) $(patsubst -I%,-isystem %,$(filter -I%,$(mpi_flags))) $(CFLAGS) >$@.log 2>/dev/null || { cat $@.log; exit 1; }
	@touch $@

# A line of a sum over nodes runs 5e9 times in all tests, which gcovr would take for an error of gcov, and so are counts below zero (GCC bug 68080)
coverage: ## the tests of `make test` with counted lines of src: a report in build/coverage/report, an error below 90 %
	@find build/coverage -name '*.gcda' -delete 2>/dev/null || true
	@$(MAKE) --no-print-directory COVERAGE=1 PETSC_ROOT="$(PETSC_ROOT)" PYTHON="$(PYTHON)" test
	@mkdir -p build/coverage/report
	$(analysis)gcovr --root . --filter src/ --exclude '.*/tutorials/' --exclude-throw-branches --gcov-suspicious-hits-threshold 0 \
	  --gcov-ignore-parse-errors negative_hits.warn_once_per_file \
	  --html-details build/coverage/report/index.html --txt build/coverage/report/lines.txt --print-summary --fail-under-line 90 build/coverage

# Each target RUNS times, from seeds and from what was found before; an input that breaks it is kept in build/fuzz/found
RUNS ?= 100000
fuzz: ## libFuzzer with address and undefined-behaviour checks on all that reads files: RUNS=100000 inputs for each target
	@.setup/debian clang-19 libclang-rt-19-dev
	@$(MAKE) --no-print-directory FUZZ=1 PETSC_ROOT="$(PETSC_ROOT)" PYTHON="$(PYTHON)" fuzzers
	$(PYTHON) tests/fuzz/seeds.py build/fuzz/seeds
	@mkdir -p build/fuzz/found $(targets:%=build/fuzz/corpus/%)
	@status=0; for t in $(targets); do \
	  ASAN_OPTIONS=detect_leaks=0 build/fuzz/tests/fuzz/$$t -runs=$(RUNS) -seed=1 -max_len=20000 -timeout=20 -rss_limit_mb=4000 -print_final_stats=1 \
	    -verbosity=0 -artifact_prefix=build/fuzz/found/$$t- build/fuzz/corpus/$$t build/fuzz/seeds/$$t >build/fuzz/$$t.log 2>&1 || status=1; \
	  sed -n -e 's/^stat::number_of_executed_units: *\([0-9]*\)/  '$$t': \1 inputs/p' -e '/ERROR\|SUMMARY\|runtime error\|Test unit written/p' build/fuzz/$$t.log; \
	done; exit $$status

fuzzers: $(replays)

$(BUILD)/impakt: $(BUILD)/src/main.o $(BUILD)/libimpakt.a
	$(call say,LINK) $(CC) $(CFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/libimpakt.a: $(members) $(BUILD)/members
	@rm -f $@
	$(call say,AR) ar rcs $@ $(members)

# PETSc goes into the library by name alone: a static one would be there twice, in the library and in the programs that use it
$(BUILD)/libimpakt.so: $(members) $(BUILD)/members
	@ls $(PETSC_ROOT)/lib/libpetsc.* | grep -q '\.\(so\|dylib\)' || { echo "make install needs a shared PETSc; $(PETSC_ROOT) has a static one" >&2; exit 1; }
	$(call say,LINK) $(CC) $(CFLAGS) $(SHARED) -shared -Wl,-soname,libimpakt.so.$(interface) -Wl,-z,defs -o $@ $(members) $(LIBS)

$(units): %: %.o $(BUILD)/libimpakt.a
	$(call say,LINK,$(@D)) $(CC) $(CFLAGS) -o $@ $^ $(shell pkg-config --libs cmocka) $(LIBS)

$(replays): %: %.o $(if $(FUZZ),,$(BUILD)/tests/fuzz/replay.o) $(BUILD)/libimpakt.a
	$(call say,LINK) $(CC) $(CFLAGS) $(if $(FUZZ),-fsanitize=fuzzer) -o $@ $^ $(LIBS)

$(addsuffix .o,$(units)): private CPPFLAGS += -Itests/support
$(BUILD)/src/sys/help.o: private CPPFLAGS += -DIMPAKT_OPTIMISATION='"$(OPTIMISE)"' # -version tells
$(members): private CFLAGS += $(SHARED)
$(filter $(BUILD)/src/element/% $(BUILD)/src/material/%,$(members)): private CFLAGS += $(KERNELS)

$(BUILD)/%.o: %.c $(BUILD)/flags $(PETSC_ROOT)/include/petscconf.h
	@mkdir -p $(@D)
	$(call say,CC,$(<D)) $(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/yardstick: tests/scaling/yardstick.c
	@mkdir -p $(@D)
	$(call say,CC) gcc -O2 -std=c11 $(WARNINGS) -o $@ $< -lm

$(BUILD)/yardstick_hex8: tests/scaling/yardstick_hex8.c
	@mkdir -p $(@D)
	$(call say,CC) gcc -O3 -std=c11 $(KERNELS) -fopenmp-simd -fno-math-errno $(WARNINGS) -o $@ $< -lm

$(BUILD)/yardstick_solids: tests/scaling/yardstick_solids.c
	@mkdir -p $(@D)
	$(call say,CC) gcc -O3 -std=c11 $(KERNELS) -fopenmp-simd -fno-math-errno $(WARNINGS) -o $@ $< -lm

$(BUILD)/yardstick_mpi: tests/scaling/yardstick_mpi.c
	@mkdir -p $(@D)
	$(call say,CC) mpicc -O2 -std=c11 $(WARNINGS) -o $@ $<

$(BUILD)/yardstick_memory: tests/scaling/yardstick_memory.c
	@mkdir -p $(@D)
	$(call say,CC) gcc -O3 -std=c11 $(WARNINGS) -o $@ $< -lm

# The options files that need nothing but themselves, as text for -example
examples := $(sort $(shell grep -l '^-bodies' $$(grep -LE 'filename|options_file|file:' options/*.opts)))
$(BUILD)/examples.inc: $(examples) $(BUILD)/examples
	@for f in $(examples); do n=$${f##*/}; echo "{\"$${n%.opts}\", (const char *const[]){"; \
	  sed -e 's/[\"\\]/\\&/g' -e 's/.*/"&",/' $$f; echo "NULL}},"; done >$@
$(BUILD)/src/sys/example.o: $(BUILD)/examples.inc
$(BUILD)/src/sys/example.o: private CPPFLAGS += -I$(BUILD)

# What the objects and the library were made with: rewritten only when that changes
$(BUILD)/flags: text = $(CC) $(CPPFLAGS) $(CFLAGS) $(LIBS), $(SHARED), $(KERNELS)
$(BUILD)/members: text = $(members)
$(BUILD)/examples: text = $(examples)
$(BUILD)/flags $(BUILD)/members $(BUILD)/examples: force
	@mkdir -p $(@D); echo '$(text)' | cmp -s - $@ || echo '$(text)' >$@

-include $(members:.o=.d) $(BUILD)/src/main.d $(addsuffix .d,$(units) $(replays))

endif
