"""From a pole of a bound transfer function to its mode shapes.

Input: :class:`symflex.transfer.BoundTransferFunction` and the number of a mode, or a root. Output:
:class:`EnclosedModeShape`, from the null space of the equations on the pole's enclosure.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from flint import acb, acb_mat

from symflex.analysis.modes.bound_equations import BESIDE, BoundEquations, null_space
from symflex.analysis.modes.shape import EnclosedModeShape, is_accurate, normalised
from symflex.balls import precision
from symflex.budget import spend
from symflex.errors import BudgetError, Diagnostic, UncertifiedError, UsageError, refused
from symflex.library.elements import Variable
from symflex.roots import Band, Modes, PoleZeroMap, Region, Root
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import StabilityVerdict
from symflex.transfer import AnyBoundFunction
from symflex.transfer.equations_at import NamedValues

DIGITS = 15
SPARE_DIGITS = 15
ROUNDS = 6  # how often the digits of the pole are doubled until those of the shape suffice
SPARE_BITS = 64
DIMENSIONS = 6  # shapes of one pole that are sought at most
NEAR = 1e-8  # relative distance within which two estimates are the same root
NEIGHBOURHOOD = Fraction(1, 4)


@dataclass(frozen=True, slots=True)
class NumberedShape:
    """A mode shape among the lowest of a model."""

    shape: EnclosedModeShape  # the shape
    is_hidden: bool  # uncontrollable from the input or unobservable in the output


def mode_shape(bound: AnyBoundFunction, which: int | Root, digits: int = DIGITS) -> EnclosedModeShape:
    """Return the shape of one mode, of a pair the member with positive imaginary part.

    ``which`` is the number of the mode: 1 is the lowest pole other than 0, a conjugate pair or a real pole is
    one mode, and one of multiplicity m counts as m. 0 is the rigid-body motion, at s = 0. Or it is a root: a
    pole, or a hidden mode. ``digits`` of displacements are correct, relative to the largest.

    SF902 when there is no such mode, or the root is no pole; SF904 when the root, or 0, has several shapes,
    or a multiple pole fewer shapes than its multiplicity; SF406 (UncertifiedError) when the equations cannot
    be told to be singular at the pole.

    >>> from symflex import pipeline
    >>> model = pipeline.loads('''
    ... symflex = 1
    ... elements.a = { type = "mass", at = "x", m = "1 kg" }
    ... elements.b = { type = "mass", at = "y", m = "2 kg" }
    ... elements.k = { type = "spring", between = ["x", "y"], k = "6 N/m" }
    ... inputs.F = { force = "x" }
    ... outputs.X = "x"
    ... ''')
    >>> bound, = pipeline.derive_bound(model, model.transfer_functions)
    >>> shape = mode_shape(bound, 1)
    >>> float(shape.motion("x").value.real.mid()), float(shape.motion("y").value.real.mid())
    (1.0, -0.5)
    """
    shapes, index = _shapes(bound, which, digits)
    is_counted = isinstance(which, int) and which > 0 and len(shapes) <= shapes[0].pole.multiplicity
    if is_counted and index < len(shapes):
        return shapes[index]
    if len(shapes) > 1 and not is_counted:
        message = f"the pole {_printed(shapes[0].pole)} has {len(shapes)} independent shapes"
        raise UsageError(Diagnostic("SF904", message, None, "mode_shapes() returns all of them"))
    if index:
        message = f"mode {which} has no shape of its own: its pole has more modes than shapes"
        raise UsageError(Diagnostic("SF904", message))
    return shapes[0]


def mode_shapes(
    bound: AnyBoundFunction, which: int | Root, digits: int = DIGITS
) -> tuple[EnclosedModeShape, ...]:
    """Return a basis of the shapes of the pole that a mode belongs to; see :func:`mode_shape`."""
    return _shapes(bound, which, digits)[0]


def lowest_modes(
    bound: AnyBoundFunction, count: int, band: Band | None = None
) -> tuple[tuple[NumberedShape, ...], StabilityVerdict]:
    """Return the lowest modes but those at 0, or a band's, then unstable ones, and whether it is stable."""
    search = _ModeSearch(bound)
    located = search.map(band or Modes(count), DIGITS + SPARE_DIGITS)
    candidates = [(root, False) for root in located.all_poles] + [(h.root, True) for h in located.hidden]
    chosen = [(root, hidden) for root, hidden in candidates if not root.is_zero and not root.im < 0]
    chosen.sort(key=lambda pair: float(pair[0].natural_frequency().mid()))
    shapes: list[NumberedShape] = []
    for root, is_hidden in chosen:
        spend()
        if len(shapes) >= count and not root.re > 0:
            continue
        if any(_is_same(s.shape.pole, root) for s in shapes):
            continue
        try:
            found_here = search.shapes(partial(search.again, root), DIGITS)
        except UsageError:
            continue  # a common factor that is not a mode of the model
        shapes += [NumberedShape(shape, is_hidden) for shape in found_here]
    return tuple(s for i, s in enumerate(shapes) if i < count or s.shape.pole.re > 0), located.verdict


