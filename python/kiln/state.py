"""state.py: documents of a stream as dictionaries; states among them with their arrays by name."""
from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy
import numpy.typing

from .errors import Error

GROUPS = ("particles", "bonds", "necks")

Floats = numpy.typing.NDArray[numpy.float64]
Arrays = dict[str, numpy.typing.NDArray[Any]]


class Document(dict[str, Any]):
    """A document of a stream: a dictionary of what its line of JSON says.

    text: it was read as a line of text, and is written as one
    spelling: numbers that were not spelled as Python spells them, so that they are written as they were
    """

    text: bool

    def __init__(self, *given: Any, **keys: Any) -> None:
        super().__init__(*given, **keys)
        self.text, self.spelling = False, {}  # type: bool, dict[float, str]

    def copy(self) -> Document:
        """A document of its own with the same values."""
        other = type(self)(self)
        other.text, other.spelling = self.text, self.spelling
        return other


class State(Document):
    """A packing of particles, perhaps with bonds. Arrays stand under the keys particles, bonds and necks, other numbers under
    their own: time (s), temperature (K), box, materials, history. All are in SI units. Arrays may be changed in
    place."""

    @classmethod
    def of(cls,
           position: numpy.typing.ArrayLike,
           radius: numpy.typing.ArrayLike,
           lengths: Sequence[float],
           origin: Sequence[float] = (0.0, 0.0, 0.0),
           periodic: Sequence[bool] = (True, True, True),
           material: Mapping[str, Any] | None = None,
           **arrays: numpy.typing.ArrayLike) -> State:
        """A state of one's own.

        position: centres, N x 3, m
        radius: N, m, or one for all
        lengths: of the box along x, y and z, m; origin: its lower corner, m; periodic: which of its faces are
        material: its constants (docs/dem-state.5); without them programs that need them ask
        arrays: others of the particles, a row each, such as velocity, m/s
        Raises Error where rows do not fit together.
        """
        place = numpy.array(position, float)
        if place.ndim != 2 or place.shape[1] != 3:
            raise Error(f"position has the shape {place.shape}, expected N x 3")
        rows = {"position": place, "radius": numpy.array(numpy.broadcast_to(numpy.asarray(radius, float), len(place)))}
        for name, values in arrays.items():
            rows[name] = numpy.asarray(values)
            if rows[name].shape[:1] != (len(place), ):
                raise Error(f"{name} has the shape {rows[name].shape}, expected a row for each of {len(place)} particles")
        box = {"origin": [float(x) for x in origin], "vectors": numpy.diag([float(x) for x in lengths]).tolist(),
               "periodic": [bool(p) for p in periodic]}
        return cls({"format": "dem-state", "version": 1, "units": "SI", "time": 0.0, "box": box,
                    **({"materials": [dict(material)]} if material else {}), "particles": rows, "history": []})

    @property
    def particles(self) -> Arrays:
        """Arrays of the particles, N rows each: position (N x 3, m), radius (m), id, material (number in materials), and what a
        program adds: displacement (m) and so on."""
        return self["particles"]  # type: ignore[no-any-return]

    @property
    def bonds(self) -> Arrays:
        """Arrays of the bonds, M rows each, none without bondify: pair (M x 2 rows of particles), image (M x 3, boxes from the
        first particle to the second), radius (m), length (m), volume (m3), and in deformed states force (N)."""
        return self.get("bonds", {})

    @property
    def necks(self) -> Arrays:
        """Arrays of contacts whose neck is known: pair, image, radius (m)."""
        return self.get("necks", {})

    @property
    def position(self) -> Floats:
        """Centres of the particles, N x 3, m; along periodic axes they may lie outside the box."""
        return self.particles["position"]

    @property
    def radius(self) -> Floats:
        """Radii of the particles, N, m."""
        return self.particles["radius"]

    @property
    def time(self) -> float:
        """Time, s."""
        return float(self.get("time", 0.0))

    @property
    def temperature(self) -> float | None:
        """Temperature, K, if it is known."""
        return self.get("temperature")

    @property
    def origin(self) -> Floats:
        """Lower corner of the box, m."""
        return numpy.array(self["box"].get("origin", (0.0, 0.0, 0.0)), float)

    @property
    def lengths(self) -> Floats:
        """Lengths of the box along x, y and z, m."""
        return numpy.diag(numpy.array(self["box"]["vectors"], float)).copy()

    @property
    def periodic(self) -> tuple[bool, bool, bool]:
        """Whether the faces of the box along x, y and z are periodic."""
        x, y, z = self["box"].get("periodic", (True, True, True))
        return bool(x), bool(y), bool(z)

    @property
    def relative_density(self) -> float:
        """Volume of particles and bonds over the volume of the box."""
        return relative_density(self)


def document_of(header: Mapping[str, Any]) -> Document:
    """A State where format says so or is missing beside a box, as other programs write; else a Document."""
    kind = State if header.get("format", "dem-state" if "box" in header else None) == "dem-state" else Document
    return kind(header)


def groups(document: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """The places of a document where arrays live; a result may use the same keys for a number."""
    return {key: document[key] for key in GROUPS if isinstance(document.get(key), dict)}


def cylinder_volume(radius: Floats, length: Floats) -> Floats:
    """Volume of bonds that do not say it, m3: of their cylinders."""
    return math.pi * radius**2 * length.clip(min=0)  # type: ignore[no-any-return]


def relative_density(state: Mapping[str, Any]) -> float:
    """Volume of particles and bonds over the volume of the box."""
    solid = 4 / 3 * math.pi * (state["particles"]["radius"]**3).sum()
    if "bonds" in state:
        bonds = state["bonds"]
        solid += (bonds["volume"] if "volume" in bonds else cylinder_volume(bonds["radius"], bonds["length"])).sum()
    return float(solid / abs(numpy.linalg.det(state["box"]["vectors"])))
