"""convert_vtu.py: states as VTK unstructured grids (VTU): spheres are vertices with a radius, bonds are lines; PVD for a series.

Box, periodic axes and time stand as arrays of the whole grid. Bonds through periodic faces end in ghosts, copies of particles
beyond the face, which reading turns into images again."""
import os
import xml.etree.ElementTree
from xml.sax.saxutils import quoteattr

import numpy

import units
from convert_common import (ConvertError, LARGE, SMALL, beside, bond_arrays, bounds, box_of, clipped, number, opened,
                            particle_arrays, periodic_axes, warn, written)
from convert_check import warn_of_loss
from convert_found import Found, style_of_units
from vtu_file import Grid

VERTEX, LINE = 1, 3  # types of cells
RADII = {"radius": 1.0, "radii": 1.0, "rad": 1.0, "diameter": 0.5}


# ---- written -------------------------------------------------------------------------------------------------------------------
def plain(values):
    """An array that VTK knows: at most two dimensions, no small integers."""
    values = numpy.asarray(values)
    values = values.reshape(len(values), -1) if values.ndim > 2 else values
    return values.astype(numpy.int64) if values.dtype.kind in "iu" and values.dtype.itemsize < 4 else values


def lines_and_ghosts(document, mode):
    """Ends of the drawn bonds, which bonds they are, and the particles whose images are added as ghosts with their shifts.
    cut: bonds through periodic faces are left out; ghosts: they end in a copy of their particle beyond the face."""
    bonds = bond_arrays(document)
    low, high = bounds(document["box"])
    pair, image = bonds["pair"].astype(numpy.int64), bonds["image"].astype(numpy.int64)
    through = image.any(axis=1)
    if mode == "cut":
        shown = numpy.flatnonzero(~through)
        if through.any():
            warn(f"{int(through.sum())} bonds through periodic faces are left out")
        return pair[shown], shown, numpy.empty(0, numpy.int64), numpy.empty((0, 3))
    keys = numpy.column_stack([pair[through, 1], image[through]])
    ghosts, which = numpy.unique(keys, axis=0, return_inverse=True)
    ends = pair.copy()
    ends[through, 1] = len(document["particles"]["radius"]) + which.ravel()
    return ends, numpy.arange(len(pair)), ghosts[:, 0], ghosts[:, 1:] * (high - low)


def mesh_of(document, mode):
    import meshio  # late: it takes longer to load than most conversions take
    particles, bonds = particle_arrays(document), bond_arrays(document)
    points, source = particles["position"], numpy.arange(len(particles["radius"]))
    cells, cell_data = [("vertex", source.reshape(-1, 1))], {}
    if bonds is not None:
        ends, shown, ghosts, shifts = lines_and_ghosts(document, mode)
        points = numpy.concatenate([points, points[ghosts] + shifts])
        source = numpy.concatenate([source, ghosts])
        cells.append(("line", ends))
        for name, values in bonds.items():
            if name in ("pair", "image"):
                continue
            values = plain(values)[shown]
            blank = numpy.full((len(particles["radius"]), *values.shape[1:]), numpy.nan if values.dtype.kind == "f" else 0,
                               values.dtype)
            cell_data[f"bond_{name}" if name in SMALL else name] = [blank, values]
    point_data = {name: plain(values)[source] for name, values in particles.items() if name != "position"}
    point_data["ghost"] = (numpy.arange(len(source)) >= len(particles["radius"])).astype(numpy.int32)
    return meshio.Mesh(points, cells, point_data=point_data, cell_data=cell_data)


def fields_of(document):
    """Arrays of the whole grid as XML."""
    low, high = bounds(document["box"])
    values = {"TimeValue": [document.get("time", 0.0)], "box_origin": low, "box_lengths": numpy.diag(document["box"]["vectors"]),
              "periodic": [float(axis) for axis in periodic_axes(document["box"])],
              "bonds": [1.0 if "bonds" in document else 0.0]}
    arrays = "".join(f'<DataArray type="Float64" Name="{name}" NumberOfTuples="{len(each)}" format="ascii">'
                     f'{" ".join(repr(float(value)) for value in each)}</DataArray>\n' for name, each in values.items())
    return f"<FieldData>\n{arrays}</FieldData>\n"


