#!/usr/bin/env bats
# package.bats: what `make install` and `make deb` put where, and bash completion.
bats_require_minimum_version 1.5.0
load helper.bash

setup_file() {
    export STAGE="$BATS_FILE_TMPDIR/stage" DEB="$BATS_FILE_TMPDIR/deb"
    make -C "$ROOT" -s BUILD="${BUILD:-build}" PREFIX=/usr DESTDIR="$STAGE" install >/dev/null
    make -C "$ROOT" -s BUILD="${BUILD:-build}" DEB_FOLDER="$DEB" deb >/dev/null
}

# The chain with the programs of one folder, at the smallest size that bends.
chain_of() {
    "$1/sinter" green -n 300 --aspect 4:1:1 --method affine --compact-to 0.6 | "$1/bondify" -q | "$1/bend" -q --cycles 1 | "$1/analyze" modulus
}

# complete WORD...: what completion offers for the last word.
complete_line() {
    bash -c 'source "$ROOT/completion/kiln.bash"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
        _kiln "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"; printf "%s\n" "${COMPREPLY[@]}"' - "$@"
}

@test "an installed tree runs, with manual pages, completion, dem-convert and dem-view" {
    run -0 --separate-stderr chain_of "$STAGE/usr/bin"
    jq -e '.young_modulus > 1e9' <<<"$output"
    run -0 bash -c 'cd "$STAGE/usr/share" && ls man/man1 man/man5 bash-completion/completions'
    for page in sinter.1 bondify.1 bend.1 analyze.1 dem-convert.1 dem-view.1 dem-state.5; do assert_output --partial "$page"; done
    for name in sinter bondify bend analyze dem-convert dem-view; do assert_line "$name"; done
    "$SINTER" green -n 20 | "$STAGE/usr/bin/dem-convert" --to csv - "$BATS_TEST_TMPDIR/out.csv"
    run -0 wc -l <"$BATS_TEST_TMPDIR/out.csv"
    # The Python package beside them finds the programs of its own installation.
    cd "$BATS_TEST_TMPDIR"
    cat >installed.py <<'END'
import kiln
print(kiln.find("sinter"), len(kiln.run("sinter green -n 20")[0].radius))
END
    run -0 env -u SINTER PYTHONPATH="$STAGE/usr/lib/python3/dist-packages" "$PYTHON" installed.py
    assert_output "$STAGE/usr/bin/sinter 20"
    run -0 "$STAGE/usr/bin/dem-view" --version
    assert_output "$("$ANALYZE" info --version | sed 's/^analyze info/dem-view/')"
}

@test "the Debian package names what it needs, unpacks and runs; installed by dpkg it can be removed again" {
    type -P dpkg-deb >/dev/null || skip "there is no dpkg-deb"
    package=$(compgen -G "$DEB/kiln_*.deb")
    run -0 dpkg-deb --field "$package" Package Depends Architecture
    assert_line "Package: kiln"
    assert_line --regexp "^Depends: .*libstdc\+\+6"
    dpkg-deb --extract "$package" "$BATS_TEST_TMPDIR/unpacked"
    run -0 --separate-stderr chain_of "$BATS_TEST_TMPDIR/unpacked/usr/bin"
    [ -e "$BATS_TEST_TMPDIR/unpacked/usr/lib/python3/dist-packages/kiln/py.typed" ]
    jq -e '.young_modulus > 1e9' <<<"$output"
    [ "$(id -u)" = 0 ] || skip "only root installs"
    mkdir -p "$BATS_TEST_TMPDIR/root/var/lib/dpkg/"{info,updates}
    touch "$BATS_TEST_TMPDIR/root/var/lib/dpkg/"{status,available}
    dpkg --root="$BATS_TEST_TMPDIR/root" --force-depends --force-not-root --install "$package"
    run -0 "$BATS_TEST_TMPDIR/root/usr/bin/sinter" --version
    dpkg --root="$BATS_TEST_TMPDIR/root" --remove kiln
    [ ! -e "$BATS_TEST_TMPDIR/root/usr/bin/sinter" ]
}

@test "completion offers options, words of options and subcommands" {
    export ROOT
    run -0 complete_line "$SINTER" --to
    assert_output "--to-density
--tolerance"
    run -0 complete_line "$SINTER" green --comp
    assert_output --compact-to
    run -0 complete_line "$ANALYZE" mod
    assert_output modulus
    run -0 complete_line "$ANALYZE" elastic --bond-l
    assert_output --bond-law
    run -0 complete_line "$BEND" --bond-law n
    assert_output neck
    run -0 complete_line "$BONDIFY" --method ""
    assert_output $'exact\nsweep\nnecks'
    run -0 complete_line "$ROOT/workflows/post/dem-view" --t
    assert_output $'--title\n--three'
    run -0 complete_line "$ROOT/workflows/post/dem-convert" --bonds c
    assert_output cut
    run -0 complete_line "$SINTER" gr
    assert_output green
}
