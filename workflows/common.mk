# common.mk: what every study shares: the programs, the settings of a run, the rules from one kind of file to the next.
#
# A study includes this file after it has said what it is: STUDY (a name), CASES (relative densities), GREEN, SINTERING, BONDING and
# BENDING (options of the four stages); FIT holds those of the fit. Every file of a run stands under OUT; a case is a folder there,
# named for its density:
#   green.kiln  sintered.kiln  history.jsonl  0.67/{sintered.kiln,bonded.kiln,bonds.json,bend.json,bent.kiln,modulus.json}  fit.json
SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
MAKEFLAGS += --no-builtin-rules --no-print-directory

ROOT    := $(abspath $(dir $(lastword $(MAKEFILE_LIST)))/..)
POST    := $(ROOT)/workflows/post
BIN     ?= $(ROOT)/build/bin
OUT     ?= $(ROOT)/build/$(STUDY)
PYTHON  ?= /usr/bin/python3
FIT     ?= --law knudsen --weights equal# the error of one curve says nothing of how packings scatter
SINTER  ?= $(BIN)/sinter
BONDIFY ?= $(BIN)/bondify
BEND    ?= $(BIN)/bend
ANALYZE ?= $(BIN)/analyze
MEASURE  = @$(PYTHON) $(POST)/measure.py
# The same in the folder of a case file, whose paths are those of that folder: $(call measure_in,FOLDER).
measure_in = @cd $(1) && $(PYTHON) $(POST)/measure.py

ifneq ($(OUT),$(abspath $(OUT)))
$(error OUT=$(OUT) is not an absolute path; try OUT=$$PWD/$(OUT))
endif

comma := ,
empty :=
space := $(empty) $(empty)
comma_list = $(subst $(space),$(comma),$(strip $(1)))
each_case = $(CASES:%=$(OUT)/%/$(1))

# ---- programs: built if they are this tree's own and are not there -------------------------------------------------------------
OWN := $(addprefix $(ROOT)/build/bin/,sinter bondify bend analyze)
PROGRAMS := $(filter $(OWN),$(SINTER) $(BONDIFY) $(BEND) $(ANALYZE))

$(OWN) &:
	$(MAKE) -C $(ROOT) BUILD=build all

# ---- settings: a file for each stage that changes only when the stage's options do, so a changed N or SEED makes the run anew --
.PHONY: FORCE
FORCE:

$(addprefix $(OUT)/,$(addsuffix .settings,GREEN SINTERING BONDING BENDING FIT $(MORE_SETTINGS))): $(OUT)/%.settings: FORCE
	@mkdir -p $(@D)
	@cmp -s $@ <(echo '$($*)') || echo '$($*)' > $@

# ---- stages --------------------------------------------------------------------------------------------------------------------
$(OUT)/green.kiln: $(OUT)/GREEN.settings | $(PROGRAMS)
	$(MEASURE) $@ $(SINTER) green $(GREEN) -o $@

$(OUT)/sintered.kiln $(OUT)/history.jsonl &: $(OUT)/green.kiln $(OUT)/SINTERING.settings | $(PROGRAMS)
	$(MEASURE) $(OUT)/sintered.kiln \
	    $(SINTER) $(SINTERING) --to-density $(call comma_list,$(CASES)) --history $(OUT)/history.jsonl -o $(OUT)/sintered.kiln $<

$(OUT)/%/sintered.kiln: $(OUT)/sintered.kiln | $(PROGRAMS)
	@mkdir -p $(@D)
	$(MEASURE) $@ $(ANALYZE) select --density $* -o $@ $<

$(OUT)/%/bonded.kiln: $(OUT)/%/sintered.kiln $(OUT)/BONDING.settings | $(PROGRAMS)
	$(MEASURE) $@ $(BONDIFY) $(BONDING) -o $@ $<

$(OUT)/%/bonds.json: $(OUT)/%/bonded.kiln | $(PROGRAMS)
	$(MEASURE) $@ $(ANALYZE) bonds -o $@ $<

$(OUT)/%/bend.json $(OUT)/%/bent.kiln: $(OUT)/%/bonded.kiln $(OUT)/BENDING.settings | $(PROGRAMS)
	$(MEASURE) $(OUT)/$*/bend.json $(BEND) $(BENDING) --states $(OUT)/$*/bent.kiln -o $(OUT)/$*/bend.json $<

$(OUT)/%/modulus.json: $(OUT)/%/bend.json | $(PROGRAMS)
	$(MEASURE) $@ $(ANALYZE) modulus -o $@ $<

$(OUT)/fit.json: $(call each_case,modulus.json) $(OUT)/FIT.settings | $(PROGRAMS)
	$(MEASURE) $@ $(ANALYZE) fit $(FIT) -o $@ $(filter %.json,$^)

# ---- all stages, named so that a missing file is made again and none is taken for a passing step -------------------------------
# A study whose stages are not these (OWN_STAGES := yes) says what STAGES are, and makes them by a rule for `stages`.
.PHONY: stages
ifneq ($(OWN_STAGES),yes)
CASE_STAGES := sintered.kiln bonded.kiln bonds.json bend.json modulus.json $(MORE_CASE_STAGES)
STAGES := green.kiln sintered.kiln $(foreach file,$(CASE_STAGES),$(CASES:%=%/$(file))) fit.json $(MORE_STAGES)

stages: $(STAGES:%=$(OUT)/%) $(OUT)/history.jsonl $(call each_case,bent.kiln)
endif

# ---- how long each stage took and how much memory it needed --------------------------------------------------------------------
.PHONY: times
times: stages
	@cd $(OUT); for stage in $(STAGES); do echo -e "$$stage\t$$(cat $$stage.time)"; done | awk -F '\t' \
	    'BEGIN { print "made               wall s    CPU s  peak MB" } \
	     { printf "%-16s %8.2f %8.2f %8d\n", $$1, $$2, $$3, $$4; wall += $$2; cpu += $$3; if ($$4 > peak) peak = $$4 } \
	     END { printf "%-16s %8.2f %8.2f %8d\n", "in all", wall, cpu, peak }'
