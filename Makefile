# Builds Kiln into build/bin, installs what is missing, runs the demo, the tests and the benchmarks. `make help` lists the targets.
SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all
MAKEFLAGS += --no-builtin-rules
ifeq ($(filter -j% --jobs%,$(MAKEFLAGS)),)
MAKEFLAGS += --jobs=$(shell nproc)
endif

BUILD    ?= build
# Below this folder a build has one name, however it is called: what objects depend on is kept by their names.
override BUILD := $(patsubst $(CURDIR)/%,%,$(abspath $(BUILD)))
PREFIX   ?= /usr/local
PYTHON   ?= /usr/bin/python3
CXX      ?= g++
ifeq ($(origin CXX),default)
CXX      := g++
endif
NATIVE   ?= 0
PETSC    ?= 0

WARNINGS := -Wall -Wextra -Wconversion -Wshadow
OPTIMISE := -O3 -DNDEBUG
ifeq ($(NATIVE),1)
OPTIMISE += -march=native
endif
CXXFLAGS  = -std=c++20 -g1 $(OPTIMISE) $(WARNINGS) -pthread -fopenmp-simd -fno-math-errno -Ilib -I. -isystem /usr/include/eigen3 \
            $(EXTRA)
LDFLAGS  := -pthread $(EXTRA)

