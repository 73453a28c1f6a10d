"""How many poles and zeros a lumped model keeps when its compliances are rigid, or its losses taken away.

Every stiffness (or damping coefficient) is multiplied by one new symbol, and the transfer function is derived
with that symbol alone among numbers. The leading (or trailing) coefficient in it of numerator and denominator
is the limit as the symbol grows without bound (or vanishes): an exact polynomial in s, whose degree counts
the roots that stay.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from symflex import pipeline
from symflex.algebra import LAPLACE
from symflex.expressions import Name, product_of
from symflex.model import ModelParameter, with_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from flint import fmpz_mpoly

    from symflex.algebra import Factored, Ring
    from symflex.expressions import Expression
    from symflex.model import Model, PlacedBlock, PlacedElement

Values = tuple[tuple[str, "Expression"], ...]
Counts = tuple[int, int]
"""Zeros and poles."""
RigidCounts = tuple[int | None, int]
"""The same; no zeros are counted where the function itself vanishes, or grows without bound."""

RESONANCES: Final = frozenset(("omega_p", "omega_z"))


def rigid_counts(model: Model) -> Mapping[tuple[str, str], RigidCounts]:
    """Return the zeros and poles of every transfer function as all compliances become rigid.

    Springs, torsion springs, massless beams and resonance blocks are stiffened; blocks that hold another
    model stay as they are. Distributed models have no such limit here.

    There are none of distributed models, and of models without any compliance. Zeros are None where nothing
    moves, as of a structure that only springs hold to ground.

    Examples
    --------
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.body = { type = "mass", at = "x", m = 2 }
    ... elements.tail = { type = "mass", at = "y", m = 3 }
    ... elements.link = { type = "spring", between = ["x", "y"], k = 12 }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> rigid_counts(model)
    {('X', 'F'): (0, 2)}
    >>> held = pipeline.loads('''
    ... symflex = 1
    ... elements.body = { type = "mass", at = "x", m = 2 }
    ... elements.link = { type = "spring", between = ["x", "ground"], k = 12 }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> rigid_counts(held)
    {('X', 'F'): (None, 0)}
    """

    def stiffened(use: PlacedElement) -> frozenset[str]:
        return frozenset(filter(None, (use.element.stiffness,)))

    def tuned(use: PlacedBlock) -> frozenset[str]:
        is_resonance = use.block is not None and use.block.type_name == "resonance"
        return RESONANCES if is_resonance else frozenset()

    return _limits(model, stiffened, tuned, max)


def undamped_counts(model: Model) -> Mapping[tuple[str, str], Counts]:
    """Return the zeros and poles of every transfer function as the coefficients of all dampers vanish.

    There are none of distributed models, and of models without dampers.
    """

    def lossy(use: PlacedElement) -> frozenset[str]:
        return frozenset(filter(None, (use.element.damping,)))

    found = _limits(model, lossy, lambda _: frozenset(), min)
    return {pair: (zeros, poles) for pair, (zeros, poles) in found.items() if zeros is not None}


def _limits(
    model: Model,
    of_element: Callable[[PlacedElement], frozenset[str]],
    of_block: Callable[[PlacedBlock], frozenset[str]],
    choose: Callable[[list[int]], int],
) -> dict[tuple[str, str], RigidCounts]:
    if model.is_distributed:
        return {}
    taken = (
        {p.name for p in model.parameters} | {n.name for n in model.nodes} | {x.name for x in model.signals}
    )
    taken |= (
        {d.name for d in model.definitions} | {b.name for b in model.blocks} | {i.name for i in model.inputs}
    )
    symbol = "scale"
    while symbol in taken:
        symbol += "_x"

    def scaled(values: Values, keys: frozenset[str]) -> Values:
        return tuple((k, product_of([Name(symbol), e]) if k in keys else e) for k, e in values)

    elements = tuple(replace(e, values=scaled(e.values, of_element(e))) for e in model.elements)
    blocks = tuple(replace(b, values=scaled(b.values, of_block(b))) for b in model.blocks)
    if elements == model.elements and blocks == model.blocks:
        return {}
    given = with_numbers(replace(model, elements=elements, blocks=blocks))
    given = replace(given, parameters=(*given.parameters, ModelParameter(symbol, None)))
    found = {}
    for tf in pipeline.derive_all(given, model.transfer_functions):
        ring = tf.ratio.ring
        if tf.ratio.is_zero or symbol not in ring.index:
            continue
        above, power = _limit(ring, tf.ratio.numerator(), symbol, choose)
        below, other_power = _limit(ring, tf.ratio.denominator(), symbol, choose)
        common = _degree(ring, above.gcd(below))
        zeros = _degree(ring, above) - common if power == other_power else None
        found[tf.output.name, tf.input.name] = (zeros, _degree(ring, below) - common)
    return found


def _limit(
    ring: Ring, value: Factored, symbol: str, choose: Callable[[list[int]], int]
) -> tuple[fmpz_mpoly, int]:
    """Return the limits of all factors, multiplied, and the power of the symbol that goes with them."""
    place = ring.index[symbol]
    found, power = ring.constant(1), 0
    for factor, exponent in value.factors:
        terms = {tuple(map(int, monomial)): int(c) for monomial, c in factor.terms()}
        kept = choose([monomial[place] for monomial in terms])
        limit = {(*m[:place], 0, *m[place + 1 :]): c for m, c in terms.items() if m[place] == kept}
        found, power = found * ring.context.from_dict(limit) ** exponent, power + kept * exponent
    return found, power


def _degree(ring: Ring, polynomial: fmpz_mpoly) -> int:
    return int(polynomial.degrees()[ring.index[LAPLACE]])
