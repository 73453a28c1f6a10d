"""From a transfer function with members whose coefficients vary along x to a program.

Input: a :class:`symflex.transfer.TransferFunction` with entries of fundamental matrices among its kernels.
Output: a :class:`Piecewise` of one piece. Numerator and denominator are sums of minors of these matrices,
each over its largest term; what follows the matrices along x is a function of the generated code.

    a clamped beam that tapers     num = |Z_03 Z_04; Z_23 Z_24|,  den = |Z_23 Z_24; Z_33 Z_34|
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from flint import fmpz_mpoly

from symflex.algebra import Factored
from symflex.algebra.dispersion import SingularStart
from symflex.along.law import PartedLaw, Summand
from symflex.along.minors import Minor, MinorSums
from symflex.codegen.program.build import Generators
from symflex.codegen.program.forge import Forge, straight
from symflex.codegen.program.nodes import CodePiece, FundamentalMinors, Piecewise, ScaledSum, Tip
from symflex.codegen.program.site import Site
from symflex.errors import Diagnostic, ModelError
from symflex.model.along import varies_along_x
from symflex.transfer import TransferFunction
from symflex.transfer.of_model import followed_along_x


def build_varying(tf: TransferFunction) -> Piecewise:
    """Return the program for complex s, uniform members followed along x too; SF910 beside frame members."""
    if _has_uniform(tf):
        tf = followed_along_x(tf)
    if _has_uniform(tf):
        message = f"{tf.name} combines frame members with tapered ones, for which code is not available yet"
        hint = "use --form band, which replaces parameters by their values"
        raise ModelError(Diagnostic("SF910", message, None, hint))
    return _Workshop(tf).program()


def _has_uniform(tf: TransferFunction) -> bool:
    return any(not law.matrix and law.kind != "exponential" for law in tf.kernels.dispersions)


@dataclass
class _Workshop:
    tf: TransferFunction
    _minors: dict[Minor, tuple[int, int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.ring = self.tf.ratio.ring
        self.forge = Forge()
        self.site = Site(self.forge, self.tf, ())
        self.sums = MinorSums(self.ring, self.tf.kernels)

    def program(self) -> Piecewise:
        forge, sides = self.forge, (self.tf.num, self.tf.den)
        bearing = [v.filter(self.sums.has_entries) for v in sides]
        plain = sides[0] / sides[1] / (bearing[0] / bearing[1])
        self._follow([f for v in bearing for f, _ in v.factors])
        halves = []
        for half in (
            bearing[0].numerator() * bearing[1].denominator(),
            bearing[1].numerator() * bearing[0].denominator(),
        ):
            values, growth = [], []
            for factor, exponent in half.factors:
                value, logarithm = self._sum(factor)
                values.append(forge.power(value, exponent))
                growth.append(forge.multiply([forge.constant(exponent), logarithm]))
            halves.append((forge.multiply(values), forge.add(growth)))
        (num, up), (den, down) = halves
        above = [self.site.value(plain.numerator()), num]
        if up != down:
            above.append(forge.apply("exp", forge.add([up, forge.negate(down)])))
        num = forge.multiply(above)
        den = forge.multiply([self.site.value(plain.denominator()), den])
        parameters = tuple(p.name for p in self.tf.parameters)
        nothing = straight(forge, [forge.constant(1)])
        return Piecewise(parameters, nothing, (), (0,), (CodePiece(straight(forge, [num, den])),))

    def _follow(self, factors: Sequence[fmpz_mpoly]) -> None:
        """Make all minors that are in use."""
        used = sorted({m for f in factors for _, product in self.sums.of(f) for m in product})
        for number, (law, length) in enumerate(self.sums.matrices):
            of_matrix = [m for m in used if m.matrix == number]
            calls = ((c.generator, c.expression) for c in self.tf.constants if c.generator in self.ring.index)
            parted = PartedLaw(law, {name: call for name, call in calls if varies_along_x(call)})
            inner = Forge()
            along = Generators(inner, self.tf, is_far=False)
            tip, beginning = (None, ()) if law.singular is None else self._tip(parted, law.singular)
            parts = straight(inner, [along.quotient(t.along)[0] for t in (*parted.every, *beginning)])
            s = self.ring.generator("s")
            bases = [Factored.polynomial(self.ring, s) ** parted.step, *(1 / d for d in parted.divisors)]
            ends = self.site.value(law.start[0]), self.site.length(length)
            wanted = tuple((m.rows, m.columns) for m in of_matrix)
            given = tuple(self.site.value(b) for b in bases)
            row = self.forge.make(FundamentalMinors, *ends, given, parts, parted.places, wanted, tip)
            # After the minors come the logarithms of their scales, by numbers of rows.
            item = partial(self.forge.item, self.forge.label(row, "minors"))
            self._minors |= {
                m: (item(i), item(len(of_matrix) + len(m.rows) - 1)) for i, m in enumerate(of_matrix)
            }

    def _tip(self, parted: PartedLaw, singular: SingularStart) -> tuple[Tip, tuple[Summand, ...]]:
        """Return how finite solutions begin at a singular start, and the parts of B."""
        size = range(len(singular.powers))
        exponents = [0 for _ in size]
        matrix = [list(row) for row in singular.matrix]
        for i in size:
            if not singular.orders[i][i] and not matrix[i][i].is_zero:
                if not matrix[i][i].is_constant or matrix[i][i].unit.denominator != 1:
                    message = f"code that starts at the end of '{parted.law.name}' where a stiffness vanishes"
                    hint = "poles, zeros and frequency responses are available"
                    raise ModelError(Diagnostic("SF910", f"{message} is not available yet", None, hint))
                exponents[i] = int(matrix[i][i].unit)
                matrix[i][i] = matrix[i][i] * 0
        parted_law = PartedLaw(
            replace(parted.law, matrix=tuple(map(tuple, matrix)), singular=None), parted.functions
        )
        below = [str(d) for d in parted.divisors]
        places = tuple(
            (i, j, singular.orders[i][j], t.power // parted.step, *(int(str(t.divisor) == d) for d in below))
            for (i, j), summands in parted_law.summands.items()
            for t in summands
        )
        return Tip(places, singular.powers, tuple(exponents), singular.free), parted_law.every

    def _sum(self, factor: fmpz_mpoly) -> tuple[int, int]:
        """Return a factor over its largest term, and the logarithm of that."""
        forge, amplitudes, exponents = self.forge, [], []
        for coefficient, product in self.sums.of(factor):
            made = [self._minors[m] for m in product]
            amplitudes.append(forge.multiply([self.site.polynomial(coefficient), *(v for v, _ in made)]))
            exponents.append(forge.add([scale for _, scale in made]))
        if len(amplitudes) == 1:
            return amplitudes[0], exponents[0]
        total = forge.label(forge.make(ScaledSum, tuple(amplitudes), tuple(exponents)), "total")
        return forge.item(total, 0), forge.item(total, 1)
