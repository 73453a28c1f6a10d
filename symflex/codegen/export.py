"""What an export target is, what it makes, and what the user is told of its accuracy."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from symflex.codegen.program import Verification
    from symflex.model import Model
    from symflex.transfer import AnyTransferFunction

ACCURACY = 1e-13
"""Relative error of exported code above which the user is warned."""


@dataclass(frozen=True, slots=True)
class Export:
    """What an exporter made.

    Parameters
    ----------
    text : str
        The file's content.
    warnings : tuple of str
        What the user should know, for instance an accuracy that was not reached.
    companions : mapping of str to str
        Files that belong beside it, by suffix.
    """

    text: str
    warnings: tuple[str, ...] = ()
    companions: Mapping[str, str] = field(default_factory=dict)


class Exporter(Protocol):
    """Turns the transfer functions of a model into a file of some language."""

    @property
    def suffix(self) -> str:
        """Of the file's name."""
        ...

    @property
    def summary(self) -> str:
        """What is made, in a line."""
        ...

    def export(
        self, model: Model, tfs: Sequence[AnyTransferFunction], stem: str = "", *, is_alone: bool = True
    ) -> Export:
        """Return the file.

        Parameters
        ----------
        model : Model
            Whose they are.
        tfs : sequence of TransferFunction
            To write.
        stem : str
            The file's name without suffix, where that is known.
        is_alone : bool
            There can be no other files beside it: it has to serve without companions.
        """
        ...


def shortfalls(verified: Sequence[Verification]) -> tuple[str, ...]:
    """Return what falls short: of a function and its response in real arithmetic the worse one, once."""
    worst: dict[str, Verification] = {}
    for v in verified:
        if v.name not in worst or (v.error or 0.0) > (worst[v.name].error or 0.0):
            worst[v.name] = v
    return tuple(w for v in worst.values() if (w := _shortfall(v)))


def _shortfall(verification: Verification) -> str:
    """Return what the user should know about an accuracy, empty when it is as it should be."""
    name, error = verification.name, verification.error
    if error is None:
        return f"{name} is not verified: {verification.reason}"
    if error <= ACCURACY:
        return ""
    low, high = (float(f) for f in verification.band)
    if not isfinite(error):
        return f"{name} overflows somewhere over {low:g} Hz to {high:g} Hz"
    return f"{name} is accurate to {error:.1e} only, over {low:g} Hz to {high:g} Hz"
