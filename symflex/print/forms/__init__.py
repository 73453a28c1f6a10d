"""Forms of a transfer function. A new form is one function and one line in ``FORMS``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from typing import Any

from symflex.algebra import LAPLACE, degree_in
from symflex.errors import Diagnostic, InternalError, UsageError, nearest, no_such, refused
from symflex.expressions import (
    Expression,
    Name,
    Number,
    Sum,
    format_expression,
    names,
    names_in,
    nodes,
    once,
    quotient,
    replace_node,
    sums_in,
)
from symflex.print.forms.arrange import Arranger, is_long_product, length, reading
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.definitions import definitions_form, shows_origin, tidied_sum
from symflex.print.forms.hidden import hidden_expressions, with_hidden
from symflex.print.forms.naming import Naming, names_of
from symflex.print.forms.notation import plain_printer, reachable
from symflex.print.forms.polynomial import (
    constant_form,
    factored_draft,
    factored_form,
    hyperbolic_draft,
    monic_form,
    polynomial_form,
)
from symflex.print.forms.printed import (
    KERNELS_ONLY,
    NOT_ENTIRE,
    Arrange,
    Begin,
    PrintedForm,
    counts_of,
    forms_of,
    lacks,
    require,
)
from symflex.print.forms.shapes import S, powers_of, shaped
from symflex.print.read_back import read_back
from symflex.transfer import AnyTransferFunction, NestedTransferFunction, TransferFunction


def _later(name: str, what: str = "form") -> Callable[..., Any]:
    """Return a form, or the draft of one, whose module is imported when it is asked for."""

    def made(*arguments: object) -> object:
        """Do what the function of that name in its module does."""
        return getattr(import_module(f"symflex.print.forms.{name}"), f"{name}_{what}")(*arguments)

    return made


def _finished(name: str) -> Arrange:
    """Return a form that is begun as when it is a candidate for the shortest one."""

    def made(tf: TransferFunction) -> PrintedForm:
        """Begin and finish the form."""
        draft = DISTRIBUTED_CANDIDATES[name](tf, Arranged())
        if draft is None:
            raise lacks(tf, name, NOT_ENTIRE)
        return draft.finish()

    return made


FORMS: dict[str, Arrange] = {
    "polynomial": polynomial_form,
    "monic": monic_form,
    "constant": constant_form,
    "factored": factored_form,
    "definitions": definitions_form,
    "zpk": _later("zpk"),
    "hyperbolic": _finished("hyperbolic"),
    "krylov": _finished("krylov"),
    "vaughan": _finished("vaughan"),
    "frequency": _later("frequency"),
}

DECIMAL_FORMS = ("zpk",)  # those that print decimals, to the digits requested
OF_SUMS = ("hyperbolic", "factored")  # those that may have kernels of two lengths and of their sum
OF_THEIR_OWN = (
    "vaughan",
    "krylov",
    "frequency",
)  # those that make functions of their own
AS_ARRANGED = ("zpk", "frequency")  # those that are not functions of s, or print decimals anyway
LARGE = 300  # number of expanded terms from which only the closed form is tried: no expanded print is shorter
CANDIDATES = ("definitions", "factored", "polynomial")
"""The symbolic forms of rational functions; the shortest print is the default, ties go to the first."""
DISTRIBUTED_CANDIDATES: dict[str, Begin] = {  # the same for functions with kernels
    "hyperbolic": hyperbolic_draft,
    "factored": factored_draft,
    "vaughan": _later("vaughan", "draft"),
    "krylov": _later("krylov", "draft"),
}
UNSHAPED = 2  # how many times as long as the shortest form is before it is shaped another may be, and win
LONG = 200  # characters of a form from which sums of blocks stay as written, where that is much shorter
SHORTER = 1.5  # how many times as long a form of one fraction has to be
READABLE = 10**20  # a whole number beyond which a function without parameters is printed in decimals, as zpk
CLOSED = 1.1  # how many times shorter a lumped form has to read with its definitions closed
LOOKED_UP = 1.2  # how many times as long functions read that have to be looked up, such as ``K_1``
SHARED = 5  # characters that a factor before a sum is worth which all its terms have
FEW = 60  # terms up to which every form is arranged: that takes some hundredths of a second
ONE_LINE = 60  # characters of a denominator beyond which functions that share it print it once
REPEATED = "P"  # the name of a sum that is repeated
REPEATED_LENGTH, REPEATED_CONSTANT = 25, 40  # characters from which that is long, and without s
REPEATED_SAVING = 50  # characters that its name must save
MORE = 1.25  # how many times the fewest terms another form may have, and still print shorter


def print_form(
    tf: AnyTransferFunction,
    form: str | None = None,
    digits: int = 6,
    arranged: Arranged | None = None,
    *,
    is_read: bool = False,
) -> PrintedForm:
    """Return a transfer function in the named form, or in the one that prints shortest.

    ``form`` is a key of :data:`FORMS`. What is ``arranged`` already, of functions of the same model, is not
    arranged again. Where a person reads it, long sums that are repeated are names. Raises SF902 when there is
    no such form, SF229 when it needs numbers; SF992 when the form, read back, is not the function.
    """
    made = _arranged(tf, form, digits, arranged or Arranged())
    if is_read and isinstance(tf, TransferFunction) and made.name not in AS_ARRANGED:
        made = with_repeated_named(tf, made)
    read_back(tf, made, digits if made.name in DECIMAL_FORMS else None)
    return in_s(tf, made)


def print_part(
    tf: TransferFunction, form: str | None = None, digits: int = 6, arranged: Arranged | None = None
) -> PrintedForm:
    """Return what stands in place of a function, such as one side of it, before it is read back.

    It is read back, and written :func:`in_s`, by whoever puts the parts together.
    """
    if form is not None and form not in FORMS:
        raise no_such("form", form, FORMS)
    arrange = _lumped if tf.is_rational else _distributed
    return arrange(tf, form, digits, arranged or Arranged())


def in_s(tf: AnyTransferFunction, made: PrintedForm) -> PrintedForm:
    """Return a form in s where the function's ring has a root of s in its place."""
    if tf.model.root is None:
        return made
    written = {d.name: d.expression for d in tf.model.definitions if d.name in made.definitions}
    from symflex.print.forms.root_of_s import in_roots  # few models have one

    where = tuple((name, written.get(name) or in_roots(e, tf.model.root)) for name, e in made.where)
    return replace(
        made, num=in_roots(made.num, tf.model.root), den=in_roots(made.den, tf.model.root), where=where
    )


