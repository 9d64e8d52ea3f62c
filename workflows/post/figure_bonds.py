"""figure_bonds.py: distribution of bond radii at each density (Fig. 4 of Dosta et al. 2017)."""
import numpy

import style
import kiln
from style import NM, pyplot

BIN = 1.0  # nm


def draw(cases):
    """cases: (relative density, bond radii in m) of each state."""
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.4))
    top = max(radii.max() for _, radii in cases) / NM
    edges = numpy.arange(0, top + 2 * BIN, BIN)
    for (density, radii), colour in zip(cases, style.SERIES):
        counts, _ = numpy.histogram(radii / NM, edges)
        axes.stairs(100 * counts / radii.size / BIN, edges, color=colour, linewidth=1.5,
                    label=f"{density:.2f}: {radii.size:,} bonds, mean {radii.mean() / NM:.1f} nm")
    axes.legend(title="Relative density", loc="upper left", alignment="left", fontsize="small")
    axes.set_xlim(0, edges[-1])
    axes.set_ylim(0, None)
    axes.set_xlabel("Bond radius, nm")
    axes.set_ylabel("Share of bonds, % per nm")
    return figure


def main():
    given = style.arguments(__doc__, ("states", "files with bonded states"))
    states = [state for path in given.states
              for state in style.documents(path, "dem-state", "which bondify writes", "bonds.radius")]
    style.save(draw([(kiln.relative_density(state), state["bonds"]["radius"]) for state in states]), given.output)


if __name__ == "__main__":
    main()
