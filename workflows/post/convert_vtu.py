"""convert_vtu.py: states as VTK unstructured grids (VTU): spheres are vertices with a radius, bonds are lines; PVD for a series."""
import os
from xml.sax.saxutils import quoteattr

import meshio
import numpy
from meshio.vtu import _vtu  # noqa: F401  (Debian's meshio registers a format when its module is imported)

from convert_common import ConvertError, LARGE, SMALL, beside, bond_arrays, bounds, particle_arrays, written


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
        return pair[shown], shown, numpy.empty(0, numpy.int64), numpy.empty((0, 3))
    keys = numpy.column_stack([pair[through, 1], image[through]])
    ghosts, which = numpy.unique(keys, axis=0, return_inverse=True)
    ends = pair.copy()
    ends[through, 1] = len(document["particles"]["radius"]) + which.ravel()
    return ends, numpy.arange(len(pair)), ghosts[:, 0], ghosts[:, 1:] * (high - low)


def mesh_of(document, mode):
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


def write_grid(path, document, mode):
    partial = beside(path, f".partial-{os.getpid()}")
    try:
        _vtu.write(partial, mesh_of(document, mode))
        os.replace(partial, path)
    finally:
        if os.path.exists(partial):
            os.unlink(partial)


def write(path, documents, given):
    """A .vtu for one state; a .pvd with a .vtu for each state beside it."""
    documents = list(documents)
    if path.endswith(".vtu"):
        if len(documents) != 1:
            raise ConvertError(
                f"{path}: there are {len(documents)} states, a VTU holds one; write a .pvd, or choose with analyze select")
        write_grid(path, documents[0], given.bonds)
        return
    stem = os.path.splitext(path)[0]
    names = [f"{stem}-{number:04d}.vtu" for number in range(1, len(documents) + 1)]
    for name, document in zip(names, documents):
        write_grid(name, document, given.bonds)
    with written(path) as stream:
        stream.write('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n<Collection>\n')
        for name, document in zip(names, documents):
            stream.write(f'<DataSet timestep="{document.get("time", 0.0)!r}" part="0" file={quoteattr(os.path.basename(name))}/>\n')
        stream.write("</Collection>\n</VTKFile>\n")
