"""stream.py: reads and writes streams of dem-state documents, text and binary, with numpy arrays (see docs/dem-state.5)."""
from __future__ import annotations

import contextlib
import io
import json
import math
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from typing import IO, Any, Union

import numpy
import numpy.typing

from .state import Document, document_of, groups
from .errors import Error

ALIGNMENT = 64  # bytes
MOST_KEYS, DEEPEST = 1024, 64  # of an object and of what stands in it; only hostile documents have more
PIECE = 1 << 26  # bytes that are read at once: a header may promise more than there is
TYPES = ("f8", "f4", "i8", "i4", "i2", "i1", "u1")

Array = numpy.typing.NDArray[Any]
Source = Union[str, "os.PathLike[str]", bytes, IO[bytes]]
Target = Union[str, "os.PathLike[str]", IO[bytes]]


# ---- reading -------------------------------------------------------------------------------------------------------------------
def unrepeated(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON; a key that stands twice is refused."""
    keys = dict(pairs)
    if len(pairs) > MOST_KEYS:
        raise Error(f"an object has {len(pairs)} keys, more than {MOST_KEYS}")
    if len(keys) < len(pairs):
        names = [key for key, _ in pairs]
        raise Error(f"key '{next(key for key in names if names.count(key) > 1)}' stands twice")
    return keys


def refuse_constant(name: str) -> None:
    raise Error(f"{name} is no number")


def check_depth(value: Any, left: int = DEEPEST) -> None:
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    if left < 0:
        raise Error(f"values stand more than {DEEPEST} levels deep")
    for each in inner:
        if isinstance(each, (dict, list)):
            check_depth(each, left - 1)


def header_of(line: bytes) -> tuple[Document, int]:
    """A document without its arrays, and the size of what follows its line."""
    spelling: dict[float, str] = {}

    def number(text: str) -> float:
        value = float(text)
        if value and number_text(value) != text:
            spelling[value] = text
        return value

    try:
        header = json.loads(line, object_pairs_hook=unrepeated, parse_constant=refuse_constant, parse_float=number)
    except (ValueError, RecursionError) as error:
        raise Error(f"is no line of JSON ({error})") from None
    if not isinstance(header, dict):
        raise Error("is not a JSON object")
    check_depth(header, DEEPEST - 1)
    size = header.pop("bytes", 0)
    if not isinstance(size, int) or isinstance(size, bool) or size < 0:
        raise Error("bytes is not a number of bytes")
    document = document_of(header)
    document.spelling = spelling
    return document, size


def array_of(name: str, spec: Any, payload: bytearray) -> Array:
    """The array that an object with type, shape, and data or at describes."""
    if not isinstance(spec, dict) or spec.get("type") not in TYPES or ("data" in spec) == ("at" in spec):
        raise Error(f"{name} is not an array with type, shape, and data or at")
    dtype, shape = numpy.dtype("<" + spec["type"]), spec.get("shape")
    if not isinstance(shape, list) or not shape or not all(type(n) is int and 0 <= n < 2**31 for n in shape):
        raise Error(f"{name}: shape is not a list of sizes")
    count = math.prod(shape)
    if "at" in spec:
        at = spec["at"]
        if type(at) is not int or at < 0 or at + count * dtype.itemsize > len(payload):
            raise Error(f"{name} lies beyond the {len(payload)} bytes behind the header")
        return numpy.frombuffer(payload, dtype, count, at).reshape(shape)
    data, kinds = spec["data"], (int, float) if dtype.kind == "f" else (int, )
    if not isinstance(data, list) or len(data) != count or not all(type(value) in kinds for value in data):
        raise Error(f"{name}: data is not a list of {count} numbers of type {spec['type']}")
    wide: Array | None
    try:
        wide = numpy.array(data, float if dtype.kind == "f" else numpy.int64)
    except OverflowError:
        wide = None
    with numpy.errstate(over="ignore"):
        narrow = None if wide is None else wide.astype(dtype)
    if narrow is None or dtype.kind != "f" and (narrow != wide).any() or not numpy.isfinite(narrow).all():
        raise Error(f"{name}: a number is beyond the type {spec['type']}")
    return narrow.reshape(shape)


def documents_in(stream: IO[bytes]) -> Iterator[Document]:
    """The documents of an open binary file or pipe, one after the other as they arrive; Error without a place for what is none."""
    for line in iter(stream.readline, b""):
        if not line.strip():
            continue
        document, size = header_of(line)
        payload = bytearray()
        while len(payload) < size and (piece := stream.read(min(size - len(payload), PIECE))):
            payload += piece
        if len(payload) < size:
            raise Error(f"{size} bytes belong behind the header, {len(payload)} are there")
        for group, arrays in groups(document).items():
            for name, spec in arrays.items():
                document.text = document.text or isinstance(spec, dict) and "data" in spec
                arrays[name] = array_of(f"{group}.{name}", spec, payload)
        yield document


def documents(source: Source) -> Iterator[Document]:
    """The documents of a stream, one after the other: states are State, results Document.

    source: name of a file, "-" for standard input, an open binary file, or bytes
    Raises Error with file and number of the document for what is no document, OSError for a file that cannot be read.
    """
    with contextlib.ExitStack() as stack:
        if isinstance(source, bytes):
            name, stream = "bytes", stack.enter_context(io.BytesIO(source))
        elif isinstance(source, (str, os.PathLike)):
            name = os.fspath(source)
            stream = sys.stdin.buffer if name == "-" else stack.enter_context(open(name, "rb"))  # type: ignore[assignment]
        else:
            name, stream = str(getattr(source, "name", "stream")), source  # type: ignore[assignment]
        number, inside = 0, documents_in(stream)
        while True:
            number += 1
            try:
                document = next(inside, None)
            except Error as error:
                raise Error(f"{name}, document {number}: {error}") from None
            if document is None:
                return
            yield document


def read(source: Source) -> list[Document]:
    """All documents of a stream, see documents(): states, results, and the lines of `sinter --history` too."""
    return list(documents(source))


# ---- writing -------------------------------------------------------------------------------------------------------------------
def number_text(value: float) -> str:
    """A number as the programs write it: the digits of repr(), as a power of ten from 1e15 on."""
    text = float.__repr__(value)
    if 1e15 <= abs(value) < 1e16:
        sign, digits = ("-" if value < 0 else ""), text.lstrip("-").replace(".", "").rstrip("0")
        text = f"{sign}{digits[0]}{'.' if digits[1:] else ''}{digits[1:]}e+15"
    return text


def json_text(value: Any, spelling: Mapping[float, str]) -> str:
    """A value as JSON without blanks, numbers as they were spelled where they were read. Error for one that is not finite."""
    if isinstance(value, Mapping):
        return "{" + ",".join(f"{json_text(str(key), {})}:{json_text(each, spelling)}" for key, each in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ",".join([json_text(each, spelling) for each in value]) + "]"
    if isinstance(value, (numpy.generic, numpy.ndarray)):
        return json_text(value.tolist(), spelling)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise Error(f"{value} is not a finite number, and text cannot hold it")
        return spelling.get(value) or number_text(value)
    try:
        return json.dumps(value, ensure_ascii=False)
    except TypeError:
        raise Error(f"a value of the type {type(value).__name__} is none of JSON") from None


def type_of(name: str, array: Array) -> str:
    kind = f"{array.dtype.kind}{array.dtype.itemsize}"
    if kind not in TYPES:
        raise Error(f"{name}: is of the type {array.dtype}; a stream holds {', '.join(TYPES)}")
    if not array.ndim:
        raise Error(f"{name}: is one number, and an array has a row for each particle, bond or neck")
    return kind


def bytes_of(document: Mapping[str, Any], text: bool | None = None) -> bytes:
    """A document as it stands in a stream, see write()."""
    if text is None:
        text = getattr(document, "text", False)
    header, payload, binary = dict(document), bytearray(), False
    for group, arrays in groups(document).items():
        for name, values in arrays.items():
            array = numpy.ascontiguousarray(values) if numpy.ndim(values) else numpy.asarray(values)
            spec: dict[str, Any] = {"type": type_of(f"{group}.{name}", array), "shape": array.shape}
            if text:
                spec["data"] = array.ravel().tolist()
            else:
                binary, spec["at"] = True, len(payload)
                payload += array.astype(array.dtype.newbyteorder("<")).tobytes()
                payload += bytes(-len(payload) % ALIGNMENT)
            header[group] = {**header[group], name: spec}
    if binary:
        header["bytes"] = len(payload)
    line = json_text(header, getattr(document, "spelling", {})).encode("utf-8")
    if binary:
        line += b" " * (-(len(line) + 1) % ALIGNMENT)
    return line + b"\n" + payload


@contextlib.contextmanager
def written(path: str, mode: str = "w") -> Iterator[Any]:
    """An open file that appears under its name only when it is whole; "-" is standard output. Devices and named pipes are written
    as they are."""
    if path == "-":
        yield sys.stdout if mode == "w" else sys.stdout.buffer
        return
    final = os.path.realpath(path)
    whole = os.path.isfile(final) or not os.path.exists(final)
    told: dict[str, Any] = {} if "b" in mode else {"encoding": "utf-8", "newline": "\n"}
    if not whole:
        with open(final, mode, **told) as stream:
            yield stream
        return
    partial = f"{final}.partial-{os.getpid()}"
    try:
        with open(partial, mode, **told) as stream:
            yield stream
        os.replace(partial, final)
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(partial)


def write(target: Target, given: Mapping[str, Any] | Iterable[Mapping[str, Any]], text: bool | None = None) -> None:
    """Writes a document or several. What a program wrote and read() read becomes the same bytes again.

    target: name of a file, which appears when it is whole, "-" for standard output, or an open binary file
    text: True for lines of JSON, False for arrays behind the header; by default each document as it was read, a new one binary
    Raises Error for what a stream cannot hold, OSError for a file that cannot be written.
    """
    if isinstance(target, (str, os.PathLike)):
        with written(os.fspath(target), "wb") as stream:
            write(stream, given, text)
        return
    for document in [given] if isinstance(given, Mapping) else given:
        target.write(bytes_of(document, text))
