"""tables.py: arrays and results as tables: numpy's structured arrays, and pandas where it is there."""
from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy
import numpy.typing

from .errors import Error

if TYPE_CHECKING:
    import pandas  # type: ignore[import]


def columns(arrays: Mapping[str, numpy.typing.ArrayLike]) -> dict[str, numpy.typing.NDArray[Any]]:
    """Arrays as columns of single numbers: name, or name[0], name[1]… of a row of several."""
    found = {}
    for name, given in arrays.items():
        values = numpy.asarray(given)
        flat = values.reshape(len(values), math.prod(values.shape[1:]))
        if flat.shape[1] == 1:
            found[name] = flat[:, 0]
        else:
            found.update({f"{name}[{k}]": flat[:, k] for k in range(flat.shape[1])})
    return found


def records(arrays: Mapping[str, numpy.typing.ArrayLike]) -> numpy.typing.NDArray[Any]:
    """Arrays of a state (state.particles, state.bonds) as one structured array: a record for each particle or bond, whose fields
    are the arrays, in their units; rows of several numbers are fields of several."""
    values = {name: numpy.asarray(array) for name, array in arrays.items()}
    rows = {len(array) for array in values.values()}
    if len(rows) != 1:
        raise Error(f"arrays of {', '.join(map(str, sorted(rows)))} rows are no table")
    table = numpy.empty(rows.pop(), [(name, array.dtype, array.shape[1:]) for name, array in values.items()])
    for name, array in values.items():
        table[name] = array
    return table


def flat(document: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    """The keys of a result, those of objects in it as key.key; without format, version, units and history."""
    keys: dict[str, Any] = {}
    for key, value in document.items():
        if isinstance(value, Mapping):
            keys.update(flat(value, f"{before}{key}."))
        elif before or key not in ("format", "version", "units", "history"):
            keys[before + key] = value
    return keys


def frame(given: Mapping[str, Any] | Iterable[Mapping[str, Any]]) -> pandas.DataFrame:
    """A DataFrame: of arrays of a state (state.bonds) a row for each particle or bond; of results, or lines of a history, a row
    for each. Numbers are in SI units. Raises Error where there is no pandas."""
    try:
        import pandas
    except ImportError:
        raise Error("a frame requires pandas, Debian's python3-pandas; kiln.records() makes tables without it") from None
    if isinstance(given, Mapping) and given and all(isinstance(value, numpy.ndarray) for value in given.values()):
        return pandas.DataFrame(columns(given))
    return pandas.DataFrame([flat(each) for each in ([given] if isinstance(given, Mapping) else given)])
