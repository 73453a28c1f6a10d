"""Units of measurement: exact factors to SI, the table of symbols, and the prefixes.

Sources: BIPM, The International System of Units, 9th edition (2019; prefixes of 2022), tables 4, 7 and 8;
NIST Special Publication 811 (2008), appendix B, for the inch, pound, and what follows from them, for columns
of mercury and water (13595.1 and 1000 kg/m^3, conventional), the calorie (thermochemical) and the Btu_IT.
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product
from typing import Final

from symflex.errors import nearest
from symflex.quantities.dimension import DIMENSIONLESS, Dimension


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as ``scale * pi**pi_power`` times a product of SI base units."""

    scale: Fraction  # exact factor to SI, without its power of pi
    pi_power: int = 0  # power of pi in the factor: 1 for deg
    dimension: Dimension = DIMENSIONLESS  # exponents of the SI base units
    # Exponent of the cycle: 1 for Hz, rev and rpm, -1 for mm/rev. A cycle is *not* multiplied in.
    cycles: int = 0
    # Exponent of the radian, which is the number 1: -1 for N*m/rad. A degree counts as a radian.
    radians: int = 0

    def __mul__(self, other: Unit) -> Unit:
        """Return the product of two units."""
        return Unit(
            self.scale * other.scale,
            self.pi_power + other.pi_power,
            self.dimension * other.dimension,
            self.cycles + other.cycles,
            self.radians + other.radians,
        )

    def __truediv__(self, other: Unit) -> Unit:
        """Return the quotient of two units."""
        return self * other**-1

    def __pow__(self, exponent: int) -> Unit:
        """Return an integer power of the unit."""
        return Unit(
            self.scale**exponent,
            self.pi_power * exponent,
            self.dimension**exponent,
            self.cycles * exponent,
            self.radians * exponent,
        )

    def scaled(self, factor: Fraction) -> Unit:
        """Return the unit ``factor`` times as large."""
        return Unit(self.scale * factor, self.pi_power, self.dimension, self.cycles, self.radians)

    def root(self, degree: int) -> Unit | None:
        """Return the exact root of the unit, or ``None`` when it is not a unit of this kind.

        >>> str(UNITS["m"].root(2).dimension), UNITS["Hz"].root(2)
        ('m^(1/2)', None)
        """
        above, below = _exact_root(self.scale.numerator, degree), _exact_root(self.scale.denominator, degree)
        counts = (self.pi_power, self.cycles, self.radians)
        if above is None or below is None or any(count % degree for count in counts):
            return None
        pi_power, cycles, radians = (count // degree for count in counts)
        return Unit(Fraction(above, below), pi_power, self.dimension ** Fraction(1, degree), cycles, radians)


def _exact_root(value: int, degree: int) -> int | None:
    low, high = 0, 1 << (value.bit_length() // degree + 1)
    while low < high:
        middle = (low + high) // 2
        if middle**degree < value:
            low = middle + 1
        else:
            high = middle
    return low if low**degree == value else None


PREFIXES: Final[dict[str, Fraction]] = {
    symbol: Fraction(10) ** power
    for symbol, power in (
        ("Q", 30), ("R", 27), ("Y", 24), ("Z", 21), ("E", 18), ("P", 15), ("T", 12), ("G", 9), ("M", 6),
        ("k", 3), ("h", 2), ("da", 1), ("d", -1), ("c", -2), ("m", -3), ("\u00b5", -6), ("\u03bc", -6),
        ("u", -6), ("n", -9), ("p", -12), ("f", -15), ("a", -18), ("z", -21), ("y", -24), ("r", -27),
        ("q", -30),
    )
}  # fmt: skip

_BASE: Final = {
    name: Unit(Fraction(1), dimension=Dimension(**{name: Fraction(1)}))
    for name in ("kg", "m", "s", "A", "K", "mol", "cd")
}
_ONE: Final = Unit(Fraction(1))
_KG, _M, _S, _A = _BASE["kg"], _BASE["m"], _BASE["s"], _BASE["A"]
_N: Final = _KG * _M / _S**2
_PA: Final = _N / _M**2
_J: Final = _N * _M
_W: Final = _J / _S
_C: Final = _A * _S
_V: Final = _W / _A
_OHM: Final = _V / _A
_WB: Final = _V * _S
_RAD: Final = Unit(Fraction(1), radians=1)
_CYCLE: Final = Unit(Fraction(1), cycles=1)
_MIN: Final = _S.scaled(Fraction(60))
_HOUR: Final = _S.scaled(Fraction(3600))
_DEG: Final = Unit(Fraction(1, 180), pi_power=1, radians=1)
_GRAVITY: Final = (_M / _S**2).scaled(Fraction("9.80665"))
_LITRE: Final = (_M**3).scaled(Fraction(1, 1000))
_INCH: Final = _M.scaled(Fraction("0.0254"))
_FOOT: Final = _M.scaled(Fraction("0.3048"))
_POUND: Final = _KG.scaled(Fraction("0.45359237"))
_OUNCE: Final = _POUND.scaled(Fraction(1, 16))
_LBF: Final = _POUND * _GRAVITY
_PSI: Final = _LBF / _INCH**2
_GALLON: Final = (_INCH**3).scaled(Fraction(231))  # of the US
_WATER: Final = _GRAVITY * (_KG / _M**3).scaled(Fraction(1000))
_MERCURY: Final = _GRAVITY * (_KG / _M**3).scaled(Fraction("13595.1"))
_CALORIE: Final = _J.scaled(Fraction("4.184"))
_MILLI: Final = Fraction(1, 1000)

PREFIXABLE_UNITS: Final[dict[str, Unit]] = {
    "m": _M,
    "g": _KG.scaled(Fraction(1, 1000)),
    "s": _S,
    "A": _A,
    "K": _BASE["K"],
    "mol": _BASE["mol"],
    "cd": _BASE["cd"],
    "rad": _RAD,
    "sr": _RAD**2,
    "Hz": _CYCLE / _S,
    "N": _N,
    "Pa": _PA,
    "J": _J,
    "W": _W,
    "C": _C,
    "V": _V,
    "F": _C / _V,
    "Ohm": _OHM,
    "ohm": _OHM,
    "\u03a9": _OHM,  # Greek capital omega
    "\u2126": _OHM,  # ohm sign
    "S": _OHM**-1,
    "Wb": _WB,
    "T": _WB / _M**2,
    "H": _WB / _A,
    "lm": _BASE["cd"] * _RAD**2,
    "lx": _BASE["cd"] * _RAD**2 / _M**2,
    "L": _LITRE,
    "l": _LITRE,
    "bar": _PA.scaled(Fraction(100_000)),
    "Wh": _W * _HOUR,
    "Ah": _A * _HOUR,
    "gf": _KG.scaled(Fraction(1, 1000)) * _GRAVITY,
    "deg": _DEG,
    "rpm": _CYCLE / _MIN,
    "Torr": _PA.scaled(Fraction(101_325, 760)),
    "P": (_PA * _S).scaled(Fraction(1, 10)),
    "St": (_M**2 / _S).scaled(Fraction(1, 10_000)),
    "cal": _CALORIE,
}

PLAIN_UNITS: Final[dict[str, Unit]] = {
    "t": _KG.scaled(Fraction(1000)),
    "tf": _KG.scaled(Fraction(1000)) * _GRAVITY,
    "min": _MIN,
    "h": _HOUR,
    "day": _HOUR.scaled(Fraction(24)),
    "\u00b0": _DEG,
    "arcmin": _DEG.scaled(Fraction(1, 60)),
    "arcsec": _DEG.scaled(Fraction(1, 3600)),
    "rev": _CYCLE,
    "cycle": _CYCLE,
    "%": _ONE.scaled(Fraction(1, 100)),
    "ppm": _ONE.scaled(Fraction(1, 1_000_000)),
    "g_n": _GRAVITY,
    "dyn": _N.scaled(Fraction(1, 100_000)),
    "atm": _PA.scaled(Fraction(101_325)),
    "in": _INCH,
    "inch": _INCH,
    "mil": _INCH.scaled(Fraction(1, 1000)),
    "ft": _FOOT,
    "yd": _FOOT.scaled(Fraction(3)),
    "mi": _FOOT.scaled(Fraction(5280)),
    "lb": _POUND,
    "lbm": _POUND,
    "oz": _OUNCE,
    "slug": _LBF * _S**2 / _FOOT,
    "lbf": _LBF,
    "ozf": _OUNCE * _GRAVITY,
    "kip": _LBF.scaled(Fraction(1000)),
    "psi": _PSI,
    "ksi": _PSI.scaled(Fraction(1000)),
    "hp": (_FOOT * _LBF / _S).scaled(Fraction(550)),
    "thou": _INCH.scaled(_MILLI),
    "Mpsi": _PSI.scaled(Fraction(1_000_000)),
    "mmHg": _M.scaled(_MILLI) * _MERCURY,
    "inHg": _INCH * _MERCURY,
    "mmH2O": _M.scaled(_MILLI) * _WATER,
    "cmH2O": _M.scaled(Fraction(1, 100)) * _WATER,
    "inH2O": _INCH * _WATER,
    "gal": _GALLON,
    "gpm": _GALLON / _MIN,
    "lpm": _LITRE / _MIN,
    "cfm": _FOOT**3 / _MIN,
    "cc": _LITRE.scaled(_MILLI),
    "mph": _FOOT.scaled(Fraction(5280)) / _HOUR,
    "knot": _M.scaled(Fraction(1852)) / _HOUR,
    "rps": _CYCLE / _S,
    "gauss": (_WB / _M**2).scaled(Fraction(1, 10_000)),
    "Btu": _J.scaled(Fraction("1055.05585262")),
}

UNITS: Final[dict[str, Unit]] = PREFIXABLE_UNITS | PLAIN_UNITS

WRITTEN_OUT: Final[dict[str, str]] = {
    written: meant
    for meant, many in {
        "s": "sec secs second seconds",
        "ms": "msec msecs",
        "min": "mins minute minutes",
        "h": "hr hrs hour hours",
        "day": "d days",
        "knot": "knots kn kts",
        "m": "meter meters metre metres mtr",
        "mm": "millimeter millimeters millimetre millimetres",
        "um": "micron microns",
        "in": "inches",
        "ft": "foot feet",
        "g": "gram grams gm gr",
        "kg": "kgs kilo kilos kilogram kilograms",
        "t": "ton tons tonne tonnes",
        "N": "newton newtons",
        "Pa": "pascal pascals",
        "J": "joule joules",
        "W": "watt watts",
        "A": "amp amps ampere amperes",
        "V": "volt volts",
        "Ohm": "ohms Ohms",
        "H": "henry henries",
        "F": "farad farads",
        "K": "kelvin kelvins degK \u00b0K",
        "Hz": "hertz cps",
        "kHz": "kilohertz",
        "rad": "radian radians",
        "deg": "degree degrees",
        "rev": "revs revolution revolutions turn turns r tr U",
        "deg/s": "dps",
        "S": "mho mhos",
        "cycle": "cycles cyc",
        "g_n": "g_0 g0 gn",
        "%": "percent",
        "cc": "ccm",
        "psi": "psia psig",
        "gpm": "GPM",
        "lpm": "LPM slpm",
        "cfm": "CFM scfm",
        "kgf": "kp kilopond",
        "gauss": "Gauss",
        "Torr": "torr",
        "in/s": "ips",
        "Btu": "BTU",
    }.items()
    for written in many.split()
}
"""Units by other words for them, which a specification may not have."""
_INSTEAD: Final = {written: f"did you mean '{meant}'?" for written, meant in WRITTEN_OUT.items()} | {
    "G": "a prefix needs a unit, as in 'GPa'; a gauss is 0.1 mT, or 'gauss'",
    "Arms": "write it in 'A': an rms ampere is sqrt(2) A at the peak",
    "Vrms": "write it in 'V': an rms volt is sqrt(2) V at the peak",
    "Apk": "did you mean 'A'?",
    "Vpk": "did you mean 'V'?",
    "Oe": "write it in A/m: an oersted is 1000/(4*pi) A/m",
    "lbs": "did you mean 'lb' (mass) or 'lbf' (force)?",
    "pi": "write pi before the unit, as in '2*pi rad/s'",
    "\u03c0": "write pi before the unit, as in '2*pi rad/s'",
    "dB": "write the ratio itself: x dB is 10^(x/20)",
    "degC": "use 'K', also in 'K/W': temperatures are absolute, and a difference of 1 degC is 1 K",
    "degF": "use 'K', also in 'K/W': temperatures are absolute, and a difference of 1 degF is 5/9 K",
    "\u00b0C": "use 'K', also in 'K/W': temperatures are absolute, and a difference of 1 degC is 1 K",
    "\u00b0F": "use 'K', also in 'K/W': temperatures are absolute, and a difference of 1 degF is 5/9 K",
}

# Products that data sheets print without a sign; the first factor may have a prefix.
_RUN_TOGETHER: Final = {
    product_of_units.replace("*", ""): product_of_units.split("*")
    for product_of_units in (
        "N*m N*cm N*mm N*s N*m*s kg*m kg*cm kg*mm g*cm g*mm V*A V*s A*s W*s".split()
    )
}  # fmt: skip

# What a symbol is, and one that it is taken for.
_ALIKE: Final = tuple(
    re.split(" = |, ", line)
    for line in (
        "lb = a mass, lbf = a force; lbm = a mass, lbf = a force; oz = a mass, ozf = a force; "
        "kg = a mass, kgf = a force; g = a mass, gf = a force; g = a mass, g_n = an acceleration; "
        "lbf = a force, lb = a mass; ozf = a force, oz = a mass; kgf = a force, kg = a mass; "
        "S = a conductance, s = a time; H = an inductance, h = a time; C = a charge, K = a temperature; "
        "T = a flux density, t = a mass; nm = a length, N*m = a torque"
    ).split("; ")
)
# What is read well and hardly meant: how, what is meant (a mass with an f in place of nothing), and of what.
_DOUBTS: Final = (
    (r"(?:[VAC]|rad/s|deg/s|\u00b0/s)/\(?(g)\)?$", "g_n", "a gram", "the acceleration of gravity"),
    (r"[VA]/\(?(kg|lb|oz)\)?$", "", "a mass", "a force"),
    (r"(?:\b(kg|g|lb|oz)\*(?:m|cm|mm|in|ft))/(?:[VA]|rad|deg)\b", "", "a mass", "a torque"),
    (r"(?:^|\W)(1/min|min\^-1)$", "rpm", "a rate without turns", "a speed of rotation"),
    (r"^(PS)$", "W", "a petasiemens", "a metric horsepower, 735.49875 W,"),
    (r"^(Gs)$", "mT", "a gigasecond", "a gauss, 0.1 mT,"),
)
# Units long enough to be given a plural; a shorter one with an s is a product, as in Pas.
_WORDS: Final = tuple(name for name in UNITS if len(name) > 2)  # noqa: PLR2004
_LONGEST_PRODUCT: Final = 8
_USUAL_PREFIXES: Final = ("", "n", "u", "m", "c", "k", "M", "G")


def unit_named(symbol: str) -> Unit | None:
    """Return the unit of a symbol, prefixed or not (``min`` is the minute), or ``None`` without one."""
    if symbol in UNITS:
        return UNITS[symbol]
    for length in (1, 2):
        factor, unit = PREFIXES.get(symbol[:length]), PREFIXABLE_UNITS.get(symbol[length:])
        if factor is not None and unit is not None:
            return unit.scaled(factor)
    return None


def run_together(symbol: str) -> tuple[Unit, Unit] | None:
    """Return what precedes the last unit of ``kgm2``, and that with its power; ``None`` for most symbols.

    The usual products are read without a sign between their factors. A digit is a power, as in UCUM, and
    that of the last factor only, like a power that follows.

    >>> [str(unit.dimension) for unit in run_together("kgm2")], run_together("Nkg"), run_together("ms")
    (['kg', 'm^2'], None, None)
    """
    letters, power = (symbol[:-1], int(symbol[-1])) if symbol[-1] in "234" else (symbol, 1)
    names = [letters] if power > 1 else []
    for length in (0, 1, 2):
        if letters[length:] in _RUN_TOGETHER:
            first, *others = _RUN_TOGETHER[letters[length:]]
            names = [letters[:length] + first, *others]
    units = [unit for unit in map(unit_named, names) if unit]
    if not units or len(units) < len(names):
        return None
    return functools.reduce(Unit.__mul__, units[:-1], _ONE), units[-1] ** power


def unit_hint(symbol: str) -> str | None:
    """Return what an unknown symbol was probably meant to be."""
    for written in (symbol, symbol.lower()):
        # Two letters are too few to tell a slip from another unit.
        if written in _INSTEAD and (written == symbol or symbol[2:]):
            return _INSTEAD[written]
    prefix = "M" if symbol.lower() == "meg" else symbol.rstrip("0123456789")
    if prefix in PREFIXES and prefix not in UNITS:
        return (
            f"a prefix needs a unit: write '{prefix}{'F' if PREFIXES[prefix] < 1 else 'Ohm'}', for instance"
        )
    small = "k" + symbol[1:]
    if symbol[0] == "K" and (unit_named(small) or run_together(small)):
        return f"did you mean '{small}'?"
    symbols = _usual_symbols()
    # Of mPa and MPa, 'MPA' is nearer to the one with more letters as written.
    same = [name for name in symbols if name.lower() == symbol.lower()]
    if same:
        best = max(same, key=lambda name: sum(a == b for a, b in zip(name, symbol, strict=False)))
        return f"did you mean '{best}'?"
    if symbol.endswith("s") and symbol[:-1] in symbols and symbol[:-1].endswith(_WORDS):
        return f"did you mean '{symbol[:-1]}'?"
    product_of_units = _product_hint(symbol)
    if product_of_units is None and "_" in symbol:
        return "between a number and a parameter write '*'"
    return product_of_units or nearest(symbol, symbols)


def unit_slip(unit: str, given: Dimension, wanted: Dimension) -> str | None:
    """Return how a unit is written that has another letter, a mass for a force, or one slash too many."""
    if unit in ("K", "m", "T", "F") and str(wanted) in ("Ohm", "F", "H", "V", "A"):
        return f"a prefix needs a unit: write '{unit.replace('K', 'k')}{wanted}'"
    return _letter_slip(unit, given, wanted) or _slash_slip(unit, given, wanted)


def _slash_slip(unit: str, given: Dimension, wanted: Dimension) -> str | None:
    """Read ``N/m/s`` as ``N/(m/s)``, also where the mass in it is a force."""
    above, *below = unit.split("/")
    last = unit_named(below[-1].strip("() ")) if len(below) == 2 and "(" not in unit else None  # noqa: PLR2004
    if last is None:
        return None
    meant, written = given * last.dimension**2, f"{above}/({below[0]}/{below[1]})"
    if meant == wanted:
        return f"'/' divides each time: write '{written}'"
    mass = _letter_slip(written, meant, wanted)
    return f"'/' divides each time, and {mass}" if mass else None


def _letter_slip(unit: str, given: Dimension, wanted: Dimension) -> str | None:
    for written, kind, meant, other in _ALIKE:
        known, factors = unit_named(written), [unit_named(name) for name in meant.split("*")]
        right = re.sub(rf"\b{written}\b", meant, unit)
        if known and right != unit:
            ratio = functools.reduce(Unit.__mul__, (f for f in factors if f), known**-1).dimension
            if wanted in (given * ratio, given / ratio):
                return f"'{written}' is {kind}, '{meant}' {other}: write '{right}'"
    return None


def unit_doubt(unit: str) -> tuple[str, str] | None:
    """Return how a unit is read that data sheets mean differently, and how what they mean is written."""
    for pattern, meant, read, what in _DOUBTS:
        if place := re.search(pattern, unit):
            right = f"{unit[: place.start(1)]}{meant or place[1] + 'f'}{unit[place.end(1) :]}"
            return f"'{place[1]}' is {read}", f"for {what} write '{right}'"
    return None


@functools.cache
def _usual_symbols() -> tuple[str, ...]:
    names = [name for name in PREFIXABLE_UNITS if name.isascii()]
    return tuple(sorted({*map("".join, product(_USUAL_PREFIXES, names)), *PLAIN_UNITS}))


def _product_hint(symbol: str) -> str | None:
    """Read ``Nm`` as ``N*m`` and ``m2`` as ``m^2``; the fewest factors win."""
    letters = symbol.rstrip("0123456789")
    digits = symbol[len(letters) :]
    if not 0 < len(letters) <= _LONGEST_PRODUCT or len(digits) > 1:
        return None
    places = range(1, len(letters))
    cuts = [(), *((i,) for i in places), *((i, j) for i in places for j in range(i + 1, len(letters)))]
    symbols = _usual_symbols()
    for cut in cuts:
        factors = [letters[i:j] for i, j in pairwise((0, *cut, len(letters)))]
        units = [unit_named(factor) for factor in factors if factor in symbols]
        # Two factors of one dimension are a slip of the finger: kgg is kg, not kg*g.
        if len({unit.dimension for unit in units if unit}) == len(factors):
            return f"did you mean '{'*'.join(factors)}{'^' + digits if digits else ''}'?"
    return None
