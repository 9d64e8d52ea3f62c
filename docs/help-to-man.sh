#!/usr/bin/env bash
# Turns a program's --help into a manual page of section 1 on standard output: help-to-man.sh PROGRAM
set -euo pipefail
program=$1
name=$(basename "$program")
version=$("$program" --version)

# Text for roff: backslashes and leading dots or quotes have a meaning there.
escaped() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }

page() {  # TITLE COMMAND...
    local help
    help=$("${@:2}" --help)
    printf '.SH %s\n.nf\n%s\n.fi\n' "$1" "$(escaped <<<"$help")"
}

help=$("$program" --help)
summary=$(sed -n '/^usage:/,/^$/d; /[^ ]/{p;q}' <<<"$help")
printf '.TH %s 1 "" "%s" "Kiln"\n.SH NAME\n%s \\- %s\n' "${name^^}" "$version" "$name" "$(escaped <<<"$summary")"
page DESCRIPTION "$program"
if [ "$name" = sinter ]; then page 'SINTER GREEN' "$program" green; fi
if [ "$name" = analyze ]; then
    for command in $(sed -nE '/^Subcommands/,/^$/ s/^  ([a-z]+) {2,}.*/\1/p' <<<"$help"); do
        page "ANALYZE ${command^^}" "$program" "$command"
    done
fi
printf '.SH SEE ALSO\n.BR sinter (1),\n.BR bondify (1),\n.BR bend (1),\n.BR analyze (1),\n.BR dem\\-state (5)\n'
