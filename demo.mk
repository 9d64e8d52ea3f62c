# demo.mk: `make demo`, the study of the paper at 3,000 particles, in half a minute, into build/demo.
DEMO_PARTICLES ?= 3000

demo: $(PROGRAMS)               ## run the paper's study at 3,000 particles; all in build/demo/report.html
	@$(MAKE) --no-print-directory -C workflows/paper N=$(DEMO_PARTICLES) OUT=$(abspath $(BUILD))/demo \
	    BIN=$(abspath $(BUILD))/bin PYTHON=$(PYTHON)
