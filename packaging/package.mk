# package.mk: `make install` and `make deb`.
INSTALLED   = $(DESTDIR)$(PREFIX)
SHARE       = $(INSTALLED)/share
# Where Python looks for packages: Debian's own folder below /usr, one of the version elsewhere.
VERSIONED   = $(shell $(PYTHON) -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
MODULES     = lib/$(if $(filter /usr,$(PREFIX)),python3,$(VERSIONED))/dist-packages
DEB_FOLDER ?= $(BUILD)/deb
VERSION     = $(shell sed -nE 's/.*version = "([^"]+)".*/\1/p' tools/common/tool.h)

.PHONY: install deb

install: all man                ## install programs, the Python package, manual pages, completion under PREFIX (default /usr/local)
	install -d $(INSTALLED)/bin $(SHARE)/man/man1 $(SHARE)/man/man5 $(SHARE)/kiln/post $(SHARE)/bash-completion/completions \
	    $(INSTALLED)/$(MODULES)/kiln
	install $(PROGRAMS) $(INSTALLED)/bin
	install -m 644 python/kiln/*.py python/kiln/py.typed $(INSTALLED)/$(MODULES)/kiln
	install -m 644 $(addprefix workflows/post/,dem_convert.py tables.py units.py vtu_file.py) \
	    workflows/post/convert_*.py workflows/post/dem_view.* $(SHARE)/kiln/post
	install $(POST_TOOLS:%=workflows/post/%) $(SHARE)/kiln/post
	ln -sfn ../../../$(MODULES)/kiln $(SHARE)/kiln/post/kiln
	for name in $(POST_TOOLS); do ln -sf ../share/kiln/post/$$name $(INSTALLED)/bin/$$name; done
	install -m 644 $(BUILD)/man/*.1 $(SHARE)/man/man1
	install -m 644 $(BUILD)/man/*.5 $(SHARE)/man/man5
	install -m 644 completion/kiln.bash $(SHARE)/bash-completion/completions/sinter
	for tool in bondify bend analyze $(POST_TOOLS); do ln -sf sinter $(SHARE)/bash-completion/completions/$$tool; done

deb: all man                    ## a Debian package of this build into build/deb
	packaging/make-deb.sh $(DEB_FOLDER) $(VERSION) $(BUILD)
