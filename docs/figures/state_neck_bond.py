"""state_neck_bond.py: the drawing of what Kiln computes with: a state in its periodic box, the neck of a contact, its bond."""
import os
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../workflows/post"))
import style  # noqa: E402  (the folder comes first)
from style import ACCENT, LINE, pyplot  # noqa: E402

PARTICLE, EDGE, IMAGE, NECK = "#d7e6f2", "#35608d", "#b8c4d0", "#f3c9a8"
OVERLAP = 0.2  # h of two spheres of radius 1: h/2R = 0.1, a relative density of about 0.7
CONTACTS = 6  # of each particle, among which it shares what it loses


def relaxed_discs(count, radius, seed):
    """Centres of discs in the periodic unit square, pushed apart until hardly any overlap."""
    centres = numpy.random.default_rng(seed).random((count, 2))
    for _ in range(4000):
        apart = centres[:, None] - centres
        apart -= numpy.round(apart)
        distance = numpy.hypot(apart[..., 0], apart[..., 1]) + numpy.eye(count)
        overlap = (2.0 * radius - distance).clip(min=0.0) * (1.0 - numpy.eye(count))
        centres += 0.25 * (apart * (overlap / distance)[..., None]).sum(axis=1)
    return centres % 1.0


def arrow(axis, start, end, text, place, colour="black", **align):
    """A length between two points, with its name at a third point."""
    axis.annotate("", end, start, arrowprops={"arrowstyle": "<->", "color": colour, "shrinkA": 0, "shrinkB": 0, "linewidth": 1.0})
    axis.text(*place, text, color=colour, **{"ha": "center", "va": "center", **align})


def pointer(axis, text, place, target, colour="black", **align):
    axis.annotate(text, target, place, color=colour, arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.8},
                  **{"ha": "center", "va": "center", **align})


def caption(axis, title, words):
    axis.text(0.0, 2.05, title, ha="center", va="bottom", fontsize=10.5, fontweight="bold")
    axis.text(0.0, -2.0, words, ha="center", va="top", fontsize=8.5)


def disc(axis, centre, radius, face=PARTICLE, edge=EDGE, **more):
    return axis.add_patch(pyplot.Circle(centre, radius, facecolor=face, edgecolor=edge, linewidth=1.1, **more))


def draw_state(axis):
    radius, scale = 0.105, 2.6  # of a disc, over the edge of the box; the box in the drawing's lengths
    centres = relaxed_discs(22, radius, 8)
    view = pyplot.Rectangle((-1.8, -1.8), 3.6, 3.6, transform=axis.transData)
    shifts = numpy.array(list(numpy.ndindex(3, 3))) - 1.0
    places = (centres[None] + shifts[:, None]).reshape(-1, 2)
    for place, inside in zip(places, numpy.repeat((shifts == 0.0).all(axis=1), len(centres))):
        disc(axis, scale * (place - 0.5), scale * radius, PARTICLE if inside else "white", EDGE if inside else IMAGE,
             zorder=2 if inside else 1).set_clip_path(view)
    axis.add_patch(pyplot.Rectangle((-scale / 2, ) * 2, scale, scale, fill=False, linewidth=1.4, linestyle="--", zorder=3))
    for first in centres:
        apart = places - first
        distance = numpy.hypot(*apart.T)
        for offset in apart[(distance > 0.0) & (distance < 2.005 * radius)]:
            axis.plot(*(scale * (first + offset / 2 - 0.5)), ".", color=ACCENT, markersize=5, zorder=4)
    caption(axis, "State: particles in a box",
            "what leaves the box on one side enters on\nthe other (grey: images); dots: contacts")