def write_grid(path, document, mode):
    from meshio.vtu import _vtu  # Debian's meshio registers a format when its module is imported
    warn_of_loss("VTU", document, {"time", "bonds", "particles.other", "bonds.other"})
    if set(document["particles"]) & {"ghost"}:
        raise ConvertError(f"{path}: an array of particles has the name ghost, which means something else here; rename it")
    partial = beside(path, f".partial-{os.getpid()}")
    try:
        if len(document["particles"]["radius"]):
            _vtu.write(partial, mesh_of(document, mode))
            with open(partial, "rb") as stream:
                grid = stream.read()
        else:
            grid = EMPTY
        with open(partial, "wb") as stream:
            stream.write(grid.replace(b"<UnstructuredGrid>", b"<UnstructuredGrid>\n" + fields_of(document).encode(), 1))
        os.replace(partial, path)
    finally:
        if os.path.exists(partial):
            os.unlink(partial)


EMPTY = b"""<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="0" NumberOfCells="0">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii"/></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii"/><DataArray type="Int64" Name="offsets" format="ascii"/>
<DataArray type="UInt8" Name="types" format="ascii"/></Cells>
<PointData><DataArray type="Float64" Name="radius" format="ascii"/></PointData></Piece></UnstructuredGrid></VTKFile>
"""


def write(path, documents, given):
    """A .vtu for one state; a .pvd with a .vtu for each state beside it."""
    documents, mode = list(documents), given.bonds or "ghosts"
    if path == "-":
        raise ConvertError("VTU is written into files, not to standard output")
    if path.endswith(".vtu"):
        if len(documents) != 1:
            raise ConvertError(
                f"{path}: there are {len(documents)} states, a VTU holds one; write a .pvd, or choose with analyze select")
        write_grid(path, documents[0], mode)
        return
    stem = os.path.splitext(path)[0]
    names = [f"{stem}-{number:04d}.vtu" for number in range(1, len(documents) + 1)]
    for name, document in zip(names, documents):
        write_grid(name, document, mode)
    with written(path) as stream:
        stream.write('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n<Collection>\n')
        for name, document in zip(names, documents):
            stream.write(f'<DataSet timestep="{document.get("time", 0.0)!r}" part="0" file={quoteattr(os.path.basename(name))}/>\n')
        stream.write("</Collection>\n</VTKFile>\n")


# ---- read ----------------------------------------------------------------------------------------------------------------------
def cells_of(grid):
    """Rows of the points that are particles, and the two ends of each line, with the cells that they are."""
    cells = grid.arrays["Cells"]
    for name in ("connectivity", "offsets", "types"):
        if cells.get(name) is None or cells[name].ndim != 1 or cells[name].dtype.kind not in "iu":
            raise ConvertError(f"{grid.path}: its cells have no {name}")
    ends, kinds = cells["offsets"].astype(numpy.int64), cells["types"]
    if len(ends) != grid.cells or len(kinds) != grid.cells:
        raise ConvertError(f"{grid.path}: {grid.cells} cells are announced, {len(ends)} are there")
    points = cells["connectivity"].astype(numpy.int64)
    widths = numpy.diff(ends, prepend=0)
    expected = numpy.select([kinds == VERTEX, kinds == LINE], [1, 2], 0)
    if (expected == 0).any():
        raise ConvertError(f"{grid.path}: has cells of type {kinds[expected == 0][0]}; known here are vertices and lines")
    if (widths != expected).any() or len(points) != expected.sum() or (len(points) and
                                                                       not 0 <= points.min() <= points.max() < grid.points):
        raise ConvertError(f"{grid.path}: its cells do not fit its points")
    lines = numpy.flatnonzero(kinds == LINE)
    return points[ends[kinds == VERTEX] - 1], numpy.column_stack([points[ends[lines] - 2], points[ends[lines] - 1]]), lines


