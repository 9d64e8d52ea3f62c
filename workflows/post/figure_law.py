"""figure_law.py: moduli of the bond laws against finite elements of the same states, and how far they are off by density."""
import os

import style
from style import GPA, pyplot
from validate import compared

MARKERS = "osD^v<>"


def draw(folders):
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(1.6 * style.WIDTH, 3.6))
    limit = 0.0
    for folder, marker in zip(folders, MARKERS):
        for model, colour, size in (("series", style.REFERENCE, 3.5), ("solid", style.LINE, 5)):
            pairs = compared(folder, model)
            voxel = [each["young_modulus"] / GPA for each, _ in pairs]
            law = [each["young_modulus"] / GPA for _, each in pairs]
            label = os.path.basename(folder) if model == "solid" else None
            left.plot(voxel, law, marker, color=colour, markersize=size, label=label, zorder=3 if model == "solid" else 2)
            off = [100 * (b / a - 1) for a, b in zip(voxel, law)]
            density = [each["relative_density"] for each, _ in pairs]
            right.plot(density, off, marker, color=colour, markersize=size)
            if model == "solid":
                error = [100 * each["extrapolation_error"] / each["young_modulus"] for each, _ in pairs]
                right.errorbar(density, off, error, fmt="none", ecolor=colour, elinewidth=0.7)
            limit = max(limit, *voxel, *law)
    left.plot([0, 1.05 * limit], [0, 1.05 * limit], color=style.ACCENT, linewidth=0.8)
    left.set(xlabel="Young's modulus of voxels, GPa", ylabel="of the law, GPa", xlim=(0, None), ylim=(0, None))
    left.legend(title="solid (grey: series)", title_fontsize=8, fontsize=8)
    right.axhspan(-10, 10, color=style.LINE, alpha=0.08, linewidth=0)
    right.axhline(0, color=style.ACCENT, linewidth=0.8)
    right.set(xlabel="Relative density", ylabel="Law over voxels - 1, %")
    return figure


def main():
    given = style.arguments(__doc__, ("folders", "packings of workflows/validate"))
    for folder in given.folders:
        for name in ("voxel", "solid", "series"):
            style.documents(os.path.join(folder, f"{name}.json"), "dem-elastic", "which workflows/validate writes", "young_modulus")
    style.save(draw(given.folders), given.output)


if __name__ == "__main__":
    main()
