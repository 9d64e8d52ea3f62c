"""style.py: the look that all figures share, their command line, and how they are saved."""
import argparse
import os

import matplotlib
import matplotlib.colors

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (the backend comes first)

NM = 1e-9  # m
GPA = 1e9  # Pa

# Colours that stay apart in grey and for colour-blind readers: rising densities from light to dark, and three for single lines.
SERIES = ("#7ad151", "#22a884", "#35608d", "#440154")
ACCENT, LINE, REFERENCE = "#d55e00", "#0072b2", "#707070"

SOLID = matplotlib.colors.LinearSegmentedColormap.from_list("solid", ("#10263b", "#6b93b8", "#f4f8fb"))  # of shaded surfaces

WIDTH = 5.2  # inches, a column and a half of a journal

pyplot.rcParams.update({
    "figure.constrained_layout.use": True,
    "figure.dpi": 200,
    "font.size": 9.5,
    "axes.titlesize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "lines.linewidth": 1.6,
    "legend.frameon": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "kiln",
})


def arguments(description, *names):
    """Parses the command line of a figure: the named input files, and -o for the picture."""
    parser = argparse.ArgumentParser(description=description)
    for name, help_text in names:
        parser.add_argument(name, help=help_text, nargs="+" if name.endswith("s") else None)
    parser.add_argument("-o", "--output", required=True, help="picture to write (png, svg or pdf)")
    return parser.parse_args()


def save(figure, path):
    """Writes the picture whole or not at all; reruns are byte-identical."""
    stem, kind = os.path.splitext(path)
    partial = f"{stem}.partial{kind}"
    stamp = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(kind)
    figure.savefig(partial, metadata=stamp)
    os.replace(partial, path)
