"""programs.py: runs Kiln's programs, or others that read and write the same streams, as one pipe."""
from __future__ import annotations

import contextlib
import json
import os
import pathlib
import queue
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import IO, Any, NamedTuple, Union

from .state import Document
from .errors import Error, NotConverged, ProgramWarning
from .stream import bytes_of, documents_in

PROGRAMS = ("sinter", "bondify", "bend", "analyze")
PIPE_CLOSED = (141, -signal.SIGPIPE)  # the reader ended first; it is the one that says why
NOT_CONVERGED = 3
SECONDS_BETWEEN_LINES = 1.0

Command = Union[str, Sequence[Union[str, "os.PathLike[str]"]]]


class Progress(NamedTuple):
    """A step of a program.

    program: its name
    step: of how many it has told until now, from 1
    values: what it says of the step, in SI units, as with -v: relative_density, time, and so on
    """

    program: str
    step: int
    values: dict[str, Any]


def find(program: str) -> str:
    """The path of a program: from the environment (SINTER, BONDIFY, BEND, ANALYZE, as the workflows name them), of the tree or
    the installation that this package is part of, or from the PATH. Error where there is none."""
    if program in PROGRAMS:
        if told := os.environ.get(program.upper()):
            return told
        for folder in pathlib.Path(__file__).resolve().parents:
            for own in (folder / "build" / "bin" / program, folder / "bin" / program):
                if os.access(own, os.X_OK) and own.is_file():
                    return str(own)
            if (folder / "Makefile").exists():
                break  # the root of the source
    found = shutil.which(program)
    if not found:
        raise Error(f"{program}: is not found; build it by make, or name its folder in PATH", program)
    return found


def option(name: str, value: Any) -> list[str]:
    """An option as words: True stands for itself, False and None for nothing, values of a list are joined by commas."""
    name = "--" + name.rstrip("_").replace("_", "-")
    if value is None or value is False:
        return []
    if value is True:
        return [name]
    if isinstance(value, (str, os.PathLike)) or not isinstance(value, Iterable):
        return [name, os.fspath(value) if isinstance(value, os.PathLike) else str(value)]
    return [name, ",".join(map(str, value))]


def command(program: str, *words: str | os.PathLike[str], **options: Any) -> list[str]:
    """The words of a command: command("sinter", "green.kiln", to_density=[0.7, 0.8], temperature="1200C").

    program: with a subcommand after a blank, such as "sinter green"
    words: further words, files mostly; options: values with their units, as on the command line, see option()
    """
    return [*program.split(), *(word for each in options.items() for word in option(*each)), *(os.fspath(word) for word in words)]


def stages_of(commands: Iterable[Command]) -> list[list[str]]:
    """The words of each program of a pipe."""
    stages: list[list[str]] = []
    for given in commands:
        if not isinstance(given, str):
            stages.append([os.fspath(word) for word in given])
            continue
        try:
            lexer = shlex.shlex(given, posix=True, punctuation_chars="|")
            lexer.whitespace_split, lexer.commenters = True, ""
            words = list(lexer)
        except ValueError as error:
            raise Error(f"'{given}': {error}") from None
        stages.append([])
        for word in words:
            if word == "|":
                stages.append([])
            else:
                stages[-1].append(word)
    if not stages or not all(stages):
        raise Error("a program is missing in the pipe")
    return stages


class Stage:
    """A running program of a pipe, and what it said."""

    def __init__(self, words: list[str], source: Any, more: Sequence[str]) -> None:
        self.name = os.path.basename(words[0])
        self.steps, self.words, self.warning = 0, "", ""
        try:
            self.process = subprocess.Popen([find(words[0]), *words[1:], *more], stdin=source, stdout=subprocess.PIPE,
                                            stderr=subprocess.PIPE)
        except OSError as error:
            raise Error(f"{words[0]}: {error.strerror}", self.name) from None

    def hear(self, line: str) -> Progress | None:
        """Takes a line of standard error: a step, a warning, or the sentence of an error."""
        if line.startswith("{"):
            with contextlib.suppress(ValueError):
                values = json.loads(line)
                self.steps += 1
                return Progress(self.name, self.steps, values)
        start, mark, _ = line.partition(": warning: ")
        if mark and " " not in start.replace(f"{self.name} ", "", 1):
            self.warning = line.replace(mark, ": ", 1)
            warnings.warn(line, ProgramWarning, stacklevel=4)
        elif line:
            self.words = line
        return None

    def error(self) -> Error | None:
        """What went wrong, after the end."""
        status = self.process.returncode
        if status == 0 or status in PIPE_CLOSED:
            return None
        if status < 0:
            return Error(f"{self.name}: was ended by {signal.Signals(-status).name}", self.name, status)
        if status == NOT_CONVERGED and self.name in PROGRAMS:
            return NotConverged(self.words or self.warning or f"{self.name}: ended without converging", self.name, status)
        return Error(self.words or f"{self.name}: ended with status {status}", self.name, status)


