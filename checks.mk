# checks.mk: what looks for faults besides the tests: relations, sanitizers, clang-tidy, a comparison of builds. None is needed
# for `make test`.
TIDY        ?= clang-tidy-14

# Trials of each relation, and the seed of the first.
TRIALS      ?= 8
SEED        ?= 1

.PHONY: relations bars asan tsan tidy same-bytes

relations: all                  ## try TRIALS (8) random cases of what must hold whatever the input, from SEED (1) on; 5 minutes
	BUILD=$(BUILD) PYTHONDONTWRITEBYTECODE=1 $(PYTHON) tests/relations/relations.py --trials $(TRIALS) --seed $(SEED) \
	    --keep $(abspath $(BUILD))/relations

bars: all                       ## bend 300 random small bars to failure and 100 with friction, from SEED (1) on; 5 minutes
	BUILD=$(BUILD) PYTHONDONTWRITEBYTECODE=1 $(PYTHON) tests/relations/bars.py --seed $(SEED)

asan:                           ## build with address and undefined-behaviour sanitizers into build-asan and run all tests
	SANITIZED=1 $(MAKE) BUILD=build-asan EXTRA="-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer" \
	    OPTIMISE="-O1 -UNDEBUG" test

tsan:                           ## build with the thread sanitizer into build-tsan and run the whole chain on four threads
	$(MAKE) BUILD=build-tsan EXTRA=-fsanitize=thread OPTIMISE="-O1 -DNDEBUG" all
	TSAN_OPTIONS=halt_on_error=1 BUILD=$(abspath build-tsan) tests/chain.sh build-tsan/chain 4
	@echo "no data race"

TIDY_STAMPS := $(patsubst %.cpp,$(BUILD)/tidy/%.ok,$(LIB_SOURCES) $(wildcard tools/*/*.cpp))

tidy: $(TIDY_STAMPS)            ## clang-tidy over lib and tools; .clang-tidy says what it looks for

$(BUILD)/tidy/%.ok: %.cpp .clang-tidy
	@command -v $(TIDY) >/dev/null || { echo "make tidy needs the Debian package $(TIDY_PACKAGES)" >&2; exit 1; }
	@mkdir -p $(@D)
	$(TIDY) --quiet $< -- -std=c++20 -fopenmp-simd -Ilib -I. -isystem /usr/include/eigen3
	@touch $@

# The preconditioner rounds in another order at -O2, so it is compiled alike; docs/reliability.md says what that means.
same-bytes: all                 ## build with -O2 into build-O2 and compare every output of the chain with that of -O3
	$(MAKE) BUILD=build-O2 build-O2/lib/linalg/incomplete_cholesky.o
	$(MAKE) BUILD=build-O2 OPTIMISE="-O2 -DNDEBUG" all
	BUILD=$(abspath $(BUILD)) tests/chain.sh $(BUILD)/chain
	BUILD=$(abspath build-O2) tests/chain.sh build-O2/chain
	diff -r $(BUILD)/chain build-O2/chain
	@echo "the same bytes"
