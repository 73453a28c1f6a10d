"""What can be claimed of models and checked. A new predicate is one function and one line in ``PREDICATES``.

Each is a pure function of facts. Its keyword arguments are the keys that a check in a claims file may have.
``of`` names what is checked: ``"two_mass: X_tip/F"`` a transfer function, ``"two_mass"`` all of a model's, or
the model itself. What the models lack is raised as a ``KeyError``, in words.

>>> from symflex.report.facts import ModelFacts, TransferFacts
>>> facts = TransferFacts("X/F", "", (), (), True, False, (0, 2), None, None, True, "", "always", "")
>>> counts({"car": ModelFacts("car", functions=(facts,))}, ("car: X/F",), zeros=0, poles=2)
Finding(verdict='holds', evidence=('X/F has no zeros and 2 poles.',))
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from symflex.errors import counted
from symflex.report.claims.claim import Finding, Models, Predicate, judged, model_of
from symflex.report.document import Run
from symflex.report.facts import ColocationFact, DataFact, LoopFacts, TransferFacts


def modes_at(
    models: Models, of: tuple[str, ...], *, hertz: tuple[float, ...], within: float, lowest: bool = False
) -> Finding:
    """Tell whether poles that oscillate, all or the lowest, are ``within`` [Hz] of these frequencies [Hz]."""
    lines, is_true = [], True
    for stem, function in functions(models, of):
        frequencies = [p.frequency_hz for p in function.poles if p.is_oscillatory]
        frequencies = frequencies[: len(hertz)] if lowest else frequencies
        near = all(abs(a - b) < within for a, b in zip(frequencies, hertz, strict=False))
        is_true = is_true and near and len(frequencies) == len(hertz)
        which = f"{counted(len(frequencies), 'mode')}, {'the lowest' if lowest else 'and no others'}"
        lines.append(f"{stem} has {which}, at {', '.join(f'{f:.2f}' for f in frequencies)} Hz.")
    return judged(is_true, "\n".join(lines))


def counts(models: Models, of: tuple[str, ...], *, zeros: int, poles: int) -> Finding:
    """Tell whether rational functions have so many zeros and poles."""
    facts = [f for _, f in functions(models, of)]
    is_true = all(f.counts == (zeros, poles) for f in facts)
    return judged(is_true, " ".join(f"{f.tf} has {_counts(f)}." for f in facts))


def arrangement(
    models: Models,
    of: tuple[str, ...],
    *,
    pole_pairs: int,
    zero_pairs: int,
    zeros_at_origin: int = 0,
    other_poles: int = 0,
) -> Finding:
    """Tell whether the array is made of so many conjugate pairs, zeros at 0, and poles of no pair."""
    lines, is_true = [], True
    for _, function in functions(models, of):
        pairs, zeros = (sum(r.is_oscillatory for r in rs) for rs in (function.poles, function.zeros))
        at_origin = sum(z.multiplicity for z in function.zeros if z.place == "origin")
        others = (function.counts[1] if function.counts else 0) - 2 * pairs
        wanted = (pole_pairs, zero_pairs, zeros_at_origin, other_poles)
        is_true = is_true and (pairs, zeros, at_origin, others) == wanted
        lines.append(
            f"{function.tf} has {_counts(function)}: {counted(pairs, 'pair')} of poles, "
            f"{counted(zeros, 'pair')} of zeros, {counted(others, 'other pole')}, "
            f"{counted(at_origin, 'zero')} at 0."
        )
    return judged(is_true, "\n".join(lines))


def added_per_mode(
    models: Models,
    of: tuple[str, ...],
    *,
    zeros: int,
    poles: int,
    zeros_are_real: bool = False,
    needs_dampers: bool = False,
) -> Finding:
    """Tell whether each flexible mode adds so many zeros and poles, with ``needs_dampers`` only with them."""
    lines, is_true = [], True
    for stem, function in functions(models, of):
        more_zeros, more_poles = function.added or (0, 0)
        wanted = (zeros * function.modes, poles * function.modes)
        are_real = all(z.place == "real axis" for z in function.zeros)
        is_true = is_true and (more_zeros, more_poles) == wanted and (are_real or not zeros_are_real)
        is_true = is_true and function.modes > 0
        more = f"{counted(more_poles, 'more pole')} and {counted(more_zeros, 'more zero')}"
        line = f"In {stem}, {function.tf} has {more} than if rigid, with {counted(function.modes, 'mode')}"
        line += ", and its zeros are real" if zeros_are_real and are_real else ""
        if needs_dampers and function.undamped is not None:
            line += f"; without dampers it has {counted(function.undamped[0], 'zero')}"
            is_true = is_true and function.undamped[0] != more_zeros
        lines.append(f"{line}.")
    return judged(is_true, "\n".join(lines), condition=needs_dampers)


def fewer_zeros_added(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether flexibility adds fewer zeros to one function than to another, though not fewer modes."""
    one, other = _two(models, of)
    (zeros, poles), (more, _) = one.added or (0, 0), other.added or (0, 0)
    return judged(
        zeros < more and one.modes >= other.modes,
        f"With {counted(one.modes, 'mode')}, {one.tf} has {counted(zeros, 'more zero')} and "
        f"{counted(poles, 'more pole')} than if rigid; {other.tf}, with {other.modes}, has {more} more.",
    )


