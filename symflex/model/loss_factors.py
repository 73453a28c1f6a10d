"""Structural damping: loss factors of elements, and the imaginary unit in values and coefficients.

A stiffness with a loss factor is ``k*(1 + j*eta_s)`` (Myklestad 1952; Bishop & Johnson 1960, The Mechanics
of Vibration, chapter 9). It describes steady motion, s = j omega with omega > 0, and is not causal: it
belongs to no differential equation with real coefficients, so nothing is said of other s.

Example: ``{ type = "spring", k = "k", eta_s = "eta" }`` has the value ``k*(1 + j*eta)`` from here on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from symflex.algebra import LAPLACE
from symflex.errors import Diagnostic, ModelError, Span
from symflex.expressions import Name, Number, Product, Sum, names, names_among, number, product_of, sum_of
from symflex.expressions.nodes import nodes
from symflex.model.model import IMAGINARY, J, Model, ModelParameter, NamedExpressions

if TYPE_CHECKING:
    from symflex.library.elements import Element
    from symflex.model.network import Draft
    from symflex.model.reading import Reader

LOSS_FACTOR = "eta_s"
WITH_ROOTS = (
    "code in this language",
    "stability of a loop",
    "a value at another s",
    "a response at omega <= 0",
    "a response in time",
    "a step response",
)
"""What is available with roots of s."""
WITH_LOSSES = ("a sensitivity", "a mode shape", "a deflection", "an explanation of zeros")
"""What is available with loss factors and complex coefficients, as it asks the equations at a root alone."""
WITH_COMPLEX = (
    "stability of a loop",
    "stability over a parameter",
    "a value at another s",
    "a response at omega <= 0",
)
"""What is available with complex coefficients beside it: they hold at every s."""
LOSSY = ("k", "E", "G", "EI", "EA", "GJ", "kappaGA")  # values of elements that their loss factor multiplies


def with_imaginary_unit(reader: Reader, draft: Draft) -> Draft:
    """Return a draft with j among its parameters where it is used and means nothing else."""
    here = next(_uses(draft), None)
    taken: dict[str, Span | None] = {n.name: None for n in draft.nodes}
    taken |= {p.name: p.span for p in draft.declared}
    taken |= {x.name: x.span for x in draft.definitions}
    taken |= {x.name: x.span for x in draft.blocks}
    taken |= {x.name: x.span for x in draft.signals}
    taken |= {x.input.name: x.input.span for x in draft.inputs}
    taken |= {u: f.span for f in draft.fields for u in f.unknowns}
    if IMAGINARY in taken:
        if here is not None and here[1]:
            message = (
                f"'{IMAGINARY}' is the imaginary unit where an element has a loss factor, and a name here"
            )
            reader.note("SF211", message, taken[IMAGINARY] or here[0], "rename what the model calls j")
        return draft
    if here is None:
        return draft
    from symflex.model.complex_values import with_real_values  # loaded where j is used

    draft = with_real_values(draft)
    here = next(_uses(draft), None)
    if here is None or any(p.name == IMAGINARY for p in draft.inherited):
        return draft
    unit = ModelParameter(IMAGINARY, J, "1", "real", doc="imaginary unit", span=here[0])
    return replace(draft, inherited=(*draft.inherited, unit))


def _uses(draft: Draft) -> Iterator[tuple[Span | None, bool]]:
    """Yield where loss factors stand, and where j does, each with whether it is a loss factor."""
    expressions = [d.expression for d in draft.definitions]
    for use in draft.elements:
        expressions += [e for _, e in use.values]
        factor = dict(use.values).get(LOSS_FACTOR)
        if factor is not None and factor != number(0):
            yield factor.span or use.span, True
    for field in draft.fields:
        expressions += [*field.equations, *field.conditions]
    expressions += [e for block in draft.blocks for _, e in block.values]
    expressions += [x.expression for x in draft.signals] + [x.expression for x in draft.outputs]
    for expression in expressions:
        yield from ((n.span, False) for n in names(expression) if n == Name(IMAGINARY))


def with_loss(element: Element, values: NamedExpressions) -> NamedExpressions:
    """Return an element's values with its stiffnesses times ``1 + j*eta_s``."""
    factor = dict(values).get(LOSS_FACTOR)
    if factor is None or (isinstance(factor, Number) and not factor.value):
        return values
    lossy = {p.name for p in element.parameters if p.name in LOSSY}
    loss = sum_of([number(1), product_of([Name(IMAGINARY), factor])])
    return tuple((n, replace(product_of([e, loss]), span=e.span) if n in lossy else e) for n, e in values)


def has_loss_factors(model: Model) -> bool:
    """Tell whether j belongs to loss factors, so that a model is valid on s = j*omega, omega > 0, alone."""
    # It does in values of elements and in fields, but beside s, and in ``1 + j*eta``. Elsewhere coefficients
    # are complex at every s, as of a motor's currents in axes that turn, or of a rotor's deflection x + j*y.
    if model.imaginary is None:
        return False
    unit, held = Name(IMAGINARY), {IMAGINARY}
    for _ in model.definitions:
        held |= {d.name for d in model.definitions if names_among(d.expression, held)}
    stiff = [e for use in model.elements for _, e in use.all_values]
    stiff += [e for f in model.fields for e in (*f.equations, *f.conditions)]
    parts = [n for e in stiff for n in nodes(e) if isinstance(n, Product) and unit in n.factors]
    sums = [n.terms for _, e in model.expressions() for n in nodes(e) if isinstance(n, Sum)]
    # In axes that turn s becomes s - j*Omega.
    turns = any(Name(LAPLACE) in t and any(unit in names(x) for x in t) for t in sums)
    is_beside_s = turns or any(Name(LAPLACE) in names(p) for p in parts)
    if any(names_among(e, held) for e in stiff) and not is_beside_s:
        return True
    pairs = (t for t in sums if len(t) == 2 and number(1) in t)  # noqa: PLR2004 (1 + j*eta)
    return any(unit in names(x) and Name(LAPLACE) not in names(x) for t in pairs for x in t)


def check_causal(model: object, what: str) -> None:
    """Refuse what j (SF251) or roots of s (SF910) in a model do not allow; other subjects pass."""
    if getattr(model, "root", None) is not None and what not in WITH_ROOTS:
        message = f"{what} is not available yet for models with roots of s, such as sqrt(s)"
        hint = "formulas, frequency responses, responses in time, poles, zeros, stable gains and code are"
        raise ModelError(Diagnostic("SF910", message, None, hint))
    unit = getattr(model, "imaginary", None)
    is_lossy = unit is not None and has_loss_factors(cast("Model", model))
    if unit is None or what in WITH_LOSSES or (what in WITH_COMPLEX and not is_lossy):
        return
    message = f"{what} is not available with loss factors (j): these hold only on s = j*omega, omega > 0"
    hint = (
        "formulas, frequency responses, modes (roots), their shapes and sensitivities, and numpy code are "
        "available; a damper or eta in seconds holds at every s"
    )
    if not is_lossy:
        message = f"{what} is not available with complex coefficients (j)"
        hint = (
            "formulas, frequency responses, roots, stability and numpy code are available; "
            "if the model is real, complex values must come in conjugate pairs"
        )
    raise ModelError(Diagnostic("SF251", message, unit.span, hint))
