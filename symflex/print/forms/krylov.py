"""Krylov-Duncan functions, in which numerator and denominator are seen to be entire in s."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from symflex.algebra import Factored
from symflex.expressions import Expression, Name, negative, number, power, product_of, quotient, sum_of
from symflex.print.forms.arrange import Arranger, shortest_sides
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.bending import krylov_of_beta
from symflex.print.forms.invariants import Invariants, in_krylov_functions, krylov_name
from symflex.print.forms.kept import KeptDefinitions
from symflex.print.forms.naming import Naming
from symflex.print.forms.notation import Line, constant_symbols, notation_of, reachable, wavenumber_laws
from symflex.print.forms.polynomial import in_kernels
from symflex.print.forms.printed import BegunForm, PrintedForm, terms_of

if TYPE_CHECKING:
    from symflex.print.forms.notation import Angle
    from symflex.transfer import TransferFunction


def krylov_draft(tf: TransferFunction, arranged: Arranged) -> BegunForm | None:
    """Begin the form in ``K_0, K_1, ...`` of the lengths, solutions along x for unit initial data.

    For a beam ``K_0 = (cosh(q) + cos(q))/2``, ``K_1 = (sinh(q) + sin(q))/(2*beta)``, ...; where
    exponents have no formula, the solutions and their derivatives at the ends stand as ``h(l)``, ``h'(l)``.
    """
    if not tf.has_formula:
        return BegunForm(terms_of(tf.ratio), partial(in_kernels, tf, "krylov", tf.ratio, arranged))
    converted = in_krylov_functions(tf.ratio.ring, tf.kernels, tf.ratio)
    if converted is None:
        return None
    own, change, value = krylov_of_beta(tf, *converted)
    return BegunForm(terms_of(value), partial(_krylov, own, change, value, arranged))


def _krylov(tf: TransferFunction, change: Invariants, value: Factored, arranged: Arranged) -> PrintedForm:
    """Return the form of a value over the ring of the change."""
    ring = change.ring
    used = ring.used_in(f for f, _ in value.factors)
    naming = Naming.of(tf)
    families: list[tuple[str, ...]] = []
    explained: set[str] = set(used)
    for i, group in enumerate(change.angles):
        orders = range(_order(group))
        shown = [order for order in orders if krylov_name(i, order) in used]
        families.append(naming.family("KLMNH", len(orders)) if shown else ("",) * len(orders))
        explained |= {g for a in group for g in a.kernels.values()} if shown else set()
        explained |= {group[0].wavenumber} if any(shown) or (shown and len(group) > 1) else set()
    notation = notation_of(tf, explained, naming, change.table)
    symbols = {**constant_symbols(tf), **notation.symbols}
    lines: list[Line] = []
    for i, group in enumerate(change.angles):
        for order, (name, line) in enumerate(zip(families[i], _functions(group, symbols), strict=True)):
            symbols[krylov_name(i, order)] = Name(name)
            lines.append((name, line))
    lines += notation.lines
    functions = (g for g in ring.names if g.startswith("K") and g in symbols and g not in tf.ratio.ring.index)
    decays = (k.generator for k in tf.kernels.kernels if not k.wavenumber)
    printer = arranged.printer(
        Arranger.plain(ring, symbols, (*functions, *decays), KeptDefinitions.of(tf, ring))
    )
    laws = {w: one.over(change.ring) for w, one in wavenumber_laws(tf).items()}
    sides = shortest_sides(printer, value, laws)
    return PrintedForm("krylov", *sides, reachable(sides, lines))


def _order(group: tuple[Angle, ...]) -> int:
    return group[0].dispersion.order


def _functions(group: tuple[Angle, ...], symbols: dict[str, Expression]) -> list[Expression]:
    """Return what ``K_0, K_1, ...`` of one argument are."""
    if any(g not in symbols for a in group for g in a.kernels.values()):
        return [number(0)] * _order(group)
    first = {f: symbols[g] for f, g in group[0].kernels.items()}
    wave = symbols[group[0].wavenumber]
    match group[0].dispersion.kind:
        case "wave":
            return [first["cosh"], quotient(first["sinh"], wave)]
        case "bending":
            pairs = [("cosh", "cos"), ("sinh", "sin")]
            return [
                quotient(
                    sum_of([first[grows], first[turns] if order < len(pairs) else negative(first[turns])]),
                    product_of([number(2), power(wave, order)]),
                )
                for order, (grows, turns) in enumerate([*pairs, *pairs])
            ]
    second = {f: symbols[g] for f, g in group[1].kernels.items()}
    x, y = wave, symbols[group[1].wavenumber]
    below = sum_of([power(x, 2), negative(power(y, 2))])
    return [
        quotient(_difference([power(x, 2), second["cosh"]], [power(y, 2), first["cosh"]]), below),
        quotient(
            _difference(
                [quotient(power(x, 2), y), second["sinh"]], [quotient(power(y, 2), x), first["sinh"]]
            ),
            below,
        ),
        quotient(_difference([first["cosh"]], [second["cosh"]]), below),
        quotient(sum_of([quotient(first["sinh"], x), negative(quotient(second["sinh"], y))]), below),
    ]


def _difference(left: list[Expression], right: list[Expression]) -> Expression:
    return sum_of([product_of(left), negative(product_of(right))])
