"""units.py: the table of units, as lib/io/quantity.cpp has it (tests/convert/test_homes.py compares the two), what unit the numbers
of a known column have, and the styles of units of LAMMPS."""
import decimal
import math
import re

ZERO_CELSIUS = 273.15  # K
ROOM_TEMPERATURE = 298.15  # K, what "RT" says

# Of each dimension: the unit's name, and by what its number is multiplied, divided and shifted to be in SI. Where the factor would
# not be exact the divisor is: 100 nm is 1e-7 m and not its neighbour.
TABLE = {
    "length": {"m": (1.0,), "cm": (1.0, 1e2), "mm": (1.0, 1e3), "um": (1.0, 1e6), "nm": (1.0, 1e9)},
    "area": {"m2": (1.0,), "mm2": (1.0, 1e6)},
    "volume": {"m3": (1.0,), "l": (1.0, 1e3)},
    "time": {"s": (1.0,), "ms": (1.0, 1e3), "us": (1.0, 1e6), "min": (60.0,), "h": (3600.0,), "d": (86400.0,)},
    "temperature": {"K": (1.0,), "C": (1.0, 1.0, ZERO_CELSIUS)},
    "heating_rate": {"K/s": (1.0,), "K/min": (1.0, 60.0), "K/h": (1.0, 3600.0),
                     "C/s": (1.0,), "C/min": (1.0, 60.0), "C/h": (1.0, 3600.0)},
    "pressure": {"Pa": (1.0,), "kPa": (1e3,), "MPa": (1e6,), "GPa": (1e9,)},
    "force": {"N": (1.0,), "kN": (1e3,), "mN": (1.0, 1e3), "uN": (1.0, 1e6), "nN": (1.0, 1e9)},
    "velocity": {"m/s": (1.0,), "mm/s": (1.0, 1e3), "um/s": (1.0, 1e6), "nm/s": (1.0, 1e9)},
    "surface_energy": {"J/m2": (1.0,), "mJ/m2": (1.0, 1e3)},
    "molar_energy": {"J/mol": (1.0,), "kJ/mol": (1e3,)},
    "mass_density": {"kg/m3": (1.0,), "g/cm3": (1e3,)},
    "angle": {"rad": (1.0,), "deg": (math.pi, 180.0)},
    "diffusion_volume": {"m3/s": (1.0,)},
    "compliance": {"m/N": (1.0,), "mm/N": (1.0, 1e3), "um/N": (1.0, 1e6), "nm/N": (1.0, 1e9), "mm/kN": (1.0, 1e6)},
    "conductivity": {"W/m/K": (1.0,)},
    "area_resistance": {"m2K/W": (1.0,), "mm2K/W": (1.0, 1e6)},
}
# Beside them, what only the columns of tables have.
COLUMNS_ONLY = {
    "area": {"cm2": (1.0, 1e4), "um2": (1.0, 1e12), "nm2": (1.0, 1e18)},
    "volume": {"cm3": (1.0, 1e6), "mm3": (1.0, 1e9), "um3": (1.0, 1e18), "nm3": (1.0, 1e27)},
    "time": {"ns": (1.0, 1e9)},
    "pressure": {"N/mm2": (1e6,), "kN/mm2": (1e9,)},
    "fraction": {"%": (1.0, 1e2), "percent": (1.0, 1e2)},
    "velocity": {"cm/s": (1.0, 1e2)},
    "moment": {"N m": (1.0,), "Nm": (1.0,), "Nmm": (1.0, 1e3), "mN m": (1.0, 1e3)},
    "mass": {"kg": (1.0,), "g": (1.0, 1e3), "mg": (1.0, 1e6), "ug": (1.0, 1e9)},
    "angular_velocity": {"rad/s": (1.0,), "1/s": (1.0,)},
    "number": {"1": (1.0,), "-": (1.0,), "%": (1.0, 1e2)},
}
SPELLINGS = (("\u00b5", "u"), ("\u03bc", "u"), ("\u2103", "C"), ("\u00b0C", "C"), ("\u00baC", "C"), ("degC", "C"), ("deg C", "C"),
             ("\u00b0 C", "C"), ("\u00b0", "deg"), ("\u00b2", "2"), ("\u00b3", "3"), ("^", ""))

