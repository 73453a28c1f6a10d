"""One model with everything that the sections of a report need, each computed once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np
import numpy.typing as npt

from symflex import pipeline
from symflex.analysis.explanation import ZeroExplanation, explain_zeros
from symflex.analysis.rational import RationalApproximation, approximate
from symflex.analysis.response import SampledResponse, adaptive_grid, default_band, respond
from symflex.audit import Audit, audit, check_published
from symflex.errors import BudgetError, Diagnostic, SymflexError
from symflex.loops import AnyLoop, DynamicColocation, StabilityMap, find_stable_gains
from symflex.loops.of_model import characteristic_loop, colocation
from symflex.model import Model, with_numbers
from symflex.model.loss_factors import has_loss_factors
from symflex.model.spec import read
from symflex.options import ColocationOptions
from symflex.print.forms import PrintedForm, print_forms
from symflex.report.structure import Counts, RigidCounts, rigid_counts, undamped_counts
from symflex.roots import PoleZeroMap
from symflex.roots.locate import DEFAULT_MODES
from symflex.transfer import AnyBoundFunction, AnyTransferFunction, TransferFunction

if TYPE_CHECKING:
    from symflex.data.measurement import MeasuredResponse


MOST_FUNCTIONS: Final = 24  # functions of a model that a report shows; the number left out is said
DIGITS: Final = 15
TOO_LARGE: Final = "the closed form is too large"
ONLY_ON_AXIS: Final = "loss factors hold on s = j*omega alone"
COMPLEX: Final = "coefficients are complex"
T = TypeVar("T")


@dataclass(frozen=True)
class Study:
    """A model, and what the pipeline makes of it."""

    path: Path  # where its text was read
    stem: str  # the name its files in the report begin with
    text: str  # the specification
    model: Model  # resolved
    measured: tuple[MeasuredResponse, ...] = ()  # responses that models may be compared with

    @staticmethod
    def of(
        path: Path,
        stem: str,
        measured: tuple[MeasuredResponse, ...] = (),
        allow_outside: tuple[Path, ...] = (),
    ) -> Study:
        """Read a specification; its ``model`` blocks may read the folders of ``allow_outside`` too."""
        model = pipeline.load(path, allow_outside)
        check_published(model, model.published)
        pipeline.check_solvable(pipeline.assemble_for_checks(with_numbers(model)))
        return Study(path, stem, read(path).text.replace("\r\n", "\n"), model, measured)

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """The transfer functions shown, as (output, input)."""
        return self.model.transfer_functions[:MOST_FUNCTIONS]

    @property
    def tfs(self) -> tuple[AnyTransferFunction, ...]:
        """The transfer functions in symbols, where their equations have a solution of reasonable size."""
        return _result(self._derived)[0]

    @property
    def why_nested(self) -> str:
        """Why the transfer functions are in nested form; empty where they are not, or there are none."""
        return "" if isinstance(self._derived, SymflexError) else self._derived[1]

    @cached_property
    def _derived(self) -> tuple[tuple[AnyTransferFunction, ...], str] | SymflexError:
        # A derivation that fails may take long: once is enough.
        if self.model.is_distributed:
            return attempt(lambda: pipeline.derive_as(self.model, self.pairs))
        return attempt(lambda: (pipeline.derive_all(self.model, self.pairs), ""))

    @cached_property
    def exported(self) -> tuple[AnyTransferFunction, ...]:
        """The same for code that solves networks, which is shorter than that of their formula."""
        if not self.model.is_distributed:
            return self.tfs
        return pipeline.derive_as(self.model, self.pairs, solves=True)[0]

    @property
    def has_symbols(self) -> bool:
        """Whether the transfer functions could be derived in symbols."""
        return not isinstance(self._derived, SymflexError)

    @cached_property
    def forms(self) -> tuple[PrintedForm, ...]:
        """Each function in its default form."""
        return print_forms(self.tfs)[0]

    @property
    def bounds(self) -> tuple[AnyBoundFunction, ...]:
        """The same functions with numbers. Raises ModelError: SF229 when a parameter has no value."""
        return _result(self._bound)

    @cached_property
    def _bound(self) -> tuple[AnyBoundFunction, ...] | SymflexError:
        return attempt(lambda: pipeline.derive_for_roots(self.model, self.pairs))

    @cached_property
    def maps(self) -> tuple[PoleZeroMap, ...]:
        """Poles and zeros, the lowest modes of distributed systems; none of functions that are zero."""
        return tuple(located for _, located in self._maps if not isinstance(located, SymflexError))

    @cached_property
    def without_map(self) -> tuple[tuple[str, SymflexError], ...]:
        """Functions whose search failed as a whole, and why."""
        return tuple((tf, located) for tf, located in self._maps if isinstance(located, SymflexError))

    @cached_property
    def _maps(self) -> tuple[tuple[str, PoleZeroMap | SymflexError], ...]:
        digits = max(self.model.analysis.digits or DIGITS, DIGITS)
        return tuple(
            (b.name, attempt(partial(pipeline.roots, b, None, digits))) for b in self.bounds if not b.is_zero
        )

    @cached_property
    def located(self) -> tuple[tuple[TransferFunction, PoleZeroMap, ZeroExplanation], ...]:
        """Every function with numbers that is not zero, with its roots and what its zeros mean."""
        if isinstance(self._bound, SymflexError) or self.model.imaginary:
            return ()
        by_name = {each.tf: each for each in self.maps}
        derived = self.tfs if self.has_symbols else ()
        symbolic = {tf.name: tf for tf in derived if tf.is_reduced}
        rows = []
        for bound in self.bounds:
            if bound.name in by_name and bound.is_reduced:
                roots = by_name[bound.name]
                explained = explain_zeros(self.model, bound, roots)
                rows.append((symbolic.get(bound.name, bound.source), roots, explained))
        return tuple(rows)

    @cached_property
    def unexplained(self) -> tuple[tuple[AnyTransferFunction, PoleZeroMap, str], ...]:
        """Functions that :attr:`located` lacks, in nested form or with loss factors, their roots, and why."""
        if isinstance(self._bound, SymflexError):
            return ()
        by_name = {each.tf: each for each in self.maps}
        why = ONLY_ON_AXIS if has_loss_factors(self.model) else COMPLEX if self.model.imaginary else TOO_LARGE
        return tuple(
            (bound.source, by_name[bound.name], why)
            for bound in self.bounds
            if bound.name in by_name and (self.model.imaginary or not bound.is_reduced)
        )

    @cached_property
    def audits(self) -> tuple[Audit, ...]:
        """What is found about printed formulas."""
        return audit(self.model)

    @cached_property
    def rigid_counts(self) -> Mapping[tuple[str, str], RigidCounts]:
        """Zeros and poles with rigid compliances; see :func:`symflex.report.structure.rigid_counts`."""
        counts = attempt(lambda: rigid_counts(self.model))
        return {} if isinstance(counts, SymflexError) else counts

    @cached_property
    def undamped_counts(self) -> Mapping[tuple[str, str], Counts]:
        """Zeros and poles without dampers; see :func:`symflex.report.structure.undamped_counts`."""
        counts = attempt(lambda: undamped_counts(self.model))
        return {} if isinstance(counts, SymflexError) else counts

    @cached_property
    def responses(self) -> tuple[SampledResponse, ...]:
        """Frequency responses over the model's band, on grids that miss no resonance."""
        band = self.model.analysis.band
        responses = []
        for bound in self.bounds:
            if bound.is_zero:
                continue
            low, high = (float(f) for f in band) if band else default_band(pipeline.roots(bound))
            responses.append(respond(bound, adaptive_grid(bound, low, high)))
        return tuple(responses)

    @cached_property
    def comparisons(self) -> tuple[DataComparison, ...]:
        """Measured responses that a transfer function of the model is named like, with that function."""
        if isinstance(self._bound, SymflexError):
            return ()
        named = {b.name: b for b in self.bounds if not b.is_zero}
        return tuple(compared(one, named[one.name]) for one in self.measured if one.name in named)

    @cached_property
    def loops(self) -> tuple[StabilityMap | SymflexError, ...]:
        """Stable values of every gain that a figure names, or why there are none."""

        def stable(gain: str) -> StabilityMap:
            return find_stable_gains(self.loop(gain))

        gains = dict.fromkeys(figure.gain for figure in self.model.figures if figure.gain)
        return tuple(attempt(partial(stable, gain)) for gain in gains)

    def loop(self, gain: str) -> AnyLoop:
        """Return the characteristic function as a polynomial in a gain; SF801 without that gain."""
        if gain not in self._characteristic:
            self._characteristic[gain] = attempt(lambda: characteristic_loop(self.model, gain))
        loop: AnyLoop | SymflexError = self._characteristic[gain]
        if isinstance(loop, SymflexError):
            raise loop
        return loop

    @cached_property
    def _characteristic(self) -> dict[str, AnyLoop | SymflexError]:
        return {}

    @cached_property
    def colocations(self) -> tuple[DynamicColocation, ...]:
        """Up to which frequency other outputs move with the one on which the input does work."""
        kinds = [(tf, (tf.input.name, tf.quantity, tf.unit), meaning.kind) for tf, _, meaning in self.located]
        joints = {key: tf for tf, key, kind in kinds if kind == "colocated"}
        colocations = []
        for tf, key, kind in kinds:
            joint = joints.get(key)
            if kind != "colocated" and joint is not None:
                one = attempt(partial(colocation, self.model, ColocationOptions(tf.name, joint.name)))
                if not isinstance(one, SymflexError):
                    colocations.append(one)
        return tuple(colocations)

    def rational(self, tf: TransferFunction) -> RationalApproximation | None:
        """Return the product of the lowest modes of a function, None if there is no such approximation."""
        bound = next(b for b in self.bounds if b.name == tf.name)
        if not bound.is_reduced:
            return None
        modes = self.model.analysis.modes or DEFAULT_MODES
        approximation = attempt(lambda: approximate(bound, modes))
        return None if isinstance(approximation, SymflexError) else approximation


