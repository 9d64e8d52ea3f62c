"""errors.py: what the package raises and warns of."""
from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .state import Document


class Error(Exception):
    """One sentence: place, cause, what was wanted. Of a failed program it is the program's own.

    program: name of the program that failed, None where none did
    status: its exit status: 1 could not, 2 wrong usage, 3 finished without converging; negative: the signal that ended it
    """

    def __init__(self, sentence: str, program: str | None = None, status: int | None = None) -> None:
        super().__init__(sentence)
        self.program, self.status = program, status


class NotConverged(Error):
    """A program finished without converging (status 3). documents: what the pipe wrote all the same."""

    documents: list[Document]


class ProgramWarning(UserWarning):
    """A warning that a program said."""