TOOLS        := sinter bondify bend analyze
LIB_SOURCES  := $(filter-out lib/petsc/%,$(wildcard lib/*/*.cpp))
LIB_OBJECTS  := $(LIB_SOURCES:%.cpp=$(BUILD)/%.o)
TOOL_OBJECTS := $(patsubst %,$(BUILD)/tools/%.o,$(TOOLS) common)
BENCH_NAMES  := $(basename $(notdir $(wildcard bench/*.cpp)))
BENCH_SCRIPTS := $(basename $(notdir $(wildcard bench/*.py)))
BIN          := $(BUILD)/bin
PROGRAMS     := $(TOOLS:%=$(BIN)/%)

# Piece "unit-2" of 4 is the second quarter of the files of tests/unit.
UNIT_PIECES    := 4
PHYSICS_PIECES := 3
files_of_piece  = $(shell ls tests/$(1)/*.cpp | \
    awk '{name[NR] = $$0} END {for (k in name) if (int((k - 1) * $(2) / NR) == $(3) - 1) print name[k]}' | sort)
pieces          = $(foreach number,$(shell seq $(2)),$(1)-$(number))
UNIT_OBJECTS   := $(BUILD)/tests/main.o \
                  $(patsubst %,$(BUILD)/tests/%.o,$(call pieces,unit,$(UNIT_PIECES)) $(call pieces,physics,$(PHYSICS_PIECES)))

.PHONY: all demo test unit-test cli-test bench man clean help packages
.SECONDARY:

all: $(PROGRAMS)                ## build the four programs into build/bin; PETSC=1: with --solver petsc, and optional-packages

help:                           ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*##/:/' | column -t -s :

# ---- dependencies from Debian -------------------------------------------------------------------------------------------------
include packages.mk

packages: $(BUILD)/packages-present

# ---- build --------------------------------------------------------------------------------------------------------------------
# What compiles and how: everything is compiled anew when it changes. A compiler's cache in front of it changes nothing.
FLAGS := $(filter-out ccache,$(CXX)) $(CXXFLAGS)
.PHONY: FORCE
FORCE:

$(BUILD)/flags: FORCE
	@mkdir -p $(@D)
	@cmp -s $@ <(echo '$(FLAGS)') || echo '$(FLAGS)' > $@

$(BUILD)/%.o: %.cpp $(BUILD)/flags | $(BUILD)/packages-present
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS) $(PRECOMPILED) -MMD -MP -c $< -o $@

# What nearly all files of a part include is compiled once. Only for g++ itself: clang has another way, and ccache needs none.
define precompiled_rule
$(BUILD)/$(1)/precompiled.h.gch: $(1)/precompiled.h lib/precompiled.h $(BUILD)/flags | $(BUILD)/packages-present
	@mkdir -p $$(@D)
	@cp $$< $$(@:.gch=)
	$(CXX) $$(CXXFLAGS) -x c++-header $$< -o $$@

$(2): $(BUILD)/$(1)/precompiled.h.gch
$(2): private PRECOMPILED := -include $(BUILD)/$(1)/precompiled.h
endef
ifeq ($(CXX),g++)
$(eval $(call precompiled_rule,lib,$(LIB_OBJECTS)))
$(eval $(call precompiled_rule,tools,$(TOOL_OBJECTS)))
$(eval $(call precompiled_rule,tests,$(UNIT_OBJECTS)))
endif

$(BUILD)/libkiln.a: $(LIB_OBJECTS)
	@rm -f $@
	ar rcs $@ $^

# Programs and tests are compiled in pieces, several files of a directory after each other: most of the time goes into templates of
# options, JSON and matrices, which each file would instantiate again. 1: name of the piece, 2: its files
define piece_rule
$(BUILD)/$(1).cpp: FORCE
	@mkdir -p $$(@D)
	@cmp -s $$@ <(printf '#include "%s"\n' $(2)) || printf '#include "%s"\n' $(2) > $$@

$(BUILD)/$(1).o: $(BUILD)/$(1).cpp $(BUILD)/flags | $(BUILD)/packages-present
	$$(CXX) $$(CXXFLAGS) $$(PRECOMPILED) -MMD -MP -c $$< -o $$@
endef
$(foreach tool,$(TOOLS) common,$(eval $(call piece_rule,tools/$(tool),$(wildcard tools/$(tool)/*.cpp))))
$(foreach n,$(shell seq $(UNIT_PIECES)),\
    $(eval $(call piece_rule,tests/unit-$(n),$(call files_of_piece,unit,$(UNIT_PIECES),$(n)))))
$(foreach n,$(shell seq $(PHYSICS_PIECES)),\
    $(eval $(call piece_rule,tests/physics-$(n),$(call files_of_piece,physics,$(PHYSICS_PIECES),$(n)))))

# Who links PETSc and MPI: with PETSC=1 the programs that solve bond networks. PETSc is found by pkg-config, MPI by its compiler.
RANKS      := $(BUILD)/tools/ranks/alone.o
SOLVING    := bend analyze
ifeq ($(PETSC),1)
PETSC_RANKS := $(BUILD)/tools/ranks/petsc.o $(patsubst %.cpp,$(BUILD)/%.o,$(wildcard lib/petsc/*.cpp))
MPICXX     ?= mpicxx
WITH_MPI    = OMPI_CXX='$(CXX)' MPICH_CXX='$(CXX)' $(MPICXX)
$(PETSC_RANKS): | $(BUILD)/petsc-present
$(PETSC_RANKS): private CXXFLAGS += $(patsubst -I%,-isystem %,$(shell pkg-config --cflags-only-I PETSc)) -DOMPI_SKIP_MPICXX
$(PETSC_RANKS) $(SOLVING:%=$(BIN)/%): private override CXX := $(WITH_MPI)
$(SOLVING:%=$(BIN)/%): private RANKS := $(PETSC_RANKS)
$(SOLVING:%=$(BIN)/%): private LDFLAGS += $(shell pkg-config --libs PETSc)
$(SOLVING:%=$(BIN)/%): $(PETSC_RANKS)
endif

$(BIN).petsc: FORCE
	@mkdir -p $(@D)
	@cmp -s $@ <(echo '$(PETSC)') || echo '$(PETSC)' > $@

OBJECTS_OF_ALL := $(BUILD)/tools/common.o $(BUILD)/libkiln.a

define tool_rule
$(BIN)/$(1): $(BUILD)/tools/$(1).o $(RANKS) $(OBJECTS_OF_ALL) $(BIN).petsc
	@mkdir -p $$(@D)
	$$(CXX) $$< $$(RANKS) $(OBJECTS_OF_ALL) $$(LDFLAGS) -o $$@
endef
$(foreach tool,$(TOOLS),$(eval $(call tool_rule,$(tool))))

$(BUILD)/test/unit: $(UNIT_OBJECTS) $(BUILD)/libkiln.a
	@mkdir -p $(@D)
	$(CXX) $^ $(LDFLAGS) -o $@

$(BUILD)/bench/%: $(BUILD)/bench/%.o $(BUILD)/libkiln.a
	@mkdir -p $(@D)
	$(CXX) $^ $(LDFLAGS) -o $@

include demo.mk checks.mk tests/fuzz/fuzz.mk packaging/package.mk
-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

# Test cases run once, programs read, ask the library and write, and lib/io waits for the disk: quick to compile counts for more
# than quick to run.
$(BUILD)/tests/%: OPTIMISE := -O1
$(BUILD)/tests/%: WARNINGS := $(filter-out -Wshadow,$(WARNINGS))
$(BUILD)/tools/% $(BUILD)/lib/io/%: OPTIMISE := -O1 -DNDEBUG

# ---- tests --------------------------------------------------------------------------------------------------------------------
test: $(BUILD)/neighbours-present all $(BUILD)/test/unit  ## build and run all tests; ends with "N passed, M failed"
	@BUILD=$(BUILD) PYTHON=$(PYTHON) tests/run.sh

unit-test: $(BUILD)/test/unit   ## closed forms, conservation laws, limits
	$(BUILD)/test/unit

cli-test: all $(BUILD)/neighbours-present  ## the programs as a user runs them
	@BUILD=$(BUILD) PYTHON=$(PYTHON) UNIT=0 tests/run.sh

# ---- benchmarks, manual pages -------------------------------------------------------------------------------------------------
# Sizes with which all of it takes some minutes; FULL=1 has those of docs, an hour and 10 GB.
ifneq ($(FULL),1)
QUICK_chain     := --largest 30000
QUICK_bending   := size slenderness tolerance --largest 30000
QUICK_sintering := --particles 1000 --tightest 1e-5 --lightest 1e19 --largest 10000
endif

bench: all $(BENCH_NAMES:%=$(BUILD)/bench/%)  ## speed against error; JSON lines and pictures in build/bench; FULL=1: an hour
	@$(foreach name,$(BENCH_NAMES),echo "== $(name)"; $(BUILD)/bench/$(name) $(QUICK_$(name)) | tee $(BUILD)/bench/$(name).jsonl;)
	@$(foreach name,$(BENCH_SCRIPTS),echo "== $(name)"; BUILD=$(abspath $(BUILD)) PROGRAMS=$(abspath $(BIN)) \
	    $(PYTHON) bench/$(name).py $(QUICK_$(name)) -o $(BUILD)/bench/$(name).png | tee $(BUILD)/bench/$(name).jsonl;)

POST_TOOLS := dem-convert dem-view

man: $(patsubst %,$(BUILD)/man/%.1,$(TOOLS) $(POST_TOOLS)) $(BUILD)/man/dem-state.5   ## manual pages into build/man

$(BUILD)/man/%.1: $(BUILD)/bin/% docs/help-to-man.sh
	@mkdir -p $(@D)
	docs/help-to-man.sh $< > $@

$(POST_TOOLS:%=$(BUILD)/man/%.1): $(BUILD)/man/%.1: workflows/post/% $(wildcard workflows/post/*.py python/kiln/*.py) \
    docs/help-to-man.sh
	@mkdir -p $(@D)
	PYTHONDONTWRITEBYTECODE=1 docs/help-to-man.sh $< > $@

$(BUILD)/man/dem-state.5: docs/dem-state.5
	@mkdir -p $(@D)
	cp $< $@

clean:                          ## delete everything that was built
	rm -rf $(BUILD)
