"""From a transfer function to the same with numbers.

Input: a :class:`TransferFunction` and exact values of its parameters.
Output: a :class:`BoundTransferFunction`, whose coefficients are exact in pi and functions of constants.

Example: a mass on a spring and a damper with m = 2 kg, b = 3 N s/m, k = 5 N/m.

    before    1 / (m s^2 + b s + k)
    after     1 / (2 s^2 + 3 s + 5)

With values that make two factors equal, such as k_1 = k_2, what was apart before cancels: it is hidden now.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from itertools import combinations
from math import lcm

from flint import fmpz_mpoly

from symflex.algebra import LAPLACE, Factored, Radicals, Ring, by_powers, degree_in
from symflex.equations import assemble
from symflex.errors import Diagnostic, ModelError, Text, UsageError, no_such
from symflex.expressions import format_expression, names
from symflex.model import ExactValue, Model, ModelParameter, with_numbers
from symflex.model.along import COORDINATE
from symflex.model.declarations import assuming
from symflex.model.settings import check_free, exact_number, value_in_unit
from symflex.quantities import parse_quantity
from symflex.transfer.against_equations import compare
from symflex.transfer.agreement import agreement
from symflex.transfer.bound import BoundTransferFunction, radicals_at
from symflex.transfer.derive import derive, nested_transfer
from symflex.transfer.lowest_terms import cancel
from symflex.transfer.transfer_function import HiddenFactor, TransferFunction

Given = int | float | Fraction | Decimal | str | ExactValue  # as a user gives it, or exact

LOSSY_TAPER = (
    "a loss factor is",
    "give eta in seconds, a damping time constant; or divide it into uniform members, which take eta_s",
)  # what members that taper do not have, and what to do
NAMES_SHOWN = 40  # names of parameters without value that one message lists


def read_values(
    parameters: tuple[ModelParameter, ...], given: Mapping[str, Given]
) -> tuple[tuple[str, ExactValue], ...]:
    """Return every parameter's exact value, the given ones instead of the declared ones.

    A float counts as the shortest decimal that prints it, so ``0.1`` is 1/10. Raises UsageError: SF902 for an
    unknown name or a value that is not a finite number; ModelError: SF229 when a parameter has no value.
    """
    names = [p.name for p in parameters if not p.is_imaginary]
    for name in given:
        if name not in names and not getattr(given[name], "is_imaginary", False):
            raise no_such("parameter", name, names)
    values = [(p.name, _read_value(p, given[p.name]) if p.name in given else p.value) for p in parameters]
    missing = []
    for parameter, (_, value) in zip(parameters, values, strict=True):
        if value != parameter.value:
            check_free(parameter)
        if value is None:
            missing.append(parameter)
        # Zero is let through: leaving an effect out is what binding is often for.
        elif value.rational < 0 and parameter.assume != "real":
            message = f"parameter '{parameter.name}' is negative, but is assumed {parameter.assume}"
            raise UsageError(Diagnostic("SF209", message, None, assuming(parameter.name, "real")))
    if missing:
        raise ModelError(_without_value(missing))
    return tuple((name, value) for name, value in values if value is not None)


def values_for(
    model: Model, used: tuple[ModelParameter, ...], given: Mapping[str, Given]
) -> tuple[tuple[str, ExactValue], ...]:
    """Return the values of parameters that are used, and of others that are given: :func:`read_values`."""
    known = {p.name: p for p in model.parameters}
    if unknown := [n for n in given if n not in known]:
        read_values(model.parameters, {unknown[0]: given[unknown[0]]})
    return read_values((*used, *(known[n] for n in given if known[n] not in used)), given)


def _without_value(missing: Sequence[ModelParameter]) -> Diagnostic:
    """Return one diagnostic for all parameters without a value: a symbolic model may have hundreds."""
    if len(missing) == 1:
        hint = "give it a value here or with --set; in Python, to bind()"
        return Diagnostic("SF229", f"parameter '{missing[0].name}' has no value", missing[0].span, hint)
    shown = ", ".join(p.name for p in missing[:NAMES_SHOWN])
    more = f" and {len(missing) - NAMES_SHOWN} more" if len(missing) > NAMES_SHOWN else ""
    hint = "give them values in [parameters], or to bind() in Python"
    return Diagnostic("SF229", f"{len(missing)} parameters have no value: {shown}{more}", None, hint)


def _read_value(
    parameter: ModelParameter, given: float | Fraction | Decimal | str | ExactValue
) -> ExactValue:
    if isinstance(given, ExactValue):
        return given
    if isinstance(given, str):
        return value_in_unit(parameter, parse_quantity(Text.alone("<value>", given)))
    return ExactValue(exact_number(parameter.name, given))


def bind(
    tf: TransferFunction, values: Mapping[str, Given] | None = None, *, varied: Collection[str] = ()
) -> BoundTransferFunction:
    """Return the transfer function with the declared values, or the given ones in their place.

    Values are in SI units or have a unit ("0.8 m"). What vanishes with a parameter that is 0 is gone before
    anything is divided by it, and values with which something cancels mean what a model with these numbers
    means, unless the parameter is one that is ``varied``. Raises ModelError: SF229 a parameter without value,
    SF231 the denominator vanishes for these values; UsageError: SF902 an unknown parameter.
    """
    if tf.model.imaginary:
        tf.kernels.without_tapers(*LOSSY_TAPER)
    used = (*tf.parameters, *(p for p in tf.hidden_parameters if p not in tf.parameters))
    used = tuple(p for p in used if p.name not in dict(tf.fixed))
    exact = values_for(tf.model, used, dict(values or {}))
    is_of_model = tf.solve is not None  # else the model has another function between these ends
    if is_of_model and tf.is_large:
        return _derived_with_numbers(tf, exact, [p.name for p in tf.model.parameters])
    zeros = [name for name, value in exact if not value.rational and name not in varied]
    if is_of_model and zeros:
        with suppress(ModelError):  # with which there may be no model, but the limit of the formula
            return _derived_with_numbers(tf, exact, zeros)
    images, every = _substitution(tf, exact), [name for name, _ in exact]
    ring, radicals = images.ring, images.radicals
    if degenerate := _singular(tf, images):
        return _derived_or_refused(tf, exact, degenerate, f"a part of {tf.name} is 0/0 or 0 at every s")
    # Kept apart, so that factors which these values make equal are still seen to cancel.
    above, below = Factored.number(ring, tf.ratio.unit), Factored.number(ring, 1)
    for factor, exponent in tf.ratio.factors:
        value = images.apply(factor)
        if value.is_zero and exponent < 0:
            return _derived_or_refused(tf, exact, every, f"the denominator of {tf.name} is zero")
        if exponent > 0:
            above = above * value**exponent
        else:
            below = below * value**-exponent
    ratio, shared = cancel(above, below, radicals=None if tf.kernels else radicals)
    if ratio.is_zero and not tf.kernels:
        shared = below  # of a function that vanishes for these values every mode is hidden
    varying = [0, *(ring.index[k.generator] for k in tf.kernels.kernels)]
    hidden = [HiddenFactor(f, e) for f, e in shared.factors if any(degree_in(f, i) for i in varying)]
    # Numbers in place of names only slow the search for roots of waves, where nothing cancels by its value.
    is_other = hidden or (tf.hidden and not tf.kernels)
    has_symbols = any(not p.is_imaginary for p in used)
    if is_other and has_symbols and not varied and is_of_model:
        # A difference of parameters that is zero connects nothing, and subsystems that are equal are one.
        with suppress(ModelError):
            return _derived_with_numbers(tf, exact, every)
    for known in tf.hidden:
        value = images.apply(known.polynomial)
        hidden += [
            HiddenFactor(f, e * known.multiplicity)
            for f, e in value.factors
            if e > 0 and any(degree_in(f, i) for i in varying)
        ]
    if not tf.kernels:
        return _compared(BoundTransferFunction(tf, exact, ratio, tuple(hidden), fixed=tf.fixed))
    kernels = tf.kernels.embedded([(v, images.apply_factored(v)) for v in tf.kernels.values])
    parts = (images.apply_factored(tf.num), images.apply_factored(tf.den))
    return _compared(BoundTransferFunction(tf, exact, ratio, tuple(hidden), kernels, parts, fixed=tf.fixed))


def with_waves(bound: BoundTransferFunction) -> BoundTransferFunction | None:
    """Return a function over a ring with kernels, where only what it hides has any; else None."""
    source = bound.source.with_waves
    if source is None or not bound.is_of_model:
        return None
    known = {p.name for p in source.model.parameters}
    uncut = bind(source, {name: value for name, value in bound.values if name in known})
    # Derived with numbers, it may be written without kernels again.
    return uncut if uncut.kernels else with_waves(uncut)


def _vanishing(what: str) -> ModelError:
    hint = "write a rigid or massless limit as a model of its own"
    return ModelError(Diagnostic("SF231", f"{what} is zero for these values", None, hint))


def _compared(bound: BoundTransferFunction) -> BoundTransferFunction:
    """Return a function once it agrees with the equations at its values; else InternalError SF991."""
    if bound.source.solve is not None:
        compare(bound.source.solve, [agreement(bound)], dict(bound.values))
    return bound


def is_degenerate(tf: TransferFunction) -> bool:
    """Tell whether a formula is 0/0 for the declared values, as where these make wavenumbers equal."""
    used = tf.parameters
    if not tf.kernels.wavenumbers or any(p.value is None for p in used):
        return False
    return bool(_degenerate(tf, _substitution(tf, read_values(used, {}))))


def _substitution(tf: TransferFunction, values: Sequence[tuple[str, ExactValue]]) -> _Substitution:
    coordinate = [COORDINATE] if any(law.matrix for law in tf.kernels.dispersions) else []
    table = dict(values)
    unit = [name for name, value in values if value.is_imaginary]
    fixed = [name for name, _ in tf.fixed if name in tf.ratio.ring.index]
    constants = (*unit, *coordinate, *fixed, *_used_constants(tf))
    ring = Ring((LAPLACE, "pi", *constants, *tf.kernels.generators))
    return _Substitution(ring, tf.ratio.ring, table, radicals_at(tf, ring, table))


def _degenerate(tf: TransferFunction, images: _Substitution) -> list[str]:
    """Return parameters whose values make a formula 0/0 at every s, as where wavenumbers are equal."""
    zeros: list[fmpz_mpoly] = []
    for law in tf.kernels.dispersions:
        c = law.characteristic
        zeros += [f for x in law.meets for f, _ in x.factors if images.apply_factored(x).is_zero]
        if law.wavenumbers and images.apply_factored(c[0]).is_zero:
            zeros += [f for f, _ in c[0].factors]
        elif law.kind == "pair" and images.apply_factored(law.discriminant).is_zero:
            zeros += [f for x in c for f, _ in x.factors]
        elif law.kind == "general" and law.replaced(images.apply_factored).has_double_root:
            zeros += [f for x in c for f, _ in x.factors]
    kernels = [tf.ratio.ring.index[name] for name in tf.kernels.generators]
    for factor in (f for value in (tf.num, tf.den) for f, e in value.factors if e < 0 or value is tf.den):
        plain = tf.kernels and not any(degree_in(factor, i) for i in kernels)
        if plain and images.apply(factor).is_zero:
            zeros.append(factor)
    return [p.name for p in tf.parameters_in(zeros)]


def _singular(tf: TransferFunction, images: _Substitution) -> list[str]:
    """Return parameters with whose values waves are other than with any, so that a formula may not hold."""
    return _degenerate(tf, images) or _with_fewer_terms(tf, images) or _in_step(tf, images)


def _with_fewer_terms(tf: TransferFunction, images: _Substitution) -> list[str]:
    """Return parameters whose values take terms from a law of waves, as the foundation's from ``s*(s + c)``.

    The points where its wavenumbers vanish or meet coincide then, or are gone, and what was divided by them
    has other roots.
    """
    zeros: list[fmpz_mpoly] = []
    for law in tf.kernels.dispersions:
        for factor in (f for x in (*law.characteristic, *law.meets) for f, _ in x.factors):
            parts = by_powers(tf.ratio.ring, factor, tf.ratio.ring.index[LAPLACE])
            zeros += [part for part in parts.values() if images.apply(part).is_zero]
    return [p.name for p in tf.parameters_in(zeros)]


def _in_step(tf: TransferFunction, images: _Substitution) -> list[str]:
    """Return parameters of waves that their values make rational multiples, whose kernels share factors."""
    laws = tf.kernels.dispersions
    if any(law.kind != "wave" for law in laws):
        return []
    pairs = combinations((law.characteristic[0] for law in laws), 2)
    alike = [x for a, b in pairs if images.radicals.either_root(images.apply_factored(a / b)) for x in (a, b)]
    return [p.name for p in tf.parameters_in([f for x in alike for f, _ in x.factors])]


def _derived_with_numbers(
    tf: TransferFunction, values: tuple[tuple[str, ExactValue], ...], names: Collection[str]
) -> BoundTransferFunction:
    """Return a function derived with the values of some parameters, so that equal waves are seen."""
    symbolic = [p.name for p in tf.model.parameters if p.name not in names]
    numeric = with_numbers(tf.model, symbolic, dict(values), in_kernels=True)
    derived = derive(assemble(numeric, nested_transfer), tf.output.name, tf.input.name)
    if derived.is_mixed:
        nameless = assemble(numeric, nested_transfer, is_nameless=True)
        derived = derive(nameless, tf.output.name, tf.input.name)
    remaining = {name: value for name, value in values if name in symbolic and not value.is_imaginary}
    return replace(bind(derived, remaining), values=values, symbolic=tf)


def _derived_or_refused(
    tf: TransferFunction, values: tuple[tuple[str, ExactValue], ...], names: Collection[str], what: str
) -> BoundTransferFunction:
    """Return a function derived with the values of some parameters; SF231 with the reason where none is."""
    if tf.solve is None:
        raise ModelError(Diagnostic("SF231", f"{what} for these values", None, "change them a little"))
    try:
        return _derived_with_numbers(tf, values, names)
    except ModelError as error:
        hint = f"write the limit as a model of its own ({error.diagnostics[0].message})"
        raise ModelError(Diagnostic("SF231", f"{what} for these values", None, hint)) from None


def bind_polynomials(
    tf: TransferFunction, bound: BoundTransferFunction, polynomials: Sequence[fmpz_mpoly]
) -> tuple[Factored, ...]:
    """Return polynomials over a ring, such as coefficients of a gain, with a bound function's values."""
    ring, values = bound.ratio.ring, dict(bound.values)
    images = _Substitution(ring, tf.ratio.ring, values, radicals_at(tf, ring, values))
    return tuple(images.apply(polynomial) for polynomial in polynomials)


