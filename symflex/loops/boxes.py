"""A characteristic function whose parameters lie anywhere in a box: where no root meets the imaginary axis.

Input: a model and the names of parameters. Output: a :class:`CharacteristicFunction`; for a box of these,
pieces of the axis on which it may vanish, and a radius beyond which no root lies in the right half-plane.

Example: ``m s^2 + b s + k + K k exp(-s T)`` with K in [0, 0.2] and T in [0, 5 ms]. Where it differs from 0 on
the whole axis for all of them, and beyond a radius in the right half-plane, no root passes the axis: the
number of right-half-plane roots is the same in the whole box (boundary crossing theorem; Bhattacharyya,
Chapellat and Keel 1995, theorem 1.4). Boxes on which this is not proved are halved; pieces of the axis
without a root for a box have none for its halves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import inf, isfinite

from flint import acb, acb_series, arb, fmpz_mpoly

from symflex.algebra import LAPLACE, Factored
from symflex.balls import Open, ball, branch, current_bits, expansion, halved, precision
from symflex.budget import spend
from symflex.errors import ModelError
from symflex.expressions import names_among
from symflex.model import ExactValue, Model
from symflex.roots.distributed.far_out import right_tail
from symflex.roots.functions.characteristic import CharacteristicValues
from symflex.roots.functions.exponential_values import Place, Summed, sums_of
from symflex.roots.locate import locate
from symflex.roots.passivity import energy_proof
from symflex.roots.pole_zero_map import WITHOUT_END, PoleZeroMap
from symflex.roots.region import Modes
from symflex.transfer import BoundTransferFunction, TransferFunction, bind
from symflex.transfer.enclose import constant_tangent, enclosure, first_order
from symflex.transfer.enclose_kernels import KernelValues
from symflex.transfer.mirrored import has_complex_waves, times_image
from symflex.transfer.of_model import derive_nameless

BITS = 64  # precision of values on boxes, which are far wider
LOWEST = 1e-6  # radius from which one is sought beyond which no root is on the right [rad/s]
OCTAVES = 24  # pieces of the axis at first, each half as high as the next; the lowest begins at 0
MOST_OPEN = 64  # pieces left open after which others stay as they are: halves of the box leave fewer
COUNT_DIGITS = 12  # digits of poles of which only the number, or the side of the axis, is asked for
NEARLY = 1 / 8  # share of a value that a box may leave and this still be as good as 0

Ends = tuple[Fraction, Fraction]
Box = tuple[Ends, ...]  # the ends of every parameter, in SI units
Piece = tuple[Fraction, Fraction]  # a part of the imaginary axis, in frequencies [rad/s]; or of another path
Line = tuple[arb, ...]  # a value in the middle of a box, and what each parameter adds up to its upper end
Path = tuple[complex, complex]  # where a straight path is at 0, and how far it goes for every 1
AXIS: Path = (0j, 1j)


@dataclass(frozen=True, slots=True)
class OpenBox:
    """A box with the pieces of the axis on which a factor may vanish."""

    box: Box
    radius: float | str  # beyond which no root lies in the right half-plane [rad/s], or why none is known
    pieces: tuple[tuple[Piece, ...], ...] = ()  # factor by factor
    weights: tuple[float, ...] = ()  # how much each parameter contributes to what is left
    lines: tuple[Line, ...] = ()  # one of each piece, or none: where none vanishes no root is on the axis

    @property
    def is_bounded(self) -> bool:
        """Whether it is known up to where roots are to be sought."""
        return not isinstance(self.radius, str)


@dataclass(frozen=True, eq=False)
class CharacteristicFunction:
    """The factors of the equations' determinant, with some parameters as symbols."""

    tf: TransferFunction  # whose denominator and hidden factors these are
    names: tuple[str, ...]  # of the parameters that lie in boxes
    values: tuple[tuple[str, ExactValue], ...]  # of the others
    nameless: TransferFunction | None = None  # without names for kernels, entire at s = 0; None if no waves
    chosen: tuple[fmpz_mpoly, ...] | None = None  # factors in place of those of all poles
    are_positive: bool = False  # no parameter has a negative value in a box
    is_modal: bool = True  # values are sums over the roots of dispersions, which are sharp far from s = 0
    is_alone: bool = False  # factors are never those of the product with the mirror image

    @classmethod
    def of(
        cls, model: Model, tf: TransferFunction, names: Sequence[str], *, are_positive: bool = False
    ) -> CharacteristicFunction:
        """Return that of a model whose other parameters are numbers, from one of its transfer functions."""
        values = tuple((p.name, p.value) for p in model.parameters if p.value and p.name not in names)
        nameless = None
        if any(law.wavenumbers for law in tf.kernels.dispersions):
            nameless = derive_nameless(model, [(tf.output.name, tf.input.name)])[0].whole
        is_alone = has_complex_waves(tf)  # of these the image has others
        return cls(tf, tuple(names), values, nameless, are_positive=are_positive, is_alone=is_alone)

    @property
    def is_complex(self) -> bool:
        """Whether coefficients are complex, so that poles need no conjugates.

        Factors are then those of the product with the mirror image, unless the function ``is_alone``.
        """
        return self.tf.model.imaginary is not None

    @cached_property
    def factors(self) -> tuple[fmpz_mpoly, ...]:
        """Those that may vanish elsewhere than at s = 0, and whose roots depend on the parameters."""
        return self._moved(self.tf) if self.chosen is None else self.chosen

    def _moved(self, tf: TransferFunction) -> tuple[fmpz_mpoly, ...]:
        hidden = [h.polynomial for h in tf.hidden]
        moving = {name: self.moved_by(tf, name) for name in self.names}
        moved = []
        for f in factors_of(tf, with_images=not self.is_alone):
            moved_by = tuple(name for name, places in moving.items() if any(f.degrees()[i] for i in places))
            # Hidden poles that energy keeps out of the right half-plane do not change the verdict.
            if moved_by and not (f in hidden and self._rests_with(moved_by)):
                moved.append(f)
        return tuple(moved)

    def _rests_with(self, names: tuple[str, ...]) -> bool:
        """Tell whether energy keeps poles that depend on some parameters out of the right half-plane."""
        if not self.are_positive:
            return False
        if names not in self._known:
            model = self.tf.model
            self._known[names] = energy_proof(model, (), self.tf.output, names).is_passive
        return self._known[names]

    @cached_property
    def _known(self) -> dict[tuple[str, ...], bool]:
        return {}

    def of_roots(self, kind: str) -> CharacteristicFunction:
        """Return the factors of the poles, or of the zeros, that the transfer function has."""
        value = self.tf.den if kind == "pole" else self.tf.num
        return replace(
            self, chosen=factors_of(self.tf, [f for f, e in value.factors if e > 0]), nameless=None
        )

    @cached_property
    def _entire(self) -> tuple[fmpz_mpoly, ...]:
        return () if self.nameless is None else self._moved(self.nameless)

    @cached_property
    def leading(self) -> frozenset[str]:
        """The generators beside the highest power of s in each factor."""
        ring = self.tf.ratio.ring
        tops = [(f, max(int(m[0]) for m in f.monoms())) for f in self.factors]
        return frozenset(
            ring.names[i] for f, top in tops for m in f.monoms() if m[0] == top for i, e in enumerate(m) if e
        )

    @property
    def at_rest(self) -> tuple[TransferFunction, tuple[fmpz_mpoly, ...]]:
        """What has values at s = 0 too, and its factors."""
        return (self.tf, self.factors) if self.nameless is None else (self.nameless, self._entire)

    def depends_on(self, name: str) -> bool:
        """Tell whether a root depends on a parameter."""
        every = factors_of(self.tf, with_images=not self.is_alone)
        return any(f.degrees()[i] for f in every for i in self.moved_by(self.tf, name))

    def moved_by(self, tf: TransferFunction, name: str) -> set[int]:
        """Return the places in the ring of what depends on a parameter, wavenumbers and kernels among it."""
        ring, table = tf.ratio.ring, tf.kernels
        moved = (c.generator for c in tf.constants if names_among(c.expression, {name}))
        moving = {name, *moved} & set(ring.index)
        laws = [d for d in table.dispersions if any(v.depends_on(n) for v in d.coefficients for n in moving)]
        waves = {w for d in laws for w in d.wavenumbers}
        kernels = (k for k in table.kernels if k.dispersion in laws or any(map(k.length.depends_on, moving)))
        return {ring.index[n] for n in (*moving, *waves, *(k.generator for k in kernels))}

    def whole(self, box: Box) -> OpenBox:
        """Return a box about which nothing is known yet."""
        radius = self._end(box)
        if isinstance(radius, str):
            return OpenBox(box, radius)
        last = Fraction(radius)
        marks = [last * 0, *(last / 2 ** (OCTAVES - k) for k in range(1, OCTAVES + 1))]
        pieces = tuple(pairwise(marks))
        if self.is_complex and self.is_alone:
            pieces = (*((-high, -low) for low, high in reversed(pieces)), *pieces)
        return OpenBox(box, radius, tuple(pieces for _ in self.factors))

    def _end(self, box: Box) -> float | str:
        bound = self.bound_in(self.tf, box)
        try:
            ends = [right_tail(bound, (f,), (acb(1),), LOWEST) for f in self.factors]
        except ModelError as error:
            # A function such as tan has a value in the middle, if only with many bits.
            with precision(4 * BITS):
                self.kernels(self.tf, tuple(((low + high) / 2,) * 2 for low, high in box))
            return error.diagnostics[0].message
        unknown = [end for end in ends if isinstance(end, str)]
        unknown.sort(key=lambda end: WITHOUT_END not in end)  # one such factor decides for all
        return unknown[0] if unknown else max(map(float, ends), default=0.0)

    def narrowed(self, box: OpenBox, bits: int = BITS, path: Path = AXIS) -> OpenBox:
        """Return the box with what is left of the pieces of the axis, or of another path."""
        with precision(bits):
            slopes = self.expanded(box.box)
            nameless = self.nameless
            entire = None if nameless is None else FirstOrder(self, nameless, self._entire, box.box)
            remaining = [self._left(slopes, entire, i, pieces, path) for i, pieces in enumerate(box.pieces)]
        every = [parts for each in remaining for parts in each.values()]
        weights = [sum(w) for w in zip(*(weights for weights, _ in every), strict=True)]
        lines = tuple(line for _, line in every) if all(line for _, line in every) else ()
        return replace(box, pieces=tuple(map(tuple, remaining)), weights=tuple(weights), lines=lines)

    def halves(self, box: OpenBox) -> list[OpenBox]:
        """Return two parts of a box, parted along the parameter that contributes most to what is open."""
        spend()
        sizes = box.weights or [
            float((high - low) / (abs(low) + abs(high))) * (1 + (name in self.leading))
            for name, (low, high) in zip(self.names, box.box, strict=True)
        ]
        i = max(range(len(sizes)), key=sizes.__getitem__)
        low, high = box.box[i]
        middle = (low + high) / 2
        parts = [(*box.box[:i], ends, *box.box[i + 1 :]) for ends in ((low, middle), (middle, high))]
        return [replace(box, box=part) if box.is_bounded else self.whole(part) for part in parts]

    def expanded(self, box: Box) -> FirstOrder:
        """Return the factors about the middle of a box."""
        return FirstOrder(self, self.tf, self.factors, box)

    def _left(
        self, slopes: FirstOrder, entire: FirstOrder | None, factor: int, pieces: Sequence[Piece], path: Path
    ) -> dict[Piece, tuple[list[float], Line]]:
        """Return the pieces, and parts of these, on which a factor may vanish, ascending.

        With each stands what every parameter contributes to that, and a line.
        """
        below = [piece for piece in pieces if piece[0] < 0]
        above = [piece for piece in pieces if piece[0] >= 0]
        mirrored = [(-high, -low) for low, high in reversed(below)]
        pieces = [*((-high, -low) for low, high in reversed(_joined_at_0(mirrored))), *_joined_at_0(above)]
        on_path = FactorOnPath(slopes, entire, factor, *map(acb, path))
        search = branch(
            map(PathPiece, pieces),
            on_path.decide,
            PathPiece.parts,
            until=lambda found, _: len(found.decided) >= MOST_OPEN,
        )
        nothing = [0.0 for _ in slopes.box], Line()
        open_pieces = {one.piece: (one.weights, one.line) for one in search.decided}
        return open_pieces | {one.piece: nothing for one in search.undecided}

    def kernels(self, tf: TransferFunction, box: Box, along: str = "") -> KernelValues:
        """Return the evaluator for parameters anywhere in a box, to first order in one of them."""
        bound = self.bound_in(tf, box)
        kernels = bound.kernel_values()
        shared = self._shared.setdefault(id(tf), kernels)
        kernels = replace(kernels, plans=shared.plans, sums=shared.sums, is_modal=self.is_modal)
        if not along:
            return kernels
        real = {n: enclosure(x) for n, x in self.values if not x.is_imaginary} | dict(bound.fixed)
        tangents = {n: first_order(x(), int(n == along)) for n, x in real.items()}
        moving = {along: tangents[along]} | {
            c.generator: constant_tangent(c.expression, tangents)
            for c in tf.constants
            if c.generator in kernels.constants and names_among(c.expression, {along})
        }
        series = {n: acb_series([acb(x[0]), acb(x[1])], 2) for n, x in moving.items()}
        return replace(kernels, constants={**kernels.constants, **series})

    @cached_property
    def _shared(self) -> dict[int, KernelValues]:
        return {}

    def sums(self, tf: TransferFunction, polynomials: Sequence[fmpz_mpoly]) -> Summed | None:
        """Return factors of a transfer function as sums of exponentials; None without a formula for them."""
        if id(tf) not in self._summed:
            self._summed[id(tf)] = sums_of(tf.ratio.ring, polynomials, tf.kernels)
        return self._summed[id(tf)]

    @cached_property
    def _summed(self) -> dict[int, Summed | None]:
        return {}

    def is_mirrored_at(self, box: Box, piece: Piece) -> bool:
        """Tell whether a piece of the axis may hold a root that is its own conjugate, and crosses alone."""
        return not piece[0]

    def located(self, point: Sequence[Fraction | ExactValue], modes: int = 1) -> PoleZeroMap:
        """Return the poles at one point, of a distributed model so many modes."""
        bound = bind(self.tf, dict(zip(self.names, point, strict=True)))
        return locate(bound, None if bound.is_rational else Modes(modes), COUNT_DIGITS, with_zeros=False)

    def bound_in(self, tf: TransferFunction, box: Box) -> BoundTransferFunction:
        """Return a transfer function whose parameters lie anywhere in a box."""
        fixed = tuple((name, enclosed(ends)) for name, ends in zip(self.names, box, strict=True))
        fixed += tf.fixed
        return BoundTransferFunction(tf, self.values, tf.ratio, tf.hidden, tf.kernels, fixed=fixed)


