"""The function on the imaginary axis, s = j*omega, in real arithmetic as far as there is no damping.

With ``s = j*omega`` the kernels of undamped beams are those of :mod:`symflex.print.forms.bending`, and rods,
shafts and strings have ``cos`` for ``cosh``.
"""

from __future__ import annotations

from collections.abc import Mapping

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Kernel, Ring, by_powers
from symflex.algebra.normal_form import with_image
from symflex.expressions import (
    Call,
    Expression,
    Name,
    format_expression,
    negative,
    number,
    product_of,
    quotient,
)
from symflex.model.model import IMAGINARY as LOSS_UNIT
from symflex.print.forms.arrange import Arranger, ProductPrinter, Sides, shortest_sides
from symflex.print.forms.bending import as_in_books, in_beta
from symflex.print.forms.economical import added
from symflex.print.forms.invariants import IMAGINARY
from symflex.print.forms.kept import KeptDefinitions
from symflex.print.forms.naming import BETA, Naming
from symflex.print.forms.notation import (
    Angle,
    Line,
    angles_of,
    constant_symbols,
    fourth_root,
    pair_lines,
    plain_printer,
    reachable,
    wave_times_length,
)
from symflex.print.forms.printed import NOT_ENTIRE, PrintedForm, lacks
from symflex.transfer import TransferFunction

LONGEST_ARGUMENT = 10  # characters printed within cosh, sinh, cos and sin: ``beta_2*l_2``


def frequency_form(tf: TransferFunction) -> PrintedForm:
    """Return the function of ``omega = s/j``, each sum split into its real and its imaginary part.

    The imaginary unit is a name with the line ``j = sqrt(-1)``, so the form holds for every complex s.
    """
    return FrequencyPage(added(as_in_books(tf))).form()