def _used_constants(tf: TransferFunction) -> list[str]:
    """Return the functions of constants that occur; the others may lack a value."""
    index = tf.ratio.ring.index
    polynomials = [*(f for f, _ in tf.all_factors), *(h.polynomial for h in tf.hidden)]
    used = [c for c in tf.constants if any(degree_in(p, index[c.generator]) for p in polynomials)]
    inside = {format_expression(n) for c in used for n in names(c.expression)}
    return [c.generator for c in tf.constants if c.generator in inside]


@dataclass(frozen=True)
class _Substitution:
    """Puts exact values in place of parameters."""

    ring: Ring
    source: Ring
    values: Mapping[str, ExactValue]
    radicals: Radicals  # over ``ring``

    def apply(self, polynomial: fmpz_mpoly) -> Factored:
        """Return the polynomial over s, pi and functions of constants."""
        names = self.source.names
        targets = [self.ring.index.get(n) for n in names]
        pi = self.ring.index["pi"]
        powers: dict[tuple[str, int], Fraction] = {}
        collected: dict[tuple[int, ...], Fraction] = {}
        for monomial, coefficient in polynomial.terms():
            number = Fraction(int(coefficient))
            exponents = [0] * len(self.ring.names)
            for name, target, exponent in zip(names, targets, monomial, strict=True):
                e = int(exponent)
                if not e:
                    continue
                if target is not None:
                    exponents[target] += e
                    continue
                value = self.values[name]
                key = (name, e)
                if key not in powers:
                    powers[key] = value.rational**e
                number *= powers[key]
                exponents[pi] += value.pi_power * e
            monomial_key = tuple(exponents)
            collected[monomial_key] = collected.get(monomial_key, Fraction(0)) + number
        return self.radicals.reduced(self._clear(collected, pi))

    def apply_factored(self, value: Factored) -> Factored:
        """Return a rational function over s, pi and functions of constants; SF231 where it divides by 0."""
        result = Factored.number(self.ring, value.unit)
        for factor, exponent in value.factors:
            image = self.apply(factor)
            if image.is_zero and exponent < 0:
                raise _vanishing("a denominator")
            result = result * image**exponent
        return result

    def _clear(self, collected: dict[tuple[int, ...], Fraction], pi: int) -> Factored:
        terms = {m: c for m, c in collected.items() if c}
        if not terms:
            return Factored.number(self.ring, 0)
        lowest = min(m[pi] for m in terms)
        if len(terms) == 1 and lowest >= 0:
            ((monomial, number),) = terms.items()
            generators = ((self.ring.context.gen(i), e) for i, e in enumerate(monomial) if e)
            return Factored(self.ring, number, tuple(generators))
        shift = min(lowest, 0)
        scale = lcm(*(c.denominator for c in terms.values()))
        integers = {
            tuple(e - shift if i == pi else e for i, e in enumerate(m)): int(c * scale)
            for m, c in terms.items()
        }
        value = Factored.polynomial(self.ring, self.ring.context.from_dict(integers))
        return value * Fraction(1, scale) * Factored.generator(self.ring, "pi") ** shift