@dataclass(frozen=True, slots=True)
class PathPiece:
    """A piece of a path, or what is left of one."""

    piece: Piece
    is_narrowed: bool = False  # to less than a half, so that it is looked at before it is halved

    def parts(self) -> list[PathPiece]:
        """Return both halves, or the piece itself if it was narrowed."""
        return [PathPiece(part) for part in ([self.piece] if self.is_narrowed else halved(self.piece))]


@dataclass(frozen=True, slots=True)
class OpenPiece:
    """A piece on which a factor may vanish for some parameters of a box; halves of it would say no more."""

    piece: Piece
    weights: list[float]  # what every parameter contributes to that
    line: Line


@dataclass(frozen=True, eq=False, slots=True)
class FactorOnPath:
    """One factor about the middle of a box, on pieces of a straight path."""

    slopes: FirstOrder
    entire: FirstOrder | None  # all factors, where kernels say nothing
    factor: int
    start: acb
    way: acb

    def decide(self, region: PathPiece) -> OpenPiece | Open[PathPiece] | None:
        """Tell whether the factor may vanish on a piece, and on how much of it.

        Where ``c + b (p - p_0) + a (w - w_0)`` is 0 for real w and p, ``(c + b (p - p_0))/a`` is real: its
        imaginary part is the line, and ``w_0`` less its real part is w (interval Newton method; Moore 1966).
        """
        low, high = region.piece
        point = (low + high) / 2
        s = self.start + self.way * ball(low).union(ball(high))
        # Next to 0 kernels of waves say nothing; all factors are tried there at once.
        factors, ones = self.slopes, [self.factor]
        if self.entire is not None and s.contains(0):
            factors, ones = self.entire, list(range(len(self.entire.polynomials)))
        near = factors.generators(s)
        around = factors.around(s, ones, near)
        if not any(value.contains(0) for value, _ in around):
            return None
        turns = [slope * self.way for _, slope in around]
        if not (low and high):
            # Where the box alone leaves a root at the start, no shorter piece does without it.
            values = factors.swings(self.start, ones, near)
            share, weights = max((share_taken(c, terms) for c, terms in values), key=lambda each: each[0])
            if share >= 1 and _is_within([turn * ball(low + high) for turn in turns], values):
                line = _line(*values[0], turns[0]) if len(ones) == 1 else ()
                return OpenPiece(region.piece, weights, line)
        values = factors.swings(self.start + self.way * ball(point), ones, near)
        steps = [turn * ball(high - point) for turn in turns]
        shares = [share_taken(c, [*terms, step]) for (c, terms), step in zip(values, steps, strict=True)]
        if all(share < 1 for share, _ in shares):
            return None
        # Where the box alone leaves it open, or nearly so, and as much as the piece, this is not halved.
        share, (*weights, by_piece) = max(shares, key=lambda each: each[0])
        is_open = share - by_piece > 1 - NEARLY
        is_spent = _is_within(steps, values)
        begin, end, line = low, high, Line()
        if len(ones) == 1:
            ((centre, terms),), (turn,) = values, turns
            step = sum((term * arb(0, 1) for term in terms), centre) / turn
            if step.is_finite():
                line = _line(centre, terms, turn)
                roots = ball(point) - step.real
                begin, end = max(low, _fraction(roots.lower())), min(high, _fraction(roots.upper()))
        if begin > end:
            return None
        if (is_open and is_spent) or (end - begin) * 2 ** current_bits() < max(end, -begin):
            return OpenPiece((begin, end), weights, line)
        return Open(PathPiece((begin, end), 2 * (end - begin) < high - low))


