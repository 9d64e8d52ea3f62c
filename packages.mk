# packages.mk: the Debian packages that Kiln needs, and how a missing one is installed.
BUILD_PACKAGES  := g++ libeigen3-dev libcli11-dev nlohmann-json3-dev libboost-dev
TEST_PACKAGES   := doctest-dev bats bats-support bats-assert parallel jq
PICTURE_PACKAGES := python3 python3-numpy python3-matplotlib python3-meshio libjs-three
# Neighbours that tests read back with, a browser, and a workflow engine: large, so only `make test` installs them, and tests skip
# without.
NEIGHBOUR_PACKAGES := python3-vtk9 chromium fonts-dejavu-core snakemake
# What single tests need and are skipped without: `make optional-packages` installs them.
OPTIONAL_PACKAGES := mypy python3-pandas slurmctld slurmd slurm-client munge
# For `make PETSC=1`, which installs them: the linear systems of bonds on several machines.
PETSC_PACKAGES := petsc-dev libopenmpi-dev openmpi-bin pkgconf
# Further checks, by hand only: `make fuzz`, `make tsan`, `make tidy`.
FUZZ_PACKAGES := clang-14 libclang-rt-14-dev
TIDY_PACKAGES := clang-tidy-14
PACKAGES := $(BUILD_PACKAGES) $(TEST_PACKAGES) $(PICTURE_PACKAGES)

# Installs those of $(1) that are missing. As root nothing is asked; otherwise sudo is used.
define install_missing
	missing=(); \
	for package in $(1); do \
	    dpkg-query -W -f '$${db:Status-Status}' "$$package" 2>/dev/null | grep -qx installed || missing+=("$$package"); \
	done; \
	if (( $${#missing[@]} )); then \
	    echo "installing $${missing[*]}"; \
	    run=(); if (( $$(id -u) )); then run=(sudo); fi; \
	    "$${run[@]}" apt-get update -qq; \
	    "$${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$${missing[@]}" >/dev/null; \
	fi
endef

# Where there is no apt-get the list is printed and the build stops.
$(BUILD)/packages-present: packages.mk
	@mkdir -p $(@D)
	@if ! command -v apt-get >/dev/null; then \
	    echo "Kiln needs what these Debian packages hold; install their like and run 'touch $@':" >&2; \
	    echo "  $(PACKAGES)" >&2; exit 1; \
	fi
	@$(call install_missing,$(PACKAGES))
	@touch $@

# A PETSc that pkg-config finds is taken as it is: that of a cluster's modules, by PKG_CONFIG_PATH.
$(BUILD)/petsc-present: packages.mk
	@mkdir -p $(@D)
	@pkg-config --exists PETSc 2>/dev/null && command -v $(MPICXX) >/dev/null || { \
	    if ! command -v apt-get >/dev/null; then \
	        echo "PETSC=1 needs PETSc, found by pkg-config, and MPI's compiler $(MPICXX)" >&2; exit 1; \
	    fi; \
	    $(call install_missing,$(PETSC_PACKAGES)); }
	@touch $@

.PHONY: optional-packages
optional-packages:              ## install what single tests are skipped without: mypy, pandas, Slurm
	@$(call install_missing,$(OPTIONAL_PACKAGES))

# Without these the tests that need them are skipped.
$(BUILD)/neighbours-present: packages.mk | $(BUILD)/packages-present
	@($(call install_missing,$(NEIGHBOUR_PACKAGES))) || echo "$(NEIGHBOUR_PACKAGES): not installed; their tests are skipped" >&2
	@touch $@