class FrequencyPage:
    """The ring of real functions of the frequency for one transfer function."""

    def __init__(self, tf: TransferFunction) -> None:
        own = in_beta(tf)
        if own is None:
            raise lacks(tf, "frequency", NOT_ENTIRE)
        self._tf, kernels = own, own.kernels.kernels
        self._bent = [a for a in angles_of(own.kernels) if a.dispersion.kind == "bending"]
        self._straight = [a for a in angles_of(own.kernels) if a.dispersion.kind != "bending"]
        self._turning = [k for k in kernels if k.function == "exp" and self._turns(k)]
        removed = {k.generator for k in self._turning}
        delays = [f"{f}[{k.generator}]" for k in self._turning for f in ("cos", "sin")]
        self.ring = Ring((*(n for n in own.ratio.ring.names if n not in removed), *delays, IMAGINARY))
        self._functions = [*(k.generator for k in kernels if k not in self._turning), *delays]

    def angles(self) -> list[tuple[Angle, Mapping[str, str]]]:
        """Return angles and the generators of their functions."""
        angles: list[tuple[Angle, Mapping[str, str]]] = [(angle, angle.kernels) for angle in self._bent]
        for angle in self._straight:
            even, odd = ("cosh", "sinh") if self._grows(angle) else ("cos", "sin")
            angles.append((angle, {even: angle.kernels["cosh"], odd: angle.kernels["sinh"]}))
        return angles

    @staticmethod
    def _turns(kernel: Kernel) -> bool:
        """Tell whether an exponential has modulus one on the axis."""
        shift = kernel.dispersion.shift
        return not (shift / Factored.generator(shift.ring, LAPLACE)).depends_on(LAPLACE)

    def form(self) -> PrintedForm:
        """Return the printed form."""
        (sides,), lines, symbols = self.printed(self.value())
        argument = product_of([symbols[IMAGINARY], symbols[LAPLACE]])
        # What the left side says is explained also where the right one does not need it.
        return PrintedForm("frequency", *sides, reachable((*sides, argument), lines), argument=argument)

    def value(self) -> Factored:
        """Return the function in the ring of the page, whose s is the frequency."""
        value, turns = Factored.number(self.ring, self._tf.ratio.unit), 0
        for factor, exponent in self._tf.ratio.factors:
            image, times = self._real(factor)
            value, turns = value * image**exponent, turns + times * exponent
        return self._turned(value, turns)

    def printed(self, *values: Factored) -> tuple[list[Sides], tuple[Line, ...], dict[str, Expression]]:
        """Return numerators and denominators of values over the ring, lines of names, and symbols."""
        lines, symbols = self._explained(self.ring.used_in(f for value in values for f, _ in value.factors))
        printer = self.printer(symbols)
        return [shortest_sides(printer, value, self.laws()) for value in values], lines, symbols

    def printer(self, symbols: dict[str, Expression]) -> ProductPrinter:
        """Return what prints values of the ring."""
        kept = KeptDefinitions.of(self._tf, self.ring)
        return ProductPrinter(Arranger.plain(self.ring, symbols, self._functions, kept), IMAGINARY)

    def _turned(self, value: Factored, times: int) -> Factored:
        """Return a value times a power of the imaginary unit."""
        if times % 4 >= 2:  # noqa: PLR2004
            value = -value
        return value * Factored.generator(self.ring, IMAGINARY) if times % 2 else value

    def _real(self, factor: fmpz_mpoly) -> tuple[Factored, int]:
        """Return a polynomial on the axis, and the power of the imaginary unit that all of it bore."""
        ring, source = self.ring, self._tf.ratio.ring
        j = ring.generator(IMAGINARY)
        images = {n: ring.generator(n) for n in source.names if n in ring.index}
        images[LAPLACE] = j * images[LAPLACE]
        if self._tf.model.imaginary and LOSS_UNIT in images:
            images[LOSS_UNIT] = j
        for angle in self._straight:
            # Of a pair the second wavenumber is imaginary on the axis, and so is that of a wave.
            first = angle.dispersion.wavenumbers[0] == angle.wavenumber and angle.dispersion.kind == "pair"
            if not first:
                images[angle.kernels["sinh"]] = j * images[angle.kernels["sinh"]]
        for d in self._tf.kernels.dispersions:
            if d.kind in ("wave", "pair"):
                w = d.wavenumbers[-1]
                images[w] = j * images[w]
        for kernel in self._turning:
            c, s = (ring.generator(f"{f}[{kernel.generator}]") for f in ("cos", "sin"))
            images[kernel.generator] = c - j * s
        work = self.reduced(factor.compose(*(images[n] for n in source.names), ctx=ring.context))
        parts = by_powers(ring, work, ring.index[IMAGINARY])
        if set(parts) == {1}:
            return Factored.polynomial(ring, parts[1]), 1
        return Factored.polynomial(ring, work), 0

    def reduced(self, work: fmpz_mpoly) -> fmpz_mpoly:
        """Use ``j^2 = -1``, ``sin^2 = 1 - cos^2`` and ``sinh^2 = cosh^2 - 1``."""
        ring = self.ring
        squares = {IMAGINARY: ring.constant(-1)}
        for angle in self._bent:
            squares[angle.kernels["sinh"]] = ring.generator(angle.kernels["cosh"]) ** 2 - 1
            squares[angle.kernels["sin"]] = 1 - ring.generator(angle.kernels["cos"]) ** 2
        for angle in self._straight:
            c = ring.generator(angle.kernels["cosh"])
            squares[angle.kernels["sinh"]] = c * c - 1 if self._grows(angle) else 1 - c * c
        for kernel in self._turning:
            squares[f"sin[{kernel.generator}]"] = 1 - ring.generator(f"cos[{kernel.generator}]") ** 2
        for name, square in squares.items():
            work, _ = with_image(ring, work, ring.index[name], Factored.polynomial(ring, square), 2)
        return work

    @staticmethod
    def _grows(angle: Angle) -> bool:
        """Tell whether the kernels of an angle stay hyperbolic on the axis."""
        return angle.dispersion.kind == "pair" and angle.dispersion.wavenumbers[0] == angle.wavenumber

    def _on_axis(self, value: Factored) -> Factored:
        """Return a value of s and the parameters at ``s = j*omega``."""
        result, turns = Factored.number(self.ring, value.unit), 0
        for factor, exponent in value.over(self._tf.ratio.ring).factors:
            image, times = self._real(factor)
            result, turns = result * image**exponent, turns + times * exponent
        return self._turned(result, turns)

    def laws(self) -> dict[str, Factored]:
        """Return per wavenumber a product of its power with omega and parameters that is one."""
        laws = {}
        for d in self._tf.kernels.dispersions:
            if d.kind in ("bending", "wave"):
                (w,) = d.wavenumbers
                beta = Factored.generator(self.ring, w)
                c0 = self._on_axis(d.characteristic[0])
                one = beta**4 / c0 * 4 if d.kind == "bending" else beta**2 / c0
                if not one.depends_on(IMAGINARY):
                    laws[w] = one
        return laws

    def _explained(self, used: frozenset[str]) -> tuple[tuple[Line, ...], dict[str, Expression]]:
        """Return the lines and the symbols of the generators used."""
        tf, naming = self._tf, Naming.of(self._tf)
        (omega,) = naming.take("omega")
        (j,) = (LOSS_UNIT,) if tf.model.imaginary else naming.take("j")
        symbols = {**constant_symbols(tf), LAPLACE: Name(omega), IMAGINARY: Name(j)}
        axis = self.printer(symbols)
        lengths = plain_printer(tf)
        waves = [w for d in tf.kernels.dispersions for w in d.wavenumbers]
        symbols |= {w: Name(n) for w, n in zip(waves, naming.take(BETA, len(waves)), strict=True)}
        functions = [f for f in self.angles() if used.intersection(f[1].values())]
        products = [wave_times_length(lengths, symbols[a.wavenumber], a.length) for a, _ in functions]
        arguments, lines = _short_or_named(products, "q", naming)
        for q, (_, own) in zip(arguments, functions, strict=True):
            symbols |= {g: Call(f, q) for f, g in own.items()}
        rates = [
            k.dispersion.shift * k.length / Factored.generator(k.length.ring, LAPLACE) for k in self._turning
        ]
        phases = [wave_times_length(lengths, Name(omega), rate) for rate in rates]
        delays, more = _short_or_named(phases, "theta", naming)
        lines += more
        for theta, kernel in zip(delays, self._turning, strict=True):
            symbols |= {f"{f}[{kernel.generator}]": Call(f, theta) for f in ("cos", "sin")}
        for kernel in tf.kernels.kernels:
            if kernel.function == "exp" and kernel not in self._turning:
                exponent = self._on_axis(kernel.dispersion.shift * kernel.length)
                symbols[kernel.generator] = Call("exp", negative(axis.quotient(exponent)))
        for d in tf.kernels.dispersions:
            lines += self._wave_lines(d, symbols, naming, axis)
        lines.append((omega, quotient(Name(LAPLACE), Name(j))))
        if not tf.model.imaginary:
            lines.append((j, Call("sqrt", number(-1))))
        return tuple(lines), symbols

    def _wave_lines(
        self, dispersion: Dispersion, symbols: dict[str, Expression], naming: Naming, axis: ProductPrinter
    ) -> list[Line]:
        named = [symbol.name for w in dispersion.wavenumbers if isinstance(symbol := symbols[w], Name)]
        c = dispersion.characteristic
        match dispersion.kind:
            case "bending":
                return [(named[0], fourth_root(axis.quotient(self._on_axis(c[0] / 4))))]
            case "wave":
                return [(named[0], axis.square_root(self._on_axis(c[0])))]
            case "pair":
                printed = [axis.quotient(self._on_axis(each)) for each in c]
                (delta,) = naming.take("delta")
                return pair_lines(named, delta, naming, printed, on_axis=True)
        return []


def _short_or_named(
    products: list[Expression], stem: str, naming: Naming
) -> tuple[list[Expression], list[Line]]:
    """Return what functions are printed of: ``beta*l`` as it is, and a name with its line for longer ones."""
    is_long = [len(format_expression(product)) > LONGEST_ARGUMENT for product in products]
    fresh = iter(naming.take(stem, sum(is_long)))
    arguments: list[Expression] = []
    lines: list[Line] = []
    for product, wants_name in zip(products, is_long, strict=True):
        if wants_name:
            lines.append((next(fresh), product))
        arguments.append(Name(lines[-1][0]) if wants_name else product)
    return arguments, lines
