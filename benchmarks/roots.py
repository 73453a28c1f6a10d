"""Poles of beams and chains, against ``mpmath.findroot`` given perfect guesses, cxroots and ``numpy.roots``.

Each way runs in a process of its own and counts in processor time. What is timed begins with a bound transfer
function: loading, deriving and binding are over. The sliding-free beam (derivations/eppinger1988) has E I =
rho A = l = 1 here, so that s = j x^2 with tan x + tanh x = 0, and s = 2 q^2 with sinh 2q + sin 2q = 0.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mpmath
from mpmath import mp, mpc, mpf

import symflex
from benchmarks.measure import OWN, Claim, Extent, Measured, Measurement, run_snippet, times_as_fast
from symflex.roots import Mode, Modes, Position, Rectangle
from symflex.roots.distributed.side import Side
from symflex.roots.locate import locate
from symflex.roots.polynomial_roots import in_order
from symflex.roots.root import exact_fraction

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from symflex.roots import Region, Root
    from symflex.transfer import BoundTransferFunction

CXROOTS_PYTHON = "SYMFLEX_CXROOTS_PYTHON"
"""Environment variable: the interpreter that has cxroots, when it is not this one."""

MODES = 200
MILLION = 1_000_000
FASTER_THAN_FINDROOT = 5.0
FASTER_THAN_CXROOTS = 300.0
CEILINGS = {"damped": 3.0, "undamped": 1.0}
"""Seconds for all poles and zeros of 200 masses at 50 digits."""
DAMPED_BOX = (-5000, 1, -20000, 20000)
"""[rad/s]."""
DAMPED_POLES = 24
"""In this box; the thirteenth pair lies above it."""

BEAM = 'type = "beam", E = "1 Pa", I = "1 m^4", rho = "1 kg/m^3", A = "1 m^2", l = "1 m"'
SLIDING_FREE = f"""
symflex = 1
[elements]
arm   = {{ {BEAM}, between = ["p", "q"] }}
slide = {{ type = "slider", at = "p" }}
[inputs]
F = {{ force = "p" }}
[outputs]
V = "s*p"
"""
CANTILEVER = Path(__file__).parents[1] / "derivations" / "classics" / "kelvin_voigt_cantilever.toml"
MASSES = 200
LOSS = Fraction(3, 10)


# ------------------------------------------------------------------------------------ what is measured


def solve(model: BoundTransferFunction, region: Region, digits: int) -> tuple[Root, ...]:
    """Return the poles in a region by the engine for undamped functions."""
    return _poles("lossless", model, region, digits)


def solve_generally(model: BoundTransferFunction, modes: int, digits: int) -> tuple[Root, ...]:
    """Return the lowest poles by the engine for any distributed function, not the one for undamped ones."""
    return _poles("guess-and-prove", model, Modes(modes), digits)


def solve_one(model: BoundTransferFunction, mode: int, digits: int) -> Root:
    """Return the pole of one number, without those below it."""
    (root,) = (root for root in _poles("lossless", model, Mode(mode), digits) if root.im > 0)
    return root


def _poles(engine: str, model: BoundTransferFunction, region: Region, digits: int) -> tuple[Root, ...]:
    side = Side(model, model.den, digits, engines=(engine,))
    if isinstance(region, Mode):
        side.numbered(region.number)
        return in_order(side.roots)
    side.search(region)
    assert side.prove(region).is_complete
    ordered = in_order(side.roots)
    inside = zip(ordered, region.classify(ordered), strict=True)
    return tuple(root for root, position in inside if position is not Position.OUTSIDE)


# ------------------------------------------------------------------------------------------- the models


def sliding_free() -> BoundTransferFunction:
    """Return V/F at the driven end of the sliding-free beam."""
    return symflex.loads(SLIDING_FREE).transfer_function("V", "F").bind().bound


def damped_cantilever() -> BoundTransferFunction:
    """Return the tip receptance of the Kelvin-Voigt cantilever with a mass and a dashpot at its tip."""
    return symflex.load(CANTILEVER).transfer_function("X_tip", "F").bind().bound


def chain(*, damped: bool) -> BoundTransferFunction:
    """Return the driving point of 200 masses in a row, held at the other end: degree 400."""
    lines = []
    for k in range(MASSES):
        ends = f'["{f"x_{k - 1}" if k else "ground"}", "x_{k}"]'
        lines.append(f'm_{k} = {{ type = "mass", at = "x_{k}", m = "1 kg" }}')
        lines.append(f'k_{k} = {{ type = "spring", between = {ends}, k = "1 N/m" }}')
        if damped:
            loss = f"{float(LOSS)} N*s/m"
            lines.append(f'b_{k} = {{ type = "damper", between = {ends}, b = "{loss}" }}')
    last = f"x_{MASSES - 1}"
    text = "\n".join(["symflex = 1", "[elements]", *lines])
    text += f'\n[inputs]\nF = {{ force = "{last}" }}\n[outputs]\nX = "{last}"\n'
    return symflex.loads(text).transfer_function("X", "F").bind().bound


# ---------------------------------------------------------------------------------------- ways to do it


def seconds(model: BoundTransferFunction, task: Callable[[BoundTransferFunction], Any]) -> tuple[float, Any]:
    """Return the processor time of a task, and what it returned."""
    begin = time.process_time()
    result = task(model)
    return time.process_time() - begin, result


def upper(poles: Sequence[Root]) -> list[mpc]:
    """Return those with a positive imaginary part, exactly."""
    return [_exact(root) for root in poles if root.im > 0]


def _exact(root: Root) -> mpc:
    parts = (exact_fraction(root.re), exact_fraction(root.im))
    with mp.workprec(max(part.numerator.bit_length() for part in parts) + 1):
        return mpc(*(mpf(part.numerator) / part.denominator for part in parts))  # over a power of two


def guess(mode: int) -> mpc:
    """Return q = (1 + j)/2 x of a mode, to double precision: what findroot is handed."""
    with mp.workdps(16):
        x = mpmath.findroot(
            lambda x: mpmath.sin(x) + mpmath.cos(x) * mpmath.tanh(x), (mode - mpf("0.25")) * mpmath.pi
        )
        return mpc(x, x) / 2


def findroot_beam(guesses: Sequence[mpc], digits: int) -> list[mpc]:
    """Return s = 2 q^2 by mpmath, each from a guess of q.

    The function is divided by its size, a constant per mode; without that no tolerance could be met.
    """
    with mp.workdps(digits):
        found = []
        for q in guesses:
            size = mpmath.exp(2 * q.real)
            root = mpmath.findroot(lambda q, size=size: (mpmath.sinh(2 * q) + mpmath.sin(2 * q)) / size, q)
            found.append(2 * root**2)
        return found


def time_beam(modes: int, digits: int) -> float:
    """Return the seconds for the lowest modes, after comparing them with their asymptotics and equation."""
    taken, result = seconds(sliding_free(), lambda model: solve(model, Modes(modes), digits))
    _compare(upper(result), modes, digits)
    return taken


def time_generally(modes: int, digits: int) -> float:
    """Return the seconds of the general engine for the lowest modes."""
    taken, result = seconds(sliding_free(), lambda model: solve_generally(model, modes, digits))
    _compare(upper(result), modes, digits)
    return taken


def time_one(mode: int, digits: int) -> float:
    """Return the seconds for one mode by its number."""
    taken, root = seconds(sliding_free(), lambda model: solve_one(model, mode, digits))
    with mp.workdps(digits + 10):
        # tan x + tanh x = 0, and tanh x is one: x = (n - 1/4) pi.
        expected = ((mode - mpf("0.25")) * mpmath.pi) ** 2
        _agree([_exact(root).imag], [expected], digits)
    return taken


def time_findroot(modes: int, digits: int, first: int = 1) -> float:
    """Return the seconds of mpmath for the same, from guesses that are right to sixteen digits."""
    guesses = [guess(mode) for mode in range(first, first + modes)]
    begin = time.process_time()
    findroot_beam(guesses, digits)
    return time.process_time() - begin


def time_damped_box(digits: int) -> float:
    """Return the seconds for the damped cantilever's poles in the box that contains 24."""
    region = Rectangle(*(Fraction(side) for side in DAMPED_BOX))
    taken, poles = seconds(
        damped_cantilever(), lambda model: _poles("guess-and-prove", model, region, digits)
    )
    number = sum(root.multiplicity for root in poles)
    if number != DAMPED_POLES:
        message = f"{number} poles in the box"
        raise RuntimeError(message)
    return taken