def show(step: Progress, last: list[float]) -> None:
    """Prints a step on standard error: over the last one on a terminal, else a line a second at most."""
    now, terminal = time.monotonic(), sys.stderr.isatty()
    if now - last[0] < (0.1 if terminal else SECONDS_BETWEEN_LINES):
        return
    last[0] = now
    told = ", ".join(f"{key.replace('_', ' ')} {value:.4g}" for key, value in step.values.items()
                     if isinstance(value, (int, float)) and not isinstance(value, bool))
    print(f"{step.program}: step {step.step}: {told}", end="\r" if terminal else "\n", file=sys.stderr, flush=True)


class Listeners:
    """Threads that move what goes into a pipe and what comes out, and the queue of what they meet: pairs of a kind and a value."""

    def __init__(self) -> None:
        self.events: queue.SimpleQueue[tuple[str, Any]] = queue.SimpleQueue()
        self.running = 0

    def start(self, work: Callable[..., None], *given: Any) -> None:

        def whole() -> None:
            try:
                work(*given)
            except Exception as error:  # it belongs to the caller's thread
                self.events.put(("error", error))
            self.events.put(("end", None))

        self.running += 1
        threading.Thread(target=whole, daemon=True).start()

    def feed(self, stream: IO[bytes], given: Iterable[Mapping[str, Any]]) -> None:
        with contextlib.suppress(BrokenPipeError), stream:
            for document in given:
                stream.write(bytes_of(document))

    def hear(self, stage: Stage) -> None:
        for line in stage.process.stderr or ():
            self.events.put(("line", (stage, line.decode("utf-8", "replace").strip())))

    def collect(self, stage: Stage) -> None:
        assert stage.process.stdout
        number = 0
        try:
            for number, document in enumerate(documents_in(stage.process.stdout), 1):
                self.events.put(("document", document))
        except Error as error:
            for _ in iter(lambda: stage.process.stdout.read(1 << 16), b""):  # type: ignore[union-attr]
                pass  # so that the program ends as it would
            self.events.put(("error", Error(f"{stage.name}: what it wrote, document {number + 1}: {error}", stage.name)))


def run(*commands: Command,
        given: Mapping[str, Any] | Iterable[Mapping[str, Any]] | None = None,
        progress: bool | Callable[[Progress], None] = False,
        threads: int | None = None) -> list[Document]:
    """Runs a pipe of programs and gives the documents that the last one writes: states are State, results Document.

    commands: the programs one after the other, each as a text as in a shell ("bondify --method necks"), or as words (see
        command()); one text may hold several with | between them. Nothing is done by a shell. Besides Kiln's four, any program
        that reads and writes such streams may stand in a pipe.
    given: a state or result, or several, that the first program reads
    progress: True prints the steps of Kiln's programs on standard error; or a function that is called with each Progress, in
        this thread
    threads: of each of Kiln's programs; all cores by default
    Warnings of programs become ProgramWarning. Raises Error with the sentence of the first program that fails, NotConverged
    (with what was written) where one ends without converging. No program is left running.
    """
    stages = stages_of(commands)
    listeners, running = Listeners(), []  # type: Listeners, list[Stage]
    try:
        for number, words in enumerate(stages):
            own = os.path.basename(words[0]) in PROGRAMS
            more = (["-v"] if own and progress else []) + (["--threads", str(threads)] if own and threads else [])
            source = running[-1].process.stdout if running else subprocess.DEVNULL if given is None else subprocess.PIPE
            running.append(Stage(words, source, more))
            if number:
                running[-2].process.stdout.close()  # type: ignore[union-attr]
            listeners.start(listeners.hear, running[-1])
        if given is not None:
            listeners.start(listeners.feed, running[0].process.stdin, [given] if isinstance(given, Mapping) else given)
        listeners.start(listeners.collect, running[-1])
        documents, odd = follow(listeners, progress)
        for stage in running:
            stage.process.wait()
    finally:
        for stage in running:
            if stage.process.poll() is None:
                stage.process.terminate()
                stage.process.wait()
    errors = [error for error in (stage.error() for stage in running) if error]
    errors.sort(key=lambda error: isinstance(error, NotConverged))  # the first that wrote nothing, if there is one
    for error in errors + odd:
        if isinstance(error, NotConverged):
            error.documents = documents
        raise error
    return documents


def follow(listeners: Listeners, progress: bool | Callable[[Progress], None]) -> tuple[list[Document], list[Error]]:
    """Takes what comes out of a pipe until all of it has ended: documents, and what was no document."""
    documents: list[Document] = []
    odd: list[Error] = []
    last = [0.0]
    while listeners.running:
        kind, value = listeners.events.get()
        if kind == "end":
            listeners.running -= 1
        elif kind == "document":
            documents.append(value)
        elif kind == "error":
            if not isinstance(value, Error):
                raise value
            odd.append(value)
        else:
            stage, line = value
            step = stage.hear(line)
            if step and callable(progress):
                progress(step)
            elif step and progress:
                show(step, last)
    if last[0] and sys.stderr.isatty():
        print(file=sys.stderr)
    return documents, odd
