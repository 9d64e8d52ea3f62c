"""vtu_file.py: reads VTK unstructured grids (VTU): arrays of points and cells and their connections; text, base64 or appended,
compressed by zlib or not. Anything that is not as the format says is refused."""
import base64
import binascii
import re
import xml.etree.ElementTree
import zlib

import numpy

from convert_common import NUMBER, ConvertError, clipped, opened

TYPES = {"Float32": "f4", "Float64": "f8", "Int8": "i1", "Int16": "i2", "Int32": "i4", "Int64": "i8", "UInt8": "u1", "UInt16": "u2",
         "UInt32": "u4", "UInt64": "u8"}
SECTIONS = ("Points", "PointData", "Cells", "CellData")


class Grid:
    """Arrays of a VTU by section and name; counts of points and cells; arrays of the whole grid under "FieldData"."""

    def __init__(self, path):
        self.path = path
        with opened(path) as stream:
            text = stream.read()
        text, self.appended = self.without_appended(text)
        try:
            root = xml.etree.ElementTree.fromstring(text)
        except (xml.etree.ElementTree.ParseError, ValueError, LookupError) as error:
            raise ConvertError(f"{path}: is no XML, {clipped(error)}") from None
        if root.tag != "VTKFile" or root.get("type") != "UnstructuredGrid":
            raise ConvertError(f"{path}: is no VTK unstructured grid but {clipped(root.get('type', root.tag))}")
        self.order = {"LittleEndian": "<", "BigEndian": ">"}.get(root.get("byte_order", "LittleEndian"))
        self.length = {"UInt32": "u4", "UInt64": "u8"}.get(root.get("header_type", "UInt32"))
        self.packed = root.get("compressor")
        if self.order is None or self.length is None or self.packed not in (None, "vtkZLibDataCompressor"):
            raise ConvertError(f"{path}: has a byte order, header type or compressor that is not known here")
        pieces = root.findall("./UnstructuredGrid/Piece")
        if len(pieces) != 1:
            raise ConvertError(f"{path}: has {len(pieces)} pieces, expected one")
        self.points, self.cells = (self.count(pieces[0], key) for key in ("NumberOfPoints", "NumberOfCells"))
        rows = {"Points": self.points, "PointData": self.points, "CellData": self.cells, "Cells": None}
        self.arrays = {name: self.section(pieces[0].findall(name), name, rows[name]) for name in SECTIONS}
        self.arrays["FieldData"] = self.section(root.findall("./UnstructuredGrid/FieldData"), "FieldData", None)

    def without_appended(self, text):
        """The XML without its appended data, which need not be XML, and these bytes."""
        found = re.search(rb"<AppendedData[^>]*>\s*_", text)
        if not found:
            return text, None
        end = text.rfind(b"</AppendedData>")
        if end < found.end():
            raise ConvertError(f"{self.path}: its appended data have no end")
        data = text[found.end():end]
        if re.search(rb"""encoding=['"]base64['"]""", found[0]):
            data = (data.strip(), )  # base64 of each array for itself
        return text[:found.start()] + text[end + len(b"</AppendedData>"):], data

    def count(self, piece, key):
        value = piece.get(key, "")
        if not re.fullmatch(r"[0-9]{1,10}", value):
            raise ConvertError(f"{self.path}: {key} is '{clipped(value)}', not a number of things")
        return int(value)

    def section(self, found, name, rows):
        if len(found) > 1:
            raise ConvertError(f"{self.path}: {name} stands twice")
        arrays = {}
        for element in found[0] if found else ():
            title = element.get("Name", name)
            if element.tag != "DataArray" or element.get("type") == "String":
                continue
            if title in arrays:
                raise ConvertError(f"{self.path}: the array '{clipped(title)}' stands twice")
            values = self.values(element, title)
            width = element.get("NumberOfComponents") or "1"
            if not re.fullmatch(r"[1-9][0-9]{0,3}", width) or len(values) % int(width):
                raise ConvertError(f"{self.path}: the array '{clipped(title)}' has {len(values)} values and {clipped(width)} "
                                   "components")
            values = values.reshape(-1, int(width))
            if rows is not None and len(values) != rows:
                raise ConvertError(f"{self.path}: the array '{clipped(title)}' has {len(values)} rows, expected {rows}")
            arrays[title] = values[:, 0] if int(width) == 1 else values
        return arrays

    def values(self, element, title):
        kind = TYPES.get(element.get("type"))
        if kind is None:
            raise ConvertError(f"{self.path}: the array '{clipped(title)}' has type {clipped(element.get('type'))}")
        form = element.get("format", "ascii")
        if form == "ascii":
            words = (element.text or "").split()
            pattern = NUMBER if kind[0] == "f" else re.compile(r"[-+]?[0-9]{1,19}")
            wrong = next((word for word in words if not pattern.fullmatch(word) and word.lower() not in ("nan", "-nan")), None)
            if wrong is not None:
                raise ConvertError(f"{self.path}: '{clipped(wrong)}' in the array '{clipped(title)}' is not a number")
            try:
                return numpy.array([float(word) if kind[0] == "f" else int(word) for word in words], kind)
            except (OverflowError, ValueError):
                raise ConvertError(f"{self.path}: a number of the array '{clipped(title)}' is beyond its type") from None
        try:
            raw = self.bytes_of(element, form)
        except (zlib.error, binascii.Error, ValueError, IndexError, MemoryError, OverflowError):
            raise ConvertError(f"{self.path}: the array '{clipped(title)}' is damaged") from None
        if len(raw) % int(kind[1]):
            raise ConvertError(f"{self.path}: the array '{clipped(title)}' is damaged")
        return numpy.frombuffer(raw, self.order + kind).astype(kind)

    def bytes_of(self, element, form):
        """The bytes of an array: blocks with their lengths in front; ValueError for what is not so."""
        if form == "binary":
            text, raw = "".join((element.text or "").split()), None
        elif form == "appended" and self.appended is not None:
            offset = int(element.get("offset", "-1"))
            if offset < 0:
                raise ValueError
            text = self.appended[0][offset:].decode("ascii") if isinstance(self.appended, tuple) else None
            raw = None if text is not None else self.appended[offset:]
        else:
            raise ValueError
        size = int(self.length[1])

        def lengths(first, count):
            """`count` lengths from the first byte on, and the rest behind them."""
            data = self.decoded(text, first, count * size) if raw is None else raw[first:first + count * size]
            return numpy.frombuffer(data[:count * size], self.order + self.length, count).tolist()

        if not self.packed:
            (total, ) = lengths(0, 1)
            data = self.decoded(text, 0, size + total)[size:] if raw is None else raw[size:size + total]
            if len(data) != total:
                raise ValueError
            return data
        (blocks, ) = lengths(0, 1)
        head = lengths(0, 3 + blocks)
        sizes, first = head[3:], (3 + blocks) * size
        if raw is None:  # the lengths are encoded for themselves
            text = text[-(-first // 3) * 4:]
        data = self.decoded(text, 0, sum(sizes)) if raw is None else raw[first:first + sum(sizes)]
        parts, at = [], 0
        for k, length in enumerate(sizes):
            parts.append(zlib.decompress(data[at:at + length]))
            if len(parts[-1]) != (head[2] if k == blocks - 1 and head[2] else head[1]):
                raise ValueError
            at += length
        return b"".join(parts)

    @staticmethod
    def decoded(text, first, count):
        """So many bytes of a text in base64."""
        data = base64.b64decode(text[:-(-(first + count) // 3) * 4], validate=True)
        if len(data) < first + count:
            raise ValueError
        return data[first:first + count]