def _result(result: T | SymflexError) -> T:
    if isinstance(result, SymflexError):
        raise result
    return result


def attempt(compute: Callable[[], T]) -> T | SymflexError:
    """Return a result, or the error that says why there is none."""
    try:
        return compute()
    except SymflexError as error:
        return error
    except MemoryError:
        hint = "give parameters numbers in place of symbols, or --jobs 1"
        return BudgetError(Diagnostic("SF504", "out of memory", None, hint))


def said(error: SymflexError) -> str:
    """Return the messages of an error in one line."""
    return "; ".join(d.message for d in error.diagnostics)


@dataclass(frozen=True, eq=False)
class DataComparison:
    """What a model says on the lines of a measurement."""

    measured: MeasuredResponse  # with n lines
    model: npt.NDArray[np.complex128]  # shape (n,): The transfer function there
    unit: str  # its unit
    # decibels and degrees: root mean squares of the differences of magnitude and phase over the lines, all
    # alike.
    decibels: float
    degrees: float


def compared(measured: MeasuredResponse, bound: AnyBoundFunction) -> DataComparison:
    """Return a comparison with the values of the data as they stand, windows and sensors included."""
    model = np.asarray(respond(bound, measured.omega).values, np.complex128)
    unit = bound.source.unit
    return DataComparison(measured, model, unit, measured.misfit_db(model), measured.misfit_degrees(model))
