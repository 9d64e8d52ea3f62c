#!/usr/bin/env bats
# faults.bats: full disks, closed folders, signals and changed files: an output is whole under its name, or what was there before.
load stream_support.bash

# Every output that a file can be named for, but for checkpoints, whose own tests are in sinter.bats.
OUTPUTS=(green sinter history bondify bend states select density modulus)
FIRE=(--temperature 1200C --to-density 0.6)

# Writes the output that goes by the short name to $2, from the input $3; its other outputs go to the file "other".
write_output() {
    local name=$1 out=$2 input=${3:-$SHARED/$1.in}
    case $name in
    green) exec "$SINTER" green -q -n "${PARTICLES:-500}" -o "$out" ;;
    sinter) exec "$SINTER" -q "${FIRE[@]}" -o "$out" "$input" ;;
    history) exec "$SINTER" -q "${FIRE[@]}" --history "$out" -o other "$input" ;;
    bondify) exec "$BONDIFY" -q -o "$out" "$input" ;;
    bend) exec "$BEND" -q --cycles 1 -o "$out" "$input" ;;
    states) exec "$BEND" -q --cycles 1 --states "$out" -o other "$input" ;;
    select) exec "$ANALYZE" select --index 1,2 -o "$out" "$input" ;;
    *) exec "$ANALYZE" "$name" -o "$out" "$input" ;;
    esac
}

setup_file() {
    export SHARED=$BATS_FILE_TMPDIR OMP_NUM_THREADS=1 name
    cd "$SHARED"
    "$SINTER" green -n 1500 --aspect 4:1:1 --method affine --compact-to 0.57 --seed 4 -o one.green
    "$BONDIFY" -q one.green -o one.bonded
    "$BEND" -q --cycles 1 one.bonded -o one.bent
    for kind in green bonded bent; do cat one.$kind one.$kind >$kind.in; done
    for name in sinter history bondify select density; do ln -s green.in $name.in; done
    for name in bend states; do ln -s bonded.in $name.in; done
    ln -s bent.in modulus.in
    for name in "${OUTPUTS[@]}"; do (write_output "$name" "$name.whole"); done
}

# Bats keeps files of its own in the folder of a test.
setup() {
    mkdir "$BATS_TEST_TMPDIR/work"
    cd "$BATS_TEST_TMPDIR/work"
}

# No file in this folder but those given.
assert_only() {
    run -0 ls -A
    assert_output "$(printf '%s\n' "$@")"
}

@test "a full disk under any output is one sentence; the run's other output does not appear" {
    for name in "${OUTPUTS[@]}"; do
        run -1 --separate-stderr write_output "$name" /dev/full
        assert_one_sentence
        assert_regex "$stderr" "/dev/full: cannot be written: No space left on device"
        assert_only
    done
}

@test "a disk that fills up while a file is written leaves what was there before, and nothing beside it" {
    limited() { (ulimit -f 1 && write_output "$@"); }
    for name in green sinter bondify states select; do
        echo before >out
        run -1 --separate-stderr limited "$name" out
        assert_one_sentence
        assert_regex "$stderr" "cannot be written: File too large"
        assert_equal "$(cat out)" before
        assert_only out
    done
}

@test "a disk that fills up under a checkpoint is one sentence; once there is room the run is resumed and ends in the same bytes" {
    resumable() { "$SINTER" -q --temperature 1200C --to-density 0.6 --checkpoint run --checkpoint-every 0s --resume -o out "$SHARED/sinter.in"; }
    limited() { (ulimit -f 8 && resumable); }
    run -1 --separate-stderr limited
    assert_one_sentence
    assert_regex "$stderr" "run: cannot be written: File too large"
    [ ! -e out ]
    resumable
    cmp out "$SHARED/sinter.whole"
    assert_only out
}

# Root obeys the mode bits of its own files once it has put the right to override them aside.
obedient() {
    if [ "$(id -u)" != 0 ]; then "$@"; else setpriv --bounding-set=-dac_override,-dac_read_search "$@"; fi
}

@test "a folder that is closed, a file that is write-protected, a path below a file: one sentence before any work" {
    export -f write_output
    mkdir closed
    echo before >closed/there
    echo before >protected
    chmod 444 protected closed/there
    chmod 555 closed
    for name in "${OUTPUTS[@]}"; do
        for out in closed/out closed/there protected protected/out; do
            wanted="Permission denied"
            if [[ $out == protected/out ]]; then wanted="Not a directory"; fi
            PARTICLES=2000000 FIRE=("${FIRE[@]}") run -1 --separate-stderr obedient timeout 10 bash -c "$(declare -p FIRE); write_output $name $out"
            assert_one_sentence
            assert_regex "$stderr" "$out: cannot be written: $wanted"
        done
        assert_equal "$(cat protected closed/there)" $'before\nbefore'
        assert_only closed protected
    done
}

assert_end() {
    local status=0
    wait "$process" || status=$?
    assert_equal "$status" "$1"
}

# A run that waits for the second document of its input, or packs a large body; its output stands beside its name by then.
begin() {
    PARTICLES=200000 write_output "$1" out pipe 7>&- &
    process=$!
    if [[ $1 != green ]]; then head -c "$(stat -c %s "$SHARED/$2")" "$SHARED/$1.in" >&7; fi
    for _ in {1..200}; do
        if compgen -G "out.partial-$process" >/dev/null; then return; fi
        sleep 0.02
    done
    fail "$1 did not begin"
}

