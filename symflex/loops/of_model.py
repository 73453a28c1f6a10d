"""Loops of a model as it is asked for: its characteristic function, its stable gains, its colocated band."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from math import pi

from symflex.budget import spend
from symflex.errors import BudgetError, ModelError, UncertifiedError
from symflex.loops import loop as loop_layer
from symflex.loops.colocation import DynamicColocation, dynamic_colocation
from symflex.loops.find import find_stable_gains
from symflex.loops.gain_functions import Limits
from symflex.loops.image import function_of, real_product, without_image
from symflex.loops.locus import is_straight
from symflex.loops.loop import Loop, pick_gain
from symflex.loops.networks import AnyLoop, network_loop
from symflex.loops.peak import loop_peaks
from symflex.loops.stability_map import StabilityMap
from symflex.model import Model, ModelParameter, with_numbers
from symflex.model.along import is_tapered
from symflex.model.loss_factors import check_causal
from symflex.model.settings import check_names
from symflex.options import (
    ColocationOptions,
    StabilityOptions,
    band_ends,
    gain_ends,
    highest_frequency,
    tolerance,
)
from symflex.roots.passivity import observed
from symflex.transfer import Given, TransferFunction
from symflex.transfer.bind import read_values
from symflex.transfer.of_model import (
    CODE_PRODUCTS,
    assemble,
    assemble_sparse,
    derive_all,
    derive_bound,
    is_large_network,
    pick_pairs,
)


def _gain_of(model: Model, name: str) -> ModelParameter:
    if name in {*(d.name for d in model.definitions), *(b.name for b in model.blocks)}:
        check_names(model, {name: ""})
    return pick_gain(model.parameters, name)


def characteristic_loop(
    model: Model,
    gain: str,
    values: Mapping[str, Given] | None = None,
    what: str = "a root locus or a loop gain",
) -> AnyLoop:
    """Return the characteristic function in a gain, of a large network unwritten; SF801, SF803, SF902."""
    parameter = _gain_of(model, gain)
    given = dict(values or {})
    # Parameters that are given another value stay symbols until that is put in. Numbers stand in kernels,
    # too: between symbols, factors that two wavenumbers share may be left in the characteristic function.
    prepared = with_numbers(model, (gain, *given), in_kernels=not is_tapered(model))
    check_causal(prepared, what)
    for name in given:
        pick_gain(model.parameters, name)
    is_large = is_large_network(model) and not prepared.imaginary
    if is_large and (network := _of_network(model, parameter, given)) is not None:
        return network
    equations = assemble(prepared)
    plain = {row.name for row in equations.outputs if row.divisor.is_one}
    pairs = [p for p in model.transfer_functions if p[0] in plain] or model.transfer_functions
    try:
        tf = _seeing(prepared, pairs, parameter)
    except BudgetError as error:
        if not model.is_distributed or is_tapered(model):
            raise
        # Where one member's motion is another's, nobody knows before that it is large.
        network = None if is_large else _of_network(model, parameter, given)
        if network is not None:
            return network
        message = f"'{gain}' occurs in several places of a network that is too large to be written out"
        raise loop_layer.no_loop("SF803", message, parameter) from error
    tf = real_product(tf, what) if prepared.imaginary else tf
    return loop_layer.characteristic_loop(tf, parameter, given)


def _seeing(model: Model, pairs: Sequence[tuple[str, str]], gain: ModelParameter) -> TransferFunction:
    """Return the first function whose poles depend on the gain, else the first: what it hides is hidden."""
    derived: list[TransferFunction] = []
    for pair in pairs:
        derived += (tf.whole for tf in derive_all(observed(model, pair[0]), [pair]))
        moving = loop_layer.gain_generators(derived[-1], gain.name)
        if any(derived[-1].den.depends_on(name) for name in moving):
            return derived[-1]
    return derived[0]


def _of_network(model: Model, parameter: ModelParameter, given: Mapping[str, Given]) -> AnyLoop | None:
    """Return the characteristic function of a network that is not written out; None where there is none."""
    gain = parameter.name
    has_value = parameter.value is not None or gain in given
    valued = tuple(p for p in model.parameters if p.name != gain or has_value)
    known = dict(read_values(valued, dict(given)))
    value = known.pop(gain, None)
    nominal = None if value is None or value.pi_power else value.rational
    sparse = assemble_sparse(with_numbers(observed(model), (gain,), known, in_kernels=True))
    return network_loop(sparse, parameter, nominal)


def stability(
    model: Model, given: StabilityOptions, values: Mapping[str, Given] | None = None
) -> StabilityMap:
    """Return for which values of a gain the model is stable; see :func:`symflex.loops.find_stable_gains`."""
    limits = gain_ends(given.limits, _gain_of(model, given.gain))
    radians = None if given.up_to is None else 2 * pi * highest_frequency(given.up_to)
    digits, what = given.digits or model.analysis.digits or 15, "stability of a loop"
    numbers = with_numbers(model, (given.gain, *(values or {})))
    check_causal(numbers, what)
    search = partial(find_stable_gains, limits=limits, digits=digits, up_to=radians)
    if numbers.imaginary:
        loop = characteristic_loop(model, given.gain, values, what)
        return of_complex(model, given.gain, values, search(loop, has_loop_gain=False))
    quick = _of_equations(model, given.gain, dict(values or {}), search)
    if quick is not None and quick.certified and not given.peaks:
        return quick
    try:
        loop = characteristic_loop(model, given.gain, values, what)
        written = search(loop)
        # Peaks are quick where both sides are polynomials in s.
        are_quick = isinstance(loop, Loop) and not loop.has_waves and loop.bound.sheets == 1
        if isinstance(loop, Loop) and (given.peaks or are_quick) and model.data_end is None:
            if written.is_stable and loop.nominal and is_straight(loop):
                peaks = loop_peaks(loop, loop.nominal)
                written = replace(written, margins=replace(written.margins, peaks=peaks))
    except BudgetError:
        if quick is None:
            raise
        spend()  # the time may be over
        return quick
    return written if quick is None or written.certified else quick


def of_complex(
    model: Model, name: str, values: Mapping[str, Given] | None, found: StabilityMap
) -> StabilityMap:
    """Return stable values that were found for a model with complex coefficients times its mirror image."""
    stated = [pick_gain(model.parameters, each) for each in values or {} if each != name]
    known = dict(read_values(tuple(stated), {p.name: (values or {})[p.name] for p in stated}))
    prepared = with_numbers(model, (name,), known, in_kernels=True)
    tf = _seeing(prepared, model.transfer_functions, pick_gain(model.parameters, name))
    return without_image(found, function_of(prepared, tf, name))


def _of_equations(
    model: Model, gain: str, given: Mapping[str, Given], search: Callable[[AnyLoop], StabilityMap]
) -> StabilityMap | None:
    """Return what a search finds of a network of two or three members, whose formula may take minutes."""
    if not is_large_network(model, CODE_PRODUCTS) or is_large_network(model) or model.imaginary:
        return None
    network = _of_network(model, _gain_of(model, gain), given)
    with suppress(UncertifiedError):
        return None if network is None else search(network)
    return None


def of_rational(
    model: Model, name: str, limits: Limits, digits: int, up_to: float | None, *, has_pairs: bool
) -> StabilityMap | None:
    """Return for which values of a parameter a model is stable, if it enters rationally; None if not.

    Then the characteristic function is a polynomial in it, and the search is that of a gain. Waves with two
    wavenumbers take long along the axis, and boxes decide more of them: they are searched if ``has_pairs``.
    """
    if model.data_end is not None:  # gains are judged up to there, parameters everywhere
        return None
    search = partial(find_stable_gains, limits=limits, digits=digits, up_to=up_to, has_loop_gain=False)
    found: StabilityMap | None = None
    try:
        found = _of_equations(model, name, {}, search)
        if found is not None and found.certified:
            return found
        loop = characteristic_loop(model, name, what="stability of a loop")
        if isinstance(loop, Loop) and (loop.functions is not None or not (has_pairs or _is_quick(loop))):
            return found
        written = search(loop)
        if with_numbers(model, (name,)).imaginary:
            return of_complex(model, name, None, written)
    except (ModelError, UncertifiedError, BudgetError):
        spend()  # the time may be over
        return found
    return written if found is None or written.certified else found


def _is_quick(loop: Loop) -> bool:
    """Tell whether no waves of a loop have two wavenumbers."""
    return not loop.has_waves or all(
        law.kind not in ("pair", "general") for law in loop.bound.kernels.dispersions
    )


def colocation(model: Model, given: ColocationOptions) -> DynamicColocation:
    """Return up to which frequency one output moves with another; see :func:`.loops.dynamic_colocation`."""
    check_causal(with_numbers(model), "a bound on colocation")
    band = None if given.band is None else band_ends(given.band, above_zero=True)
    tip, joint = derive_bound(model, pick_pairs(model, [given.tf, given.reference]))
    phase = tolerance(given.phase, "--phase", ("deg", "°"), "10 deg")
    magnitude = tolerance(given.magnitude, "--magnitude", ("dB",), "1 dB")
    return dynamic_colocation(tip, joint, phase, magnitude, band)
