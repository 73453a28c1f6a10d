"""The functions a generated module consists of, with the programs chosen for them.

Input: transfer functions.
Output: a :class:`Member` for each, and after it one for its response in real arithmetic where there is one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from symflex.codegen.program import choose_programs

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from symflex.codegen.program import Piecewise, Program, Verification
    from symflex.transfer import AnyTransferFunction


@dataclass(frozen=True, slots=True)
class Member:
    """One function of a module.

    Parameters
    ----------
    tf : TransferFunction or NestedTransferFunction
        Whose values it computes.
    program : Program or Piecewise
        Of s; of the angular frequency where it is real.
    wanted : str
        The name it has where the language and the other names admit it.
    verification : Verification
        How well it agrees with ball arithmetic.
    """

    tf: AnyTransferFunction
    program: Program | Piecewise
    wanted: str
    verification: Verification

    @property
    def key(self) -> str:
        """Tells it from the other members."""
        return f"{'at' if self.program.is_real else 'of'} {self.tf.name}"


def members_of(
    tfs: Sequence[AnyTransferFunction],
    band_hz: tuple[Fraction, Fraction] | None,
    samples: int,
) -> tuple[Member, ...]:
    """Return the members for some transfer functions; one that is given twice counts once.

    Parameters
    ----------
    tfs : sequence of TransferFunction
        Derived.
    band_hz, samples
        As for :func:`symflex.codegen.program.choose_programs`.
    """
    found: list[Member] = []
    for tf in {tf.name: tf for tf in tfs}.values():
        (program, verification), real = choose_programs(tf, band_hz, samples)
        wanted = f"{tf.output.name}_over_{tf.input.name}"
        found.append(Member(tf, program, wanted, verification))
        if real is not None:
            found.append(Member(tf, real[0], f"{wanted}_at", real[1]))
    return tuple(found)


def verifications(members: Sequence[Member]) -> tuple[Verification, ...]:
    """Return how well members agree with ball arithmetic: functions of s, then responses."""
    ordered = sorted(members, key=lambda member: member.program.is_real)
    return tuple(member.verification for member in ordered)