@dataclass(frozen=True, eq=False)
class FirstOrder:
    """Factors of a characteristic function about the middle of a box of parameters.

    ``f(s, p)`` lies in ``f(s, p_0)`` plus slopes times the distances from the middle. A slope is that for
    all values of its parameter and of those before it, and for the middle of those after it (Hansen 1968).
    Each f is divided by its exponential that is largest about s: as a length changes, little is left to turn.
    """

    function: CharacteristicFunction
    tf: TransferFunction
    polynomials: tuple[fmpz_mpoly, ...]
    box: Box

    @cached_property
    def halves(self) -> list[arb]:
        """Half of each parameter's range."""
        return [ball((b - a) / 2) for a, b in self.box]

    @cached_property
    def _characteristics(self) -> list[CharacteristicValues]:
        """Those for the whole box, at its middle, and along each parameter."""
        middle = tuple(((a + b) / 2,) * 2 for a, b in self.box)
        parts = [self.box, *((*self.box[:i], *middle[i:]) for i in range(len(middle) + 1))]
        kernels = (
            self.function.kernels(self.tf, part, along)
            for part, along in zip(parts, ("", "", *self.function.names), strict=True)
        )
        sums = self.function.sums(self.tf, self.polynomials)
        return [CharacteristicValues.of(each, self.polynomials, sums) for each in kernels]

    def generators(self, s: acb) -> Place:
        """Return all generators to first order in s, for all s in a ball and for all parameters."""
        return self._characteristics[0].at(expansion(s))

    def around(self, s: acb, ones: Sequence[int], near: Place | None = None) -> list[tuple[acb, acb]]:
        """Return values and slopes in s of some factors, for all s in a ball and for all parameters."""
        wide, near = self._characteristics[0], near or self.generators(s)
        return [wide.first_order(i, near, wide.largest([i], near)) for i in ones]

    def swings(self, s: acb, ones: Sequence[int], near: Place) -> list[tuple[acb, list[acb]]]:
        """Return values at the middle of the box, and by how much every parameter's half range moves each."""
        halves = self.halves
        return [(c, [x * h for x, h in zip(xs, halves, strict=True)]) for c, xs in self.at(s, ones, near)]

    def at(self, s: acb, ones: Sequence[int], near: Place | None = None) -> list[tuple[acb, list[acb]]]:
        """Return values at the middle of the box and slopes in every parameter, on the branch of ``near``."""
        near = near or self.generators(s)
        wide, middle, *others = self._characteristics
        centre, points = middle.at(s, near), [(each, each.at(acb_series([s, 0], 2), near)) for each in others]
        found = []
        for i in ones:
            less = wide.largest([i], near)
            slopes = [each.first_order(i, at, less)[1] for each, at in points]
            found.append((middle.first_order(i, centre, less)[0], slopes))
        return found