def colocated(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether outputs are taken where the input acts, or rigidly joined to it."""
    facts = [f for _, f in functions(models, of)]
    are, are_not = ([f.tf for f in facts if bool(f.colocated) is truth] for truth in (True, False))
    kinds = ((are, "colocated"), (are_not, "not colocated"))
    said = [f"{' and '.join(tfs)} {'is' if len(tfs) == 1 else 'are'} {kind}." for tfs, kind in kinds if tfs]
    return judged(not are_not, " ".join(said))


def infinitely_many(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether functions are transcendental, with infinitely many poles and zeros."""
    finite = [f.tf for _, f in functions(models, of) if not f.is_infinite]
    return judged(not finite, f"Rational: {', '.join(finite)}." if finite else "All are transcendental.")


def modes_suffice(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether a product of the lowest modes, exact at s = 0, is within 5 % up to the last of them."""
    lines, is_true = [], True
    for _, function in functions(models, of):
        kept = function.truncation
        if kept is None:
            raise KeyError(f"rational approximation of {function.tf}")
        is_true = is_true and kept.five_percent_hz >= kept.last_hz
        lines.append(
            f"For {function.tf} the product of {kept.modes} modes, exact at s = 0, is within 1 % up to "
            f"{kept.one_percent_hz:.0f} Hz and within 5 % up to {kept.five_percent_hz:.0f} Hz "
            f"(sampled); mode {kept.modes} is at {kept.last_hz:.0f} Hz."
        )
    return judged(is_true, "\n".join(lines))


def interlacing(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether poles and zeros listed lie on the imaginary axis and take turns there, proved."""
    facts = [f for _, f in functions(models, of)]
    is_true = all(f.alternates and f.certified for f in facts)
    words = "lie exactly on the axis (proved) and alternate" if is_true else "do not alternate there"
    listed = [f"{len(f.poles)} poles and {len(f.zeros)} zeros of {f.tf}" for f in facts]
    return judged(is_true, "\n".join(f"The {these} listed {words}." for these in listed))


def same_poles(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether two functions have the same poles listed, all on the imaginary axis."""
    one, other = _two(models, of)
    is_same = len(one.poles) == len(other.poles) and all(
        abs(a.re - b.re) + abs(a.im - b.im) <= a.radius + b.radius
        for a, b in zip(one.poles, other.poles, strict=True)
    )
    on_axis = all(p.place in ("imaginary axis", "origin") for p in other.poles)
    words = "are the same" if is_same else "differ"
    where = ", on the axis (proved)" if on_axis else ""
    return judged(is_same and on_axis, f"The {len(other.poles)} poles listed {words}{where}.")


def mirrored_real_zeros(models: Models, of: tuple[str, ...], *, count: int = 0) -> Finding:
    """Tell whether all zeros are real, each with its mirror image; a ``count`` of 0 is any number."""
    lines: list[Run] = []
    facts = functions(models, of)
    for stem, function in facts:
        right = [f"{z.re:.4g}" for z in function.zeros if z.is_in_right_half_plane]
        zeros = ", ".join(f"{z.re:.4g}{z.im:+.4g}j" for z in function.zeros)
        listed = f"±{', ±'.join(right)}" if function.has_mirrored_real_zeros else zeros
        lines += ["\n", f"In {stem}, {function.tf} has zeros at {listed} rad/s."]
        lines += _bracket(function) if function.bracket else ()
    is_true = all(f.has_mirrored_real_zeros for _, f in facts)
    is_true = is_true and (not count or all(len(f.zeros) == count for _, f in facts))
    return judged(is_true, *lines[1:], condition=any(f.bracket for _, f in facts))


def minimum_phase(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether no zero lies in the right half-plane, for all values of the parameters."""
    facts = functions(models, of)
    words = {True: "minimum phase", False: "nonminimum phase"}
    said = [(f"In {stem}, {f.tf} is {words[f.is_minimum_phase]}", f) for stem, f in facts]
    lines = [f"{start} {f.condition.replace('always', 'for all values')}: {f.reason}." for start, f in said]
    is_true = all(f.is_minimum_phase and f.condition == "always" for _, f in facts)
    return judged(is_true, "\n".join(lines))


def nonminimum_phase(models: Models, of: tuple[str, ...], *, for_these_values: bool = False) -> Finding:
    """Tell whether zeros lie in the right half-plane; ``for_these_values`` says nothing of others."""
    lines: list[Run] = []
    facts = functions(models, of)
    for stem, function in facts:
        zeros = counted(function.right_half_plane_zeros, "zero")
        lines += ["\n", f"In {stem}, {function.tf} has {zeros} in the right half-plane."]
        lines += () if for_these_values else _bracket(function)
    is_true = all(not f.is_minimum_phase for _, f in facts)
    has_condition = not for_these_values and any(f.bracket for _, f in facts)
    return judged(is_true, *lines[1:], condition=has_condition)


def printed_formula(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether a formula of ``[published]`` is equal to the derived function."""
    findings = [_of_one(models, name) for name in of]
    worst = next((f for f in findings if f.verdict != "holds"), findings[0])
    return Finding(worst.verdict, ("\n".join(str(run) for f in findings for run in f.evidence),))


def _of_one(models: Models, name: str) -> Finding:
    stem, _, tf = name.partition(": ")
    audits = {key: (verdict, changes) for key, verdict, changes in models[stem].audits}
    if tf not in audits:
        raise KeyError(f"printed formula of {tf}")
    verdict, changes = audits[tf]
    right = "The formula is proved equal to the derived function."
    wrong = f"The formula is proved not to be the derived function. {changes}."
    if verdict not in ("equal", "differs"):
        return _unexamined("The comparison was not decided.")
    return judged(verdict == "equal", right if verdict == "equal" else wrong)


def best_fit(
    models: Models,
    of: tuple[str, ...],
    *,
    decibels: float = 0.0,
    synthetic: str = "The data in this report are synthetic.",
) -> Finding:
    """Tell whether of all models these alone are within some ``decibels`` (root mean square) of the data.

    0 is for no measure, and the claim is not examined; ``synthetic`` is said where the only data are.
    """
    compared = [(stem, fact) for stem, facts in models.items() for fact in facts.data]
    measured = [(stem, fact) for stem, fact in compared if not fact.is_synthetic]
    if not measured:
        lacking = "The comparison needs measured data, and the report has none."
        return _unexamined(f"{lacking} {synthetic} {_off(compared)}." if compared else lacking)
    if not decibels:
        return _unexamined(f"The claim does not say what counts as close. {_off(measured)}.")
    good = {stem for stem, fact in measured if fact.decibels < decibels}
    return judged(good == set(of), f"{_off(measured)}. Close means here: within {decibels:g} dB rms.")


def unstable_at_high_gain(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether loops are stable up to some gain and unstable for the largest ones examined."""
    lines, is_true = [], True
    for stem in of:
        loop = _loop(models, stem)
        end = loop.stable[0][1] if loop.stable else 0.0
        is_true = is_true and loop.unstable_at_last > 0
        crossing = f", where poles cross at {loop.crossings_hz[0]:.4g} Hz" if loop.crossings_hz else ""
        words = f"unstable for {loop.gain} > {end or 0:.4g}{crossing}"
        lines.append(f"{stem} is {words if loop.unstable_at_last else 'stable'}.")
    return judged(is_true, "\n".join(lines))


def always_stable(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether loops are stable for all gains examined."""
    found = [(stem, _loop(models, stem)) for stem in of]
    loops = [(stem, len(loop.stable) == 1 and not loop.crossings_hz) for stem, loop in found]
    lines = [f"{stem} is {'' if is_so else 'not '}stable for all gains examined." for stem, is_so in loops]
    return judged(all(is_so for _, is_so in loops), "\n".join(lines))


def together(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether outputs move with one where the input acts, from the lowest frequency examined."""
    colocations = [(_colocation(models, name), models[model_of(name)]) for name in of]
    lines = [
        f"In {facts.stem}, {one.tf} and {one.reference} move together {_up_to(one)}; "
        f"its first mode is at {_first_mode(facts.of(one.tf)):.4g} Hz."
        for one, facts in colocations
    ]
    is_limited = any(one.bandwidth_hz is not None for one, _ in colocations)
    lines += ["Condition: below that frequency."] if is_limited else []
    return judged(all(one.is_together for one, _ in colocations), " ".join(lines), condition=is_limited)


def together_farthest(models: Models, of: tuple[str, ...]) -> Finding:
    """Tell whether the first output moves with the colocated one to the largest share of its first mode."""
    lines: list[str] = []
    shares: list[float] = []
    for name in of:
        colocation = _colocation(models, name)
        end = (colocation.bandwidth_hz or colocation.examined_hz) if colocation.is_together else 0.0
        shares.append(end / _first_mode(models[model_of(name)].of(colocation.tf)))
        moves = f"In {model_of(name)}, outputs move together {_up_to(colocation)}"
        lines.append(f"{moves}, {shares[-1]:.2g} times its first mode.")
    return judged(all(shares[0] > share for share in shares[1:]), "\n".join(lines))


_EVERY: Final[tuple[Predicate, ...]] = (
    modes_at, counts, arrangement, added_per_mode, fewer_zeros_added, colocated, infinitely_many,
    modes_suffice, interlacing, same_poles, mirrored_real_zeros, minimum_phase, nonminimum_phase,
    printed_formula, best_fit, unstable_at_high_gain, always_stable, together, together_farthest,
)  # fmt: skip
PREDICATES: Final[Mapping[str, Predicate]] = {p.__name__.replace("_", "-"): p for p in _EVERY}
"""What ``is`` of a check may be: names of functions, with hyphens."""


def functions(models: Models, of: tuple[str, ...]) -> list[tuple[str, TransferFacts]]:
    """Return the transfer functions named, with their models' names; KeyError for what is missing."""
    facts: list[tuple[str, TransferFacts]] = []
    for name in of:
        stem, _, tf = name.partition(": ")
        facts += [(stem, f) for f in ((models[stem].of(tf),) if tf else models[stem].functions)]
    return facts


def _two(models: Models, of: tuple[str, ...]) -> tuple[TransferFacts, TransferFacts]:
    (_, one), (_, other) = functions(models, of)[:2]
    return one, other


def _unexamined(reason: str) -> Finding:
    return Finding("not examined", (reason,))


def _off(facts: list[tuple[str, DataFact]]) -> str:
    return "; ".join(
        f"{stem} is off by {f.decibels:.3g} dB, {f.degrees:.3g} degrees rms" for stem, f in facts
    )


def _loop(models: Models, stem: str) -> LoopFacts:
    if not models[stem].loops:
        raise KeyError(f"stable gains of {stem}")
    return models[stem].loops[0]


def _colocation(models: Models, name: str) -> ColocationFact:
    stem, _, tf = name.partition(": ")
    return {colocation.tf: colocation for colocation in reversed(models[stem].colocations)}[tf]


def _first_mode(function: TransferFacts) -> float:
    return min(p.frequency_hz for p in function.poles if p.is_oscillatory)


def _up_to(colocation: ColocationFact) -> str:
    within = f"within {colocation.phase_degrees:g} degrees and {colocation.magnitude_db:g} dB"
    end = "" if colocation.bandwidth_hz else ", the end of the band"
    return f"{within} up to {colocation.bandwidth_hz or colocation.examined_hz:.4g} Hz{end}"


def _counts(function: TransferFacts) -> str:
    zeros, poles = function.counts or (0, 0)
    return f"{counted(zeros, 'zero')} and {counted(poles, 'pole')}"


def _bracket(function: TransferFacts) -> tuple[Run, ...]:
    if function.bracket_mathematics is None:
        return (f" {function.reason[:1].upper()}{function.reason[1:]}.",) if function.reason else ()
    return (" Nonminimum phase exactly when ", function.bracket_mathematics, " < 0, as for these values.")
