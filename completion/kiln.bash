# kiln.bash: bash completion for sinter, bondify, bend, analyze, dem-convert and dem-view. Options and their words are those that
# --help lists.

_kiln() {
    local current=$2 previous=$3 command=("$1") help words
    COMPREPLY=()
    if [[ ${1##*/} == sinter && ${COMP_WORDS[1]-} == green ]] || [[ ${1##*/} == analyze && $COMP_CWORD -gt 1 ]]; then
        command+=("${COMP_WORDS[1]}")
    fi
    help=$("${command[@]}" --help 2>/dev/null) || return 0
    if [[ ${1##*/} == analyze && $COMP_CWORD == 1 && $current != -* ]]; then
        words=$(sed -nE '/^Subcommands/,$ s/^  ([a-z]+) {2,}.*/\1/p' <<<"$help")
    elif [[ $previous == --* ]] && grep -qE -- "(^| |,)$previous ([A-Z]+:)?\{" <<<"$help"; then
        words=$(sed -nE "/$previous ([A-Z]+:)?\{/ { s/^.*$previous ([A-Z]+:)?\{([^}]*)\}.*/\2/p; q }" <<<"$help" | tr , ' ')
    elif [[ $current == -* ]]; then
        words=$(sed -nE 's/^  (-[^ ]+( [A-Z]+,)? ?[^ ]*).*/\1/p' <<<"$help" | grep -oE -- '--[a-z-]+')
    elif [[ ${1##*/} == sinter && $COMP_CWORD == 1 ]]; then
        words="green"
        compopt -o default 2>/dev/null
    fi
    mapfile -t COMPREPLY < <(compgen -W "${words-}" -- "$current")
}

complete -o default -F _kiln sinter bondify bend analyze dem-convert dem-view
