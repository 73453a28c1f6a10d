"""May a pole of a model lie in the right half-plane or on the axis, and if not, why: by energy.

Input: a model with values, an output whose own poles count, names of parameters of which any positive value
is meant. Output: an :class:`EnergyProof`.

In ``x^H A(s) x/s`` mass, damping and stiffness are each nonnegative where no element supplies energy, and at
Re(s) > 0 their sum vanishes only where nothing moves: no pole lies there (Anderson & Vongpanitlerd 1973,
Network Analysis and Synthesis, chapter 2). Fields are treated in :mod:`symflex.roots.passive_fields`.

A force or torque that follows the motion it acts on, ``u = -K (alpha + beta s) q`` with alpha and beta not
negative, is a spring and a damper: added to such a structure it makes another one. The same holds of every
law whose force over velocity is positive real, as of filtered PD control, whose lead is a spring in series
with a damper. A pole lies on the axis only where nothing that dissipates moves, and what rests with that is
followed through the equations.

Example: PD control of the joint of a flexible arm. At a pole on the axis the joint rests, and no moment is
left on it: three of four states of the link vanish at its base. Then ``(EI y'')'' = rho A omega^2 y`` makes
deflection, slope, moment and shear grow from there with one sign, and a mass at the tip would have to pull
where it pushes. So the link rests too: no pole is on the axis, at any frequency.

Uniform members that are compressed supply energy to slow motion only. Over s their energy is
``rho A |w|^2 s + (EI |w''|^2 - P |w'|^2)/s``, and on a length l the integral of ``|w'|^2`` is at most that of
``e |w''|^2 + (1/e + 12/l^2) |w|^2`` for every e (Redheffer 1963): with ``e = EI/P`` the real part is positive
from ``abs(s)^2 = P/(rho A) (P/(EI) + 12/l^2)`` on.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from math import atan2, pi, prod

from flint import arb

from symflex.algebra import LAPLACE, Factored, terms_of
from symflex.balls import ball, precision
from symflex.equations import Equations
from symflex.expressions import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Power,
    Product,
    Quotient,
    Sum,
    names_among,
    nodes,
    substitute,
)
from symflex.library.elements import CIRCUITS, LinearForm, Terms, Variable
from symflex.library.elements.line import Beam, LineElement
from symflex.library.elements.lumped import ThroughSource
from symflex.model import ExactValue, Model, Output, PlacedElement, Signal
from symflex.model.along import COORDINATE
from symflex.model.network import variable_of
from symflex.model.signs import Line, follows_inputs, line_of, parameter_signs, value_along
from symflex.roots.passive_fields import BITS, INERTIA, fields_supply_nothing, free_terms
from symflex.roots.root import ROUNDING
from symflex.transfer.of_model import assemble

PASSIVE = "passive, nothing supplies energy"
SETTLED = "without input no signal grows"  # the same of a model without elements, which has no energy
COMPRESSED = "compressed members supply energy only to slow motion, which has no pole in the right half-plane"
OBSERVED = "(output)"  # no name of a specification reads so
Powers = dict[tuple[int, int], arb]  # coefficients of a polynomial, by the powers of s and of the gain
Ends = tuple[Variable | None, ...]  # what moves, or acts, at an element's nodes; ``None`` at the reference
GROWING = ((1, 1, -1, 1), (1, 1, 1, -1))
"""Signs of y, theta, f_a, tau_a at a beam's first end and of y, theta, f, tau at its second, if y, y', EI y''
and EI y''' are positive: it delivers ``-EI y'''`` and ``EI y''`` at the first end, the opposite at the
second."""
FALLING = ((1, -1, 1, 1), (1, -1, -1, -1))  # the same, seen from the second end, if y and EI y'' fall


@dataclass(frozen=True, slots=True)
class EnergyProof:
    """What energy says of the poles of a model; without a ``reason`` nothing is proved."""

    reason: str = ""  # why no pole lies in the right half-plane
    rests: bool = False  # all rests where no energy is lost: none lies on the axis but at 0
    limit: float = 0.0  # abs(s) [rad/s] beyond which the above is so; with 0 it is everywhere
    has_loop: bool = False  # signals or blocks act on the structure
    stiffness: float = 0.0  # of a loop whose gain is ``stiffness + damping s``, up to a factor
    damping: float = 0.0

    @property
    def is_passive(self) -> bool:
        """Whether it is proved that nothing supplies energy."""
        return bool(self.reason) and not self.limit

    def least_phase_margin(self, omega: float) -> float:
        """Return an angle [rad] that no phase margin at a frequency above omega [rad/s] is below.

        The force on a passive structure and the velocity there differ by 90 degrees at most.
        """
        return min(atan2(self.damping * omega, self.stiffness), pi / 2)


def energy_proof(
    model: Model,
    values: Iterable[tuple[str, ExactValue]] = (),
    output: Output | None = None,
    free: Sequence[str] = (),
) -> EnergyProof:
    """Return what energy says of the poles of a model.

    ``values`` are put in place of those the parameters have; those named ``free``, such as a gain, may have
    any positive value. An ``output`` may have poles of its own, as ``x/(T*s + 1)`` has. Nothing is known with
    loss factors, imposed outputs, parameters that depend on s, elements that are not of this program, fields
    beside signals or elements but those of circuits, or a value of the wrong sign.
    """
    if model.imaginary or model.imposed:  # what imposes an output supplies what that takes
        return EnergyProof()
    known = {p.name: p.value for p in model.parameters if p.value is not None} | dict(values)
    known = {name: value for name, value in known.items() if name not in free}
    declared = (replace(p, value=None, assume="positive") if p.name in free else p for p in model.parameters)
    seen = () if output is None else (output,)
    model = replace(_with_signals_of(model, seen), parameters=tuple(declared))
    line, inputs = line_of(model, known.items()), {each.name for each in model.inputs}
    sources = [e for e in model.elements if e.element.is_source and not follows_inputs(e, line, inputs)]
    rest = [e for e in model.elements if e not in sources]
    signs = {e.name: parameter_signs(e, line) for e in rest}
    gain = free[0] if len(free) == 1 else ""
    if model.fields:
        domains = {domain for e in model.elements for _, domain in e.domains}
        if (
            model.signals
            or model.blocks
            or not domains.issubset(CIRCUITS)
            or not all(isinstance(e.element, ThroughSource) for e in sources)
            or not all(e.element.is_source or _supplies_nothing(e, line, signs[e.name]) for e in rest)
        ):
            return EnergyProof()
        is_passive, are_lossy, equations = fields_supply_nothing(model, known)
        structure = _Structure(equations, rest, signs, gain, line, known, ())
        rests = is_passive and (structure.rests_with_fields(are_lossy) if model.elements else are_lossy)
        return EnergyProof(PASSIVE, rests) if is_passive else EnergyProof()
    pressed = [e for e in rest if isinstance(e.element, Beam) and signs[e.name].get("N") == -1]
    for use in pressed:  # as if pulled: the same rests on the axis, as far as its proof needs no sign
        signs[use.name]["N"] = 1
    has_loop = bool(sources or model.signals or model.blocks)
    if (
        not all(isinstance(e.element, ThroughSource) for e in sources)
        or not all(e.element.is_source or _supplies_nothing(e, line, signs[e.name]) for e in rest)
        or (pressed and (has_loop or free))
        or (limit := _fastest_growth(pressed, line)) is None
    ):
        return EnergyProof()
    pulled = tuple(
        replace(e, values=tuple((name, Negative(x) if name == "N" else x) for name, x in e.values))
        if e in pressed
        else e
        for e in rest
    )
    equations, places = _with_signals_for(replace(model, elements=pulled), sources)
    structure = _Structure(equations, pulled, signs, gain, line, known, {use.name for use in pressed})
    closed = structure.closed_at(places)
    if closed is None:
        return EnergyProof()
    reason = COMPRESSED if pressed else PASSIVE if rest else SETTLED
    return replace(closed, reason=reason, limit=limit, has_loop=has_loop)


def _supplies_nothing(use: PlacedElement, line: Line, signs: Mapping[str, int | None]) -> bool:
    """Tell whether it is proved that an element that is no source supplies no energy."""
    law, given = use.element.passive, dict(use.values)
    if law is None or any(
        given[name] != given[law.equal[0]]
        and line.sign(Sum((given[name], Negative(given[law.equal[0]])))) != 0
        for name in law.equal
    ):
        return False
    if law.is_alike and len({domain in CIRCUITS for _, domain in use.domains}) > 1:
        return False
    if law.definite:
        one, other, mutual = (given[name] for name in law.definite)
        if line.sign(Sum((Product((one, other)), Negative(Product((mutual, mutual)))))) not in (0, 1):
            return False
    return all(sign is not None and (sign >= 0 or name in law.of_any_sign) for name, sign in signs.items())


def _with_signals_for(model: Model, sources: Sequence[PlacedElement]) -> tuple[Equations, list[_Acting]]:
    """Return the equations of a model and of what sources supply, as signals, and where these act."""
    named, signals = list(model.elements), list(model.signals)
    for number, source in enumerate(sources):
        ((quantity, supplied),) = source.values
        name = str(number)  # no name of a specification begins so
        named.append(replace(source, values=((quantity, Name(name)),)))
        signals.append(Signal(name, supplied))
    dynamic = _dynamic(model)
    equations = assemble(
        replace(
            model,
            elements=tuple(named),
            signals=tuple(replace(each, expression=substitute(each.expression, dynamic)) for each in signals),
            outputs=(),
            figures=(),
            published=(),
        )
    )
    return equations, [
        _Acting(_ends(source, equations.model), int(any(d in CIRCUITS for _, d in source.domains)))
        for source in sources
    ]


def _dynamic(model: Model) -> dict[str, Expression]:
    """Return the definitions that depend on s, each in terms of none: their poles are seen then."""
    kept = {LAPLACE, *(b.name for b in model.blocks)}
    definitions: dict[str, Expression] = {}
    for _ in model.definitions:
        opened = {d.name: substitute(d.expression, definitions) for d in model.definitions}
        definitions = {name: e for name, e in opened.items() if names_among(e, kept)}
    return definitions


def observed(model: Model, seen: str = "") -> Model:
    """Return a model whose determinant has all poles: those, too, that outputs but one have of their own."""
    return _with_signals_of(model, [o for o in model.outputs if o.name != seen])


def _with_signals_of(model: Model, outputs: Sequence[Output]) -> Model:
    """Return a model with outputs as signals where they have poles of their own but at 0."""
    behind = {LAPLACE, *(b.name for b in model.blocks), *_dynamic(model)}

    def may_vanish(e: Expression) -> bool:
        below = e.denominator if isinstance(e, Quotient) else e.base if isinstance(e, Power) else None
        is_whole = isinstance(e, Power) and isinstance(e.exponent, Number) and e.exponent.value >= 0
        if below is None or is_whole:
            return False
        is_power = not any(isinstance(n, Sum | Call) for n in nodes(below))  # whose root is 0
        return any(name != LAPLACE or not is_power for name in names_among(below, behind))

    def has_poles(e: Expression) -> bool:
        return bool(names_among(e, behind - {LAPLACE})) or any(map(may_vanish, nodes(e)))

    own = [Signal(f"{OBSERVED} {o.name}", o.expression) for o in outputs if has_poles(o.expression)]
    return replace(model, signals=(*model.signals, *own)) if own else model


def _fastest_growth(pressed: Sequence[PlacedElement], line: Line) -> float | None:
    """Return an abs(s) [rad/s] beyond which compressed beams supply no energy; ``None`` if unknown."""
    squares = []
    with precision(BITS):
        for use in pressed:
            length = value_along(dict(use.values)["l"], arb("nan"), line)
            along = arb(0).union(arb("nan") if length is None else length)
            given = {name: value_along(value, along, line) for name, value in use.values}
            force = given["N"]
            bending, mass = _product(given, "EI", "E", "I"), _product(given, "rhoA", "rho", "A")
            if force is None or length is None or not bending > 0 or not mass > 0:
                return None
            squares.append(float((-force / mass * (12 / length**2 - force / bending)).upper()))
    return float(max(squares, default=0.0) ** 0.5) * (1 + ROUNDING)


def _product(given: Mapping[str, arb | None], whole: str, *parts: str) -> arb:
    """Return a product, given whole or in parts; not a number where one has no value."""
    values = [given.get(name) for name in ((whole,) if whole in given else parts)]
    return prod((arb("nan") if value is None else value for value in values), start=arb(1))


@dataclass(frozen=True, slots=True)
class _Acting:
    """Where a source acts, and the power of s by which what moves there is more than a displacement."""

    ends: Ends
    rate: int  # 1 of voltages, whose product with a current is power as that of a velocity with a force is


def _ends(use: PlacedElement, model: Model) -> Ends:
    """Return what moves at the nodes of an element of one port."""
    (port,) = (port for port, _ in use.nodes)
    nodes, domain = {n.name: n for n in model.nodes}, dict(use.domains)[port]
    return tuple(
        None if r.is_ground else variable_of(r, nodes[r.node], domain) for r in dict(use.nodes)[port]
    )


@dataclass(frozen=True, slots=True)
class _Feedback:
    """How a force follows the motion it acts on."""

    is_moved: bool  # the gain is part of it, or there is none
    loses: bool  # it dissipates wherever that moves
    powers: Powers | None  # of a polynomial


@dataclass(frozen=True)
class _Structure:
    """The equations of a passive structure and of what closes a loop about it, with numbers."""

    equations: Equations
    rest: Sequence[PlacedElement]  # all elements but the loop's source
    signs: Mapping[str, Mapping[str, int | None]]  # of their parameters
    gain: str
    line: Line
    values: Mapping[str, ExactValue]
    pressed: Container[str]  # names of beams that are in the equations as if pulled

    def closed_at(self, places: Sequence[_Acting]) -> EnergyProof | None:
        """Return how loops are closed by what acts at one end or between two, None if that is not passive."""
        laws = [law for number, at in enumerate(places) if (law := self._law(number, at)) is not None]
        if len(laws) < len(places):
            return None
        # Signals are no part of the structure: none is left that moves by itself.
        moving = {v for v in self.equations.unknowns if v.kind in ("node", "through")}
        own = [form for role, form in self._forms if role in ("signal", "constraint")]
        if not _followed(moving, own, self._fades).issuperset(self.equations.unknowns):
            return None
        damped = [at.ends for at, law in zip(places, laws, strict=True) if law.loses]
        moved = [law.powers for law in laws if law.is_moved]
        known = [powers for powers in moved if powers is not None]
        size = [float(sum(c.mid() for law in known for (i, _), c in law.items() if i == n)) for n in range(3)]
        # The phase of a mass, of a filter, or of a loop in several places, is not known.
        is_bounded = len(moved) == len(known) == 1 and not size[INERTIA]
        damping = size[1] if is_bounded else 0.0
        return EnergyProof(stiffness=size[0], damping=damping, rests=self._rests(damped))

    @cached_property
    def _forms(self) -> list[tuple[str, Terms]]:
        """What vanishes where inputs rest, each row with its role."""
        return [(row.role, free_terms(row.form)) for row in self.equations.rows]

    def _law(self, number: int, at: _Acting) -> _Feedback | None:
        """Return with what minus the motion is multiplied, where that is proved to be passive."""
        ends = at.ends
        effort = Variable("signal", str(number))
        rows = [form for role, form in self._forms if role in ("signal", "constraint")]
        for variable in {v for row in rows for v in row} - {effort, *ends}:
            rows = _without(variable, rows)
        feedback = next((row for row in rows if effort in row), None)
        if feedback is None:
            return None
        if len(feedback) == 1:
            return _Feedback(is_moved=False, loses=False, powers={})  # it follows inputs, through signals
        signs = zip(ends, (1, -1), strict=False)
        shares = [feedback[v] / feedback[effort] * sign for v, sign in signs if v in feedback]
        is_between = len(shares) == sum(v is not None for v in ends)
        if not is_between or not all((x - shares[0]).is_zero for x in shares):
            return None
        law, below = self._powers(shares[0].numerator()), self._powers(shares[0].denominator())
        if law is None or below is None or any(j for _, j in below) or any(j > 1 for _, j in law):
            return None
        law = {(i + at.rate, j): c for (i, j), c in law.items() if c != 0}
        is_moved = not self.gain or any(j for _, j in law)
        if below.keys() == {(0, 0)}:
            with precision(BITS):
                law = {power: c / below[0, 0] for power, c in law.items()}
            is_passive = all(i <= INERTIA and c > 0 for (i, _), c in law.items())
            return _Feedback(is_moved, any(i == 1 for i, _ in law), law) if is_passive else None
        over = {i + 1: c for (i, _), c in below.items()}
        losses = {
            _loss({i: c for (i, j), c in law.items() if j == power}, over) for power in {j for _, j in law}
        }
        return None if None in losses else _Feedback(is_moved, True in losses, None)

    def rests_with_fields(self, are_lossy: bool) -> bool:
        """Tell the same of fields beside circuits: a field rests if all states at one of its ends do."""
        fields = [f for f in self.equations.continua if None not in f.initial]
        ends = [(f.initial, tuple(v for v, _ in f.final)) for f in fields]
        lossy = {v for here in chain(*ends) for v in here if v is not None and are_lossy}
        return self._rests((), [(both, len(both[0])) for both in ends], lossy)

    def _rests(
        self,
        damped: Sequence[Ends],
        fields: Iterable[tuple[tuple[Ends, Ends], int]] = (),
        lossy: Iterable[Variable] = (),
    ) -> bool:
        """Tell whether everything rests where what is damped does, at any frequency of the axis."""
        one = Factored.number(self.equations.ring, 1)
        damped = list(damped)
        resting = set(lossy)
        members = list(fields)  # with how much of an end, at rest, stops them
        beams: list[tuple[Ends, Ends]] = []
        for use in self.rest:
            given, law = self.signs[use.name], use.element.damping
            if law and given[law] == 1:
                damped.append(_ends(use, self.equations.model))
            if given.get("R") == 1:  # what flows through a resistance, of motors too
                resting.add(Variable("through", use.name, use.element.through[0]))
            if isinstance(use.element, LineElement):
                states = self._states(use, use.element)
                # Whatever loses no energy bends, twists and shears nowhere, or nowhere leaves its place.
                is_lossy = 1 in (given.get("eta"), given["c_f"])
                members.append((states, len(use.element.ends) if is_lossy else len(states[0])))
                if use.name not in self.pressed and _grows(use, given):
                    beams.append(states)
                if _loses(use, given, self.line):
                    resting.update(v for state in states for v in state if v is not None)
        own = forms = [form for _, form in self._forms]
        together = [free_terms(LinearForm.of(*zip(ends, (one, -one), strict=False))) for ends in damped]
        for pair in together:
            forms = _without(next(reversed(pair)), [pair, *forms]) if len(pair) > 1 else forms
        forms = [*own, *forms, *together]
        known = -1
        while len(resting) > known:
            known = len(resting)
            resting = _followed(resting, forms, self._turn)
            for states, count in members:
                for here in states:
                    if all(v is None or v in resting for v in here[:count]):
                        resting.update(v for v in chain(*states) if v is not None)
            resting |= self._unable_to_grow(beams, resting, forms)
        return resting.issuperset(self.equations.unknowns)

    def _states(self, use: PlacedElement, element: LineElement) -> tuple[Ends, Ends]:
        """Return what moves at both ends of a member, and what it delivers there."""
        ends = []
        for end, through in zip(_ends(use, self.equations.model), ("_a", ""), strict=True):
            across: Ends = (end,)
            if len(element.ends) > 1:
                across = tuple(end and Variable("node", end.owner, c) for c in element.ends)
            ends.append((*across, *(Variable("through", use.name, q + through) for q in element.through)))
        return ends[0], ends[1]

    def _unable_to_grow(
        self, beams: Sequence[tuple[Ends, Ends]], resting: set[Variable], forms: Sequence[Terms]
    ) -> set[Variable]:
        """Return quantities at ends of beams that rest: nothing else there moves, and they cannot grow."""
        bounded: set[Variable] = set()
        for states in beams:
            for here, signs in ((states[0], GROWING[0]), (states[1], FALLING[1])):
                moving = {v: sign for v, sign in zip(here, signs, strict=True) if v and v not in resting}
                if len(moving) == 1 and self._is_impossible(moving, beams, resting, forms):
                    bounded.update(moving)
        return bounded

    def _is_impossible(
        self,
        signs: dict[Variable, int],
        beams: Sequence[tuple[Ends, Ends]],
        resting: set[Variable],
        forms: Sequence[Terms],
    ) -> bool:
        """Tell whether quantities cannot have these signs, with those that follow along beams and rows."""
        known = -1
        while len(signs) > known:
            known = len(signs)
            for states in beams:
                for (here, there), (first, second) in ((states, GROWING), (states[::-1], FALLING[::-1])):
                    at_rest = [v is None or v in resting for v in here]
                    if all(at_rest) or not all(
                        still or (v and signs.get(v) == sign)
                        for v, sign, still in zip(here, first, at_rest, strict=True)
                    ):
                        continue
                    for v, sign in zip(there, second, strict=True):
                        if v is None or v in resting or signs.setdefault(v, sign) != sign:
                            return True
            for form in forms:
                left = [v for v in form if v not in resting]
                unknown = [v for v in left if v not in signs]
                turns = {self._turn(form[v]) * signs[v] for v in left if v in signs}
                if len(turns) != 1 or 0 in turns or len(unknown) > 1:
                    continue
                if not unknown:
                    return True
                if all(self._is_real(form[v]) for v in left):
                    signs[unknown[0]] = -1 if self._turn(form[unknown[0]]) in turns else 1
        return False

    @cached_property
    def _numbers(self) -> dict[str, arb]:
        """The ring's generators that have a number."""
        with precision(BITS):
            values = {"pi": arb.pi()} | {
                name: ball(v.rational) * arb.pi() ** v.pi_power
                for name, v in self.values.items()
                if name != self.gain
            }
            for name, value in self.equations.definitions:
                parts = value.numerator(), value.denominator()
                above, below = (self._powers(part, values) for part in parts)
                if above is not None and below is not None and above.keys() == below.keys() == {(0, 0)}:
                    values[name] = above[0, 0] / below[0, 0]
        return values

    def _powers(self, value: Factored, numbers: Mapping[str, arb] | None = None) -> Powers | None:
        """Return a polynomial's coefficients, ``None`` where one of its names has no number."""
        numbers = self._numbers if numbers is None else numbers
        names, coefficients = value.ring.names, Powers()
        with precision(BITS):
            for monomial, coefficient in terms_of((value / value.unit).expand()):
                total, powers = ball(value.unit) * coefficient, {LAPLACE: 0, self.gain: 0}
                for name, exponent in ((names[i], e) for i, e in monomial):
                    if name in powers:
                        powers[name] = exponent
                    elif name in numbers:
                        total = total * numbers[name] ** exponent
                    else:
                        return None
                at = (powers[LAPLACE], powers[self.gain])
                coefficients[at] = coefficients.get(at, arb(0)) + total
        return coefficients

    def _fades(self, coefficient: Factored) -> bool:
        """Tell whether a coefficient vanishes in the left half-plane or at 0 only, for every K > 0."""
        powers = self._powers(coefficient)
        if powers is None or self._turn(coefficient) == 0:
            return False
        order = min(i for i, _ in powers)
        if all(i == order for i, _ in powers):
            return True
        return not any(j for _, j in powers) and _is_stable({i - order: c for (i, _), c in powers.items()})

    def _turn(self, coefficient: Factored) -> complex:
        """Return the side of a coefficient, 1, -1, 1j or -1j, for s = j omega and K > 0; 0 without one."""
        even, odd = set[int](), set[int]()
        for (of_s, _), c in (self._powers(coefficient) or {}).items():
            sign = 1 if c > 0 else -1 if c < 0 else 0
            (odd if of_s % 2 else even).add(sign * (1, 1, -1, -1)[of_s % 4])
        return even.pop() if even in ({1}, {-1}) else 1j * odd.pop() if odd in ({1}, {-1}) else 0

    def _is_real(self, coefficient: Factored) -> bool:
        """Tell whether a coefficient is real on the axis, and has one sign there."""
        return self._turn(coefficient) != 0 and all(i % 2 == 0 for i, _ in self._powers(coefficient) or {})


