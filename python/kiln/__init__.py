"""Kiln's streams and programs in Python: states as numpy arrays, results as dictionaries.

    import kiln
    results = kiln.run("sinter green -n 3000 --aspect 4:1:1 | sinter --temperature 1200C --to-density 0.8",
                       "bondify", "bend", "analyze modulus", progress=True)
    print(results[0]["young_modulus"])            # Pa
    for state in kiln.documents("bonded.kiln"):   # one after the other; kiln.read gives a list
        print(state.time, state.relative_density, state.bonds["radius"].mean())

All quantities are in SI units. docs/python.md shows more; docs/dem-state.5 says what stands in a document."""
from .state import Document, State, cylinder_volume, groups, relative_density
from .errors import Error, NotConverged, ProgramWarning
from .programs import Progress, command, find, run
from .stream import documents, read, write
from .tables import columns, frame, records

__version__ = "0.1.0"
__all__ = [
    "Document", "Error", "NotConverged", "Progress", "ProgramWarning", "State", "columns", "command", "cylinder_volume",
    "documents", "find", "frame", "groups", "read", "records", "relative_density", "run", "write"
]
