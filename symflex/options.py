"""Options of each command: one frozen dataclass a command, made by the command line and by Python alike.

        symflex roots beam.toml --modes 3 --digits 20      RootsOptions(modes=3, digits=20)
    bound.poles(3, digits=20)                          RootsOptions(modes=3, digits=20)

A field has its default, its names on the command line and what the help says of it, and the command line is
made of the fields, in their order. What may have a unit is a text there and a number in Python; it is kept as
it was given, and read by the functions at the end. Nobody compares or prints options: methods for that, of
all commands, would take 7 ms of every start.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from decimal import Decimal
from fractions import Fraction
from math import inf, isfinite, isinf, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

from symflex.errors import Diagnostic, SpecError, Text, UsageError, refused

if TYPE_CHECKING:
    from symflex.model import ModelParameter
    from symflex.quantities import Quantity

Stated = float | Fraction | str  # a number, or a text with or without a unit
Ends = tuple[Stated, Stated]
Places = Sequence[str | Path]
T = TypeVar("T")

POINTS: Final = 201  # number of points of a response in time if no times are given
FREQUENCIES: Final = 200  # default number of frequencies of a swept response
UNBOUNDED: Final = ("inf", "-inf", "+inf")


def option(default: T, *flags: str, **said: object) -> T:
    """Return a field: its default, its names on the command line (none for an argument), what is said of it.

    That is ``help``, ``metavar``, ``nargs`` and other words of :func:`click.option`, or in place of its
    ``type``: ``least`` and ``most``, ``choices``, ``is_path``, ``is_folder`` (one that exists). What is False
    by default is a switch.
    """
    found: Any = field(default=default, metadata={"flags": flags, **said})
    return found  # type: ignore[no-any-return]


def file_option(about: str) -> str | None:
    """Return the field of a file to write, with what is said of it."""
    return option(None, "-o", "--output", is_path=True, help=about)


MATRIX: Final = {"help": "All pairs as one matrix over their common denominator."}
ENDS: Final = {"metavar": "NAMES"}
ONE_TF: Final = {"metavar": "OUT/IN", "help": "Transfer function.  [default: the first one]"}
SOME_TFS: Final = {"metavar": "OUT/IN", "multiple": True}
ONLY_TFS: Final = {**SOME_TFS, "help": "Only this transfer function; may be repeated."}
RECORD: Final = {
    "metavar": "FILE",
    "help": "Time record: its input drives the model, its output is compared and drawn.",
}
COLUMNS_OF_RECORD: Final = {"metavar": "WORDS", "help": "Columns of the record: t,u,y."}
JSON: Final = {"help": "Print the result as JSON."}
OUTSIDE: Final = {
    "multiple": True,
    "is_folder": True,
    "metavar": "FOLDER",
    "help": "Let model blocks read this folder too; may be repeated.",
}
TWO: Final = {"nargs": 2, "metavar": "LO HI"}
SHOWN: Final = {"show_default": True}
SHAPERS: Final = ("zv", "zvd", "ei")
SHAPED_MODES: Final = {"least": 1, "most": 20, **SHOWN, "help": "Shape the N lowest modes."}
MOST_DIGITS: Final = 10_000
JOINT: Final = {"hidden": True}  # has no effect since shapers of several modes are convolved
SPREAD: Final = {
    "metavar": "[SHARE]",
    "is_flag": False,
    "flag_value": "",
    "help": "All parameters at once, each off by up to this share, 10%; without one, those with a 'spread'.",
}
REPRESENTATIONS: Final = ("auto", "expanded", "nested")
WIDTHS: Final = "ieee|a4|MM"
WIDTH: Final = {"metavar": WIDTHS, "help": "Width of the figure: 88.5 mm, 170 mm or a number in mm."}
FONT: Final = {"metavar": "FONT", "help": "Font: times, latex or sans.  [default: times]"}


@dataclass(frozen=True, eq=False, repr=False)
class CheckOptions:
    """Options of ``symflex check``."""

    as_json: bool = option(False, "--json", **JSON)
    equations: bool = option(
        False,
        "--equations",
        help="Print the linear equations that [equations] or [energy] become, and the values at equilibrium.",
    )
    strict: bool = option(False, "--strict", help="Exit with code 3 if there is a warning.")


@dataclass(frozen=True, eq=False, repr=False)
class DeriveOptions:
    """Options of ``symflex derive``."""

    tfs: Sequence[str] = option((), "--tf", **ONLY_TFS)
    form: str | None = option(
        None,
        "--form",
        metavar="FORM",
        help="polynomial, monic, constant, factored, definitions, zpk, frequency; for beams, rods and "
        "delays also hyperbolic, krylov, vaughan; nested selects that representation.  [default: the "
        "shortest symbolic form]",
    )
    format: str = option("text", "--format", choices=("text", "latex", "json", "typst", "omml"), **SHOWN)
    width: str | None = option(
        None,
        "--width",
        metavar=WIDTHS,
        help="Break LaTeX equations to a column of this width, in ten-point type.  [default: no breaks]",
    )
    representation: str = option(
        "auto",
        "--representation",
        choices=REPRESENTATIONS,
        **SHOWN,
        help="expanded: quotients of polynomials; nested: straight-line programs of named sub-impedances; "
        "auto: nested, with a note, if expansion would be too large.",
    )
    as_json: bool = option(False, "--json", help="Same as --format json.")
    digits: int = option(6, "--digits", least=1, most=1000, **SHOWN, help="Digits of the form zpk.")
    symbolic: bool = option(
        False, "--symbolic", "--letters", help="Print formulas in symbols, which is the default."
    )
    limits: bool = option(False, "--limits", help="Print leading terms for s -> 0 and s -> infinity instead.")
    dimensionless: bool = option(
        False, "--dimensionless", help="Print functions in as few dimensionless groups as there are."
    )
    short: Stated | None = option(
        None,
        "--short",
        metavar="SHARE",
        help="Drop terms while no coefficient of s changes by more than this share, such as 1%.",
    )
    spread: Stated | None = option(
        None, "--spread", metavar="SHARE", help="--short: spread of all parameters, in place of their own."
    )
    order: int | None = option(
        None,
        "--order",
        least=0,
        most=12,
        help="Expand functions of beams, rods and delays in s, exactly, up to this power.",
    )
    is_matrix: bool = option(False, "--matrix", **MATRIX)
    inputs: str = option("", "--in", **ENDS, help="--matrix: inputs, such as u1,u2.  [default: all]")
    outputs: str = option("", "--out", **ENDS, help="--matrix: outputs, such as y1,y2.  [default: all]")
    is_rga: bool = option(
        False,
        "--rga",
        help="--matrix: print static gains, their inverse and relative gains at s = 0.",
    )


@dataclass(frozen=True, eq=False, repr=False)
class ExportOptions:
    """Options of ``symflex export``."""

    target: str = option("", "--to", metavar="TARGET", help="One of the targets below.  [required]")
    tfs: Sequence[str] = option((), "--tf", **ONLY_TFS)
    form: str | None = option(
        None,
        "--form",
        metavar="FORM",
        help="latex: any form of derive; code: band, a product over poles and zeros.",
    )
    up_to: Stated | None = option(
        None,
        "--up-to",
        metavar="FREQUENCY",
        help="End of the band of a band form, in Hz or with a unit.  [default: the model's band or modes]",
    )
    width: str | None = option(
        None, "--width", metavar=WIDTHS, help="latex: width of the column.  [default: a4, 170 mm]"
    )
    no_figures: bool = option(False, "--no-figures", help="latex: write no figures.")
    representation: str = option(
        "auto",
        "--representation",
        choices=REPRESENTATIONS,
        **SHOWN,
        help="Quotients of polynomials or nested expressions, as for derive.",
    )
    output: str | None = file_option("File to write.  [default: standard output]")
    is_minimal: bool = option(False, "--minimal", help="state-space: leave out hidden states.")
    sample: str | None = option(
        None,
        "--sample",
        metavar="TIME",
        help="Sampling time, such as 1ms: write difference equations with the declared values.",
    )
    method: str | None = option(
        None,
        "--method",
        choices=("zoh", "tustin", "matched"),
        help="--sample: zoh holds the input between samples, exactly; tustin (bilinear) and matched "
        "(roots) are for controllers.  [default: zoh]",
    )
    prewarp: str | None = option(
        None,
        "--prewarp",
        metavar="FREQUENCY",
        help="--method tustin: frequency at which the response is exact, in Hz or with a unit.",
    )
    is_direct: bool = option(
        False, "--direct", help="--sample: one section for all poles, not one for each pair."
    )
    is_matrix: bool = option(
        False, "--matrix", help="Code: one more function, of the matrix of all functions."
    )
    inputs: str = option("", "--in", **ENDS, help="--matrix: inputs, such as u1,u2.  [default: all]")
    outputs: str = option("", "--out", **ENDS, help="--matrix: outputs, such as y1,y2.  [default: all]")
    strict: bool = option(False, "--strict", help="Exit with code 4 if the verified accuracy falls short.")


@dataclass(frozen=True, eq=False, repr=False)
class RootsOptions:
    """Options of ``symflex roots``, and of what Python finds at poles and zeros.

    Python gives ``band`` in Hz and ``region`` in rad/s.
    """

    tf: str | None = option(None, "--tf", **ONE_TF)
    modes: int | None = option(
        None, "--modes", least=1, help="Only the N lowest modes, and roots at the origin."
    )
    mode: int | None = option(
        None, "--mode", least=1, help="Only mode number N, in order of natural frequency."
    )
    band: Ends | None = option(
        None, "--band", **TWO, help='Only natural frequencies in a band: 0.1 1000, "1 kHz".'
    )
    region: tuple[Stated, Stated, Stated, Stated] | None = option(
        None, "--region", nargs=4, metavar="RE0 RE1 IM0 IM1", help="Only a rectangle of the s plane [rad/s]."
    )
    digits: int | None = option(
        None, "--digits", least=1, most=MOST_DIGITS, help="Correct digits.  [default: 6; 15 in JSON]"
    )
    explain: bool = option(
        False, "--explain", help="Say which constrained system has the zeros as its poles."
    )
    symbolic: bool = option(
        False,
        "--symbolic",
        "--letters",
        help="Formulas of the roots, and when they are real or imaginary.",
    )
    format: str = option("text", "--format", choices=("text", "latex"), **SHOWN, help="Format of --symbolic.")
    sensitivity: Sequence[str] = option(
        (),
        "--sensitivity",
        metavar="[PARAM]",
        multiple=True,
        is_flag=False,
        flag_value="",
        help="How roots move with this parameter, or with every parameter if none is named; may be repeated.",
    )
    spread: Stated | None = option(None, "--spread", **SPREAD)
    is_matrix: bool = option(False, "--matrix", help="Poles and zeros of all pairs as one matrix.")
    inputs: str = option("", "--in", **ENDS, help="--matrix: inputs, such as u1,u2.  [default: all]")
    outputs: str = option("", "--out", **ENDS, help="--matrix: outputs, such as y1,y2.  [default: all]")
    strict: bool = option(False, "--strict", help="Also exit with code 4 if part of the region is left out.")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class RationalOptions:
    """Options of ``symflex rational``."""

    tf: str | None = option(None, "--tf", **ONE_TF)
    modes: int | None = option(
        None, "--modes", least=0, help="Number of modes to keep.  [default: that of [analysis], or 5]"
    )
    form: str = option(
        "product",
        "--form",
        choices=("product", "modal", "state-space"),
        **SHOWN,
        help="product: poles and zeros; modal: residues; state-space: equations with a proved error.",
    )
    error: Stated | None = option(
        None,
        "--error",
        metavar="SHARE",
        help="state-space: as few modes as this error allows, relative to the static value.",
    )
    band: Ends | None = option(None, "--band", **TWO, help="state-space: band of the error.  [default: all]")
    is_matrix: bool = option(False, "--matrix", help="state-space: all pairs as one matrix.")
    inputs: str = option("", "--in", **ENDS, help="--matrix: inputs, such as u1,u2.  [default: all]")
    outputs: str = option("", "--out", **ENDS, help="--matrix: outputs, such as y1,y2.  [default: all]")
    output: str | None = file_option("state-space: write a specification, which every export takes.")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class RespondOptions:
    """Options of ``symflex respond``."""

    tf: str | None = option(None, "--tf", **ONE_TF)
    to: str = option(
        "step",
        "--to",
        **SHOWN,
        metavar="step|impulse|ramp|free|FILE.csv",
        help="Input from t = 0 on; a file has two columns, time_s and the value; free: no input.",
    )
    record: str | None = option(None, "--record", **RECORD)
    columns: str = option("", "--columns", **COLUMNS_OF_RECORD)
    hold: bool = option(
        False, "--hold", help="Hold every value of a file until the next one, as digital controllers do."
    )
    initial: Sequence[str] = option(
        (),
        "--initial",
        metavar="STATE=VALUE",
        multiple=True,
        help="Value before t = 0: x='1 mm', 's*x=0.1 m/s', coil.i=2; may be repeated.",
    )
    until: str | None = option(
        None,
        "--until",
        metavar="TIME",
        help="Last time: 0.5s, '20 ms', 0.5.  [default: until the slowest motion has died away,"
        " or the last time of a file]",
    )
    points: int | None = option(
        None,
        "--points",
        least=2,
        most=1_000_000,
        help=f"Number of times, evenly spaced from 0.  [default: {POINTS}, or the times of a file]",
    )
    digits: int = option(
        12, "--digits", least=1, most=1000, **SHOWN, help="Correct digits of the largest value."
    )
    output: str | None = file_option("File to write: .csv, .pdf, .pgf, .png or .svg.")
    xlim: Ends | None = option(None, "--xlim", **TWO, help="Time axis of a figure [s].")
    ylim: Ends | None = option(None, "--ylim", **TWO, help="Vertical axis of a figure.")
    width: float | str | None = option(None, "--width", **WIDTH)
    font: str | None = option(None, "--font", **FONT)
    shaped: str | None = option(
        None, "--shaped", choices=SHAPERS, help="Pass the input through this shaper of 'symflex shape' first."
    )
    modes: int = option(1, "--modes", **SHAPED_MODES)
    joint: bool = option(False, "--joint", **JOINT)
    strict: bool = option(False, "--strict", help="Exit with code 4 if a value is not certified.")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class ShapeOptions:
    """Options of ``symflex shape``."""

    tf: str | None = option(None, "--tf", **ONE_TF)
    modes: int = option(1, "--modes", **SHAPED_MODES)
    kind: str = option(
        "zv",
        "--kind",
        choices=SHAPERS,
        **SHOWN,
        help="zv: zero vibration; zvd: its derivative by frequency is zero too; ei: extra-insensitive, with "
        "5 % residual vibration.",
    )
    joint: bool = option(False, "--joint", **JOINT)
    digits: int = option(15, "--digits", least=1, most=1000, **SHOWN, help="Correct significant digits.")
    output: str | None = file_option("Figure of residual vibration: .pdf, .pgf, .png or .svg.")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class SweepOptions:
    """Options of ``symflex sweep``.

    Python gives the values of each parameter as a mapping, and the frequencies.
    """

    over: Sequence[str] | Mapping[str, str | Sequence[Stated | Decimal]] = option(
        (),
        "--over",
        multiple=True,
        metavar="NAME=VALUES",
        help="Grid: k=1e4:1e6:log:200, k=1:5:lin:9, m=1,2,5. Random: k=1e4:1e6[:log], k=+-5%. May be "
        "repeated.",
    )
    draws: int | None = option(None, "--monte-carlo", least=1, metavar="N", help="Draw N random points.")
    seed: int = option(1, "--seed", least=0, **SHOWN, help="Seed of the random numbers.")
    of: str = option(
        "poles", "--of", choices=("poles", "zeros", "response", "margins"), **SHOWN, help="What to compute."
    )
    tf: str | None = option(None, "--tf", **ONE_TF)
    modes: int | None = option(None, "--modes", least=1, help="Only the N lowest modes.")
    band: Ends | None = option(
        None, "--band", **TWO, help='Only this band of frequencies: 0.1 1000, "1 kHz".'
    )
    count: int | None = option(
        None, "--count", least=2, most=100_000, help=f"Frequencies of a response.  [default: {FREQUENCIES}]"
    )
    gain: str | None = option(
        None, "--gain", metavar="K", help="margins: the parameter that is the loop's gain."
    )
    output: str | Path | None = option(
        None, "-o", "--output", is_path=True, help="File to write: .nc, .npz, .csv or .parquet."
    )
    fresh: bool = option(False, "--fresh", help="Discard the points that an earlier run kept in FILE.part.")
    workers: int | None = option(
        None, "--workers", least=1, most=1024, help="Number of processes.  [default: one per processor]"
    )
    scheduler: str | None = option(
        None, "--scheduler", metavar="tcp://HOST:PORT", help="Compute on this dask.distributed cluster."
    )
    as_json: bool = option(False, "--json", help="Print a summary as JSON.")


@dataclass(frozen=True, eq=False, repr=False)
class StabilityOptions:
    """Options of ``symflex stability``.

    Python gives ``limits`` in SI units, None for none, and ``up_to`` in Hz.
    """

    gain: str = option("", "--gain", metavar="K", help="Parameter that is the loop's gain.")
    limits: tuple[Stated | None, Stated | None] | None = option(
        None,
        "--range",
        **TWO,
        help='Only gains between two values: 0 1e4, "1 kN/m" inf.  [default: every gain of its assumed sign; '
        "with beams, rods or delays up to 100 times its value]",
    )
    up_to: Stated | None = option(
        None,
        "--up-to",
        metavar="FREQUENCY",
        help="With infinitely many poles: highest frequency counted, in Hz or with a unit.",
    )
    digits: int | None = option(
        None, "--digits", least=1, most=1000, help="Correct significant digits.  [default: 15]"
    )
    over: Sequence[str] = option(
        (),
        "--over",
        multiple=True,
        metavar="P",
        help="In place of --gain: any parameter, such as a delay or a length; twice: a chart. For "
        "a chart --range takes the name first: --range T 0 '5 ms'.",
    )
    ranges: Sequence[tuple[str, Stated, Stated]] = option(
        (), "--range-of", nargs=3, multiple=True, hidden=True, metavar="P LO HI"
    )
    resolve: Stated = option(
        "1 %", "--resolve", metavar="SHARE", **SHOWN, help="Share of a chart that may stay undecided."
    )
    peaks: bool = option(False, "--peaks", help="With beams or delays too: peaks of S and T, disk margin.")
    is_all: bool = option(False, "--all", help="Print all boundaries, not only the first ten.")
    symbolic: bool = option(
        False,
        "--symbolic",
        "--letters",
        help="Symbolic conditions; with --over twice, their boundary as a curve.",
    )
    of: str = option(
        "poles", "--of", choices=("poles", "zeros"), **SHOWN, help="Whose conditions --symbolic prints."
    )
    tf: str | None = option(None, "--tf", **ONE_TF)
    format: str = option("text", "--format", choices=("text", "latex"), **SHOWN, help="Format of --symbolic.")
    spread: Stated | None = option(None, "--spread", **SPREAD)
    is_matrix: bool = option(
        False, "--matrix", help="Close a loop from each output to the input in its place, with minus."
    )
    inputs: str = option("", "--in", **ENDS, help="--matrix: inputs, such as u1,u2.  [default: all]")
    outputs: str = option("", "--out", **ENDS, help="--matrix: outputs, such as y1,y2.  [default: all]")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class ContactOptions:
    """Options of ``symflex contact``. Python gives SI units."""

    port: str | None = option(
        None, "--port", metavar="PORT", help="Port of [ports], or node.  [default: the only one]"
    )
    environment: str = option(
        "",
        "--environment",
        required=True,
        metavar="LAW",
        help='What touches it: "k_e + b_e*s + m_e*s^2", spring, damper, mass, spring-damper, wall, any, or '
        "FILE.toml:PORT.",
    )
    over: Sequence[str] = option(
        (),
        "--over",
        multiple=True,
        metavar="P",
        help="A parameter, of the environment or of SPEC; twice: a chart.  [default: what has no value]",
    )
    limits: tuple[Stated | None, Stated | None] | None = option(
        None,
        "--range",
        **TWO,
        help='Only values between two: 0 "5 kN/m"; the name goes first if there are several.  [default: '
        "all positive ones of the environment; else as for symflex stability]",
    )
    ranges: Sequence[tuple[str, Stated, Stated]] = option(
        (), "--range-of", nargs=3, multiple=True, hidden=True, metavar="P LO HI"
    )
    up_to: Stated | None = option(
        None, "--up-to", metavar="VALUE", help="Largest value of the environment's one letter."
    )
    digits: int | None = option(
        None, "--digits", least=1, most=1000, help="Correct significant digits.  [default: 15]"
    )
    resolve: Stated = option("1 %", "--resolve", metavar="SHARE", **SHOWN, help="As for symflex stability.")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class PeakOptions:
    """Options of ``symflex peak``. Python gives Hz."""

    tf: str | None = option(None, "--tf", **ONE_TF)
    band: Ends | None = option(None, "--band", **TWO, help="Only frequencies in a band.  [default: all]")
    digits: int = option(12, "--digits", least=1, most=1000, **SHOWN, help="Correct significant digits.")
    is_h2: bool = option(False, "--h2", help="The H2 norm instead: the RMS of the output under white noise.")
    noise: str = option("", "--noise", metavar="EXPR", help="--h2: shape the noise, such as 'w_0/(s + w_0)'.")
    is_matrix: bool = option(False, "--matrix", help="The largest singular value of all pairs as one matrix.")
    inputs: str = option("", "--in", **ENDS, help="--matrix: inputs, such as u1,u2.  [default: all]")
    outputs: str = option("", "--out", **ENDS, help="--matrix: outputs, such as y1,y2.  [default: all]")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class PassivityOptions:
    """Options of ``symflex passivity``."""

    ports: Sequence[str] = option(
        (),
        "--port",
        multiple=True,
        metavar="PORT",
        help="Port of [ports], or node; twice: a machine with two ports.  [default: the only one]",
    )
    over: Sequence[str] = option(
        (), "--over", multiple=True, metavar="P", help="For which values of a parameter; twice: of two."
    )
    limits: tuple[Stated | None, Stated | None] | None = option(
        None, "--range", **TWO, help="Only values between two; with two parameters the name goes first."
    )
    ranges: Sequence[tuple[str, Stated, Stated]] = option(
        (), "--range-of", nargs=3, multiple=True, hidden=True, metavar="P LO HI"
    )
    symbolic: bool = option(False, "--symbolic", "--letters", help="Symbolic conditions, of lumped models.")
    digits: int = option(12, "--digits", least=1, most=100, **SHOWN, help="Correct significant digits.")
    output: str | None = file_option("Figure of the real part over frequency: FILE.pdf, .png, .svg.")
    as_json: bool = option(False, "--json", **JSON)

    @property
    def stability(self) -> StabilityOptions:
        """What says the ranges of parameters."""
        return StabilityOptions("", self.limits, None, None, self.over, self.ranges)


@dataclass(frozen=True, eq=False, repr=False)
class ColocationOptions:
    """Options of ``symflex colocation``. Python gives degrees, decibels and Hz."""

    tf: str = option("", "--tf", required=True, metavar="OUT/IN", help="Output away from the actuator.")
    reference: str = option("", "--with", required=True, metavar="OUT2/IN", help="Colocated output.")
    phase: Stated = option("10 deg", "--phase", **SHOWN, metavar="ANGLE", help="Largest phase difference.")
    magnitude: Stated = option("1 dB", "--magnitude", **SHOWN, metavar="DB", help="Largest difference.")
    band: Ends | None = option(
        None, "--band", **TWO, help="Frequencies to examine.  [default: band of [analysis]]"
    )
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class PlotOptions:
    """Options of ``symflex plot``."""

    kind: str = option("")
    tfs: Sequence[str] = option((), "--tf", **SOME_TFS, help="Draw this transfer function; may be repeated.")
    gain: str | None = option(
        None, "--gain", metavar="K", help="Parameter that is the loop's gain, for figures of a loop."
    )
    band: Ends | None = option(None, "--band", **TWO, help='Frequencies shown: 0.1 1000, "1 kHz".')
    xlim: Ends | None = option(
        None, "--xlim", **TWO, help="Ends of the horizontal axis; rad/s in an s plane."
    )
    ylim: Ends | None = option(None, "--ylim", **TWO, help="Ends of the vertical axis; dB in a Bode plot.")
    phase: Ends | None = option(None, "--phase", **TWO, help="Ends of the phase axis of a Bode plot [deg].")
    limits: tuple[Stated | None, Stated | None] | None = option(
        None, "--range", **TWO, help="First and last gain of a locus, or of the parameter --over."
    )
    over: Sequence[str] = option(
        (), "--over", multiple=True, metavar="P", help="Parameter of a figure of stability; twice: a chart."
    )
    ranges: Sequence[tuple[str, Stated, Stated]] = option(
        (), "--range-of", nargs=3, multiple=True, hidden=True, metavar="P LO HI"
    )
    resolve: Stated = option("1 %", "--resolve", metavar="SHARE", **SHOWN, help="As for symflex stability.")
    box: bool = option(False, "--box", help="Draw the largest box about the values with the same count.")
    modes: int | None = option(None, "--modes", least=1, help="Show the N lowest modes.")
    output: str | None = file_option("File to write: .pdf, .pgf, .svg or .png; .gif of shapes.")
    width: float | str | None = option(None, "--width", **WIDTH)
    font: str | None = option(None, "--font", **FONT)
    until: str | None = option(
        None, "--until", metavar="TIME", help="Last time of a step or impulse response: 0.5s."
    )
    record: str | None = option(None, "--record", **RECORD)
    columns: str = option("", "--columns", **COLUMNS_OF_RECORD)
    asymptotes: bool = option(
        False, "--asymptotes", help="Draw asymptotes of lumped functions in a Bode plot."
    )
    is_matrix: bool = option(
        False, "--matrix", help="poles_zeros, nyquist: all functions, or those of --tf, as one matrix."
    )
    verdict: bool = option(False, "--verdict", help="Write above the figure whether the system is stable.")
    spread: Stated | None = option(None, "--spread", **SPREAD)
    port: str | None = option(
        None,
        "--port",
        metavar="PORT",
        help="Port or node of a figure of passivity or z-width.  [default: the only one]",
    )
    environment: str | None = option(
        None, "--environment", metavar="LAW", help="What is at the port, for z-width; see symflex contact."
    )
    at: Sequence[Stated] = option(
        (), "--at", multiple=True, metavar="F", help="Frequency of a deflection: 30Hz; may be repeated."
    )

    @property
    def stability(self) -> StabilityOptions:
        """What a figure of stability asks for."""
        return StabilityOptions("", self.limits, None, None, self.over, self.ranges, self.resolve)


@dataclass(frozen=True, eq=False, repr=False)
class DrawOptions:
    """Options of ``symflex draw``."""

    values: bool = option(False, "--values", help="Label symbols with values and units.")
    output: str | None = file_option("File to write: .pdf, .pgf, .svg or .png.")
    width: str | None = option(
        None, "--width", metavar=WIDTHS, help="Width of the drawing: 88.5 mm, 170 mm or a number in mm."
    )
    font: str | None = option(None, "--font", **FONT)


@dataclass(frozen=True, eq=False, repr=False)
class RefereeOptions:
    """Options of ``symflex referee``."""

    paper: str = option("", nargs=1, required=True, is_path=True, metavar="PAPER.tex")
    models: Places = option(
        (),
        "--model",
        multiple=True,
        required=True,
        is_path=True,
        metavar="SPEC",
        help="Specification that the formulas are compared with; may be repeated.",
    )
    allow_outside: Places = option((), "--allow-outside", **OUTSIDE)
    output: str | None = file_option("Page to write, .html: each formula with its verdict.")
    errata: str | None = option(None, "--errata", is_path=True, help="List of errata to write, as LaTeX.")
    strict: bool = option(False, "--strict", help="Exit with code 4 unless every formula and table is right.")
    as_json: bool = option(False, "--json", **JSON)


@dataclass(frozen=True, eq=False, repr=False)
class AuditOptions:
    """Options of ``symflex audit``."""

    tfs: Sequence[str] = option(
        (), "--tf", **SOME_TFS, help="Only the formula of this transfer function; may be repeated."
    )
    latex: str | None = option(
        None, "--latex", is_path=True, metavar="FILE.tex", help="Judge the formulas of a paper instead."
    )
    equation: str | None = option(
        None, "--equation", metavar="LABEL", help="With --latex: only the equation with this label or tag."
    )
    strict: bool = option(False, "--strict", help="Exit with code 4 unless every formula and table is right.")
    as_json: bool = option(False, "--json", **JSON)


SEGMENTS: Final = {
    "least": 1,
    "metavar": "N",
    "help": "Time records: average this many segments by Welch's method.  [default: depends on the input]",
}
ESTIMATOR: Final = {
    "choices": ("h1", "h2"),
    **SHOWN,
    "help": "Time records: h1 for noise at the output, h2 for noise at the input.",
}
WINDOW_OF_DATA: Final = {
    "metavar": "NAME",
    "help": "Window of the estimate, hann, none or exponential:SECONDS (its time constant), if the file does "
    "not give it; for a time record, the window to use.",
}


@dataclass(frozen=True, eq=False, repr=False)
class FitOptions:
    """Options of ``symflex fit``. Python gives data in place of their paths, too."""

    data: Sequence[object] = option((), nargs=-1, is_path=True)
    records: str = option(
        "",
        "--records",
        metavar="u=FILE,y=FILE",
        help="A time record with one channel a file, in place of DATA: u is the input, y an output.",
    )
    base: str | Path | None = option(
        None, "--base", is_path=True, help="Specification whose transfer function the resonances multiply."
    )
    allow_outside: Places = option((), "--allow-outside", **OUTSIDE)
    tfs: Sequence[str] = option(
        (),
        "--tf",
        **SOME_TFS,
        help="Transfer function of --base or --model; one for each response.  Without: responses to fit.",
    )
    model: str | Path | None = option(
        None,
        "--model",
        is_path=True,
        help="Specification whose parameters are fitted in place of resonances.",
    )
    free: str = option("", "--free", metavar="NAMES", help="Parameters of --model to fit, such as k,b,J_2.")
    modes: int | None = option(
        None, "--modes", least=1, most=50, help="Number of resonances.  [default: chosen by --criterion]"
    )
    start: str = option(
        "auto",
        "--start",
        choices=("auto", "peaks", "vector", "aaa"),
        **SHOWN,
        help="Start of the fit; auto tries all and keeps the best.",
    )
    criterion: str = option(
        "bic", "--criterion", choices=("bic", "aicc"), **SHOWN, help="Chooses the number of resonances."
    )
    band: tuple[float, float] | None = option(
        None, "--band", type=float, **TWO, help="Use only lines between these frequencies [Hz]."
    )
    is_gain_free: bool = option(False, "--gain", help="Fit a gain on the base, too.")
    is_lag_free: bool = option(False, "--lag", help="Fit a sensor lag, 1/(1 + T s).")
    is_lag_signed: bool = option(False, "--signed-lag", help="Like --lag, but T may be negative (a lead).")
    is_delay_free: bool = option(False, "--delay", help="Fit a delay, exp(-T s), T not negative.")
    slope: int | None = option(
        None, "--slope", least=-6, most=6, help="Without --base: power of s.  [default: chosen by the fit]"
    )
    columns: str = option(
        "",
        "--columns",
        metavar="WORDS",
        help="Columns of the file, such as f,re,im or f_khz,-,mag_db,phase_deg; of arrays f=NAME,h=NAME; "
        "s21; of time records t,u,y.",
    )
    first_hz: float = option(
        0.0, "--from", type=float, least=0, help="First frequency of data that list none [Hz]; needs --step."
    )
    step_hz: float | None = option(None, "--step", type=float, least=0, help="Spacing of the lines [Hz].")
    averages: float | None = option(
        None, "--averages", type=float, least=1, help="Number of averages, if the file does not give it."
    )
    window: str | None = option(None, "--window", **WINDOW_OF_DATA)
    segments: int | None = option(None, "--segments", **SEGMENTS)
    estimator: str = option("h1", "--estimator", **ESTIMATOR)
    hold: str = option(
        "auto",
        "--hold",
        choices=("auto", "held", "joined", "smooth"),
        **SHOWN,
        help="Time records: the input is held between samples, lines join them, or it has no frequency above "
        "half the sampling rate.",
    )
    is_validated: bool = option(
        False,
        "--validate",
        help="Time records: fit the first half alone, too, and compare its prediction with the second half.",
    )
    driving: str | None = option(
        None,
        "--driving",
        metavar="OUT/IN",
        help="Response at the driven point: fit it, and compute mass-normalised mode shapes from all "
        "responses.",
    )
    output: str | None = file_option("Specification to write.")
    loop: str | None = option(
        None,
        "--loop",
        metavar="K",
        help="Also write a loop that feeds back the first response with the gain K, for 'symflex stability "
        "--gain K'.",
    )
    figure: str | None = option(
        None,
        "--plot",
        is_path=True,
        help="Figure to write: data, fit and residual of all responses; .pdf, .svg or .png.",
    )
    order_figure: str | None = option(
        None, "--plot-order", is_path=True, help="Stabilisation diagram to write: poles over model order."
    )
    strict: bool = option(False, "--strict", help="Exit with code 4 and write nothing if the fit is poor.")
    as_json: bool = option(False, "--json", **JSON)

    @property
    def fits_parameters(self) -> bool:
        """Whether parameters of a specification are fitted; SF902 for options of resonances beside these."""
        if self.model is None and not self.free:
            return False
        if self.model is None:
            raise refused("--free is for the parameters of --model SPEC")
        for one in fields(self):
            if one.name in OF_RESONANCES and getattr(self, one.name) != one.default:
                raise refused(f"{one.metadata['flags'][0]} is for fits of resonances, without --model")
        return True


OF_RESONANCES = frozenset(
    "base modes start criterion is_gain_free is_lag_free is_lag_signed is_delay_free slope is_validated "
    "driving loop order_figure".split()
)
"""Options of :class:`FitOptions` that only fits of resonances have."""


@dataclass(frozen=True, eq=False, repr=False)
class MeasureOptions:
    """Options of ``symflex measure``."""

    tf: str | None = option(None, "--tf", **ONE_TF)
    output: str = option(
        "", "-o", "--output", is_path=True, required=True, help="File to write: .csv, .npz or .uff."
    )
    band: tuple[float, float] | None = option(
        None, "--band", type=float, **TWO, help="Frequencies to write [Hz].  [default: band of [analysis]]"
    )
    spacing: float | None = option(
        None, "--spacing", type=float, metavar="X", help="Spacing of lines [Hz].  [default: HI/800]"
    )
    averages: int = option(40, "--averages", least=1, **SHOWN, help="Number of records to average.")
    noise: float = option(
        0.03, "--noise", type=float, least=0, **SHOWN, help="Ratio of sensor noise to signal, rms."
    )
    rolloff: float | None = option(
        5000.0, "--rolloff", type=float, least=0, **SHOWN, help="Corner of the accelerometer [Hz], or 0."
    )
    seed: int = option(1, "--seed", least=0, **SHOWN, help="Seed of the random numbers.")
    columns: str = option("", "--columns", metavar="WORDS", help="Columns of a time record: t,u,y.")
    window: str | None = option(None, "--window", **WINDOW_OF_DATA)
    segments: int | None = option(None, "--segments", **SEGMENTS)
    estimator: str = option("h1", "--estimator", **ESTIMATOR)


@dataclass(frozen=True, eq=False, repr=False)
class LiveOptions:
    """Options of ``symflex live``."""

    specs: Places = option((), nargs=-1, required=True, is_path=True, metavar="SPEC...")
    tfs: Sequence[str] = option((), "--tf", **ONLY_TFS)
    output: str | None = file_option("Page to write, a .html.  [default: named after SPEC, or live.html]")
    allow_outside: Places = option((), "--allow-outside", **OUTSIDE)


@dataclass(frozen=True, eq=False, repr=False)
class ReportOptions:
    """Options of ``symflex report``."""

    specs: Places = option((), nargs=-1, required=True, is_path=True, metavar="SPEC...")
    allow_outside: Places = option((), "--allow-outside", **OUTSIDE)
    output: str | Path = option(
        "report",
        "-o",
        "--output",
        **SHOWN,
        is_path=True,
        metavar="DIR",
        help="Folder to write; files of the same name are replaced, others stay.",
    )
    live: bool = option(False, "--live", help="Write a page with sliders for every model, and link it.")
    pdf: bool | None = option(
        None, "--pdf/--no-pdf", help="Write report.pdf.  [default: if pdflatex is installed]"
    )
    day: str | None = option(
        None,
        "--date",
        metavar="YYYY-MM-DD",
        help="Date to print, or 'none'.  [default: today, or SOURCE_DATE_EPOCH]",
    )
    jobs: int | None = option(
        None, "-j", "--jobs", least=1, most=64, help="Models at once.  [default: one per processor]"
    )


def exact(number: float | Fraction) -> Fraction:
    """Return the shortest decimal that prints a number.

    >>> exact(0.1)
    Fraction(1, 10)
    """
    return number if isinstance(number, Fraction) else Fraction(Decimal(repr(float(number))))


def finite(number: float | Fraction, flag: str) -> Fraction:
    """Return the shortest decimal that prints a number; SF902 unless it is finite."""
    if not isfinite(number):
        raise refused(f"{flag} is a finite number, not {number}")
    return exact(number)


def checked_digits(digits: int) -> int:
    """Return how many digits are asked for; SF902 for none or too many."""
    if not 1 <= digits <= MOST_DIGITS:
        raise refused(f"digits must be from 1 to {MOST_DIGITS}, not {digits}")
    return digits


def band_ends(band: Ends, *, above_zero: bool = False) -> tuple[Fraction, Fraction]:
    """Return the ends of a band [Hz]; SF902 for texts that are no frequencies, the lower one first.

    >>> band_ends(("0.1", "1 kHz"))
    (Fraction(1, 10), Fraction(1000, 1))
    """
    low, high = (frequency(end, "--band", "0.1 or '1 kHz'", is_hertz=True) for end in band)
    if isinstance(band[0], str) and (not 0 <= low < high or (above_zero and not low)):
        above = " above 0" if above_zero else ""
        raise refused(f"--band takes two frequencies in Hz{above}, the lower one first")
    return low, high


def frequency(given: Stated, flag: str, example: str, *, is_hertz: bool = False) -> Fraction:
    """Return a frequency in Hz, or in rad/s, from a number or a quantity that counts per second."""
    if not isinstance(given, str):
        return finite(given, flag.removeprefix("--"))
    from symflex.model.analysis import in_limits
    from symflex.model.dimensions import PER_SECOND
    from symflex.model.model import PI_NEARLY

    wrong = refused(f"{flag} takes numbers such as {example}, found '{given[:60]}'")
    quantity = _quantity(given, flag, wrong)
    if quantity.unit and quantity.dimension != PER_SECOND:
        raise wrong
    number = in_limits(quantity)
    if not quantity.unit or bool(quantity.cycles) == is_hertz:
        return number
    return number / (2 * PI_NEARLY) if is_hertz else number * 2 * PI_NEARLY


def duration(given: str, flag: str, *, or_zero: bool = False) -> Fraction:
    """Return a positive time [s], or 0 where that is one; SF902 for a text that is none.

    >>> duration("20 ms", "--until")
    Fraction(1, 50)
    """
    from symflex.model.analysis import in_limits
    from symflex.model.dimensions import SECOND

    wrong = refused(f"{flag} takes a positive time such as 0.5 or '20 ms', found '{given[:60]}'")
    quantity = _quantity(given, flag, wrong)
    if quantity.unit and quantity.dimension != SECOND:
        raise wrong
    seconds = in_limits(quantity)
    if not (seconds > 0 or (or_zero and seconds == 0)):
        raise wrong
    return seconds


def highest_frequency(given: Stated) -> float:
    """Return a positive frequency [Hz]."""
    value = float(frequency(given, "--up-to", "100 or '1 kHz'", is_hertz=True))
    if not value > 0:
        flag = "--up-to" if isinstance(given, str) else "up_to_hz"
        raise refused(f"{flag} takes a positive frequency")
    return value


def plain_number(given: Stated, units: tuple[str, ...]) -> float:
    """Return the number a text says, with or without one of some units; not a number where it says none."""
    if not isinstance(given, str):
        return float(given)
    for unit in units:
        given = given.strip().removesuffix(unit)
    try:
        return float(given)
    except ValueError:
        return nan


def tolerance(given: Stated, flag: str, units: tuple[str, ...], example: str) -> float:
    """Return a largest difference; SF902 for a text that is not a positive number."""
    value = plain_number(given, units)
    if isinstance(given, str) and not 0 < value < inf:
        raise refused(f"{flag} takes a positive number such as '{example}', found '{given[:40]}'")
    return value


def share_of(given: Stated, flag: str, most: float = 1) -> Fraction:
    """Return a share of one, given in percent or as a number; SF902 for none between 0 and ``most``.

    >>> share_of("1 %", "--short"), share_of(0.1, "--spread")
    (Fraction(1, 100), Fraction(1, 10))
    """
    value = plain_number(given, ("%",))
    is_percent = isinstance(given, str) and "%" in given
    if not 0 < value < (100 * most if is_percent else most):
        raise refused(f"{flag} takes a share such as '1 %', found '{str(given)[:40]}'")
    return Fraction(Decimal(str(value))) / (100 if is_percent else 1)


def axis_ends(given: Ends | None, flag: str, *, is_frequency: bool = False) -> tuple[float, float] | None:
    """Return the ends of an axis, the lower one first: numbers, or frequencies [rad/s]; SF902 for others."""
    if given is None:
        return None
    if is_frequency:
        low, high = (float(frequency(end, flag, "-10 or '3 rad/s'")) for end in given)
    else:
        low, high = (plain_number(end, ("dB", "deg", "°")) for end in given)
        for text, end in zip(given, (low, high), strict=True):
            if not isfinite(end):
                raise refused(f"{flag} takes numbers such as -60, found '{str(text)[:40]}'")
    if not low < high:
        raise refused(f"{flag} takes two numbers, the lower one first")
    return low, high


def gain_ends(
    limits: tuple[Stated | None, Stated | None] | None, parameter: ModelParameter
) -> tuple[Fraction | None, Fraction | None] | None:
    """Return the range of a gain in SI units, None for an end that is infinite."""
    return None if limits is None else (_gain(limits[0], parameter), _gain(limits[1], parameter))


def _gain(given: Stated | None, parameter: ModelParameter) -> Fraction | None:
    if given is None or not isinstance(given, str):
        return None if given is None or isinf(given) else exact(given)
    if given.strip().lower() in UNBOUNDED:
        return None
    from symflex.model.settings import value_in_unit
    from symflex.quantities import unit_of

    wrong = refused(f"--range takes values such as 0, 1e4 or inf, found '{given[:60]}'")
    quantity = _quantity(given, "--range", wrong)
    dimension = unit_of(parameter.unit).dimension if parameter.unit else None
    if quantity.unit and quantity.dimension != dimension:
        measured = f"is in '{parameter.unit}'" if parameter.unit else "is a number without a unit"
        raise UsageError(
            Diagnostic("SF203", f"'{parameter.name}' {measured}, the range is in '{quantity.unit}'")
        )
    return value_in_unit(parameter, quantity).nearly


def _quantity(given: str, flag: str, wrong: UsageError) -> Quantity:
    from symflex.quantities import parse_quantity

    try:
        return parse_quantity(Text.alone(flag, given))
    except SpecError as error:
        (first, *_) = error.diagnostics
        if first.code == "SF103":
            # A quantity, but of a size that nothing here computes with.
            message = f"{flag} '{given[:60]}': {first.message}"
            raise UsageError(Diagnostic("SF103", message, None, first.hint)) from None
        raise wrong from None
