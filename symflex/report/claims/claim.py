"""A statement of a publication with the computation that judges it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.report.facts import ModelFacts

if TYPE_CHECKING:
    from symflex.report.document import Run, Verdict

Models = Mapping[str, ModelFacts]
"""Facts by the name of the model's file, without suffix."""


@dataclass(frozen=True, slots=True)
class Finding:
    """What a check found.

    Parameters
    ----------
    verdict : str
        ``holds``, ``holds with a condition``, ``does not hold`` or ``not examined``.
    evidence : tuple of Run
        The numbers it rests on, or why nothing was examined.
    """

    verdict: Verdict
    evidence: tuple[Run, ...]


@dataclass(frozen=True, slots=True)
class Claim:
    """A statement of a publication.

    Parameters
    ----------
    key : str
        A short name, of letters and hyphens.
    place : str
        The section it stands in.
    quote : str
        Its words.
    needs : tuple of str
        Names of the models that the check reads.
    check : callable
        Judges it from the facts about these models.
    is_quotation : bool
        The words are the publication's own.
    """

    key: str
    place: str
    quote: str
    needs: tuple[str, ...]
    check: Callable[[Models], Finding]
    is_quotation: bool = True

    def judge(self, models: Models) -> Finding:
        """Return the finding; what needs a model that is not there is not examined."""
        missing = [name for name in self.needs if name not in models]
        if missing:
            return Finding("not examined", (f"the report does not hold {', '.join(missing)}",))
        try:
            return self.check(models)
        except KeyError as lacking:
            return Finding("not examined", (f"the models have no {lacking.args[0]} with numbers",))


@dataclass(frozen=True, slots=True)
class Publication:
    """A publication whose models and claims are known.

    Parameters
    ----------
    name : str
        What the ``source`` of its specifications begins with.
    title : str
        Its title.
    models : tuple of str
        Its models, in its own order.
    claims : tuple of Claim
        In the order in which it makes them.
    """

    name: str
    title: str
    models: tuple[str, ...]
    claims: tuple[Claim, ...]


def judged(is_true: bool, *evidence: Run, condition: bool = False) -> Finding:
    """Return a finding: does not hold unless true, and holds with a condition when the evidence names one."""
    if not is_true:
        return Finding("does not hold", evidence)
    return Finding("holds with a condition" if condition else "holds", evidence)