def _arranged(tf: AnyTransferFunction, form: str | None, digits: int, arranged: Arranged) -> PrintedForm:
    if isinstance(tf, NestedTransferFunction):
        if form not in (None, "nested"):
            message = f"{tf.name} was derived in nested form, which cannot be expanded into other forms"
            raise refused(message, "ask for the expanded representation")
        from symflex.print.forms.nested import nested_form  # only with large models

        return nested_form(tf)
    if form == "nested":
        raise refused(f"{tf.name} is derived in expanded form", "ask for the nested representation")
    if form is not None and form not in FORMS:
        raise no_such("form", form, FORMS)
    if form is None:
        if tf.model.analysis.print:
            from symflex.print.forms.own import own_form  # few models ask for it

            if (own := _proposed(tf, own_form(tf), arranged)) is not None:
                return own
        if (wanted := tf.model.analysis.form) in forms_of(tf):
            form = wanted
    if not tf.is_rational:
        made = _distributed(tf, form, digits, arranged)
    else:
        made = _lumped(tf, form, digits, arranged)
        if form is None and not tf.model.root and is_unreadable((made.num, made.den)):
            return _made(tf, "zpk", digits, arranged)
    if form is None and _length(made) > LONG and (written := _written(tf, arranged)) is not None:
        return min((made, written), key=lambda f: _length(f) * (1 if f is made else SHORTER))
    return made