def time_chain(digits: int, *, damped: bool) -> float:
    """Return the seconds for all poles and zeros of the chain."""
    taken, result = seconds(chain(damped=damped), lambda model: locate(model, None, digits))
    with mp.workdps(digits + 10):
        found = sorted(upper(result.poles), key=abs)
        _agree(found, sorted((s for s in chain_poles(damped=damped) if s.imag > 0), key=abs), digits)
    return taken


def chain_poles(*, damped: bool) -> list[mpc]:
    """Return the poles in closed form: s^2 + mu (1 + b s) = 0, mu = 4 sin^2((2 j - 1) pi/(2 (2 N + 1)))."""
    b = mpf(LOSS.numerator) / LOSS.denominator if damped else mpf(0)
    poles = []
    for j in range(1, MASSES + 1):
        mu = 4 * mpmath.sin((2 * j - 1) * mpmath.pi / (2 * (2 * MASSES + 1))) ** 2
        root = mpmath.sqrt(mpc((mu * b / 2) ** 2 - mu))
        poles += [-mu * b / 2 + root, -mu * b / 2 - root]
    return poles


def numpy_in_the_wrong_half_plane() -> int:
    """Return how many poles of the damped chain ``numpy.roots`` puts into the right half-plane."""
    import numpy as np  # slow to import; only here

    before, now = np.array([Fraction(1)]), np.array([Fraction(1), LOSS, Fraction(1)])  # one mass, descending
    joint = np.array([LOSS, Fraction(1)])
    mass = np.array([Fraction(1), 2 * LOSS, Fraction(2)])
    square = np.convolve(joint, joint)
    for _ in range(MASSES - 1):
        longer = np.convolve(mass, now)
        longer[-len(before) - 2 :] -= np.convolve(square, before)
        before, now = now, longer
    return int((np.roots(now.astype(float)).real > 0).sum())