def scaled(grid, section, name, system):
    """The numbers of an array in SI units."""
    values = grid.arrays[section][name]
    if values.dtype.kind != "f":
        return values.astype(numpy.int64)
    values = values.astype(float)
    column = "radius" if section == "PointData" and name.lower() in RADII else name.removeprefix("bond_")
    power = units.power(system, column)
    if power is None and system != "si":
        warn(f"{grid.path}: the unit of the array {clipped(name)} is not known; its numbers are left as they are")
    return values * 10.0**power if power and power > 0 else values / 10.0**-power if power else values


def radius_name(grid):
    names = [name for name in grid.arrays["PointData"] if name.lower() in RADII]
    if len(names) > 1:
        raise ConvertError(f"{grid.path}: the arrays {', '.join(names)} may all be radii; leave all but one out")
    return names[0] if names else None


def box_from(fields, grid, by):
    """The box of the arrays that dem-convert writes; None for a grid without them."""
    told = [name for name in ("box_origin", "box_lengths", "periodic") if name in fields]
    if not told:
        return None
    if len(told) != 3 or any(fields[name].shape != (3, ) for name in told) or any(flag not in (0, 1)
                                                                                  for flag in fields["periodic"]):
        raise ConvertError(f"{grid.path}: box_origin, box_lengths and periodic are not three numbers each")
    low, lengths = ([float(value) * by for value in fields[name]] for name in told[:2])
    return {**box_of(low, low, fields["periodic"]), "vectors": numpy.diag(lengths).tolist()}


def bonds_of(grid, path, ends, cells, row, shift, ids, system, box):
    """Bonds from lines; row and shift say which particle a point is, and by how many boxes it is moved."""
    if (row[ends] < 0).any():
        raise ConvertError(f"{path}: a line ends in a point that is no particle")
    bonds = {"file": path, "ids": ids[row[ends]].reshape(-1, 2), "radius": numpy.full(len(ends), numpy.nan)}
    if box is not None:
        bonds["image"], bonds["told"] = shift[ends[:, 1]] - shift[ends[:, 0]], numpy.ones(len(ends), bool)
    for name in grid.arrays["CellData"]:
        values = scaled(grid, "CellData", name, system)[cells]
        plain_name = name.removeprefix("bond_") if name.removeprefix("bond_") in SMALL else name
        if plain_name in ("pair", "image", "ids", "told", "file"):
            raise ConvertError(f"{path}: an array of bonds has the name {plain_name}, which means something else here")
        if plain_name in LARGE and values.ndim != 1:
            raise ConvertError(f"{path}: the array {plain_name} of the bonds has several components")
        bonds[plain_name] = values.astype(float) if plain_name in LARGE else values
    return bonds


def whole_arrays(grid, names):
    """Arrays of whole numbers, one for each point."""
    for name in names:
        values = grid.arrays["PointData"].get(name)
        if values is not None and (values.ndim != 1 or values.dtype.kind not in "iu"):
            raise ConvertError(f"{grid.path}: the array {name} is not one whole number for each point")
        yield values