def draw_neck(axis):
    half = 1.0 - OVERLAP / 2.0  # half the distance between the centres
    neck = numpy.sqrt(4.0 * 0.5 * OVERLAP)  # a^2 = 4 R* h, R* = 1/2
    # The neck's profile: an arc tangent to both spheres whose waist is a.
    fillet = (half**2 + neck**2 - 1.0) / (2.0 * (1.0 - neck))
    top = neck + fillet
    touch = numpy.array([half, top]) / (1.0 + fillet)  # from the centre of a sphere
    angle = numpy.linspace(-1.0, 1.0, 60) * numpy.arctan2(half - touch[0], top - touch[1])
    arc = numpy.column_stack([fillet * numpy.sin(angle), top - fillet * numpy.cos(angle)])
    for side in (-1.0, 1.0):
        disc(axis, (side * half, 0.0), 1.0, zorder=1)
    outline = numpy.vstack([arc, arc[::-1] * (1.0, -1.0)])
    axis.add_patch(pyplot.Polygon(outline, facecolor=NECK, edgecolor="none", zorder=2))
    for mirror in (1.0, -1.0):
        axis.plot(arc[:, 0], mirror * arc[:, 1], color=ACCENT, linewidth=1.6, zorder=3)
    for side in (-1.0, 1.0):
        disc(axis, (side * half, 0.0), 1.0, "none", zorder=3)
        axis.plot(side * half, 0.0, "+", color="black", markersize=6, zorder=4)
    arrow(axis, (0.0, 0.0), (0.0, neck), "a", (0.13, 0.3), ACCENT)
    arrow(axis, (-half, -1.45), (half, -1.45), "d", (0.0, -1.62))
    for side in (-1.0, 1.0):
        axis.plot([side * half] * 2, [-0.12, -1.55], color="black", linewidth=0.6, linestyle=":")
    slant = numpy.array([-numpy.cos(0.9), numpy.sin(0.9)])
    arrow(axis, (-half, 0.0), numpy.array([-half, 0.0]) + slant, "r", numpy.array([-half, 0.0]) + 0.5 * slant + (0.17, 0.08))
    arrow(axis, (-OVERLAP / 2, -0.05), (OVERLAP / 2, -0.05), "", (0, 0), LINE)
    pointer(axis, "overlap h = r₁ + r₂ − d", (0.0, 1.5), (-0.05, -0.05), LINE)
    pointer(axis, "neck, radius a", (0.0, -1.12), (0.0, -neck), ACCENT)
    caption(axis, "Contact: overlap h and neck a", "sintering brings the centres together;\na² = 4 R* h, 1/R* = 1/r₁ + 1/r₂")


def bond_radius(distance, sphere, volume):
    """Root of pi Rb^2 Lb(Rb) = V, Lb = d - 2 sqrt(R^2 - Rb^2) (Eq. 2 and 4), by bisection; and the length Lb."""
    low, high = 0.0, sphere
    for _ in range(60):
        middle = 0.5 * (low + high)
        length = distance - 2.0 * numpy.sqrt(sphere**2 - middle**2)
        low, high = (middle, high) if numpy.pi * middle**2 * length < volume else (low, middle)
    return middle, length


def draw_bond(axis):
    half = 1.0 - OVERLAP / 2.0
    volume = 2.0 * 4.0 / 3.0 * numpy.pi * (1.0 - half**3) / CONTACTS
    radius, length = bond_radius(2.0 * half, half, volume)
    for side in (-1.0, 1.0):
        disc(axis, (side * half, 0.0), 1.0, "none", IMAGE, linestyle="--", zorder=1)
        disc(axis, (side * half, 0.0), half, zorder=2)
        axis.plot(side * half, 0.0, "+", color="black", markersize=6, zorder=4)
    axis.add_patch(
        pyplot.Rectangle((-length / 2, -radius), length, 2 * radius, facecolor=NECK, edgecolor=ACCENT, linewidth=1.6, zorder=3))
    arrow(axis, (0.0, 0.0), (0.0, radius), "", (0, 0), ACCENT)
    axis.plot([-length / 2, length / 2], [0.0, 0.0], color=ACCENT, linewidth=0.8, linestyle="-.", zorder=4)
    axis.text(length / 2 + 0.06, 0.3, "R$_b$", color=ACCENT, ha="left", va="center", zorder=5)
    arrow(axis, (-length / 2, -1.45), (length / 2, -1.45), "", (0, 0), ACCENT)
    axis.text(length / 2 + 0.08, -1.47, "L$_b$", color=ACCENT, ha="left", va="center")
    for side in (-1.0, 1.0):
        axis.plot([side * length / 2] * 2, [-radius, -1.55], color=ACCENT, linewidth=0.6, linestyle=":")
    slant = numpy.array([-numpy.cos(0.9), numpy.sin(0.9)])
    arrow(axis, (-half, 0.0), numpy.array([-half, 0.0]) + half * slant, "r",
          numpy.array([-half, 0.0]) + 0.5 * half * slant + (0.17, 0.08))
    pointer(axis, "given to this particle's bonds", (0.0, 1.5), (-half + 0.28, 0.91), EDGE)
    caption(axis, "Bond: a solid cylinder",
            "the spheres shrink until none overlap; the\nbond has the volume that the two lost to it")


def main():
    given = style.arguments(__doc__)
    figure = pyplot.figure(figsize=(9.0, 3.9), layout="none")
    for place, draw in enumerate((draw_state, draw_neck, draw_bond)):
        axis = figure.add_axes((place / 3, 0.0, 1 / 3, 1.0))
        draw(axis)
        axis.set_xlim(-2.0, 2.0)
        axis.set_ylim(-2.65, 2.55)
        axis.set_axis_off()
    style.save(figure, given.output)


if __name__ == "__main__":
    main()
