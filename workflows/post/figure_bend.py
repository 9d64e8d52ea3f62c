"""figure_bend.py: side view of the bent bar, its bonds coloured by the normal force in them (Fig. 5 of Dosta et al. 2017)."""
import numpy
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle

import style
from dem_view import bent_positions
from style import NM, pyplot

SHOWN_SLICE = 6  # mean particle diameters of the width that are drawn, in the middle
NANONEWTON = 1e-9  # N


def cylinder_height(position, reach, x, radius, side):
    """Height of the axis of a cylinder at x that just touches the particles from above (side 1) or below (side -1), m."""
    distance = numpy.abs(position[:, 0] - x)
    near = distance < radius + reach
    return side * (side * position[near, 2] + numpy.sqrt((radius + reach[near]) ** 2 - distance[near] ** 2)).max()


def middle_slice(position, pair, thickness):
    """True for the bonds in the middle of the bar's width."""
    y = position[pair, 1].mean(axis=1)
    return numpy.abs(y - (y.min() + y.max()) / 2) <= thickness / 2


def draw(state, test):
    """state: the bar with the displacements of its particles and the forces of its bonds; test: the dem-bend result."""
    particles, bonds = state["particles"], state["bonds"]
    position, factor = bent_positions(particles, test["height"])
    shown = middle_slice(position, bonds["pair"], SHOWN_SLICE * 2 * particles["radius"].mean())
    force = bonds["normal_force"][shown] / NANONEWTON
    order = numpy.argsort(numpy.abs(force))
    lines = position[bonds["pair"][shown][order]][:, :, [0, 2]] / NM

    left, right = lines[:, :, 0].min(), lines[:, :, 0].max()
    low, high = lines[:, :, 1].min(), lines[:, :, 1].max()
    margin = 0.45 * test["height"] / NM
    figure, axes = pyplot.subplots(figsize=(6.8, 6.8 * (high - low + 2 * margin) / (right - left) * 0.86 + 0.95))
    middle = test["length"] / 2 + state["box"]["origin"][0]
    radius, half_span = test["punch_radius"], test["span"] / 2
    for name, x, side in (("punch", middle, 1), ("support", middle - half_span, -1), ("support", middle + half_span, -1)):
        z = cylinder_height(position, particles["radius"], x, radius, side)
        axes.add_patch(Circle((x / NM, z / NM), radius / NM, facecolor="#eeeeee", edgecolor="#888888", linewidth=0.8))
        axes.text(x / NM, (z - side * 0.75 * radius) / NM, name, ha="center", va="center", color="#555555")
    limit = numpy.quantile(numpy.abs(force), 0.99)
    bars = LineCollection(lines, array=force[order], cmap="coolwarm", clim=(-limit, limit), linewidths=1.1, rasterized=True)
    axes.add_collection(bars)
    axes.set_xlim(left, right)
    axes.set_ylim(low - margin, high + margin)
    axes.set_aspect("equal")
    axes.set_xlabel(f"Length, nm (bending shown {factor:,.0f} times enlarged)")
    axes.set_ylabel("Height, nm")
    scale = figure.colorbar(bars, ax=axes, location="bottom", shrink=0.5, aspect=40, extend="both")
    scale.set_label("Normal force in a bond, nN:  compression < 0 < tension")
    return figure


def main():
    given = style.arguments(__doc__, ("test", "result of bend"), ("states", "bent bar of the same test"))
    state = style.documents(given.states[0], "dem-state", "which bend --states writes", "bonds.normal_force",
                            "particles.displacement")[0]
    test = style.documents(given.test, "dem-bend", "which bend writes", "height", "span", "length", "punch_radius")[0]
    style.save(draw(state, test), given.output)


if __name__ == "__main__":
    main()