def _loss(above: Mapping[int, arb], below: Mapping[int, arb]) -> bool | None:
    """Tell whether a positive real quotient of polynomials has a positive real part at every frequency.

    None where it is not proved that it is positive real: both together have to have roots in the
    left half-plane only, and the real part must nowhere on the axis be negative (Chen & Smith 2009, A note on
    tests for positive-real functions).
    """
    order = min(*above, *below)
    with precision(BITS):
        total, real = dict(above), dict[int, arb]()
        for k, c in below.items():
            total[k] = total.get(k, arb(0)) + c
            for i in (i for i in above if (i - k) % 2 == 0):
                sign = -1 if (i - k) % 4 else 1
                real[i + k] = real.get(i + k, arb(0)) + sign * above[i] * c
        if any(not x >= 0 for x in real.values()) or not _is_stable({i - order: c for i, c in total.items()}):
            return None
    return any(x > 0 for x in real.values())


def _is_stable(coefficients: Mapping[int, arb]) -> bool:
    """Tell whether all roots of a polynomial lie in the left half-plane, by Routh's scheme."""
    degree = max(coefficients)
    first, second = ([coefficients.get(i, arb(0)) for i in range(n, -1, -2)] for n in (degree, degree - 1))
    with precision(BITS):
        if first[0] < 0:
            first, second = [-c for c in first], [-c for c in second]
        for _ in range(degree):
            if not first[0] > 0 or not second[0] > 0:
                return False
            following = zip([*first[1:], arb(0)], [*second[1:], arb(0), arb(0)], strict=False)
            first, second = second, [x - first[0] / second[0] * y for x, y in following]
    return bool(first[0] > 0)


