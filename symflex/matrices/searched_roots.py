"""Poles and zeros of a transfer matrix that are searched: those of distributed models, in a region.

Input: a model, and the names of outputs and inputs. Output: :class:`.matrix_roots.MatrixRoots`.

Example: a free beam, pushed and read at both ends. Its poles are those of the function from one input that
drives both ends to the sum of what is read; its zeros the poles of the beam whose ends are imposed, n pi for
the roots of the wavenumber, as of a pinned beam. At s = 0 one function shows 2 of the 4 poles of both rigid
motions. ``[A B]`` and ``[A; C]`` are proved to have full rank there, so the matrix has all four.

A matrix that is not square, or not of full normal rank, has a zero where all its minors of the largest order
have one. The zeros of one minor are found; where a sum of all of them is proved not to vanish there is none.
Places where it may vanish are reported as not excluded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import pi
from typing import TypeVar

from flint import acb

from symflex import equations as equations_layer
from symflex.algebra import LAPLACE
from symflex.balls import precision
from symflex.equations import Equations
from symflex.matrices.constrained import driven_at_once, imposed
from symflex.matrices.matrix_roots import DecouplingZero, MatrixRoots, directions, is_conjugate, matrix_name
from symflex.matrices.system_matrix import SystemMatrix, independent, is_regular
from symflex.model import Model, with_numbers
from symflex.model.along import is_tapered
from symflex.roots import Band, HiddenRoot, Modes, PoleZeroMap, Region, Root
from symflex.roots.locate import locate
from symflex.roots.passivity import EnergyProof, energy_proof
from symflex.roots.pole_zero_map import (
    AT_REST,
    COINCIDE,
    EXAMINED,
    NONE_ON_AXIS,
    StabilityVerdict,
    chosen,
    hidden_region,
    judge,
    search_modes,
)
from symflex.roots.polynomial_roots import in_order
from symflex.roots.root import count_roots, groups, overlap
from symflex.transfer.derive import nested_transfer
from symflex.transfer.of_model import assemble_sparse, derive_for_roots

Rest = TypeVar("Rest")
BEYOND = 1 + 1e-9  # how far beyond a root its mode is searched, relative to it
RANK_BITS = 256  # of the matrix at a point, which proves its normal rank
POINT = (0.37, 0.61)  # where that is, in abs(s) of the highest pole: far from all roots, most likely
NOT_FULL = "the normal rank is not proved: more than this was not found"
NOT_EXCLUDED = "a zero of a matrix that is not square, or not of full rank, is not excluded, and not proved"


@dataclass(frozen=True)
class _Invariant:
    entries: Sequence[Root]  # all invariant zeros
    missed: Sequence[Root]  # hidden modes among them beyond those that are shown
    reason: str | None  # why it is not proved which of them are hidden modes


@dataclass(frozen=True, eq=False)
class SearchedMatrix:
    """A matrix whose poles and zeros are searched in a region."""

    model: Model
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    region: Region | None
    digits: int

    def roots(self) -> MatrixRoots:
        """Return the roots in the region."""
        model = driven_at_once(self.model, self.outputs, self.inputs)
        modes = self._located(model, self.region, self.outputs, EXAMINED if self._is_passive else None)
        modes, (poles, apart) = self._enough(modes, model, self.outputs, self._apart)
        hidden = [each.root for each in apart]
        pairs, is_proved = self._independent(max((float(root.size().mid()) for root in poles), default=1.0))
        searched, reasons = [modes], [modes.certificate.reason, None if is_proved else NOT_FULL]
        entries: Sequence[Root] = ()
        zeros: Sequence[Root] = ()
        if pairs:
            is_square = len(pairs) == len(self.outputs) == len(self.inputs)
            where = modes.region if is_square else hidden_region(modes.region, poles)
            model, read = imposed(self.model, pairs), [y for y, _ in pairs]
            located, (zeros, found) = self._enough(
                self._located(model, where, read, EXAMINED),
                model,
                read,
                lambda each: self._transmitted(each, len(pairs), hidden, is_square=is_square),
            )
            searched.append(located)
            apart_from_zeros = [*hidden, *found.missed]
            entries = [r for r in found.entries if _is_among(r, zeros) or _is_among(r, apart_from_zeros)]
            reasons += [located.certificate.reason, found.reason]
            reasons.append(NOT_EXCLUDED if not is_square and zeros else None)
        zeros = in_order(_merged(zeros))
        verdict = self._verdict(modes, [*poles, *modes.unstable], hidden)
        located = PoleZeroMap.of(
            matrix_name(self.outputs, self.inputs),
            modes.region,
            self.digits,
            ", ".join(sorted({e for each in searched for e in each.certificate.engine.split(", ")})),
            (in_order(poles), zeros, [HiddenRoot(each.root, each.how) for each in apart]),
            verdict,
            growing=modes.unstable,
            missing=sum(each.certificate.counted - each.certificate.found for each in searched),
            reasons=reasons,
            code=next((each.certificate.code for each in searched if each.certificate.code), None),
            excluded=list(dict.fromkeys(part for each in searched for part in each.excluded)),
            is_default=modes.is_default_region,
        )
        return MatrixRoots(
            located,
            self.outputs,
            self.inputs,
            len(pairs),
            in_order(_merged(entries)),
            tuple(apart),
            directions(self._matrix, len(pairs), zeros),
        )

    def _enough(
        self,
        first: PoleZeroMap,
        model: Model,
        read: Sequence[str],
        split: Callable[[PoleZeroMap], tuple[Sequence[Root], Rest]],
    ) -> tuple[PoleZeroMap, tuple[Sequence[Root], Rest]]:
        """Return a map and its roots that the matrix has, from further out in place of those it has not."""
        known, parts, wanted = first, split(first), first.region

        def search(modes: int) -> int:
            nonlocal known, parts
            if not isinstance(wanted, Modes):
                return 0
            if modes > wanted.count:
                more = self._located(model, Modes(modes), read, EXAMINED)
                if len(more.poles) == len(known.poles):
                    return 0
                known, parts = more, split(more)
            is_all = all(_is_among(root, parts[0]) for root in known.poles)
            shown = sum(group[0].multiplicity for group in groups(in_order(parts[0])))
            return 0 if is_all else wanted.count - shown

        if isinstance(wanted, Modes) and not search_modes(wanted.count, search):
            certificate = replace(known.certificate, reason=COINCIDE)
            return replace(first, certificate=certificate), parts
        if known is first:
            return first, parts
        whole = replace(first, certificate=known.certificate, hidden=known.hidden)
        return whole, (chosen(parts[0], wanted), parts[1])

    def _transmitted(
        self, located: PoleZeroMap, rank: int, hidden: Sequence[Root], *, is_square: bool
    ) -> tuple[Sequence[Root], _Invariant]:
        """Return the transmission zeros among the poles with outputs imposed, and all invariant zeros."""
        entries = [*located.poles, *(h.root for h in located.hidden)]
        if not is_square:
            entries = [root for root in entries if not self._is_excluded(rank, root)]
        further = self._modes_up_to([root for root in entries if not _is_among(root, hidden)])
        missed = [] if further is None else [z.root for z in self._apart(further)[1]]
        missed = [root for root in missed if not _is_among(root, hidden)]
        reason = None if further is None else further.certificate.reason
        return _without(entries, [*hidden, *missed]), _Invariant(entries, missed, reason)

    def _modes_up_to(self, roots: Sequence[Root]) -> PoleZeroMap | None:
        """Return all modes as far as those of some roots that inputs or outputs may miss reach; else nothing.

        Zeros may be shown that lie beyond the highest pole shown, and so beyond the hidden modes known.
        """
        unsure = self._unsure(roots)
        if not unsure:
            return None
        highest = max(float(root.size().mid()) for root in unsure) / (2 * pi) * BEYOND
        model = driven_at_once(self.model, self.outputs, self.inputs)
        return self._located(model, Band(Fraction(0), Fraction(highest)), self.outputs, EXAMINED)

    def _unsure(self, roots: Sequence[Root]) -> list[Root]:
        """Return roots, one of a conjugate pair, where inputs or outputs may miss a mode."""
        one_of_two = [root for root in roots if not (self._matrix.is_real and root.im < 0)]
        return [root for root in one_of_two if not all(self._reach(root))]

    def _reach(self, root: Root) -> tuple[bool, bool]:
        """Tell whether it is proved that inputs move, and that outputs show, all that moves at a root."""
        with precision(2 * root.working_bits()):
            values = self._matrix.on(root.enclosure())
            return values.is_controllable, values.is_observable

    @cached_property
    def _energy(self) -> list[EnergyProof]:
        """What energy says of the poles of the model and of each output's own filter."""
        values = [(p.name, p.value) for p in self.model.parameters if p.value is not None]
        read = (output for output in self.model.outputs if output.name in self.outputs)
        return [energy_proof(self.model, values, output) for output in read]

    @property
    def _is_passive(self) -> bool:
        return all(proof.is_passive for proof in self._energy)

    def _verdict(self, modes: PoleZeroMap, poles: Sequence[Root], hidden: Sequence[Root]) -> StabilityVerdict:
        """Return the verdict on the model: by its energy, or that on the modes that one input drives."""
        if self._is_passive:
            unsure = "" if all(proof.rests for proof in self._energy) else NONE_ON_AXIS
            verdict = judge(poles, unsure, self._energy[0].reason, hidden)
            return self._of_a_pair(verdict, hidden) if verdict.word == "unknown" else verdict
        known = modes.verdict
        if count_roots(hidden) == count_roots(h.root for h in modes.hidden):
            return known if hidden or not known.hidden.endswith(AT_REST) else replace(known, hidden="")
        return judge(poles, "" if known.certified else known.reason, hidden=hidden)

    def _of_a_pair(self, verdict: StabilityVerdict, hidden: Sequence[Root]) -> StabilityVerdict:
        """Return that the model is stable where that is proved of a pair that misses no more on the axis."""
        (bound,) = derive_for_roots(self.model, [(self.outputs[0], self.inputs[0])])
        pair = locate(bound, self.region, self.digits, with_zeros=False)
        missed = count_roots(h.root for h in pair.hidden if h.root.on_imaginary_axis)
        is_all = missed == count_roots(root for root in hidden if root.on_imaginary_axis)
        return (
            replace(pair.verdict, hidden=verdict.hidden)
            if pair.verdict.word == "stable" and is_all
            else verdict
        )

    def _located(
        self,
        model: Model,
        region: Region | None,
        read: Sequence[str],
        judged: PoleZeroMap | None,
        digits: int = 0,
    ) -> PoleZeroMap:
        (bound,) = derive_for_roots(model, [(model.outputs[0].name, model.inputs[0].name)])
        located = locate(bound, region, digits or self.digits, with_zeros=False, judged=judged)
        return located if bound.is_reduced else self._without_powers_of_fields(located, read)

    def _without_powers_of_fields(self, located: PoleZeroMap, read: Sequence[str]) -> PoleZeroMap:
        """Return a map without the powers of s that only clear what fields are written with.

        The value of a field with a load along it is one over a power of s, and yet entire. A signal that is
        that value has its equation times that power, which is no mode.
        """
        rows = [row for row in self._equations.outputs if row.name in read]
        s = self._equations.ring.generator(LAPLACE)
        spare = sum(row.divisor.exponent_of(s) - row.poles.exponent_of(s) for row in rows)
        hidden, poles = list[HiddenRoot](), list[Root]()
        for each in located.hidden:
            less = min(spare, each.root.multiplicity) if each.root.is_zero else 0
            spare -= less
            if each.root.multiplicity > less:
                root = replace(each.root, multiplicity=each.root.multiplicity - less)
                hidden.append(replace(each, root=root))
        for root in located.poles:
            less = min(spare, root.multiplicity) if root.is_zero else 0
            spare -= less
            if root.multiplicity > less:
                poles.append(replace(root, multiplicity=root.multiplicity - less))
        return replace(located, poles=tuple(poles), hidden=tuple(hidden))

    @cached_property
    def _equations(self) -> Equations:
        numbers = with_numbers(self.model, in_kernels=True)
        if is_tapered(numbers) or numbers.root:
            return equations_layer.assemble(numbers, nested_transfer, is_nameless=True)
        return assemble_sparse(numbers)

    @cached_property
    def _matrix(self) -> SystemMatrix:
        return SystemMatrix.of(self._equations, self.outputs, self.inputs)

    def _apart(self, modes: PoleZeroMap) -> tuple[list[Root], list[DecouplingZero]]:
        """Return the poles of the matrix, and what inputs or outputs of it all miss.

        One input and one output see one of several modes in one place; all inputs may see the others. What
        all miss may be among the poles where the kernels of a quotient hide a factor that cancels.
        """
        missed = self._missed(modes)
        poles = [root for root in modes.poles if not _is_among(root, missed)]
        apart: list[DecouplingZero] = []
        for each in (*modes.hidden, *(HiddenRoot(root, "coincident") for root in missed)):
            root, times = each.root, each.root.multiplicity
            is_moved, is_seen = self._reach(root)
            if is_moved and is_seen:
                poles.append(root)
                continue
            inputs, outputs = (0 if is_moved else times), (0 if is_seen else times)
            is_exact = each.is_proved and is_moved != is_seen and times == 1
            both = inputs + outputs - times
            apart.append(DecouplingZero(root, inputs, outputs, both, each.cause, is_exact=is_exact))
        return _merged(poles), apart

    def _missed(self, modes: PoleZeroMap) -> list[Root]:
        """Return poles that inputs or outputs may all miss, looked at to twice the digits, as pairs are."""
        # Beside a mode that is hidden, no rank tells whether another is in the same place.
        hidden = [h.root for h in modes.hidden]
        alone = [root for root in modes.poles if not (root.is_zero or _is_among(root, hidden))]
        unsure = self._unsure(alone)
        if not unsure:
            return []
        model = driven_at_once(self.model, self.outputs, self.inputs)
        closer = self._located(model, modes.region, self.outputs, EXAMINED, 2 * self.digits)
        found = [*closer.poles, *(h.root for h in closer.hidden)]
        both = [root for root in found if any(overlap(root, u) or is_conjugate(root, u) for u in unsure)]
        return [root for root in both if not all(self._reach(root))]

    def _independent(self, size: float) -> tuple[list[tuple[str, str]], bool]:
        """Return pairs whose matrix is proved regular at a point, and whether no more are independent.

        With functions of members as independent names, modulo a prime, no rank is smaller.
        """
        height, width = len(self.outputs), len(self.inputs)
        with precision(RANK_BITS):
            values = self._matrix.on(acb(*(size * part for part in POINT)))
            places = independent(height, width, lambda rows, columns: is_regular(values.minor(rows, columns)))
        found = [(self.outputs[i], self.inputs[j]) for i, j in places]
        modulo = self._matrix.modulo
        return found, len(found) == min(height, width) or (modulo is not None and len(found) == modulo.rank)

    def _is_excluded(self, rank: int, root: Root) -> bool:
        with precision(2 * root.working_bits()):
            return is_regular(self._matrix.on(root.enclosure()).squared(rank))


def _merged(roots: Sequence[Root]) -> list[Root]:
    """Return roots, those that overlap as one."""
    found: list[Root] = []
    for root in roots:
        i = next((i for i, other in enumerate(found) if overlap(root, other)), None)
        if i is None:
            found.append(root)
        else:
            other = found[i]
            is_same = root.certified and other.certified and root.is_zero and other.is_zero
            found[i] = replace(other, multiplicity=other.multiplicity + root.multiplicity, certified=is_same)
    return found


def _is_among(root: Root, others: Sequence[Root]) -> bool:
    return any(overlap(root, other) for other in others)


def _without(roots: Sequence[Root], others: Sequence[Root]) -> list[Root]:
    """Return roots less others at the same place."""
    left = list(roots)
    for other in others:
        times = other.multiplicity
        for i, root in enumerate(left):
            if times and root.multiplicity and overlap(root, other):
                common = min(times, root.multiplicity)
                left[i], times = replace(root, multiplicity=root.multiplicity - common), times - common
    return [root for root in left if root.multiplicity]