def _shapes(
    bound: AnyBoundFunction, which: int | Root, digits: int
) -> tuple[tuple[EnclosedModeShape, ...], int]:
    """Return the shapes of a pole, and the place of the mode asked for among them."""
    search = _ModeSearch(bound)
    if not isinstance(which, int):
        return search.shapes(partial(search.again, which), digits), 0
    index = search.numbered(which, digits)[1]
    return search.shapes(lambda more: search.numbered(which, more)[0], digits), index


class _ModeSearch:
    """Finds poles of one bound transfer function to more and more digits, and solves for their shapes."""

    def __init__(self, bound: AnyBoundFunction) -> None:
        self.bound = bound
        self._maps: dict[tuple[Region | None, int], PoleZeroMap] = {}
        self.equations = BoundEquations(bound, "a mode shape")

    def map(self, region: Region | None, digits: int) -> PoleZeroMap:
        key = (region, digits)
        if key not in self._maps:
            self._maps[key] = locate(self.bound, region, digits)
        return self._maps[key]

    def numbered(self, number: int, digits: int) -> tuple[Root, int]:
        """Return the pole of a mode, and which of its modes it is."""
        if number < 0:
            raise refused(f"modes are numbered from 1, and mode 0 is the motion at s = 0; found {number}")
        located = self.map(Modes(max(number, 1)), digits)
        poles = located.poles
        if number == 0:
            hidden = (h.root for h in located.hidden)
            rigid = next((p for p in (*poles, *hidden) if p.is_zero), None)
            if rigid is None:
                message = "the model has no pole at 0, so no rigid-body motion"
                raise refused(message, "modes are numbered from 1")
            return rigid, 0
        before = 0
        for root in poles:
            if root.is_zero or root.im < 0:
                continue
            if number <= before + root.multiplicity:
                return root, number - before - 1
            before += root.multiplicity
        count = f"{before} mode" + ("" if before == 1 else "s")
        message = f"{self.bound.name} has only {count} besides those at s = 0; mode {number} does not exist"
        raise refused(message)

    def again(self, root: Root, digits: int) -> Root:
        """Return a root known already, to more digits where it is found again."""
        known = (p for (_, most), m in self._maps.items() if most >= digits for p in _poles_of(m))
        if root.is_zero or any(p is root for p in known):
            return root
        region: Region | None = None
        if self.bound.source.solves_network and self._maps:
            region = next(iter(self._maps))[0]  # a disc contains all roots below: one search serves them all
        elif not self.bound.is_rational:
            frequency = Fraction(root.frequency_hz())
            region = Band(frequency * (1 - NEIGHBOURHOOD), frequency * (1 + NEIGHBOURHOOD))
        try:
            located = self.map(region, digits)
        except (BudgetError, UncertifiedError):
            spend()
            return root
        nearest = min(_poles_of(located), key=lambda r: _distance(r, root), default=root)
        return nearest if _is_same(nearest, root) else root

    def shapes(self, pole: Callable[[int], Root], digits: int) -> tuple[EnclosedModeShape, ...]:
        """Return the shapes of a pole that can be found to any number of digits."""
        working = digits + SPARE_DIGITS
        best: tuple[EnclosedModeShape, ...] = ()
        for _ in range(ROUNDS):
            try:
                root = pole(working)
            except (BudgetError, UncertifiedError):
                if best:
                    break
                raise
            enclosed = self._at(root, digits)
            best = enclosed or best
            if enclosed and all(is_accurate(shape, digits) for shape in enclosed):
                break
            working *= 2
        if not best:
            message = f"the equations cannot be solved for the shape of the pole near {_printed(root)}"
            raise UncertifiedError(Diagnostic("SF406", message, None, "ask for more digits of the pole"))
        return best

    def _at(self, root: Root, digits: int) -> tuple[EnclosedModeShape, ...]:
        """Return the shapes at a pole, none when its enclosure is too wide."""
        bits = root.working_bits() + SPARE_BITS
        with precision(bits):
            s = acb(root.re, root.im)
            at, unknowns = self.equations.at, self.equations.unknowns
            number, beside = at.on(s), at.on(s.mid() * BESIDE if s.mid() != 0 else acb(1))
            matrix, typical = (x.matrix(at.entries()) for x in (number, beside))
            for dimension in range(1, DIMENSIONS + 1):
                space = null_space(matrix, dimension, typical)
                if space is None:
                    continue
                if not space.is_refuted:
                    basis = _tidied(space.basis, unknowns, self.equations.units)
                    is_proved = dimension == 1 and root.certified
                    raw = [self._shape(root, number, values, is_proved) for values in basis]
                    scaled = [normalised(shape, digits) for shape in raw]
                    return tuple(x for x in scaled if x is not None) if None not in scaled else ()
                if dimension == 1:
                    # With more dimensions it may be that the balls are too wide for fewer.
                    hint = "zeros have no mode shape, and neither do poles of a filter in an output"
                    raise refused(f"s = {_printed(root)} is not a pole of the model's equations", hint)
                return ()
        return ()

    def _shape(
        self, root: Root, number: NamedValues, values: Sequence[acb], is_proved: bool
    ) -> EnclosedModeShape:
        motions, distributed = self.equations.motion(number, values)
        return EnclosedModeShape(motions, distributed, "", root, is_proved)


