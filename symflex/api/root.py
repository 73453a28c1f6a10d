"""Poles and zeros as mpmath numbers, with residues and derivatives; and what a user may call a mode by."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import mpmath

from symflex import roots as roots_layer
from symflex.balls import precision, to_complex_mpmath, to_mpmath
from symflex.roots import HiddenRoot, decimals, figure
from symflex.roots import Root as CertifiedRoot

if TYPE_CHECKING:
    import sympy
    from flint import acb

    from symflex.analysis import rational as rational_layer
    from symflex.analysis import sensitivity as sensitivity_layer
    from symflex.roots.root import RootDecimals
    from symflex.symbolic.roots import RootFormula, SymbolicFactor


SHOWN_DIGITS = 12
RADIUS_BITS = 64
_POWER: Final = re.compile(r"e\+?(-?\d+)$")


def radius_of(ball: acb) -> mpmath.mpf:
    """Return an upper bound on the distance from the midpoint to any point of a ball, in the ball's unit.

    >>> from flint import acb, arb
    >>> round(float(radius_of(acb(arb(1, 3), arb(0, 4)))), 6)
    5.0
    """
    with precision(RADIUS_BITS):
        return to_mpmath((ball.real.rad() ** 2 + ball.imag.rad() ** 2).sqrt().upper())


@dataclass(frozen=True)
class Root:
    """A root s [rad/s].

    Parameters
    ----------
    certified_root : symflex.roots.Root
        The enclosure and what was proved about it.
    """

    certified_root: roots_layer.Root
    _factors: Callable[[], tuple[SymbolicFactor, ...]] | None = field(default=None, repr=False, compare=False)
    _symbols: Mapping[str, sympy.Symbol] = field(default_factory=dict, repr=False, compare=False)

    @property
    def symbolic(self) -> tuple[str, ...]:
        """Formulas of the root, ``omega_p = sqrt(k/m)`` and the like, each proved; often nothing."""
        return tuple(map(str, self._formulas))

    @property
    def letters(self) -> tuple[str, ...]:
        """An earlier name of ``symbolic``."""
        return self.symbolic

    @property
    def expressions(self) -> dict[str, sympy.Expr]:
        """The same as SymPy expressions by name, ``{"omega_p": sqrt(k/m)}``."""
        from symflex.print.sympy import to_sympy  # most roots are numbers only

        return {f.name: to_sympy(f.expression, self._symbols) for f in self._formulas}

    @property
    def _formulas(self) -> Iterator[RootFormula]:
        found = () if self._factors is None else self._factors()
        formulas = (f for each in found for f in each.formulas)
        return (f for f in formulas if any(r is self.certified_root for r in f.roots))

    @property
    def re(self) -> mpmath.mpf:
        """Real part [rad/s], midpoint of its enclosure; exactly zero on the imaginary axis."""
        return to_mpmath(self.certified_root.re)

    @property
    def im(self) -> mpmath.mpf:
        """Imaginary part [rad/s]; exactly zero for a real root."""
        return to_mpmath(self.certified_root.im)

    @property
    def value(self) -> mpmath.mpc:
        """The midpoint of the enclosure [rad/s], with all its digits whatever the working precision.

        Arithmetic with it rounds to ``mpmath.mp.dps`` digits, as mpmath does; see ``mpmath.workdps``.
        """
        return to_complex_mpmath(self.certified_root.enclosure())

    @property
    def radius(self) -> mpmath.mpf:
        """A bound on the distance from :attr:`value` to the root [rad/s]."""
        return radius_of(self.certified_root.enclosure())

    @property
    def multiplicity(self) -> int:
        """The multiplicity of the root."""
        return self.certified_root.multiplicity

    @property
    def certified(self) -> bool:
        """False when several roots could not be separated inside the enclosure, or nothing is proved."""
        return self.certified_root.certified

    @property
    def on_imaginary_axis(self) -> bool:
        """True when the real part is proved to be zero."""
        return self.certified_root.on_imaginary_axis

    @property
    def is_real(self) -> bool:
        """True when the imaginary part is proved to be zero."""
        return self.certified_root.is_real

    @property
    def frequency_hz(self) -> float:
        """Natural frequency abs(s)/(2 pi) [Hz]; with loss factors omega/(2 pi), see :attr:`loss_factor`."""
        return self.certified_root.frequency_hz()

    @property
    def damping_ratio(self) -> float | None:
        """``-re/abs(s)``, None at the origin."""
        return self.certified_root.damping_ratio()

    @property
    def loss_factor(self) -> float | None:
        """The loss factor eta of ``s^2 = -omega^2 (1 + j eta)``; None in models without any."""
        factor = self.certified_root.loss_factor()
        return None if factor is None else float(factor.mid())

    def __repr__(self) -> str:
        printed = self.certified_root.decimal(SHOWN_DIGITS).readable
        times = f", {self.multiplicity} times" if self.multiplicity > 1 else ""
        return f"<Root {printed.re}, {printed.im} j{times}, radius {printed.radius}>"

    def __complex__(self) -> complex:
        return complex(self.re, self.im)

    def _repr_latex_(self) -> str:
        times = rf"\quad ({self.multiplicity}\times)" if self.multiplicity > 1 else ""
        return rf"$s = {complex_latex(self.certified_root.decimal(SHOWN_DIGITS))}\ \mathrm{{rad/s}}{times}$"


def complex_latex(printed: RootDecimals) -> str:
    r"""Return a complex number in LaTeX.

    >>> from symflex.roots.root import RootDecimals
    >>> print(complex_latex(RootDecimals("-1.5", "-2.0e-7", "1e-12")))
    -1.5 - 2.0\cdot 10^{-7}\,\mathrm{j}
    >>> print(complex_latex(RootDecimals("0e-28", "2.0", "1e-12")))
    {\sim}0 + 2.0\,\mathrm{j}
    """
    readable = printed.readable
    real, imaginary = (
        _POWER.sub(r"\\cdot 10^{\1}", part).replace("~", r"{\sim}") for part in (readable.re, readable.im)
    )
    if printed.im == "0":
        return real
    sign = "-" if imaginary.startswith("-") else "+"
    return rf"{real} {sign} {imaginary.removeprefix('-')}\,\mathrm{{j}}"


class RootTable(tuple[Root, ...]):
    """Poles or zeros; in a notebook, a table."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        from symflex.print.roots import PAGE_COLUMNS, PrintedRoot

        entries = (PrintedRoot(root.certified_root, is_pair=False) for root in self)
        rows = [(str(i), *entry.cells(PAGE_COLUMNS, SHOWN_DIGITS)) for i, entry in enumerate(entries)]
        return _table(("", *(column.head for column in PAGE_COLUMNS)), rows)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    from symflex.print.html import NUMBER, html_table  # only notebooks ask

    written = [[cell.replace("-", "\u2212") for cell in row] for row in rows]
    return html_table(head, [NUMBER] * len(head), written)