def is_unreadable(parts: Sequence[Expression]) -> bool:
    """Tell whether a function without parameters has whole numbers that nobody reads."""
    if any(isinstance(n, Name) and n != S for e in parts for n in names_in(e)):
        return False
    numbers = (abs(n.value.numerator) for e in parts for n in nodes(e) if isinstance(n, Number))
    return max(numbers, default=0) > READABLE


def _distributed(tf: TransferFunction, form: str | None, digits: int, arranged: Arranged) -> PrintedForm:
    """Return a form with definitions closed, or with them opened where that is much shorter."""
    from symflex.print.forms.bending import as_in_books  # only with beams
    from symflex.print.forms.economical import added, economical

    def shortest(own: TransferFunction) -> PrintedForm:
        each = economical(own)
        of_beams = as_in_books(each)
        whole = added(of_beams)
        if form is None:
            made = tuple(_drafted(each, whole, arranged))
        else:
            own_kernels = whole if form in OF_SUMS else each if form in OF_THEIR_OWN else of_beams
            made = (_made(own_kernels, form, digits, arranged),)
        return replace(min(made, key=_length), source=own)

    closed, opened = arranged.definitions.of(tf), shortest(tf)
    if closed is None or closed.is_rational:
        return opened
    kept = shortest(closed)
    return opened if MORE * _length(opened) < _length(kept) else kept


def _lumped(tf: TransferFunction, form: str | None, digits: int, arranged: Arranged) -> PrintedForm:
    """Return a form, definitions closed where that is shorter and no form was asked for."""

    def shortest(own: TransferFunction) -> PrintedForm:
        if form:
            return _made(own, form, digits, arranged)
        begun = [FORMS[name](own, arranged) for name in _candidates(own)]
        rough = {made.name: length(made.num, made.den) for made in begun if not is_hiding(made)}
        most = max(LONG, UNSHAPED * min(rough.values(), default=0))
        made = (_explained(own, f, arranged) for f in begun if rough.get(f.name, 0) <= most)
        return min(made, key=lambda f: (is_hiding(f), _length(f)))

    def is_hiding(made: PrintedForm) -> bool:
        return not (form or tf.is_large or shows_origin(tf.ratio, made.num, made.den))

    opened = shortest(tf)
    is_kept = form is None and bool(tf.definitions)
    closed = arranged.definitions.of(tf) if is_kept else None
    # What cancels only where definitions are opened would stand in both sides.
    if closed is None or _order(closed) > _order(tf):
        return opened
    kept = replace(shortest(closed), source=closed)
    is_better = is_hiding(opened) or not is_hiding(kept)
    return kept if is_better and CLOSED * _read(kept) < _read(opened) else opened


def _read(form: PrintedForm) -> float:
    """Return the length of a form and half of that of its definitions, which a reader looks up."""
    return _length(form) + length(*(e for name, e in form.where if name in form.definitions)) / 2


def _order(tf: TransferFunction) -> int:
    return sum(degree_in(f, 0) * e for f, e in tf.num.factors)


def _written(tf: TransferFunction, arranged: Arranged) -> PrintedForm | None:
    """Return a function as a sum of blocks, None if it is not written so."""
    from symflex.print.forms.written import written_form  # few prints are so long

    return _proposed(tf, written_form(tf), arranged)


def _proposed(tf: TransferFunction, made: PrintedForm | None, arranged: Arranged) -> PrintedForm | None:
    """Return a form that nobody asked for, made from a text or from values alone, if it is read back."""
    if made is None:
        return None
    made = _explained(tf, made, arranged)
    try:
        read_back(tf, made)
    except InternalError:
        return None
    return made


def _made(tf: TransferFunction, form: str, digits: int, arranged: Arranged) -> PrintedForm:
    require(tf, form)
    arguments = (tf, digits) if form in DECIMAL_FORMS else (tf,)
    return _explained(tf, FORMS[form](*arguments), arranged)


