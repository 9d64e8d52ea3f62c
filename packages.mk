# packages.mk: the Debian packages that Kiln needs, and how a missing one is installed.
BUILD_PACKAGES  := g++ libeigen3-dev libcli11-dev nlohmann-json3-dev libboost-dev
TEST_PACKAGES   := doctest-dev bats bats-support bats-assert jq
PICTURE_PACKAGES := python3 python3-numpy python3-matplotlib python3-meshio
PACKAGES := $(BUILD_PACKAGES) $(TEST_PACKAGES) $(PICTURE_PACKAGES)

# As root nothing is asked; otherwise sudo is used; where there is no apt-get the list is printed and the build stops.
$(BUILD)/packages-present: packages.mk
	@mkdir -p $(@D)
	@missing=(); \
	if ! command -v apt-get >/dev/null; then \
	    echo "Kiln needs what these Debian packages hold; install their like and run 'touch $@':" >&2; \
	    echo "  $(PACKAGES)" >&2; exit 1; \
	fi; \
	for package in $(PACKAGES); do \
	    dpkg-query -W -f '$${db:Status-Status}' "$$package" 2>/dev/null | grep -qx installed || missing+=("$$package"); \
	done; \
	if (( $${#missing[@]} )); then \
	    echo "installing $${missing[*]}"; \
	    run=(); if (( $$(id -u) )); then run=(sudo); fi; \
	    "$${run[@]}" apt-get update -qq; \
	    "$${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$${missing[@]}" >/dev/null; \
	fi
	@touch $@
