"""figure_grains.py: grain size against relative density of firings with coarsening, with what each mechanism has moved."""
import os

import kiln
import style
from style import pyplot


def read(path):
    """The lines of a history that have grain sizes."""
    steps = style.documents(path, None, "the history of sinter", "relative_density")
    steps = [step for step in steps if "mean_grain_diameter" in step]
    if not steps:
        style.refuse(f"{path}: no line has mean_grain_diameter; sinter writes it with --coarsening")
    return steps


def draw(histories):
    """histories: name and steps of each firing."""
    figure, (sizes, moved) = pyplot.subplots(2, 1, figsize=(style.WIDTH, 4.6), sharex=True, height_ratios=(2, 1))
    for number, (name, steps) in enumerate(histories):
        color = style.SERIES[number % len(style.SERIES)]
        density = [step["relative_density"] for step in steps]
        sizes.plot(density, [step["mean_grain_diameter"] / style.NM for step in steps], color=color, label=name)
        sizes.plot(density, [step["mean_intercept"] / style.NM for step in steps], color=color, linewidth=0.8, linestyle="--")
        few = [step for step in steps if step["grains"] < 100]
        if few:
            sizes.plot(few[0]["relative_density"], few[0]["mean_grain_diameter"] / style.NM, "x", color=color)
        for key, line in (("moved_by_surface", "-"), ("moved_by_boundary", ":")):
            moved.plot(density, [1e18 * step[key] for step in steps], color=color, linestyle=line)
    sizes.plot([], [], color=style.REFERENCE, linewidth=0.8, linestyle="--", label="mean intercept")
    sizes.plot([], [], "x", color=style.REFERENCE, linestyle="", label="fewer than 100 grains from here on")
    sizes.set_yscale("log")
    sizes.set_ylabel("Mean grain diameter, nm")
    sizes.legend()
    moved.set_ylabel("Moved, µm³")
    moved.set_xlabel("Relative density (moved by surface diffusion: full line, by boundaries: dots)")
    return figure


def main():
    given = style.arguments(__doc__, ("histories", "histories of sinter --coarsening, JSON lines"))
    names = [os.path.splitext(os.path.basename(path))[0] for path in given.histories]
    style.save(draw(list(zip(names, map(read, given.histories)))), given.output)


if __name__ == "__main__":
    main()
