# fuzz.mk: `make fuzz` feeds mutated documents to the reader for FUZZ_SECONDS, under the address and undefined behaviour sanitizers,
# `make fuzz-tables` tables to those of sizes, spheres, furnace logs and bending tests;
# `make mutate` feeds spoilt streams to the four programs as they are, `make mutate-formats` spoilt files of others to dem-convert,
# `make mutate-tables` exports of testing machines to analyze.
FUZZ_SECONDS ?= 60
# Documents after which the fuzzer ends if the time has not come yet; -1 is none.
FUZZ_RUNS    ?= -1
COUNT        ?= 10000
FUZZ_CXX     ?= clang++-14
FUZZ_FLAGS   := -std=c++20 -g1 -O1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined \
                -Ilib -isystem /usr/include/eigen3
FUZZ_SOURCES := tests/fuzz/reader_fuzz.cpp $(wildcard lib/io/*.cpp) lib/core/array.cpp lib/core/state.cpp \
                lib/physics/materials.cpp lib/physics/schedule.cpp
FUZZ_OBJECTS := $(FUZZ_SOURCES:%.cpp=$(BUILD)/fuzz/%.o)
TABLE_SOURCES := tests/fuzz/table_fuzz.cpp $(wildcard lib/io/*.cpp lib/packing/s*.cpp) lib/analysis/histogram.cpp \
                lib/core/array.cpp lib/core/state.cpp lib/core/neighbours.cpp lib/physics/materials.cpp lib/physics/schedule.cpp
TABLE_OBJECTS := $(TABLE_SOURCES:%.cpp=$(BUILD)/fuzz/%.o)
# The seeds are the conformance set; what is found goes to $(BUILD)/fuzz/corpus and is used again.
# No input needs more memory than this, nor longer than this for one document.
FUZZ_LIMITS  := -rss_limit_mb=1024 -malloc_limit_mb=64 -timeout=10 -max_len=16384

.PHONY: fuzz fuzz-tables mutate mutate-formats mutate-powders mutate-tables
fuzz: $(BUILD)/fuzz/reader      ## feed mutated documents to the reader for FUZZ_SECONDS (60)
	@mkdir -p $(BUILD)/fuzz/corpus
	$< $(FUZZ_LIMITS) -max_total_time=$(FUZZ_SECONDS) -runs=$(FUZZ_RUNS) -dict=tests/fuzz/dem-state.dict \
	    -artifact_prefix=$(BUILD)/fuzz/ -print_final_stats=1 $(BUILD)/fuzz/corpus $(wildcard tests/data/conformance/*valid)

fuzz-tables: $(BUILD)/fuzz/table  ## feed mutated tables to the readers of sizes, spheres, logs and tests for FUZZ_SECONDS (60)
	@mkdir -p $(BUILD)/fuzz/tables
	$< $(FUZZ_LIMITS) -max_total_time=$(FUZZ_SECONDS) -runs=$(FUZZ_RUNS) -dict=tests/fuzz/tables.dict \
	    -artifact_prefix=$(BUILD)/fuzz/ -print_final_stats=1 $(BUILD)/fuzz/tables tests/fuzz/tables

mutate: all                     ## feed COUNT (10000) spoilt streams to the four programs; 8 ms each
	@mkdir -p $(BUILD)/mutants
	BIN=$(abspath $(BUILD))/bin PYTHONDONTWRITEBYTECODE=1 $(PYTHON) tests/fuzz/mutate.py --count $(COUNT) --keep $(BUILD)/mutants

mutate-powders: all             ## feed COUNT (10000) files each of sizes, diameters, spheres and furnace logs to sinter; 5 ms each
	@mkdir -p $(BUILD)/mutants
	BIN=$(abspath $(BUILD))/bin PYTHONDONTWRITEBYTECODE=1 $(PYTHON) tests/fuzz/mutate_powders.py --count $(COUNT) \
	    --keep $(BUILD)/mutants

mutate-tables: $(BUILD)/bin/analyze  ## feed COUNT (10000) exports of testing machines, whole and spoilt, to analyze; 20 ms each
	@mkdir -p $(BUILD)/mutants
	BIN=$(abspath $(BUILD))/bin PYTHONDONTWRITEBYTECODE=1 $(PYTHON) tests/fuzz/mutate_tables.py --count $(COUNT) \
	    --keep $(BUILD)/mutants

mutate-formats: all             ## feed COUNT (10000) spoilt files of each foreign format to dem-convert; 2 ms each
	@mkdir -p $(BUILD)/mutants
	ANALYZE=$(abspath $(BUILD))/bin/analyze PYTHONDONTWRITEBYTECODE=1 $(PYTHON) tests/convert/mutate_formats.py --count $(COUNT) \
	    --keep $(abspath $(BUILD))/mutants

$(BUILD)/fuzz/reader: $(FUZZ_OBJECTS)
	$(FUZZ_CXX) $(FUZZ_FLAGS) $^ -o $@

$(BUILD)/fuzz/table: $(TABLE_OBJECTS)
	$(FUZZ_CXX) $(FUZZ_FLAGS) $^ -o $@

$(BUILD)/fuzz/%.o: %.cpp
	@command -v $(FUZZ_CXX) >/dev/null || \
	    { echo "make fuzz needs $(FUZZ_CXX), of the Debian packages $(FUZZ_PACKAGES)" >&2; exit 1; }
	@mkdir -p $(@D)
	$(FUZZ_CXX) $(FUZZ_FLAGS) -MMD -MP -c $< -o $@
