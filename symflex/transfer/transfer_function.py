"""The transfer function: an exact rational function of s with names, units and what was cancelled from it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from symflex.expressions import Name, names
from symflex.kernels import LAPLACE, NO_KERNELS, KernelTable, ModalSums, degree_in

if TYPE_CHECKING:
    from collections.abc import Sequence

    from flint import fmpz_mpoly

    from symflex.elimination import Closure
    from symflex.equations import ConstantFunction
    from symflex.kernels import Factored, Ring
    from symflex.model import Input, Model, Output, Parameter


@dataclass(frozen=True, slots=True)
class HiddenFactor:
    """A polynomial in s that cancelled: its roots are uncontrollable or unobservable modes."""

    polynomial: fmpz_mpoly
    multiplicity: int


@dataclass(frozen=True)
class ClosedForm:
    """The same function with sub-impedances and definitions kept as single symbols.

    Parameters
    ----------
    closure : Closure
        The ring with one generator per closed sum, and what each sum is.
    num, den : fmpz_mpoly
        Coprime polynomials in that ring.
    """

    closure: Closure
    num: fmpz_mpoly
    den: fmpz_mpoly


@dataclass(frozen=True)
class TransferFunction:
    """``output = ratio(s) * input``, in lowest terms.

    Parameters
    ----------
    output, input : Output, Input
        What is measured and what drives.
    ratio : Factored
        Numerator over denominator; every factor of one is coprime to every factor of the other.
    closed : ClosedForm or None
        The compact form; ``None`` when it could not be reduced without opening its sums.
    hidden : tuple of HiddenFactor
        The common factors in s that were cancelled.
    quantity, unit : str
        ``receptance``, ``mobility``, ...; SI unit, empty when unknown.
    base : Ring
        The equations' ring: as ``ratio.ring``, and one generator per definition.
    definitions : tuple of (str, Factored)
        The definitions over ``base``, each in terms of earlier ones.
    constants : tuple of ConstantFunction
        What function generators such as ``sqrt(k*m)`` stand for.
    model : Model
        Where it comes from.
    kernels : KernelTable
        What the wavenumbers and kernels in the ring are; empty for a lumped system.
    parts : tuple of Factored, optional
        Numerator and denominator of a distributed system, each entire in s; see :attr:`num` and :attr:`den`.
    """

    output: Output
    input: Input
    ratio: Factored
    closed: ClosedForm | None
    hidden: tuple[HiddenFactor, ...]
    quantity: str
    unit: str
    base: Ring
    definitions: tuple[tuple[str, Factored], ...]
    constants: tuple[ConstantFunction, ...]
    model: Model
    kernels: KernelTable = NO_KERNELS
    parts: tuple[Factored, Factored] | None = None

    @property
    def num(self) -> Factored:
        """The numerator, entire in s.

        For a distributed system it may bear negative powers of wavenumbers and of differences of their
        squares; the kernels vanish where these do.
        """
        return self.ratio.numerator() if self.parts is None else self.parts[0]

    @property
    def den(self) -> Factored:
        """The denominator, entire in s; see :attr:`num`."""
        return self.ratio.denominator() if self.parts is None else self.parts[1]

    @property
    def is_distributed(self) -> bool:
        """True when the function is transcendental: it holds kernels besides s."""
        return bool(self.kernels)

    @cached_property
    def is_nameless(self) -> bool:
        """True when it holds kernels of wavenumbers that have no formula."""
        return any(
            self.ratio.depends_on(k.generator) for k in self.kernels.kernels if k.function == "fundamental"
        )

    @property
    def is_mixed(self) -> bool:
        """True when some of its wavenumbers have a formula and others have none."""
        named = (*self.kernels.wavenumbers, *(k.generator for k in self.kernels.kernels if k.wavenumber))
        return self.is_nameless and any(self.ratio.depends_on(name) for name in named)

    @property
    def name(self) -> str:
        """``OUT/IN``."""
        return f"{self.output.name}/{self.input.name}"

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters that occur, in declared order."""
        return self._parameters_in([f for f, _ in self.all_factors])

    @property
    def all_factors(self) -> tuple[tuple[fmpz_mpoly, int], ...]:
        """The factors of the ratio and of everything its wavenumbers and kernels are made of."""
        return (*self.ratio.factors, *(f for v in self.kernels.values for f in v.factors))

    @cached_property
    def modal_sums(self) -> ModalSums:
        """The polynomials of the ring in fundamental functions as sums of exponentials."""
        return ModalSums(self.ratio.ring, self.kernels)

    @cached_property
    def hidden_parameters(self) -> tuple[Parameter, ...]:
        """The parameters that occur in hidden factors, in declared order."""
        return self._parameters_in([h.polynomial for h in self.hidden])

    def _parameters_in(self, polynomials: Sequence[fmpz_mpoly]) -> tuple[Parameter, ...]:
        used = {n for i, n in enumerate(self.ratio.ring.names) if any(degree_in(p, i) for p in polynomials)}
        for constant in self.constants:
            if constant.generator in used:
                used |= {n.name for n in names(constant.expression) if isinstance(n, Name)}
        return tuple(p for p in self.model.parameters if p.name in used)

    @property
    def order(self) -> tuple[int, int]:
        """Degrees in s of numerator and denominator."""
        return degree(self.ratio.numerator()), degree(self.ratio.denominator())


def degree(value: Factored) -> int:
    """Return the degree in s of a product of polynomials."""
    i = value.ring.index[LAPLACE]
    return sum(degree_in(f, i) * e for f, e in value.factors)