first_of() {
    case $1 in
    bend | states) echo one.bonded ;;
    modulus) echo one.bent ;;
    *) echo one.green ;;
    esac
}

@test "a signal in the middle of any output leaves what was there before; after kill -9 the same command makes the whole" {
    for name in "${OUTPUTS[@]}"; do
        for signal in INT TERM KILL; do
            mkfifo pipe
            exec 7<>pipe
            echo before >out
            begin "$name" "$(first_of "$name")"
            kill -s "$signal" "$process"
            assert_end "$((128 + $(kill -l "$signal")))"
            exec 7>&-
            if [[ $name != @(sinter|history) || $signal == KILL || $(head -c 6 out) == before ]]; then
                cmp out <(echo before)
            else  # a signal ends sintering after the step; the state that it reached is written
                jq -e . <(head -1 out)
            fi
            rm -f pipe other
            if [[ $signal != KILL ]]; then assert_only out; fi
        done
        (write_output "$name" out)
        cmp out "$SHARED/$name.whole"
        rm -f out* other*
    done
}

# A run that has read its first document and stands in the middle of writing it to a pipe that nobody empties.
begin_in_pipe() {
    mkfifo pipe
    exec 8<>pipe
    write_output "$1" pipe "${2:-$SHARED/$1.in}" 2>said 8>&- &
    process=$!
    head -c 1 <&8 >begun
}

# What the pipe still holds and is yet to get, into the file "rest".
drain() {
    exec 9<pipe 8>&-
    cat <&9 >rest
    exec 9<&-
}

# The first signal may come between two writes, and the second of them would wait for the reader; the second signal waits for nothing.
@test "a signal, sent twice in the middle of a pipe, ends the run with its status; the next program says that its input is cut" {
    for name in sinter bondify states select; do
        for signal in INT TERM KILL; do
            begin_in_pipe "$name"
            kill -s "$signal" "$process"
            sleep 0.1
            kill -s "$signal" "$process" || true
            assert_end "$((128 + $(kill -l "$signal")))"
            drain
            assert_equal "$(cat said)" ""
            run -1 --separate-stderr bash -c 'cat begun rest | "$ANALYZE" density'
            assert_regex "$stderr" "standard input, document 1: is truncated: [0-9]+ bytes belong behind its header, [0-9]+ are there"
            rm -f pipe said other*
        done
    done
}

@test "an input that is replaced while it is read: the run goes on with the file that it opened" {
    "$SINTER" green -q -n 10 -o small
    for name in sinter bondify states select; do
        cp "$SHARED/$name.in" input
        begin_in_pipe "$name" input
        cp small new
        mv new input
        drain
        assert_end 0
        cat begun rest | cmp - "$SHARED/$name.whole"
        rm pipe
    done
}

@test "an input that is cut while it is read: the run says so and fails" {
    for name in sinter bondify states; do
        cp "$SHARED/$name.in" input
        begin_in_pipe "$name" input
        truncate -s "$(($(stat -c %s input) * 3 / 4))" input
        drain
        assert_end 1
        run -0 cat said
        assert_output --regexp "input, document 2: is truncated: [0-9]+ bytes belong behind its header, [0-9]+ are there$"
        rm pipe
    done
}

@test "an output may be the input, by the same name or through a link" {
    for name in "${OUTPUTS[@]:1}"; do
        cp "$SHARED/$name.in" same
        (write_output "$name" same same)
        cmp same "$SHARED/$name.whole"
        cp "$SHARED/$name.in" same
        ln -sf same link
        (write_output "$name" link same)
        cmp same "$SHARED/$name.whole"
        [ -L link ]
        cp "$SHARED/$name.in" same
        ln -f same hard
        (write_output "$name" same hard)
        cmp same "$SHARED/$name.whole"
        cmp hard "$SHARED/$name.in"
        rm -f same link hard other
        assert_only
    done
}

@test "two outputs of one run with one name are wrong usage" {
    while IFS='|' read -r tool options; do
        run -2 --separate-stderr bash -c "\"\$$tool\" $options"
        assert_one_sentence
        assert_regex "$stderr" "two outputs of one run cannot have the same name"
    done <<END
SINTER|${FIRE[*]} -o out --history out $SHARED/green.in
SINTER|${FIRE[*]} -o out --checkpoint ./out $SHARED/green.in
SINTER|${FIRE[*]} -o out --history log --checkpoint log $SHARED/green.in
BEND|-o out --states $PWD/out $SHARED/bonded.in
BEND|--states - $SHARED/bonded.in
END
    assert_only
    "$BEND" -q --states /dev/null -o /dev/null "$SHARED/one.bonded"
}

@test "two runs with one output leave the whole of one of them" {
    (write_output select twice.bonded "$SHARED/bonded.in")
    for name in bondify sinter states; do
        for delay in 0 0.05; do
            write_output "$name" out & first=$!
            sleep "$delay"
            write_output select out & second=$!
            wait "$first"
            wait "$second"
            cmp -s out "$SHARED/$name.whole" || cmp out "$SHARED/select.whole"
            rm -f out other
            assert_only twice.bonded
        done
    done
}
