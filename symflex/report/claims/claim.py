"""A statement of a publication with the checks that judge it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from symflex.report.facts import ModelFacts

if TYPE_CHECKING:
    from symflex.report.document import Run, Verdict

Models = Mapping[str, ModelFacts]
"""Facts by the name of the model's file, without suffix."""

Predicate = Callable[..., "Finding"]
"""What may be checked, with facts, the names of what is checked, and values by keyword."""

WORST: Final[tuple[Verdict, ...]] = ("not examined", "does not hold", "holds with a condition", "holds")
"""Verdicts; of several checks the first one here counts."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What a check found."""

    verdict: Verdict  # ``holds``, ``holds with a condition``, ``does not hold`` or ``not examined``
    evidence: tuple[Run, ...]  # the numbers it rests on, or why nothing was examined


@dataclass(frozen=True, slots=True)
class Check:
    """A predicate with what its author adds to the evidence."""

    predicate: Predicate  # with its values, but for what is checked
    of: tuple[str, ...]  # what is checked: ``"model: OUT/IN"``, or the name of a model's file without suffix
    # note and condition: Sentences; with a condition, what holds does so under it.
    note: str = ""
    condition: str = ""

    def judge(self, models: Models) -> Finding:
        """Return the finding with what was added."""
        found = self.predicate(models, self.of)
        condition = self.condition and f"Condition: {self.condition}"
        added = [f" {text}" for text in (self.note, condition) if text]
        is_conditional = self.condition and found.verdict == "holds"
        return Finding(
            "holds with a condition" if is_conditional else found.verdict, (*found.evidence, *added)
        )


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement of a publication."""

    key: str  # a short name, of letters and hyphens
    place: str  # the section it stands in
    quote: str  # its words
    checks: tuple[Check, ...]  # all of them have to hold
    is_quotation: bool = True  # the words are the publication's own

    def judge(self, models: Models) -> Finding:
        """Return the finding; what needs a model that is not there is not examined."""
        needs = dict.fromkeys(model_of(name) for check in self.checks for name in check.of)
        missing = [name for name in needs if name not in models]
        if missing:
            return Finding("not examined", (f"the report does not hold {', '.join(missing)}",))
        try:
            found = [check.judge(models) for check in self.checks]
        except KeyError as lacking:
            return Finding("not examined", (f"the models have no {lacking.args[0]} with numbers",))
        lines: list[Run] = []
        for one in found:
            lines += ["\n", *one.evidence]
        return Finding(min((one.verdict for one in found), key=WORST.index), tuple(lines[1:]))


@dataclass(frozen=True, slots=True)
class Publication:
    """A publication and what it claims of its models."""

    name: str  # what the ``source`` of its specifications begins with
    title: str  # its title
    models: tuple[str, ...]  # its models, in its own order
    claims: tuple[Claim, ...]  # in the order in which it makes them


def model_of(name: str) -> str:
    """Return the model that ``"model: OUT/IN"`` or ``"model"`` names."""
    return name.partition(":")[0]


def judged(is_true: bool, *evidence: Run, condition: bool = False) -> Finding:
    """Return a finding: does not hold unless true, and holds with a condition when the evidence names one."""
    if not is_true:
        return Finding("does not hold", evidence)
    return Finding("holds with a condition" if condition else "holds", evidence)