Mode = int | Root | CertifiedRoot | HiddenRoot


def plain_mode(mode: Mode) -> int | CertifiedRoot:
    """Return a mode as :mod:`symflex.analysis.modes` takes it: its number, or its root.

    >>> plain_mode(2)
    2
    """
    if isinstance(mode, Root):
        return mode.certified_root
    return mode.root if isinstance(mode, HiddenRoot) else mode


@dataclass(frozen=True, slots=True, repr=False)
class PoleZeroMap(roots_layer.PoleZeroMap):
    """Poles, zeros and hidden modes; in a notebook, a table. See :class:`symflex.roots.PoleZeroMap`."""

    def _repr_html_(self) -> str:
        from symflex.print.html import roots_html  # only notebooks ask

        return roots_html(self)


@dataclass(frozen=True)
class Residue:
    """The contribution of a mode to a transfer function: its principal part at a pole p.

    Parameters
    ----------
    principal : symflex.analysis.rational.PrincipalPart
        The enclosures.
    """

    principal: rational_layer.PrincipalPart

    @property
    def pole(self) -> Root:
        """The pole p."""
        return Root(self.principal.root)

    @property
    def value(self) -> mpmath.mpc:
        """The coefficient of ``1/(s - p)``, midpoint of its enclosure; in the function's unit times rad/s."""
        return to_complex_mpmath(self.principal.value)

    @property
    def radius(self) -> mpmath.mpf:
        """A bound on the distance from :attr:`value` to the residue; if unproved, an estimate."""
        return radius_of(self.principal.value)

    @property
    def coefficients(self) -> tuple[mpmath.mpc, ...]:
        """The coefficients of ``1/(s - p)``, ``1/(s - p)^2``, ... up to the pole's multiplicity."""
        return tuple(map(to_complex_mpmath, self.principal.coefficients))

    @property
    def certified(self) -> bool:
        """Whether the pole, and with it the residue, is proved."""
        return not self.principal.is_estimate

    def __repr__(self) -> str:
        re, im = (mpmath.nstr(part, SHOWN_DIGITS) for part in (self.value.real, self.value.imag))
        return f"<Residue {re}, {im} j at {complex(self.pole):.6g}, radius {mpmath.nstr(self.radius, 2)}>"

    def __complex__(self) -> complex:
        return complex(self.value)


