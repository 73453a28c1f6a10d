"""The function on the imaginary axis, s = j*omega, in real arithmetic as far as there is no damping.

With ``s = j*omega`` the exponents of an undamped beam are ``+-beta`` and ``+-j*beta``: its Krylov-Duncan
functions are ``(cosh(q) + cos(q))/2``, ``(sinh(q) + sin(q))/(2*beta)``, ... of ``q = beta*l``.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Dispersion, Factored, Kernel, KernelTable, Ring, by_powers
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
from symflex.print.forms.economical import LARGE, angle_doubled, is_half
from symflex.print.forms.invariants import IMAGINARY, in_krylov_functions, krylov_name
from symflex.print.forms.kept import KeptDefinitions
from symflex.print.forms.naming import Naming
from symflex.print.forms.notation import (
    Angle,
    Line,
    angles_of,
    constant_symbols,
    pair_lines,
    plain_printer,
    reachable,
    speed_squared,
    wave_times_length,
)
from symflex.print.forms.printed import NOT_ENTIRE, PrintedForm, lacks
from symflex.transfer import TransferFunction

LONGEST_ARGUMENT = 10  # characters printed within cosh, sinh, cos and sin: ``beta_2*l_2``


def frequency_form(tf: TransferFunction) -> PrintedForm:
    """Return the function of ``omega = s/j``, each sum split into its real and its imaginary part.

    The imaginary unit is a name with the line ``j = sqrt(-1)``, so the form holds for every complex s.
    """
    return FrequencyPage(tf).form()


class FrequencyPage:
    """The ring of real functions of the frequency for one transfer function."""

    def __init__(self, tf: TransferFunction) -> None:
        self._tf = tf
        bending = tuple(d for d in tf.kernels.dispersions if d.kind == "bending")
        table = KernelTable(
            bending, tuple(k for k in tf.kernels.kernels if k.dispersion in bending and k.wavenumber)
        )
        converted = in_krylov_functions(tf.ratio.ring, table, tf.ratio)
        if converted is None:
            raise lacks(tf, "frequency", NOT_ENTIRE)
        self._change, self._value = converted
        others = KernelTable(
            tf.kernels.dispersions, tuple(k for k in tf.kernels.kernels if k not in table.kernels)
        )
        self._bent = tuple(group[0] for group in self._change.angles)
        self._straight = angles_of(others)
        self._turning = [k for k in others.kernels if k.function == "exp" and self._turns(k)]
        removed = {k.generator for k in (*table.kernels, *self._turning)}
        self._arguments = [(i, k) for i, angle in enumerate(self._bent) for k in range(1 + _halvings(angle))]
        functions = [g for i, k in self._arguments for g in _functions(i, k).values()]
        delays = [f"{f}[{k.generator}]" for k in self._turning for f in ("cos", "sin")]
        plain = [n for n in tf.ratio.ring.names if n not in removed]
        self.ring = Ring((*plain, *functions, *delays, IMAGINARY))
        self._functions = [
            *(k.generator for k in others.kernels if k not in self._turning),
            *functions,
            *delays,
        ]

    def angles(self) -> list[tuple[Angle, int, dict[str, str]]]:
        """Return angles, times their length in arguments, and the generators of functions of these."""
        angles = [(self._bent[i], 2**k, _functions(i, k)) for i, k in self._arguments]
        for angle in self._straight:
            even, odd = ("cosh", "sinh") if self._grows(angle) else ("cos", "sin")
            angles.append((angle, 1, {even: angle.kernels["cosh"], odd: angle.kernels["sinh"]}))
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
        value = Factored.number(self.ring, self._value.unit)
        turns = 0
        waves = {
            str(self._change.ring.generator(d.wavenumbers[0])): d for d in self._change.table.dispersions
        }
        for factor, exponent in self._value.factors:
            if (wave := waves.get(str(factor))) is not None:
                # 4 mu^4 = -beta^4; what is left of the wavenumber is a power of that.
                assert exponent % 4 == 0
                beta = Factored.generator(self.ring, wave.wavenumbers[0])
                value = value * beta**exponent * Fraction(-1, 4) ** (exponent // 4)
                continue
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
        source, ring = self._change.ring, self.ring
        lowered, scale = self._lowered(factor)
        j = ring.generator(IMAGINARY)
        images = {n: ring.generator(n) for n in ring.names}
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
        for i in range(len(self._bent)):
            ch, sh, co, si = (ring.generator(g) for g in _functions(i).values())
            for order, image in enumerate((ch + co, sh + si, ch - co, sh - si)):
                images[krylov_name(i, order)] = image
        zero = ring.constant(0)
        work = lowered.compose(*(images.get(n, zero) for n in source.names), ctx=ring.context)
        work = self.reduced(work)
        parts = by_powers(ring, work, ring.index[IMAGINARY])
        if set(parts) == {1}:
            return self._in_whole_lengths(parts[1]) * scale, 1
        return self._in_whole_lengths(work) * scale, 0

    def _in_whole_lengths(self, work: fmpz_mpoly) -> Factored:
        """Return a polynomial in functions of twice a half length, where all of it can be so written."""
        ring, halvings = self.ring, 0
        for i, k in self._arguments:
            half, whole = _functions(i, k), _functions(i, k + 1)
            is_used = any(int(work.degrees()[ring.index[g]]) for g in half.values())
            if not is_used or (i, k + 1) not in self._arguments or len(work) > LARGE:
                continue
            doubled = angle_doubled(ring, work, replace(self._bent[i], kernels=half))
            if doubled is None:
                continue
            images = {g: ring.generator(whole[f]) for f, g in half.items()}
            work, halvings = self.reduced(ring.replaced(doubled[0], images)), halvings + doubled[1]
        return Factored.polynomial(ring, work) / Factored.number(ring, 2) ** halvings

    def _lowered(self, factor: fmpz_mpoly) -> tuple[fmpz_mpoly, Factored]:
        """Return a polynomial in ``2*beta^m*K_m`` and ``beta^4``, and what it is multiplied by."""
        source = self._change.ring
        waves = [source.index[d.wavenumbers[0]] for d in self._change.table.dispersions]
        owner = [
            (source.index[krylov_name(i, order)], order, source.index[angle.wavenumber])
            for i, angle in enumerate(self._bent)
            for order in range(4)
        ]
        terms = []
        for monomial, coefficient in factor.terms():
            m = [int(e) for e in monomial]
            value = Fraction(int(coefficient))
            for k, order, w in owner:
                value /= 2 ** m[k]
                m[w] -= order * m[k]
            for w in waves:
                value *= Fraction(-1, 4) ** (int(monomial[w]) // 4)
            terms.append((m, value))
        least = {w: min(m[w] for m, _ in terms) for w in waves}
        below = 1
        for _, value in terms:
            below = max(below, value.denominator)
        lowered: dict[tuple[int, ...], int] = {}
        for m, value in terms:
            for w in waves:
                m[w] -= least[w]
            lowered[tuple(m)] = int(value * below)
        scale = Factored.number(self.ring, Fraction(1, below))
        for w in waves:
            scale = scale * Factored.generator(self.ring, source.names[w]) ** least[w]
        return source.context.from_dict(lowered), scale

    def reduced(self, work: fmpz_mpoly) -> fmpz_mpoly:
        """Use ``j^2 = -1``, ``sin^2 = 1 - cos^2`` and ``sinh^2 = cosh^2 - 1``."""
        ring = self.ring
        squares = {IMAGINARY: ring.constant(-1)}
        for i, k in self._arguments:
            own = _functions(i, k)
            squares[own["sinh"]] = ring.generator(own["cosh"]) ** 2 - 1
            squares[own["sin"]] = 1 - ring.generator(own["cos"]) ** 2
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
        source, ring = value.ring, self.ring
        result, turns = Factored.number(ring, value.unit), 0
        for factor, exponent in value.factors:
            embedded = factor.compose(
                *(self._change.ring.generator(n) for n in source.names), ctx=self._change.ring.context
            )
            image, times = self._real(embedded)
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
                one = beta**4 / -c0 if d.kind == "bending" else beta**2 / c0
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
        symbols |= {w: Name(n) for w, n in zip(waves, naming.take("beta", len(waves)), strict=True)}
        functions = [f for f in self.angles() if used.intersection(f[2].values())]
        products = [wave_times_length(lengths, symbols[a.wavenumber], a.length * n) for a, n, _ in functions]
        arguments, lines = _short_or_named(products, "q", naming)
        for q, (_, _, own) in zip(arguments, functions, strict=True):
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
                square = speed_squared(dispersion)
                if square is None:
                    return [(named[0], Call("sqrt", axis.square_root(-self._on_axis(c[0]))))]
                (a,) = naming.take("a")
                root = plain_printer(self._tf).square_root(square)
                return [(named[0], Call("sqrt", quotient(symbols[LAPLACE], Name(a)))), (a, root)]
            case "wave":
                return [(named[0], axis.square_root(self._on_axis(c[0])))]
            case "pair":
                printed = [axis.quotient(self._on_axis(each)) for each in c]
                (delta,) = naming.take("delta")
                return pair_lines(named, delta, naming, printed, on_axis=True)
        return []


def _functions(angle: int, doublings: int = 0) -> dict[str, str]:
    """Return the generators of the functions of an angle, doubled some times."""
    times = f"*{2**doublings}" if doublings else ""
    return {f: f"{f}[{angle}{times}]" for f in ("cosh", "sinh", "cos", "sin")}


def _halvings(angle: Angle) -> int:
    """Return how often the length is halved in what stands in the model."""
    length, times = angle.length, 0
    while is_half(length):
        length, times = length * 2, times + 1
    return times


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
