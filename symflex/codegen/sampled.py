"""Code that takes one step at every sample: the outline of a file, and what exports any language.

Input: transfer functions, and how they are sampled.
Output: an :class:`Export`. Difference equations are made and measured here, and handed as a :class:`StepFile`
to a :class:`SampledLanguage`, which spells it::

    y = 1.8 * x + w[0]        y = 1.8 * x + w[0];        y := 1.8 * x + w[0];
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from math import pi
from typing import TYPE_CHECKING

from flint import acb

from symflex.budget import spend
from symflex.codegen.module_text import (
    BlockComment,
    default_value,
    identifiers,
    inert,
    origin_lines,
    value_as_written,
    wrapped,
)
from symflex.errors import BudgetError, Diagnostic
from symflex.model import Model
from symflex.transfer import AnyTransferFunction, bind

if TYPE_CHECKING:
    from symflex.codegen.difference import DifferenceEquation
    from symflex.codegen.export import Export
    from symflex.state_space.sampled import Sampling

SHOWN_POLES = 8  # poles in z that a comment lists

METHODS = {  # how a file describes the method that it was sampled by
    "zoh": "the input held from one to the next, exactly",
    "tustin": "by the bilinear transformation",
    "matched": "with poles and zeros matched",
}


@dataclass(frozen=True, eq=False)
class StepFunction:
    """One transfer function of a file."""

    tf: AnyTransferFunction
    equation: DifferenceEquation
    name: str  # an identifier, by default OUT_over_IN
    measured: str  # a sentence on what rounding costs

    @property
    def late(self) -> int:
        """The delay in samples."""
        return self.equation.sampled.late

    def described(self, width: int) -> list[str]:
        """Return what its comment says, in lines."""
        poles = [_shown(p) for p in self.equation.sampled.poles if not p.imag < 0]
        more = f" and {len(poles) - SHOWN_POLES} more" if len(poles) > SHOWN_POLES else ""
        unit = f" [{self.tf.unit}]" if self.tf.unit else ""
        lines = [inert(f"{self.tf.name}{unit}: one step, from rest.")]
        if poles:
            lines += ["", *wrapped(f"Poles in z: {', '.join(poles[:SHOWN_POLES])}{more}.", width)]
        if self.late:
            lines += wrapped(f"In addition, a delay of {self.late} times the sampling time.", width)
        return [*lines, "", *wrapped(self.measured, width)]


@dataclass(frozen=True, eq=False)
class StepFile:
    """What a file consists of, in no language yet."""

    model: Model
    functions: Sequence[StepFunction]
    sampling: Sampling
    stem: str | None  # the file's name without suffix; None if there can be no other files beside it

    def introduction(self, usage: str, width: int) -> list[str]:
        """Return what the comment at the head says, in lines; ``usage`` says how functions are called."""
        how = METHODS[self.sampling.method]
        if self.sampling.prewarp is not None:
            how += f", exact at {float(self.sampling.prewarp.nearly) / (2 * pi):.6g} Hz"
        lines = ["Difference equations, one step per sample.", "", *origin_lines(self.model, width)]
        written = f"Written by symflex for a sampling time of {float(self.sampling.sample)!r} s, {how}."
        values = []
        for p in (p for p in self.model.parameters if p.value is not None):
            value = value_as_written(p) or f"{default_value(p).removesuffix('.0')} {p.unit}".rstrip()
            values.append(f"{p.name} = {value}")
        lines += [*wrapped(written, width), ""]
        lines += wrapped(inert(f"Values: {', '.join(values)}."), width) if values else []
        return [*lines, "", *wrapped(usage, width)]


@dataclass(frozen=True, slots=True)
class SampledLanguage:
    """A language of code that takes one step per sample."""

    suffix: str  # of the file's name
    summary: str  # what is made, in a line
    print: Callable[[StepFile], Export]  # makes the file
    comment: BlockComment  # how it spells one
    reserved: Collection[str] = ()  # identifiers that functions cannot have
    is_caseless: bool = False  # true where X and x are one identifier


@dataclass(frozen=True, slots=True)
class DifferenceExporter:
    """Transfer functions as code that takes one step per sample."""

    language: SampledLanguage
    sampling: Sampling
    is_direct: bool = False  # one section for all poles

    solves = False

    @property
    def suffix(self) -> str:
        """The end of the file's name."""
        return self.language.suffix

    @property
    def summary(self) -> str:
        """What is made, in a line."""
        return self.language.summary

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the file; accuracy that was not reached is a warning."""
        from symflex.analysis.sampling import sampled_transfer_function  # imports mpmath, for few exports
        from symflex.codegen.difference import difference_equation

        wanted = {tf.name: f"{tf.output.name}_over_{tf.input.name}" for tf in tfs}
        if self.language.is_caseless:
            wanted = {key: name.lower() for key, name in wanted.items()}
        names = identifiers(wanted, self.language.reserved)
        functions, warnings = [], []
        for tf in tfs:
            spend()
            if not tf.is_reduced:
                message = f"the closed form of {tf.name} is too large to be sampled"
                raise BudgetError(Diagnostic("SF502", message, None, "split the model"))
            sampled = sampled_transfer_function(bind(tf), self.sampling)
            equation = difference_equation(sampled, is_direct=self.is_direct)
            measured, warning = equation.measured()
            warnings += [warning] if warning else []
            functions.append(StepFunction(tf, equation, names[tf.name], measured))
        made = self.language.print(StepFile(model, functions, self.sampling, None if is_alone else stem))
        return replace(made, warnings=(*warnings, *made.warnings))


def _shown(pole: acb) -> str:
    re, im = float(pole.real.mid()), float(pole.imag.mid())
    return f"{re:.9g}" if im == 0 else f"{re:.9g} +- {im:.9g}j"