def _drafted(tf: TransferFunction, whole: TransferFunction, arranged: Arranged) -> Iterator[PrintedForm]:
    """Yield the forms of a function with kernels that might print shortest, always some."""
    begun = [
        DISTRIBUTED_CANDIDATES[name](whole if name in OF_SUMS else tf, arranged) for name in _candidates(tf)
    ]
    drafts = [draft for draft in begun if draft is not None]
    most = max(FEW, MORE * min(draft.terms for draft in drafts))
    yield from (_explained(tf, draft.finish(), arranged) for draft in drafts if draft.terms <= most)


def _explained(tf: TransferFunction, made: PrintedForm, arranged: Arranged) -> PrintedForm:
    """Return a form as a person would write it, with the definitions that occur in it."""
    if made.name not in AS_ARRANGED:
        made = shaped(tf.model, made, arranged.signs(tf.model))
    explained = {name for name, _ in made.where}
    parts = (made.num, made.den, *(e for _, e in made.where), *(law for _, law in (*made.laws, *made.closed)))
    meanings = {d.name: d.expression for d in tf.model.definitions if d.name not in explained}
    if tf.model.root is not None:  # a form is arranged, and read back, in the root of s
        printer = plain_printer(tf, tf.base)
        values = {n: v for n, v in tf.definitions if n in meanings and v.depends_on(LAPLACE)}
        meanings |= {n: printer.quotient(value) for n, value in values.items()}
    lines = reachable(parts, meanings.items())
    return replace(made, where=(*made.where, *lines), definitions=frozenset(name for name, _ in lines))


def with_repeated_named(tf: TransferFunction, form: PrintedForm) -> PrintedForm:
    """Return a form in which a long sum that stands in several places is a name: ``P*(c*cosh(q) + P*s)``.

    Sides are named one after the other, so that functions of one denominator share it.
    """
    naming, put = Naming.of(tf), dict[Expression, Expression]()
    naming.keep(name for name, _ in form.where)

    def named(*parts: Expression) -> list[Expression]:
        """Return parts with names, and then what the new ones stand for, which bears names, too."""
        each = list(parts)
        for total, name in put.items():
            each = [replace_node(part, total, name) for part in each]
        while (repeated := _most_repeated(each)) is not None:
            put[repeated] = Name(*naming.take(REPEATED))
            each = [*(replace_node(part, repeated, put[repeated]) for part in each), repeated]
        return each

    den, *below = named(form.den)
    num, *above = named(form.num)
    called = (name.name for name in put.values() if isinstance(name, Name))
    # A sum without new names in it is arranged already.
    totals = (total if total in put else tidied_sum(total, tf.base.index) for total in (*below, *above))
    return replace(form, num=num, den=den, where=(*zip(called, totals, strict=True), *form.where))


def _most_repeated(parts: Sequence[Expression]) -> Sum | None:
    """Return the sum whose name saves most characters, None where none saves many."""
    counts = Counter(n for part in parts for n in nodes(part) if isinstance(n, Sum) and n not in parts)
    least = {n: REPEATED_LENGTH if S in names(n) else REPEATED_CONSTANT for n, m in counts.items() if m > 1}
    saved = {n: (counts[n] - 1) * length(n) for n, chars in least.items() if length(n) >= chars}
    best = max(saved, key=lambda n: saved[n], default=None)
    return best if best is not None and saved[best] >= REPEATED_SAVING else None


def print_forms(
    tfs: Sequence[AnyTransferFunction], form: str | None = None, digits: int = 6, *, is_read: bool = True
) -> tuple[tuple[PrintedForm, ...], tuple[str, ...]]:
    """Return all functions in a form, and a sentence on each that lacks it; SF902 when none has it."""
    printed: list[PrintedForm] = []
    sentences: list[str] = []
    refusal: UsageError | None = None
    arranged = Arranged()
    for tf in tfs:
        try:
            printed.append(print_form(tf, form, digits, arranged, is_read=is_read))
            own = [name for name, _ in tf.model.analysis.print]
            if own and form is None and not any(name in own for name, _ in printed[-1].where):
                sentences.append(
                    f"{tf.name} has no factor in {', '.join(own)}: in its {printed[-1].name} form"
                )
        except UsageError as error:
            refusal = refusal or error
            printed.append(print_form(tf, None, digits, arranged, is_read=is_read))
            sentences.append(f"{tf.name} has no {form} form: printed in its {printed[-1].name} form")
    if refusal is not None and len(sentences) == len(printed):
        raise refusal
    return tuple(printed), tuple(sentences)