def _joined_at_0(pieces: Sequence[Piece]) -> list[Piece]:
    """Return pieces from 0 on, those that touch it as one.

    That says of a small box what many said of a large one.
    """
    last = next((i for i, (one, two) in enumerate(pairwise(pieces)) if one[1] < two[0]), len(pieces) - 1)
    return (
        [(pieces[0][0], pieces[last][1]), *pieces[last + 1 :]] if pieces and not pieces[0][0] else [*pieces]
    )


def _is_within(steps: Sequence[acb], values: Sequence[tuple[acb, list[acb]]]) -> bool:
    """Tell whether a piece of the path contributes no more than the box does, or the box without end."""
    wide = sum((term.abs_upper() for _, terms in values for term in terms), arb(0))
    return not wide.is_finite() or bool(sum((step.abs_upper() for step in steps), arb(0)) <= wide)


def _line(centre: acb, terms: Sequence[acb], turn: acb) -> Line:
    line = tuple((each / turn).imag for each in (centre, *terms))
    return line if all(each.is_finite() for each in line) else ()


def share_taken(centre: acb, terms: Sequence[acb]) -> tuple[float, list[float]]:
    """Return how much of a value sums of terms, each times -1 to 1, take away in the best direction.

    Below 1 no sum takes it to 0: a zonotope and 0 are parted by the normal of one of its edges, if by any.
    With it stands the share of each term.
    """
    best = inf, [1.0 for _ in terms]
    for direction in (centre, *(term * acb(0, 1) for term in terms)):
        across = direction.mid().conjugate()
        size = (across * centre).real.abs_lower()
        parts = [float(((across * term).real.abs_upper() / size).upper()) for term in terms]
        if size > 0 and isfinite(total := sum(parts) * (1 + 1e-12)) and total < best[0]:
            best = total, parts
    return best