class ResidueTable(tuple[Residue, ...]):
    """Residues at poles; in a notebook, a table."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        rows = []
        for residue in self:
            pole, value = residue.pole.certified_root, residue.principal.value
            rows.append([figure(part, SHOWN_DIGITS) for part in (pole.re, pole.im, value.real, value.imag)])
        return _table(("Re pole [rad/s]", "Im pole [rad/s]", "Re residue", "Im residue"), rows)


@dataclass(frozen=True)
class Sensitivity:
    """How a root s moves with a parameter p; numbers are midpoints of certified enclosures.

    Parameters
    ----------
    moved : symflex.analysis.sensitivity.RootDerivative
        The enclosures.
    """

    moved: sensitivity_layer.RootDerivative

    @property
    def kind(self) -> str:
        """``pole`` or ``zero``."""
        return self.moved.kind

    @property
    def root(self) -> Root:
        """The root."""
        return Root(self.moved.root)

    @property
    def parameter(self) -> str:
        """The parameter's name."""
        return self.moved.parameter.name

    @property
    def status(self) -> str:
        """``certified``, ``multiple`` (there is no derivative) or ``undecided``."""
        return self.moved.status

    @property
    def derivative(self) -> mpmath.mpc | None:
        """ds/dp [rad/s per unit of the parameter]; ``None`` if there is none."""
        return None if self.moved.derivative is None else to_complex_mpmath(self.moved.derivative)

    @property
    def radius(self) -> mpmath.mpf | None:
        """A bound on the distance from :attr:`derivative` to the true one."""
        return None if self.moved.derivative is None else radius_of(self.moved.derivative)

    @property
    def normalised(self) -> mpmath.mpc | None:
        """``(p/s) ds/dp``; its real part is ``(p/f) df/dp``. ``None`` at s = 0."""
        normalised = self.moved.normalised
        return None if normalised is None else to_complex_mpmath(normalised)

    @property
    def frequency(self) -> mpmath.mpf | None:
        """df/dp [Hz per unit of the parameter] of the natural frequency ``f = abs(s)/(2 pi)``."""
        frequency = self.moved.frequency
        return None if frequency is None else to_mpmath(frequency)

    @property
    def damping_ratio(self) -> mpmath.mpf | None:
        """dzeta/dp [1 per unit of the parameter]; ``None`` for real roots."""
        damping_ratio = self.moved.damping_ratio
        return None if damping_ratio is None else to_mpmath(damping_ratio)

    @property
    def loss_factor(self) -> mpmath.mpf | None:
        """deta/dp of the loss factor [1 per unit of the parameter]; ``None`` in models without any."""
        loss_factor = self.moved.loss_factor
        return None if loss_factor is None else to_mpmath(loss_factor)

    def __repr__(self) -> str:
        if self.moved.derivative is None:
            return f"<Sensitivity of a {self.kind} to {self.parameter}: {self.status}>"
        derivative = self.moved.derivative
        printed = decimals(derivative.real, derivative.imag, SHOWN_DIGITS).readable
        return f"<Sensitivity of a {self.kind} to {self.parameter}: {printed.re}, {printed.im} j>"


class SensitivityTable(tuple[Sensitivity, ...]):
    """How roots move with parameters; in a notebook, a table of relative changes."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        from symflex.print.html import escape_html  # only notebooks ask

        rows = []
        for moved in self:
            root, relative = moved.root.certified_root, moved.moved.normalised
            location = (figure(part, SHOWN_DIGITS) for part in (root.re, root.im))
            share = (moved.status, "")
            if relative is not None:
                share = (figure(relative.real, 6), figure(relative.imag, 6))
            rows.append((moved.kind, *location, escape_html(moved.parameter), *share))
        head = ("", "Re [rad/s]", "Im [rad/s]", "p", "Re (p/s) ds/dp", "Im (p/s) ds/dp")
        return _table(head, rows)