def with_shared_denominators(
    tfs: Sequence[AnyTransferFunction], forms: Sequence[PrintedForm]
) -> tuple[PrintedForm, ...]:
    """Return forms in which each long denominator that several share is a name, which the first explains."""
    groups: dict[object, list[int]] = {}
    for i, (tf, form) in enumerate(zip(tfs, forms, strict=True)):
        if tf.model.root is None and form.name not in DECIMAL_FORMS:
            meaning = form.den, reachable((form.den,), form.where), form.laws, form.closed
            groups.setdefault(meaning, []).append(i)
    shared, naming = list(forms), Naming(())
    for tf, form in zip(tfs, forms, strict=True):
        parts = (form.num, form.den, *(e for _, e in (*form.where, *form.laws, *form.closed)))
        naming.keep((*names_of(tf.model), *(n.name for e in parts for n in names_in(e))))
        naming.keep(name for name, _ in (*form.where, *form.laws))
    if len(groups) > 1:
        naming.keep("D")  # LaTeX calls every long denominator D(s) that has no name
    for first, *others in groups.values():
        den = forms[first].den
        if not others or len(format_expression(den)) <= ONE_LINE:
            continue
        (name,) = naming.take("D")
        for i in (first, *others):
            named = replace(forms[i], den=Name(name), where=((name, den), *forms[i].where))
            read_back(tfs[i], named)
            shared[i] = named if i == first else replace(named, where=forms[i].where)
    return tuple(shared)


def terms_to_print(tf: AnyTransferFunction, form: str | None = None) -> int:
    """Return about how many terms a symbolic form prints; 0 where that is not known, or few in any case."""
    if not (tf.is_reduced and tf.is_rational) or form == "zpk":
        return 0
    closed = tf.closed if form in (None, "definitions") and tf.length > LARGE else None
    return tf.length if closed is None else len(closed.num) + len(closed.den)


def _candidates(tf: TransferFunction) -> tuple[str, ...]:
    candidates: tuple[str, ...] = CANDIDATES
    if tf.is_rational and not tf.is_large and (is_long_product(tf.num) or is_long_product(tf.den)):
        candidates = tuple(name for name in CANDIDATES if name != "polynomial")
    elif not tf.is_rational:
        own = forms_of(tf)
        if any(d.kind == "bending" for d in tf.kernels.dispersions):
            own = tuple(name for name in own if name != "vaughan")  # books have beams in beta
        candidates = tuple(name for name in DISTRIBUTED_CANDIDATES if name in own)
    return candidates if tf.length <= LARGE else candidates[:1]


def _length(form: PrintedForm) -> float:
    """Return the length of all but the model's definitions, which may stay closed."""
    parts = [form.num, form.den, *(e for name, e in form.where if name not in form.definitions)]
    if form.name == "krylov":
        return LOOKED_UP * length(*parts)
    return length(*parts) if form.name in KERNELS_ONLY else sum(map(reading, parts)) + _shared(*parts)


def _shared(*parts: Expression) -> int:
    """Return the characters that ``K*(T*s + 1)`` may take more than ``K*T*s + K``."""
    return SHARED * sum(map(_shares, frozenset().union(*map(sums_in, parts))))


@once
def _shares(total: Sum) -> bool:
    """Tell whether all terms of a sum have a factor in common."""
    shared = {*powers_of(total.terms[0])[1]}
    for term in total.terms[1:]:
        if not shared:
            return False
        shared.intersection_update(powers_of(term)[1])
    return bool(shared)


__all__ = [
    "CANDIDATES",
    "FORMS",
    "Arranger",
    "PrintedForm",
    "counts_of",
    "hidden_expressions",
    "in_s",
    "is_unreadable",
    "print_form",
    "print_forms",
    "print_part",
    "terms_to_print",
    "with_hidden",
    "with_shared_denominators",
]
