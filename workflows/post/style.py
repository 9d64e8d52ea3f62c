"""style.py: the look that all figures share, their command line, and how they are saved."""
import argparse
import os
import sys

import matplotlib
import matplotlib.colors

import kiln

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


def refuse(sentence):
    """Ends the program with one sentence."""
    raise SystemExit(f"{os.path.basename(sys.argv[0])}: {sentence}")


def documents(path, kind, maker, *keys):
    """The documents of a file, which must be of the format `kind`, such as dem-fit (None: lines without one), and have all keys
    ("bonds.radius"); maker: what writes such files, for the one sentence with which the program ends otherwise."""
    expected = f"expected {f'{kind}, {maker}' if kind else maker}"
    try:
        found = kiln.read(path)
    except OSError as error:
        refuse(f"{path}: {error.strerror}")
    except kiln.Error as error:
        refuse(f"{error}; {expected}")
    if not found:
        refuse(f"{path}: holds no document; {expected}")
    for number, document in enumerate(found, 1):
        place = f"{path}, document {number}"
        if kind and document.get("format", "dem-state") != kind:
            refuse(f"{place}: is {document.get('format', 'dem-state')}, {expected}")
        for key in keys:
            inner = document
            for name in key.split("."):
                inner = inner.get(name) if isinstance(inner, dict) else None
            if inner is None:
                refuse(f"{place}: has no {key}; {expected}")
    return found


def temperature_text(kelvin):
    """"1200 °C" of one temperature, "25 to 1200 °C" of several."""
    low, high = (f"{value - 273.15:.0f}" for value in (min(kelvin), max(kelvin)))
    return f"{low} °C" if low == high else f"{low} to {high} °C"


def save(figure, path):
    """Writes the picture whole or not at all; reruns are byte-identical."""
    stem, kind = os.path.splitext(path)
    partial = f"{stem}.partial{kind}"
    stamp = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(kind)
    figure.savefig(partial, metadata=stamp)
    os.replace(partial, path)