def _fraction(x: arb) -> Fraction:
    mantissa, exponent = x.man_exp()
    return int(mantissa) * Fraction(2) ** int(exponent)


def factors_of(
    tf: TransferFunction, given: Sequence[fmpz_mpoly] | None = None, *, with_images: bool = True
) -> tuple[fmpz_mpoly, ...]:
    """Return all factors of the characteristic function, or those given, without powers of s alone."""
    ring = tf.ratio.ring
    alone = {
        ring.index[LAPLACE],
        *(ring.index[k.generator] for k in tf.kernels.kernels if k.function == "exp"),
    }
    every = given
    if every is None:
        every = [*(f for f, e in tf.den.factors if e > 0), *(h.polynomial for h in tf.hidden)]
    if tf.model.imaginary and with_images:  # what meets the axis below 0 has an image that meets it above
        images = (times_image(Factored.polynomial(ring, each)).factors for each in every)
        every = [f for factors in images for f, _ in factors]
    return tuple(f for f in every if len(f) > 1 or not any(f.degrees()[i] for i in alone))


def enclosed(ends: Ends) -> Callable[[], arb]:
    """Return a ball about the values between two ends, none of which is negative unless an end is."""
    low, high = ends

    def ball_of() -> arb:
        if low != 0:
            return ball(low).union(ball(high))
        # Radii are rounded up; a middle that is rounded alike keeps the lower end at 0.
        half = float(high / 2) * (1 + 2.0**-40)
        return arb(float(arb(0, half).rad()), half)

    return ball_of
