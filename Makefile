# Builds Kiln into build/bin, installs what is missing, runs the demo, the tests and the benchmarks. `make help` lists the targets.
SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all
MAKEFLAGS += --no-builtin-rules

BUILD    ?= build
PREFIX   ?= /usr/local
PYTHON   ?= /usr/bin/python3
CXX      ?= g++
ifeq ($(origin CXX),default)
CXX      := g++
endif
NATIVE   ?= 0

WARNINGS := -Wall -Wextra -Wconversion -Wshadow
OPTIMISE := -O3 -DNDEBUG
ifeq ($(NATIVE),1)
OPTIMISE += -march=native
endif
CXXFLAGS := -std=c++20 -g1 $(OPTIMISE) $(WARNINGS) -fopenmp -fno-math-errno -Ilib -I. -isystem /usr/include/eigen3 $(EXTRA)
LDFLAGS  := -fopenmp $(EXTRA)

TOOLS        := sinter bondify bend analyze
LIB_SOURCES  := $(wildcard lib/*/*.cpp)
LIB_OBJECTS  := $(LIB_SOURCES:%.cpp=$(BUILD)/%.o)
TOOL_OBJECTS := $(patsubst %.cpp,$(BUILD)/%.o,$(filter-out %/main.cpp,$(wildcard tools/*/*.cpp)))
UNIT_OBJECTS := $(patsubst %.cpp,$(BUILD)/%.o,$(wildcard tests/unit/*.cpp tests/physics/*.cpp))
BENCH_NAMES  := $(basename $(notdir $(wildcard bench/*.cpp)))
PROGRAMS     := $(TOOLS:%=$(BUILD)/bin/%)

.PHONY: all demo test unit-test cli-test bench man install asan clean help packages
.SECONDARY:

all: $(PROGRAMS)                ## build the four programs into build/bin

help:                           ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*##/:/' | column -t -s :

# ---- dependencies from Debian -------------------------------------------------------------------------------------------------
include packages.mk

packages: $(BUILD)/packages-present

# ---- build --------------------------------------------------------------------------------------------------------------------
$(BUILD)/%.o: %.cpp | $(BUILD)/packages-present
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS) -MMD -MP -c $< -o $@

$(BUILD)/libkiln.a: $(LIB_OBJECTS)
	@rm -f $@
	ar rcs $@ $^

define tool_rule
$(BUILD)/bin/$(1): $$(patsubst %.cpp,$(BUILD)/%.o,$$(wildcard tools/$(1)/*.cpp)) $(BUILD)/libkiln.a
	@mkdir -p $$(@D)
	$(CXX) $$^ $(LDFLAGS) -o $$@
endef
$(foreach tool,$(TOOLS),$(eval $(call tool_rule,$(tool))))

$(BUILD)/test/unit: $(UNIT_OBJECTS) $(TOOL_OBJECTS) $(BUILD)/libkiln.a
	@mkdir -p $(@D)
	$(CXX) $^ $(LDFLAGS) -o $@

$(BUILD)/bench/%: $(BUILD)/bench/%.o $(BUILD)/libkiln.a
	@mkdir -p $(@D)
	$(CXX) $^ $(LDFLAGS) -o $@

-include demo.mk tests/fuzz/fuzz.mk
-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

clean:                          ## delete everything that was built
	rm -rf $(BUILD)