def _poles_of(located: PoleZeroMap) -> list[Root]:
    """Return all poles found, hidden ones among them."""
    return [*located.all_poles, *(h.root for h in located.hidden)]


def _distance(a: Root, b: Root) -> float:
    with precision(64):
        return float(abs(acb(a.re.mid() - b.re.mid(), a.im.mid() - b.im.mid())).mid())


def _is_same(a: Root, b: Root) -> bool:
    if a.re.overlaps(b.re) and a.im.overlaps(b.im):
        return True
    return _distance(a, b) <= NEAR * float(b.natural_frequency().mid())


def _printed(root: Root) -> str:
    decimals = root.decimal(6)
    return f"{decimals.re} + {decimals.im} j"


def _tidied(
    basis: tuple[tuple[acb, ...], ...], unknowns: Sequence[Variable], units: dict[Variable, str]
) -> tuple[tuple[acb, ...], ...]:
    """Return a basis in which each vector alone moves one of as many places."""
    count = len(basis)
    if count == 1:
        return basis
    places = _independent(basis, [j for j, v in enumerate(unknowns) if units[v] in ("m", "rad", "V")])
    if len(places) < count:
        places = _independent(basis, range(len(unknowns)))
    square = acb_mat([[basis[k][j] for k in range(count)] for j in places])
    try:
        mixing = square.inv()
    except ZeroDivisionError:
        return basis
    mixed = acb_mat([[basis[k][j] for k in range(count)] for j in range(len(unknowns))]) * mixing
    return tuple(
        tuple(acb(int(places[k] == j)) if j in places else mixed[j, k] for j in range(len(unknowns)))
        for k in range(count)
    )


def _independent(basis: tuple[tuple[acb, ...], ...], places: Sequence[int]) -> list[int]:
    """Return as many places as vectors where these are independent, the largest amplitudes first."""
    rows = {j: [complex(vector[j].mid()) for vector in basis] for j in places}
    chosen: list[int] = []
    while rows and len(chosen) < len(basis):
        pivot_row = max(rows, key=lambda j: sum(abs(x) ** 2 for x in rows[j]))
        pivot = rows.pop(pivot_row)
        size = sum(abs(x) ** 2 for x in pivot)
        if size == 0:
            break
        chosen.append(pivot_row)
        for j, row in rows.items():
            share = sum(x * y.conjugate() for x, y in zip(row, pivot, strict=True)) / size
            rows[j] = [x - share * y for x, y in zip(row, pivot, strict=True)]
    return sorted(chosen)