def read_grid(path, given):
    grid = Grid(path)
    fields, data = grid.arrays["FieldData"], grid.arrays["PointData"]
    ours = "box_lengths" in fields
    system = style_of_units("si" if ours else None, given, path, path)
    position = grid.arrays["Points"]
    if len(position) != 1 or next(iter(position.values())).shape != (grid.points, 3):
        raise ConvertError(f"{path}: has no points with three coordinates")
    length = units.SYSTEMS[system][1]
    position = next(iter(position.values())).astype(float)
    position = position / 10.0**-length if length else position
    for name, values in {"the points": position, **data}.items():
        if values.dtype.kind == "f" and not numpy.isfinite(values).all():
            raise ConvertError(f"{path}: {clipped(name)} holds what is not a finite number")
    vertices, ends, cells = cells_of(grid)
    ghost, ids, kinds = whole_arrays(grid, ("ghost", "id", "material"))
    ghost = numpy.zeros(grid.points, bool) if ghost is None else ghost != 0
    real = numpy.flatnonzero(~ghost)
    if len(vertices) and not numpy.array_equal(numpy.sort(vertices), real):
        raise ConvertError(f"{path}: its vertices are not its points, each once")
    if not len(vertices) and ghost.any():
        raise ConvertError(f"{path}: has ghosts and no vertices")
    ids = numpy.arange(grid.points, dtype=numpy.int64) if ids is None else ids.astype(numpy.int64)
    if len(numpy.unique(ids[real])) < len(real):
        raise ConvertError(f"{path}: an id stands twice")
    box = box_from(fields, grid, 1.0)
    row, shift = images_of(path, position, real, ghost, ids, box)
    name = radius_name(grid)
    radius = scaled(grid, "PointData", name, system).astype(float) * RADII[name.lower()] if name else numpy.full(grid.points,
                                                                                                                 numpy.nan)
    if radius.ndim != 1:
        raise ConvertError(f"{path}: the radius of a point has several components")
    particles = {"id": ids[real], "position": position[real], "radius": radius[real]}
    particles.update({each: scaled(grid, "PointData", each, system)[real] for each in data
                      if each not in ("id", "ghost", "material", name)})
    time = fields.get("TimeValue", numpy.zeros(1)).astype(float)
    found = Found(path, path, particles, box=box, time=float(time[0]) if len(time) == 1 and time.ndim == 1 else numpy.nan,
                  labels=kinds[real].tolist() if kinds is not None else None, first=0)
    if len(ends) or "bonds" in fields and fields["bonds"].any():
        found.bonds = bonds_of(grid, path, ends, cells, row, shift, ids, system, box)
    return found


def images_of(path, position, real, ghost, ids, box):
    """The row of the particle that each point is or is an image of, and by how many boxes it is moved."""
    row, shift = numpy.full(len(position), -1), numpy.zeros((len(position), 3), numpy.int64)
    row[real] = numpy.arange(len(real))
    by_id = {int(ids[each]): each for each in real}
    if ghost.any() and box is None:
        raise ConvertError(f"{path}: has ghosts and no box")
    for each in numpy.flatnonzero(ghost):
        source = by_id.get(int(ids[each]))
        if source is None:
            raise ConvertError(f"{path}: a ghost has id {ids[each]}, which no particle has")
        lengths = numpy.diag(box["vectors"])
        if not (lengths > 0).all():
            raise ConvertError(f"{path}: the box has no length")
        moved = (position[each] - position[source]) / lengths
        if not (abs(moved - numpy.round(moved)) < 1e-6).all() or not (abs(moved) < 1e6).all():
            raise ConvertError(f"{path}: the ghost of particle {ids[each]} is not moved by whole boxes")
        row[each], shift[each] = row[source], numpy.round(moved).astype(numpy.int64)
    return row, shift


def read(path, given):
    """The state of a .vtu, or those of a .pvd."""
    if path == "-":
        raise ConvertError("VTU is read from files, not from standard input")
    if not path.removesuffix(".gz").endswith(".pvd"):
        yield read_grid(path, given)
        return
    with opened(path) as stream:
        text = stream.read()
    try:
        sets = xml.etree.ElementTree.fromstring(text).findall("./Collection/DataSet")
    except (xml.etree.ElementTree.ParseError, ValueError, LookupError):
        raise ConvertError(f"{path}: is no XML") from None
    if not sets:
        raise ConvertError(f"{path}: names no data sets")
    for each in sets:
        found = read_grid(os.path.join(os.path.dirname(path), each.get("file", "")), given)
        found.time = number(each.get("timestep", ""), path)
        yield found