def _grows(use: PlacedElement, signs: Mapping[str, int | None]) -> bool:
    """Tell whether a member is a beam whose states all grow once they are positive, as under tension."""
    return (
        isinstance(use.element, Beam)
        and dict(use.choices).get("theory") == "euler-bernoulli"
        and all(signs[n] == 1 for n in ("E", "I", "rho", "A", "l"))
        and all(signs[n] == 0 for n in ("eta", "c_f", "k_f"))
        and signs["N"] in (0, 1)
    )


def _loses(use: PlacedElement, signs: Mapping[str, int | None], line: Line) -> bool:
    """Tell whether a member rests where it loses no energy.

    Without strain it moves as a rigid body, which its mass alone does not let it do by itself; an axial force
    that varies may, as in a hinged blade that turns, and rotary inertia that varies. Without deflection the
    sections of a Timoshenko beam may still turn, all alike, against shear.
    """
    theory = dict(use.choices).get("theory")
    if signs["c_f"] == 1 and theory != "timoshenko":
        return True
    heavy = signs["rho"] == 1 and signs.get("A", signs.get("J")) == 1
    is_even = all(COORDINATE not in line.opened_names(value) for name, value in use.values if name == "N")
    is_free = signs["k_f"] == 0 and is_even and theory != "rayleigh"
    return signs.get("eta") == 1 and is_free and heavy


def _without(variable: Variable, rows: Sequence[Terms]) -> list[Terms]:
    """Return what linear rows say without one of their variables."""
    pivot = next((row for row in rows if variable in row), None)
    if pivot is None:
        return list(rows)
    forms = []
    for row in rows:
        if row is pivot:
            continue
        if variable in row:
            share = row[variable] / pivot[variable]
            zero = Factored.number(share.ring, 0)
            others = (row.keys() | pivot.keys()) - {variable}
            total = {v: row.get(v, zero) - pivot.get(v, zero) * share for v in others}
            forms.append({v: c for v, c in total.items() if not c.is_zero})
        else:
            forms.append(row)
    return forms


def _followed(
    resting: set[Variable], forms: Sequence[Terms], is_nonzero: Callable[[Factored], object]
) -> set[Variable]:
    """Return what rests with what does: in a row, what is multiplied by something and left alone."""
    resting_too, known = set(resting), -1
    while len(resting_too) > known:
        known = len(resting_too)
        for form in forms:
            left = [v for v in form if v not in resting_too]
            if len(left) == 1 and is_nonzero(form[left[0]]):
                resting_too.add(left[0])
    return resting_too
