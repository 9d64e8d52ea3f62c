"""of_streams.py: relations of all programs as readers and writers of streams: the same bytes, however a stream is handed over."""
import os
import random
import signal
import subprocess
import time

import numpy

from draw import bar, cell, density_of, green, until_taken
from firings import Firing, fired
from trial import Broken, program, same


def _fireable(trial, gains=(0.02,)):
    """Options of `sinter` and two states that reach these densities, above that of the denser one, with them."""
    def make():
        states, firing = [green(trial, 80), green(trial, 80)], Firing(trial)
        start = max(map(density_of, states))
        goals = "--to-density=" + ",".join(f"{start + gain:.4f}" for gain in gains)
        for state in states:
            fired(trial, firing, state, goals)
        return ("sinter", *firing.arguments(goals)), states

    return until_taken(make, "cannot be reached", "has shrunk into itself")


def _stages(trial):
    """A program with options and two states that it reads, at random."""
    kind = trial.choose("sinter", "bondify", "bend", "density", "bonds", "elastic", "select", "info")
    if kind == "bend":
        state, options, _ = bar(trial, 120)
        return ("bend", *options), [state, state]
    if kind == "sinter":
        return _fireable(trial)
    if kind in ("bondify", "density", "select", "info"):
        states = [green(trial, 80), green(trial, 80)]
        arguments = {"bondify": ("bondify", "--quiet"),
                     "density": ("analyze", "density", "--correlation", "--range=150nm", "--bins=7"),
                     "select": ("analyze", "select", "--quiet", "--density=0.5,0.6"), "info": ("analyze", "info")}[kind]
        return arguments, states
    return ("analyze", kind), [cell(trial, 80)[0], cell(trial, 80)[0]]


def stream_text_or_binary(trial):
    """A state as text or binary, from a file or a pipe, gives the same bytes: 17 digits hold a double. --text and binary output
    hold the same states."""
    command, (state, _) = _stages(trial)
    binary, text = trial.put("binary.kiln", state), trial.put("text.jsonl", state, text=True)
    wanted = trial.run(*command, binary)
    if command[:2] != ("analyze", "info"):  # which tells the names of files and how many bytes there are
        same("output from text", trial.run(*command, text), wanted)
        same("output from a pipe", trial.run(*command, given=trial.bytes_of(binary)), wanted)
    trial.run(*command, "-o", "out.kiln", binary)
    same("output in a file", trial.bytes_of("out.kiln"), wanted)
    if command[0] in ("sinter", "bondify") or "select" in command:
        trial.run(*command, "--text", "-o", "out.jsonl", binary)
        for found, kept in zip(trial.get("out.jsonl"), trial.get("out.kiln"), strict=True):
            same("header", {key: value for key, value in found.items() if key not in ("particles", "bonds")},
                 {key: value for key, value in kept.items() if key not in ("particles", "bonds")})
            for group in ("particles", "bonds"):
                same("arrays", found.get(group, {}).keys(), kept.get(group, {}).keys())
                for name, values in kept.get(group, {}).items():
                    same(f"{group}.{name}", found[group][name], values)


def stream_joined(trial):
    """cat a b | tool is tool a and then tool b, byte by byte; `analyze select` and `info`, which speak of a whole stream, apart."""
    command, states = _stages(trial)
    while command[1:2] in (("select",), ("info",)):
        command, states = _stages(trial)
    names = [trial.put(f"{k}.kiln", state, text=trial.choose(True, False)) for k, state in enumerate(states)]
    apart = b"".join(trial.run(*command, name) for name in names)
    same("output for both files", trial.run(*command, *names), apart)
    same("output for their stream", trial.run(*command, given=b"".join(map(trial.bytes_of, names))), apart)


def stream_order_of_keys(trial):
    """The order of keys and arrays in a document, spaces, ids left out where they are 0, 1, 2, ... and images where all are none:
    the same bytes."""
    command, (state, _) = _stages(trial)
    if command[1:2] == ("info",):
        command = ("analyze", "density")
    wanted = trial.run(*command, trial.put("plain.kiln", state))
    shuffler = random.Random(int(trial.random.integers(10**9)))

    def shuffled(value):
        items = list(value.items())
        shuffler.shuffle(items)
        return dict(items)

    other = shuffled({**state, "particles": shuffled(state["particles"])})
    if (other["particles"]["id"] == numpy.arange(len(other["particles"]["id"]))).all() and command[0] == "analyze":
        del other["particles"]["id"]
    if "bonds" in other:
        other["bonds"] = shuffled(other["bonds"])
    if command[:2] != ("analyze", "select"):
        same("output", trial.run(*command, trial.put("shuffled.kiln", other, text=trial.choose(True, False))), wanted)


def stream_threads(trial):
    """One thread or two: the same bytes, of packings large enough for loops to be divided (10,000 particles)."""
    options = [f"--particles={trial.random.integers(8500, 10500)}", "--method=affine", "--density=0.42",
               f"--compact-to={trial.between(0.55, 0.62):.3f}", f"--seed={trial.random.integers(10**6)}"]
    firing = Firing(trial, tolerance=1e-2)
    outputs = []
    for threads in (1, 2):
        trial.run("sinter", "green", *options, "-o", "green.kiln", threads=threads)
        goal = density_of(trial.get("green.kiln")[0]) + 0.01
        trial.run("sinter", *firing.arguments(f"--to-density={goal!r}"), "-o", "fired.kiln", "green.kiln", threads=threads)
        trial.run("bondify", "-q", "-o", "bonded.kiln", "fired.kiln", threads=threads)
        outputs.append([trial.bytes_of(f"{name}.kiln") for name in ("green", "fired", "bonded")])
        outputs[-1].append(trial.run("analyze", "density", "bonded.kiln", threads=threads))
    for name, found, wanted in zip(("green body", "sintered", "bonded", "measured"), *outputs):
        same(name, found, wanted)


def stream_resumed(trial):
    """A run killed at a random moment, by a signal that it may answer or not, and resumed until it is through: the same bytes in
    the output and the history as in one go."""
    (_, *options), states = _fireable(trial, (0.005, 0.01, 0.02, 0.03))
    trial.put("two.kiln", *states)
    begun = time.monotonic()
    trial.run("sinter", *options, "--history=whole.jsonl", "-o", "whole.kiln", "two.kiln")
    took = time.monotonic() - begun
    command = ["sinter", *options, "--checkpoint=check.kiln", "--checkpoint-every=0.001ms", "--resume", "--history=parts.jsonl",
               "-o", "parts.kiln", "two.kiln"]
    trial.commands.append(" ".join(["# killed and resumed:", *command]))
    for _ in range(4):
        process = subprocess.Popen([program("sinter"), *command[1:]], cwd=trial.folder, stderr=subprocess.PIPE,
                                   env={**os.environ, "OMP_NUM_THREADS": "1"})
        try:
            process.wait(trial.between(0.0, 1.2 * took))
            break
        except subprocess.TimeoutExpired:
            process.send_signal(trial.choose(signal.SIGKILL, signal.SIGINT, signal.SIGTERM))
        said = process.communicate(timeout=60)[1]
        if process.returncode not in (0, 130, 143, -9, -2, -15):
            raise Broken(f"the run broken off ended with status {process.returncode}: {said.decode()}")
    process.stderr.close()
    trial.run(*command)
    for kind in ("kiln", "jsonl"):
        same(f"output .{kind}", trial.bytes_of(f"parts.{kind}"), trial.bytes_of(f"whole.{kind}"))
    same("no checkpoint is left", os.path.exists(trial.path("check.kiln")), False)
