"""A transfer function in as few dimensionless groups as there are.

Input: a transfer function in expanded form; the model may prefer groups, in ``[analysis]``.
Output: its scale, its groups with names and values, and what it is in them.

    1/(m*s^2 + b*s + k)    1/k times 1/(S^2 + 2*zeta*S + 1)    S = s*sqrt(m/k), zeta = b/(2*sqrt(m*k))

Theorem (Buckingham 1914): a function of n quantities, whose dimensions have rank r, is one of n - r groups.
Here every change of scale counts that changes the terms of each factor alike, and both sides of the law of
each wavenumber: changes of units, and others, as of E and 1/I. Differences of exponents of terms span all
that none of them alters. Their echelon form has a group in each row: one quantity times powers of a base,
which comes last: lengths and data of members, masses, stiffnesses. With these set to 1 the model has its
groups in place of the others. What is shown is read again and compared with the function at its test points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Final

from flint import fmpq, fmpq_mat

from symflex import expressions as e
from symflex.algebra import Factored
from symflex.algebra.ring import terms_of
from symflex.balls import precision
from symflex.errors import SymflexError, Text
from symflex.expressions import Expression, Name, format_expression
from symflex.library.elements import LineElement
from symflex.model import ExactValue, with_numbers
from symflex.model.linearity import factored_of
from symflex.model.model import ModelParameter
from symflex.print.forms import print_form
from symflex.print.forms.naming import RATIOS, Naming
from symflex.print.forms.printed import PrintedForm, S
from symflex.print.forms.shapes import plain, powers_of
from symflex.print.label import symbol
from symflex.print.latex.equation import ratio_latex
from symflex.quantities import Dimension, unit_of
from symflex.symbolic.limits import (
    NotSymbolicError,
    Row,
    SymbolicForm,
    definitions_of,
    opened,
    times,
    value_of,
    written_powers,
)
from symflex.transfer import AnyTransferFunction, TransferFunction
from symflex.transfer.enclose import principal_values
from symflex.transfer.of_model import derive_all
from symflex.transfer.probes import probes_of

Exponents = dict[str, Fraction]  # a product of powers of quantities

ONE: Final = Fraction(1)
BASE: Final = ("m", "kg", "N/m", "kg*m^2", "N*m", "H", "F")  # units that groups are ratios to, in this order
DAMPERS: Final = ("N*s/m", "N*m*s", "Ohm")  # units of damping, in no base as long as there is another choice
BITS, ENOUGH = 192, 64  # precision at the test points, and how many bits of it have to agree


def dimensionless_of(tf: AnyTransferFunction) -> SymbolicForm:
    """Return a transfer function in dimensionless groups, its scale, and what these are."""
    try:
        if not tf.is_reduced or tf.is_zero or tf.model.root is not None:
            raise NotSymbolicError("it is nested, zero, or has roots of s")
        return _in_groups(tf)
    except SymflexError as error:
        return SymbolicForm(tf, (), (f"no groups: {error.diagnostics[0].message}",))


def _in_groups(tf: TransferFunction) -> SymbolicForm:
    parameters = {p.name: p for p in tf.parameters if not p.is_imaginary}
    if missing := next((n for n, p in parameters.items() if not p.unit and p.value is None), None):
        raise NotSymbolicError(f"nothing says which unit '{missing}' has")
    groups, scale = _basis(tf, parameters)
    base = {name: ExactValue(ONE) for name in parameters if name not in groups}
    model = with_numbers(tf.model, groups, base, in_kernels=True)
    form = print_form(derive_all(model, [(tf.output.name, tf.input.name)])[0])
    if form.laws:
        raise NotSymbolicError("its waves have no formula")
    naming = Naming.of(tf)
    # A form may take the names of the base, which it does not know.
    freed = {name: Name(naming.take(name)[0]) for name, _ in form.where if name in base}
    naming.keep(name for name, _ in form.where)
    rows, images = _named_groups(tf, naming, groups, parameters)
    function, lines = _in_names(tf, form, freed | images)
    size = written_powers({Name(name): scale[name] for name in (*parameters, S.name) if name in scale})
    head = Row(tf.name, " = scale *", rf"{ratio_latex(tf)} &= \text{{scale}} \cdot", function)
    named = [Row(name, " =", f"{symbol(name, {}).latex} &=", line) for name, line in lines.items()]
    sized = _row(tf, "scale", size)._replace(left=r"\text{scale} &=", unit=tf.unit)
    found = SymbolicForm(tf, (head, *named, sized, *rows))
    _check(found)
    return found


def _basis(
    tf: TransferFunction, parameters: Mapping[str, ModelParameter]
) -> tuple[dict[str, Exponents], Exponents]:
    """Return the groups, by the quantity that each divides by powers of a base, and the scale."""
    named = {S.name, *parameters}
    wanted = {format_expression(x): _exponents(opened(tf, x)) or {} for x in tf.model.analysis.prefer}
    wanted = {text: row for text, row in wanted.items() if set(row) <= named}  # else of another function
    divisors = {name for row in wanted.values() for name in list(row)[1:]}
    # The best ones for a base come last.
    ordered = sorted(parameters.values(), key=lambda p: (p.name in divisors, _choice(tf, p)))
    others = [*tf.kernels.wavenumbers, *(c.generator for c in tf.constants)]
    invariant, scale = _invariants(tf)
    echelon = _echelon(invariant, [*others, S.name, *(p.name for p in ordered)])
    for pivot, row in echelon.items():
        scale = times((scale, ONE), (row, -scale.get(pivot, Fraction(0))))
    groups = {name: echelon[name] for name in (S.name, *parameters) if name in echelon}
    for text, row in wanted.items():
        main = next(iter(row), "")
        if main not in groups or times((row, ONE), (groups[main], -row[main])):
            raise NotSymbolicError(f"'{text}' in prefer of [analysis] is not a group, or not beside others")
    return groups, scale


def _named_groups(
    tf: TransferFunction,
    naming: Naming,
    groups: Mapping[str, Exponents],
    parameters: Mapping[str, ModelParameter],
) -> tuple[list[Row], dict[str, Expression]]:
    """Return a row for each group, with its usual name, and what quantities are in these names."""
    rows: list[Row] = []
    images: dict[str, Expression] = {} if S.name in groups else {S.name: e.number(1)}
    units = {p.name: unit_of(p.unit or "1").dimension for p in tf.parameters} | {S.name: Dimension(s=-ONE)}
    for main, row in groups.items():
        unit = str(units[main]) if main != S.name else ""
        name, words = ("S", "") if main == S.name else RATIOS.get(unit, ("Pi", ""))
        is_ratio = unit in DAMPERS and {abs(n) for k, n in row.items() if k != main} == {ONE / 2}
        (name,), words = naming.take("zeta" if is_ratio else name), "damping ratio" if is_ratio else words
        halves: dict[Expression, Fraction] = {e.number(2): ONE} if is_ratio else {}
        powers: dict[Expression, Fraction] = {Name(k): row[k] for k in (main, *parameters) if k in row}
        group = written_powers(times((powers, ONE), (halves, -ONE)))
        remainder = prod((units[n] ** x for n, x in row.items()), start=Dimension())
        if remainder != Dimension():
            raise NotSymbolicError(f"{format_expression(group)} would be one, and is in {remainder}")
        images[main] = written_powers(halves | {Name(name): ONE})
        rows.append(_row(tf, name, group, words))
    return rows, images


def _in_names(
    tf: TransferFunction, form: PrintedForm, images: Mapping[str, Expression]
) -> tuple[Expression, dict[str, Expression]]:
    """Return a form and its lines with groups in place of quantities."""
    one, meant = e.number(1), dict(definitions_of(tf))
    lines = {n: e.replace_node(plain(line, {}), e.Call("sqrt", one), one) for n, line in form.where}
    # The model's own names mean something else in groups; what is only another name is left out as well.
    inside = {name: lines.pop(name) for name in (*lines,) if name in meant or isinstance(lines[name], Name)}
    function = e.quotient(form.num, form.den)
    for put in (*[inside] * len(inside), images):
        function, lines = plain(function, put), {name: plain(line, put) for name, line in lines.items()}
    return function, {format_expression(images.get(name, Name(name))): line for name, line in lines.items()}


def _row(tf: TransferFunction, name: str, expression: Expression, words: str = "") -> Row:
    value = None if S in e.names(expression) else value_of(tf, expression)
    return Row(name, " =", f"{symbol(name, {}).latex} &=", expression, words, value)


def _choice(tf: TransferFunction, parameter: ModelParameter) -> tuple[bool, int, int]:
    """Return a key that is larger, the better a parameter serves as one of the base."""
    data = [x for law in tf.kernels.dispersions if law.wavenumbers for x in law.coefficients]
    data += [k.length for k in tf.kernels.kernels if k.wavenumber]
    waves = tf.ring.used_in(f for x in data for f, _ in x.factors)
    members = (use for use in tf.model.elements if isinstance(use.element, LineElement))
    waves |= {n.name for use in members for _, x in use.values for n in e.names(opened(tf, x))}
    unit = str(unit_of(parameter.unit or "1").dimension)
    rank = BASE.index(unit) if unit in BASE else len(BASE) + (unit in DAMPERS) + 2 * (unit == "1")
    return parameter.name in waves, -rank, -tf.model.parameters.index(parameter)


def _echelon(rows: Sequence[Exponents], columns: Sequence[str]) -> dict[str, Exponents]:
    """Return the reduced echelon form of rows, by the column in which each begins."""
    zero, found = Fraction(0), {}
    table = [[fmpq(*row.get(name, zero).as_integer_ratio()) for name in columns] for row in rows]
    reduced, rank = fmpq_mat(table or [[fmpq(0)]]).rref()
    for i in range(rank):
        values = {name: reduced[i, j] for j, name in enumerate(columns)}
        row = {name: Fraction(int(x.p), int(x.q)) for name, x in values.items() if x != 0}
        found[next(iter(row))] = row
    return found


def _invariants(tf: TransferFunction) -> tuple[list[Exponents], Exponents]:
    """Return products that no change of scale alters, and one that changes as the function does."""
    rows: list[Exponents] = []
    silent = {"pi", *(k.generator for k in tf.kernels.kernels)}

    def powers(value: Factored) -> Exponents:
        total: Exponents = {}
        names = value.ring.names
        for factor, exponent in value.factors:
            monomials = [[(names[i], Fraction(n)) for i, n in m] for m, _ in terms_of(factor)]
            first, *more = ({name: n for name, n in m if name not in silent} for m in monomials)
            rows.extend(times((other, ONE), (first, -ONE)) for other in more)
            total = times((total, ONE), (first, Fraction(exponent)))
        return total

    scale = powers(tf.ratio)
    for law in tf.kernels.dispersions:
        orders = {"wave": {0: 2}, "bending": {0: 4}, "pair": {0: 4, 2: 2}, "exponential": {}}.get(law.kind)
        if orders is None:
            raise NotSymbolicError("its waves have no formula")
        for i, n in orders.items():
            exponents = powers(law.characteristic[i])
            rows += [times(({w: Fraction(n)}, ONE), (exponents, -ONE)) for w in law.wavenumbers]
    for k in tf.kernels.kernels:
        rate = {k.wavenumber: ONE} if k.wavenumber else powers(k.dispersion.shift)
        rows.append(times((rate, ONE), (powers(k.length), ONE)))
    for constant in tf.constants:
        is_root, inside = constant.expression.name == "sqrt", constant.expression.argument
        squared = powers(factored_of(inside, tf.ratio.ring)) if is_root else {}
        rows.append(times(({constant.generator: Fraction(2)}, ONE), (squared, -ONE)))
        rows += [{n.name: ONE} for n in e.names(inside) if isinstance(n, Name) and not is_root]
    return rows, scale


def _exponents(expression: Expression) -> Exponents | None:
    """Return a product as powers of names, None where it contains a sum or another function."""
    parts: list[tuple[Exponents, Fraction]] = []
    for base, n in powers_of(expression)[1].items():
        inside = _exponents(base.argument) if isinstance(base, e.Call) and base.name == "sqrt" else None
        if inside is None and not isinstance(base, Name):
            return None
        exponents = {base.name: Fraction(2)} if isinstance(base, Name) else inside or {}
        parts.append((exponents, Fraction(n, 2)))
    return times(*parts)


def _check(found: SymbolicForm) -> None:
    """Compare what is shown, read again, with the function at its test points."""
    probes = probes_of(found.tf)
    lines = {r.name: e.parse(Text.alone("<group>", format_expression(r.expression))) for r in found.rows}
    term = e.product_of([lines["scale"], lines.pop(found.tf.name)])
    for _ in lines:
        term = e.substitute(term, lines)
    chosen = range(len(probes.points))
    with precision(BITS):
        known = probes.numbers(chosen, BITS)
        shown = principal_values(opened(found.tf, term), len(chosen), known.__getitem__)
        pairs = [(x, y) for x, y in zip(shown, probes.values(BITS), strict=True) if x.is_finite()]
    if not pairs or not all(x.overlaps(y) and x.rel_accuracy_bits() > ENOUGH for x, y in pairs):
        raise NotSymbolicError("what was found is not proved")