def _compare(found: list[mpc], modes: int, digits: int) -> None:
    """Compare some twenty of the modes: all would take as long as what the engine is compared with."""
    if len(found) != modes:
        message = f"{len(found)} poles, not {modes}"
        raise RuntimeError(message)
    some = range(1, modes + 1, max(1, modes // 20))
    with mp.workdps(digits + 10):
        expected = findroot_beam([guess(mode) for mode in some], digits + 10)
        _agree([found[mode - 1] for mode in some], expected, digits)


def _agree(found: list[Any], expected: list[Any], digits: int) -> None:
    wrong = len(found) != len(expected) or any(
        abs(a - b) > mpf(10) ** (2 - digits) * abs(b) for a, b in zip(found, expected, strict=False)
    )
    if wrong:
        message = f"{len(found)} poles do not agree with {len(expected)}"
        raise RuntimeError(message)


# The ten lowest x by the real characteristic function and its derivative, which suits cxroots best: in a box
# of s, with the growth taken out, it took three times as long and returned six of the ten.
CXROOTS = """
import time
import numpy as np
from cxroots import Rectangle

f = lambda x: np.sin(x) + np.cos(x) * np.tanh(x)
df = lambda x: np.cos(x) - np.sin(x) * np.tanh(x) + np.cos(x) / np.cosh(x) ** 2
begin = time.process_time()
found = Rectangle([1, 31], [-1, 1]).roots(f, df)
taken = time.process_time() - begin
expected = (np.arange(1, 11) - 0.25) * np.pi
assert len(found.roots) == 10 and np.allclose(np.sort(np.real(found.roots)), expected, atol=0.01)
print(taken)
"""


# ------------------------------------------------------------------------------------------- the report


def measure(extent: Extent) -> Measured:
    """Measure all ways, each within the limit, and compare."""
    limit = extent.limit
    measurements: list[Measurement] = []
    claims: list[Claim] = []

    def run(task: str, way: str, call: str) -> Measurement | None:
        seconds = max(limit, OWN) if way.startswith("symflex") else limit
        found = _run(task, way, f"from benchmarks import roots\nprint(roots.{call})", seconds)
        measurements.extend([found] if found else [])
        return found

    for digits in extent.of((50, 1000), (50,)):
        task = f"sliding-free beam, {MODES} pairs of poles at {digits} digits"
        ours = run(task, "symflex", f"time_beam({MODES}, {digits})")
        theirs = run(task, "`mpmath.findroot`, guesses given", f"time_findroot({MODES}, {digits})")
        claims.append(_ratio(f"{task}: times as fast as `findroot`", FASTER_THAN_FINDROOT, theirs, ours))
    interpreter = os.environ.get(CXROOTS_PYTHON, sys.executable)
    if _has_cxroots(interpreter):
        task = "sliding-free beam by the general engine, ten poles"
        ours = run(task, "symflex, 15 digits", "time_generally(10, 15)")
        theirs = _run(task, "cxroots, doubles", CXROOTS, limit, interpreter)
        measurements.extend([theirs] if theirs else [])
        claims.append(_ratio("ten poles: times as fast as cxroots", FASTER_THAN_CXROOTS, theirs, ours))
    if extent.is_quick:
        return Measured(measurements, claims)
    task = f"sliding-free beam, pole number {MILLION} at 50 digits"
    run(task, "symflex", f"time_one({MILLION}, 50)")
    run(task, "`mpmath.findroot`, guess given", f"time_findroot(1, 50, {MILLION})")
    task = "sliding-free beam by the general engine, 50 digits"
    run(task, "50 modes", "time_generally(50, 50)")
    run(task, "200 modes", "time_generally(200, 50)")
    task = f"Kelvin-Voigt cantilever with mass and dashpot, box of {DAMPED_POLES} poles at 50 digits"
    run(task, "symflex", "time_damped_box(50)")
    for kind, ceiling in CEILINGS.items():
        task = f"{kind} chain of {MASSES} masses at 50 digits"
        found = run(task, "symflex, with the zeros", f"time_chain(50, damped={kind == 'damped'})")
        taken = found.taken if found else math.nan
        claims.append(Claim(f"{task} [s]", ceiling, taken, larger_is_better=False, is_ratio=False))
    claims.append(
        Claim(
            f"damped chain of {MASSES} masses: poles that `numpy.roots` puts into the right half-plane",
            1.0,
            numpy_in_the_wrong_half_plane(),
            is_ratio=False,
        )
    )
    return Measured(measurements, claims)


def _run(
    task: str, way: str, code: str, limit: float, interpreter: str = sys.executable
) -> Measurement | None:
    """Return the measurement, or say on stderr why there is none."""
    try:
        return run_snippet(task, way, code, limit, interpreter)
    except subprocess.CalledProcessError as failure:
        reason = [line for line in failure.stderr.splitlines() if line and not line.startswith(" ")][-1]
        print(f"not done: {task}, {way}: {reason}", file=sys.stderr)
        return None


def _ratio(text: str, bound: float, theirs: Measurement | None, ours: Measurement | None) -> Claim:
    # What was not done is missed.
    return Claim(text, bound, times_as_fast(ours, theirs) if theirs and ours else math.nan)


def _has_cxroots(interpreter: str) -> bool:
    """Return whether cxroots can be imported, and say so when it cannot."""
    found = subprocess.run([interpreter, "-c", "import cxroots"], capture_output=True, check=False)
    if found.returncode:
        print(
            "skipped: ten poles against cxroots, which is not installed (extra `bench`; or its Python in "
            f"{CXROOTS_PYTHON})",
            file=sys.stderr,
        )
    return not found.returncode