# What the numbers of columns are, by name: of particles, of bonds, and as LAMMPS names them. Exponents of mass, length and time.
EXPONENTS = {
    "length": (0, 1, 0), "volume": (0, 3, 0), "time": (0, 0, 1), "velocity": (0, 1, -1), "angular_velocity": (0, 0, -1),
    "mass": (1, 0, 0), "mass_density": (1, -3, 0), "force": (1, 1, -2), "moment": (1, 2, -2), "pressure": (1, -1, -2),
    "angular_momentum": (1, 2, -1), "number": (0, 0, 0)
}
COLUMNS = {
    "length": "x y z xu yu zu radius diameter length displacement dx dy dz",
    "volume": "volume",
    "velocity": "vx vy vz velocity",
    "angular_velocity": "omegax omegay omegaz angular_velocity",
    "mass": "mass",
    "mass_density": "density",
    "force": "fx fy fz force normal_force shear_force",
    "moment": "tqx tqy tqz torque moment",
    "angular_momentum": "angmomx angmomy angmomz",
    "pressure": "tensile_stress shear_stress pressure stress",
    "number": "id type mol molecule element xs ys zs xsu ysu zsu ix iy iz proc procp1 broken coordination id1 id2 material ghost "
              "image_x image_y image_z batom1 batom2 btype index"
}
DIMENSION = {name: dimension for dimension, names in COLUMNS.items() for name in names.split()}

# Powers of ten of kg, m and s that are the units of mass, length and time of a LAMMPS style of units.
SYSTEMS = {"si": (0, 0, 0), "cgs": (-3, -2, 0), "micro": (-15, -6, -6), "nano": (-21, -9, -9)}
WITHOUT_METRES = ("lj", "real", "metal", "electron")  # the other styles of LAMMPS


def spelled(unit):
    """A unit as the table spells it: µ is u, the degree sign and superscripts are plain."""
    for sign, plain in SPELLINGS:
        unit = unit.replace(sign, plain)
    return unit.strip()


def known(dimension):
    return ", ".join({**TABLE.get(dimension, {}), **COLUMNS_ONLY.get(dimension, {})})


def scale_of(unit, dimension=None):
    """Factor, divisor and offset of a unit, of that dimension or of any; None for one that is not known."""
    for group in (TABLE, COLUMNS_ONLY):
        for each in (dimension,) if dimension else group:
            scale = group.get(each, {}).get(spelled(unit))
            if scale:
                return scale + (1.0, 0.0)[len(scale) - 1:]
    return None


def quantity(text, dimension):
    """SI value of a text such as 50nm; None if it is not a number with a unit of that dimension."""
    found = re.fullmatch(r"([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)\s*(\S+(?: \S+)?)", text.strip())
    scale = found and scale_of(found[2], dimension)
    return float(found[1]) * scale[0] / scale[1] + scale[2] if scale else None


def stem(column):
    """The name of a column without the number of its component: force of force[2]."""
    return re.sub(r"\[[0-9]+\]$", "", column)


def power(system, column):
    """Power of ten by which the numbers of a column differ from SI in a LAMMPS style of units; None where that is not known."""
    dimension = DIMENSION.get(stem(column))
    return dimension and sum(a * b for a, b in zip(EXPONENTS[dimension], SYSTEMS[system]))


def shifted(text, power_of_ten):
    """The number of a text times a power of ten, as near as there is one."""
    return float(decimal.Decimal(text).scaleb(power_of_ten)) if power_of_ten else float(text)


def times(value, count):
    """So many times a number, such as 10 steps of 1e-6 s: 1e-5 and not its neighbour."""
    return float(decimal.Decimal(repr(value)) * count)


def shown(value, power_of_ten=0):
    """A number divided by a power of ten, in digits from which shifted() makes the same number."""
    text = repr(float(value))
    return str(decimal.Decimal(text).scaleb(-power_of_ten)) if power_of_ten else text
