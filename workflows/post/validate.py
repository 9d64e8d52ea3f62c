"""validate.py: tables of what laws and networks say against the voxel model of the same states; see workflows/validate."""
import argparse
import os
import statistics

import kiln
from style import GPA

MODULI = ("axial_modulus", "young_modulus")


def root_mean_square(values):
    return (sum(value * value for value in values) / len(values)) ** 0.5


def compared(folder, model="solid"):
    """The voxel document and the network's of each state of a packing."""
    voxel, network = (kiln.read(os.path.join(folder, f"{name}.json")) for name in ("voxel", model))
    return list(zip(voxel, network, strict=True))


def law_table(folders):
    """Moduli of both laws over those of voxels, like with like: mean along the axes, and isotropic average."""
    yield (f"{'packing':<12} {'density':>7} {'voxels GPa':>18} {'solid GPa':>10} {'solid':>8} {'series':>8} "
           f"{'axial: solid':>12} {'nu voxels':>10} {'solid':>7} {'series':>7}")
    off = {"solid": [], "series": []}
    for folder in folders:
        for (voxel, solid), (_, series) in zip(compared(folder), compared(folder, "series"), strict=True):
            ratios = {}
            for name, law in (("solid", solid), ("series", series)):
                ratios[name] = [law[key] / voxel[key] - 1 for key in MODULI]
                off[name].append(ratios[name] + [law["poisson_ratio"] - voxel["poisson_ratio"]])
            yield (f"{os.path.basename(folder):<12} {voxel['relative_density']:7.3f} {voxel['young_modulus'] / GPA:9.1f} +- "
                   f"{voxel['extrapolation_error'] / GPA:4.1f} {solid['young_modulus'] / GPA:10.1f} {ratios['solid'][1]:+8.1%} "
                   f"{ratios['series'][1]:+8.1%} {ratios['solid'][0]:+12.1%} {voxel['poisson_ratio']:10.3f} "
                   f"{solid['poisson_ratio']:7.3f} {series['poisson_ratio']:7.3f}")
    yield ""
    for name, values in off.items():
        axial, isotropic, poisson = zip(*values)
        yield (f"{name:<7} {len(values)} states: isotropic average rms {root_mean_square(isotropic):.1%}, worst "
               f"{max(isotropic, key=abs):+.1%}; along the axes rms {root_mean_square(axial):.1%}, "
               f"worst {max(axial, key=abs):+.1%}; "
               f"Poisson's ratio rms {root_mean_square(poisson):.3f}, worst {max(poisson, key=abs):+.3f}")


def flow_table(folders):
    yield f"{'packing':<12} {'density':>7} {'voxels W/m/K':>18} {'network':>8} {'':>8} {'bound':>7}"
    off = []
    for folder in folders:
        pairs = zip(kiln.read(os.path.join(folder, "voxel-flow.json")), kiln.read(os.path.join(folder, "network-flow.json")),
                    strict=True)
        for voxel, network in pairs:
            off.append(network["conductivity"] / voxel["conductivity"] - 1)
            yield (f"{os.path.basename(folder):<12} {voxel['relative_density']:7.3f} {voxel['conductivity']:9.2f} +- "
                   f"{voxel['extrapolation_error']:4.2f} {network['conductivity']:9.2f} {off[-1]:+8.1%} {voxel['bound']:7.2f}")
    yield ""
    yield f"{len(off)} states: rms {root_mean_square(off):.1%}, worst {max(off, key=abs):+.1%}"


def row_table(paths):
    """Means over packings at each density, necks as the sintering law has them."""
    packings = [kiln.read(path) for path in paths]
    yield f"{'density':>7} {'union':>6} {'E GPa':>7} {'standard error':>15} {'axial':>7} {'nu':>6}   {len(packings)} packings"
    for states in zip(*packings, strict=True):
        young = [state["young_modulus"] / GPA for state in states]
        error = statistics.stdev(young) / len(young) ** 0.5 if len(young) > 1 else float("nan")
        mean = {key: statistics.mean(state[key] for state in states)
                for key in ("relative_density", "union_fraction", "axial_modulus", "poisson_ratio")}
        yield (f"{mean['relative_density']:7.3f} {mean['union_fraction']:6.3f} {statistics.mean(young):7.1f} {error:15.1f} "
               f"{mean['axial_modulus'] / GPA:7.1f} {mean['poisson_ratio']:6.3f}")


def twice_table(paths):
    coarse, fine = (kiln.read(path) for path in paths)
    yield f"{'density':>7} {'E GPa':>14} {'twice as fine':>15} {'off':>6} {'of stated':>10}   {'nu':>14} {'twice as fine':>14}"
    for one, two in zip(coarse, fine, strict=True):
        off = one["young_modulus"] - two["young_modulus"]
        yield (f"{one['relative_density']:7.3f} {one['young_modulus'] / GPA:7.1f} +- {one['extrapolation_error'] / GPA:3.1f} "
               f"{two['young_modulus'] / GPA:8.1f} +- {two['extrapolation_error'] / GPA:3.1f} {off / two['young_modulus']:+6.1%} "
               f"{abs(off) / one['extrapolation_error']:10.2f}   {one['poisson_ratio']:.4f} +- {one['poisson_ratio_error']:.4f} "
               f"{two['poisson_ratio']:14.4f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", choices=("law", "flow", "row", "twice"))
    parser.add_argument("inputs", nargs="+", help="folders of packings, or results")
    parser.add_argument("-o", "--output", required=True)
    given = parser.parse_args()
    tables = {"law": law_table, "flow": flow_table, "row": row_table, "twice": twice_table}
    text = "\n".join(tables[given.table](given.inputs)) + "\n"
    with open(given.output, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
