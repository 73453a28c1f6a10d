"""How inputs and outputs of a square matrix interact: static gains, static decoupling, relative gains.

Input: a transfer matrix. Output: its values at rest and their inverse, in symbols; its relative gain array.

The relative gain of output i and input j is the gain from one to the other with all other inputs at zero,
over that with all other outputs imposed as zero (Bristol 1966):

    lambda_ij(s) = g_ij(s) (G^-1)_ji(s)

Rows and columns add up to 1, and scaling an input or output changes nothing. A function of s in lowest terms,
it has a value at rest also where both factors have none, as with integrators. G(0)^-1 before the inputs
decouples the system at rest.

    G(0) = [k_1, k_2; 0, k_3]     G(0)^-1 = [1/k_1, -k_2/(k_1 k_3); 0, 1/k_3]     Lambda(0) = [1, 0; 0, 1]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

from symflex.algebra import LAPLACE, NO_KERNELS, Factored, by_powers
from symflex.errors import Diagnostic, ModelError
from symflex.expressions import Expression, format_expression, names_in, number, quotient
from symflex.matrices.inverse import inverse
from symflex.matrices.notations import drawn_matrix, ends_text
from symflex.matrices.printed import MatrixForm
from symflex.matrices.transfer_matrix import TransferMatrix, derive_matrix, joined_ring, one_table
from symflex.model import with_numbers
from symflex.model.loss_factors import check_causal
from symflex.print.forms import print_part
from symflex.print.forms.printed import PrintedForm
from symflex.print.read_back import read_back
from symflex.print.text import INDENT, WIDTH, hanging
from symflex.transfer import AnyTransferFunction, TransferFunction, bind
from symflex.transfer.lowest_terms import cancel

Gains = tuple[tuple[TransferFunction, ...], ...]  # constants, a row per output
EXPONENTIAL = "exp"
SCHEMA = "symflex.interaction/1"


@dataclass(frozen=True, repr=False)
class Interaction:
    """Values of a square matrix at rest, each a constant; what has none there is None."""

    matrix: TransferMatrix
    gains: Gains | None  # G(0); None where an output integrates
    decoupling: Gains | None  # G(0)^-1; None where that is not finite
    relative: Gains | None  # the relative gain array at s = 0

    def __str__(self) -> str:
        return interaction_text(self)

    def said(self, gains: Gains) -> tuple[tuple[Expression, ...], ...]:
        """Return constants as an author would write them, each read back."""
        return tuple(tuple(map(_printed, row)) for row in gains)

    @cached_property
    def with_numbers(self) -> Interaction | None:
        """The same of the model with the values of its parameters, with which other things may cancel."""
        matrix = self.matrix
        rows, columns = [o.name for o in matrix.outputs], [i.name for i in matrix.inputs]
        try:
            return interaction(derive_matrix(with_numbers(matrix.model, in_kernels=True), rows, columns))
        except ModelError:
            return None

    def values(self, gains: Gains) -> list[list[float]] | None:
        """Return constants in doubles, None where a parameter has no value or one is complex or infinite."""
        one = self.with_numbers
        pairs = () if one is None else zip(self.each, one.each, strict=True)
        numeric = next((own for said, own in pairs if said is gains), None)
        if numeric is None:
            return None
        try:
            numbers = [[bind(tf)(0j) for tf in row] for row in numeric]
        except ModelError:
            return None
        if any(x.imag for row in numbers for x in row):
            return None
        return [[x.real for x in row] for row in numbers]

    @property
    def each(self) -> tuple[Gains | None, ...]:
        """All three."""
        return self.gains, self.decoupling, self.relative

    def numbers(self, gains: Gains, digits: int = 6) -> tuple[tuple[Expression, ...], ...] | None:
        """Return constants in decimals of so many digits, None where a parameter has no value."""
        values = self.values(gains)
        if values is None:
            return None
        return tuple(tuple(number(Fraction(f"{x:.{digits}g}")) for x in row) for row in values)


def interaction(matrix: TransferMatrix) -> Interaction:
    """Return static gains, static decoupling and relative gains; SF237, SF902 as of an inverse."""
    check_causal(matrix.model, "a value at s = 0")
    for tf in matrix.each:
        _check_letters(tf)
    turned = inverse(matrix)
    relative = [
        [_product(g, turned.pairs[j][i]) for j, g in enumerate(row)] for i, row in enumerate(matrix.pairs)
    ]
    gains = _at_rest(matrix.pairs)
    return Interaction(matrix, gains, gains and _at_rest(turned.pairs), _at_rest(relative))


def _product(g: object, h: object) -> TransferFunction:
    """Return the product of two functions in lowest terms."""
    if not (isinstance(g, TransferFunction) and isinstance(h, TransferFunction)):
        message = "symbolic relative gains need functions in expanded form"
        raise ModelError(Diagnostic("SF910", message, None, "values of rga(s) need none"))
    kernels = one_table([g.kernels, h.kernels])
    if kernels is None:
        message = "relative gains of functions with kernels of several lengths are not available yet"
        raise ModelError(Diagnostic("SF910", message, None, "values of rga(s) need none"))
    ring = joined_ring([g.ring, h.ring], kernels) if kernels else g.ring
    ratio = g.ratio.over(ring) * h.ratio.over(ring)
    ratio, _ = cancel(ratio.numerator(), ratio.denominator(), radicals=None if kernels else g.radicals)
    return _like(g, ratio, replace(g, kernels=kernels))


def _like(g: TransferFunction, ratio: Factored, base: TransferFunction) -> TransferFunction:
    parts = (ratio.numerator(), ratio.denominator()) if base.kernels else None
    return replace(
        base, reduced=ratio, closed=None, hidden=(), parts=parts, solve=None, with_waves=None, unit=g.unit
    )


def _at_rest(pairs: Sequence[Sequence[object]]) -> Gains | None:
    """Return the values of functions at s = 0; None where one is infinite."""
    rows: list[tuple[TransferFunction, ...]] = []
    for row in pairs:
        values: list[TransferFunction] = []
        for tf in row:
            if not isinstance(tf, TransferFunction):
                message = "symbolic static gains need functions in expanded form"
                raise ModelError(Diagnostic("SF910", message, None, "dcgain() has values"))
            value = value_at_rest(tf)
            if value is None:
                return None
            values.append(value)
        rows.append(tuple(values))
    return tuple(rows)


def _check_letters(tf: AnyTransferFunction) -> None:
    """Return where a function has a symbolic static gain, which beams and roots of s have not."""
    if tf.model.root is not None or any(k.function != EXPONENTIAL for k in tf.kernels.kernels):
        message = f"the symbolic static gain of {tf.name} is not available here: it is no rational function"
        raise ModelError(Diagnostic("SF910", message, None, "dcgain() has its value, --limits its letters"))


def value_at_rest(tf: TransferFunction) -> TransferFunction | None:
    """Return a function's value at s = 0, None where that is infinite.

    Raises SF910 for beams, roots of s, and where delays leave 0/0.
    """
    _check_letters(tf)
    if tf.is_zero:
        return _constant(tf, tf.ratio)
    ring, ratio = tf.ratio.ring, Factored.number(tf.ratio.ring, tf.ratio.unit)
    delays = {k.generator: ring.constant(1) for k in tf.kernels.kernels}
    images = [delays.get(name, ring.generator(name)) for name in ring.names]
    for factor, exponent in tf.ratio.factors:
        image = factor.compose(*images) if delays else factor
        if image.is_zero():
            message = f"the symbolic static gain of {tf.name} is not available here: it is 0/0 with delays"
            raise ModelError(Diagnostic("SF910", message, None, "dcgain() has its value"))
        ratio = ratio * Factored.polynomial(ring, image) ** exponent
    order = ratio.exponent_of(ring.generator(LAPLACE))
    if order < 0:
        return None
    rest = Factored.number(ring, ratio.unit if order == 0 else 0)
    for factor, exponent in ratio.factors if order == 0 else ():
        lowest = by_powers(ring, factor, ring.index[LAPLACE])[0]
        rest = rest * Factored.polynomial(ring, lowest) ** exponent
    rest, _ = cancel(rest.numerator(), rest.denominator(), radicals=None if tf.kernels else tf.radicals)
    return _constant(tf, rest)


def _constant(tf: TransferFunction, value: Factored) -> TransferFunction:
    made = replace(tf, reduced=value, closed=None, hidden=(), parts=None, solve=None, with_waves=None)
    return replace(made, kernels=NO_KERNELS)


def _printed(tf: TransferFunction) -> Expression:
    form = print_part(tf)
    read_back(tf, PrintedForm(form.name, form.num, form.den, form.where))
    return quotient(form.num, form.den)


def interaction_text(found: Interaction, width: int = WIDTH) -> str:
    """Return static gains, static decoupling and relative gains for a terminal, each with its numbers."""
    lines = [f"{ends_text(found.matrix.outputs)} / {ends_text(found.matrix.inputs)}", ""]
    for title, head, gains in _named(found):
        if gains is None and title == "static decoupling" and found.gains is None:
            continue
        if gains is None:
            lines += [f"{INDENT}{title}: none, a value is infinite at s = 0", ""]
            continue
        said = found.said(gains)
        form = MatrixForm(title, number(1), number(1), said)
        picture = drawn_matrix(f"{head} = ", form, "1")
        numbers = found.numbers(gains)
        lines += [f"{INDENT}{title}", ""]
        if max(map(len, picture)) <= width or numbers == said:
            lines += picture
        else:
            for i, row in enumerate(said, 1):
                for j, e in enumerate(row, 1):
                    lines += hanging(f"{INDENT}{head}_{i}{j} = ", e, width)
        if numbers is not None and any(names_in(e) for row in said for e in row):
            lines += ["", *drawn_matrix(" " * len(head) + " = ", replace(form, entries=numbers), "1")]
        lines.append("")
    return "\n".join(lines).rstrip()


def _named(found: Interaction) -> tuple[tuple[str, str, Gains | None], ...]:
    return (
        ("static gains", "G(0)", found.gains),
        ("static decoupling", "G(0)^-1", found.decoupling),
        ("relative gains", "RGA(0)", found.relative),
    )


def interaction_json(found: Interaction) -> dict[str, object]:
    """Return the document ``symflex derive --matrix --rga --json`` prints."""
    document: dict[str, object] = {
        "schema": SCHEMA,
        "outputs": [o.name for o in found.matrix.outputs],
        "inputs": [i.name for i in found.matrix.inputs],
    }
    for title, _, gains in _named(found):
        said = gains and [[format_expression(e) for e in row] for row in found.said(gains)]
        values = gains and found.values(gains)
        document[title.replace(" ", "_")] = gains and {"is": said, "values": values}
    return document
