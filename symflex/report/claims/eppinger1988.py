"""What Eppinger and Seering claim about their models, and the checks that judge it.

S. D. Eppinger and W. P. Seering, "Modeling Robot Flexibility for Endpoint Force Control", 1988. Quotations
are in the order of the text. Claims about measured data need the data, which the paper prints as a plot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from symflex.report.claims.claim import Claim, Finding, Publication, judged
from symflex.report.numerals import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from symflex.report.claims.claim import Models
    from symflex.report.document import Run
    from symflex.report.facts import ColocationFact, DataFact, LoopFacts, TransferFacts

MODES_HZ: Final = (11.0, 38.0, 44.0, 67.0, 77.0)
"""The dominant structural modes, section 'Experimental Robot Dynamics'."""

ROUNDING_HZ: Final = 0.5
"""The paper gives whole numbers, and says "roughly"."""

EXPERIMENT: Final = "Experimental Robot Dynamics"
RIGID: Final = "Rigid-Body Dynamics"
POLYNOMIAL: Final = "Polynomial Resonance Model"
LUMPED: Final = "Lumped-Mass Models"
BENDING: Final = "Bending Beam Models"
DISCUSSION: Final = "Discussion"

WELL_DB: Final = 3.0
"""What is taken for a good fit: the paper gives no measure."""

BENDING_BEAMS: Final = ("sliding_free_beam", "lumped_bending_beam")

_TWO_ZEROS_PER_MODE: Final = 2


def _modes(models: Models) -> Finding:
    shown: list[Run] = []
    is_true = True
    for stem, tf in (("polynomial_resonance", "A_tip/V_cmd"), ("six_mass", "X_tip/F")):
        found = [p.frequency_hz for p in models[stem].of(tf).poles if p.is_oscillatory]
        near = len(found) == len(MODES_HZ) and all(
            abs(a - b) < ROUNDING_HZ for a, b in zip(found, MODES_HZ, strict=True)
        )
        is_true = is_true and near
        shown += [f"{stem}: {', '.join(f'{f:.2f}' for f in found)} Hz", "\n"]
    (beam, *_) = (p.frequency_hz for p in models["sliding_free_beam"].of("V_act/F").poles if p.is_oscillatory)
    shown.append(f"sliding_free_beam: first mode at {beam:.2f} Hz")
    return judged(is_true and abs(beam - MODES_HZ[0]) < ROUNDING_HZ, *shown)


def _second_order(models: Models) -> Finding:
    velocity = models["rigid_body"].of("V_tip/V_cmd")
    return judged(
        velocity.counts == (0, 2), f"V_tip/V_cmd has {_counts(velocity)}; an integrator adds a pole."
    )


def _printed(key: str, stem: str, tf: str, note: str = "") -> Claim:
    def check(models: Models) -> Finding:
        found = {name: (verdict, changes) for name, verdict, changes in models[stem].audits}
        if tf not in found:
            raise KeyError(f"printed formula of {tf}")
        verdict, changes = found[tf]
        if verdict not in ("equal", "differs"):
            return _unexamined("The comparison was not decided.")
        if verdict == "equal":
            return judged(True, f"Proved equal to the derived function{note}.")
        return judged(False, f"Proved not to be the derived function. {changes}.")

    place = RIGID if stem == "rigid_body" else BENDING
    quote = f"The formula printed for {tf.replace('/', '(s)/')}(s)"
    return Claim(key, place, quote, (stem,), check, is_quotation=False)


def _polynomial_counts(models: Models) -> Finding:
    function = models["polynomial_resonance"].of("A_tip/V_cmd")
    poles = sum(p.is_oscillatory for p in function.poles)
    zeros = sum(z.is_oscillatory for z in function.zeros)
    at_origin = sum(z.multiplicity for z in function.zeros if z.place == "origin")
    rest = (function.counts[1] if function.counts else 0) - 2 * len(MODES_HZ)
    is_true = (poles >= len(MODES_HZ), zeros, at_origin, rest) == (True, len(MODES_HZ), 1, 2)
    return judged(
        is_true, f"{_counts(function)}: five pairs each, two poles of the rigid body, {at_origin} zero at 0."
    )


def _one_zero(models: Models) -> Finding:
    shown: list[Run] = []
    is_true, needs_loss = True, False
    for stem in ("two_mass", "six_mass"):
        function = models[stem].of("X_tip/F")
        zeros, poles = function.added or (0, 0)
        are_real = all(z.place == "real axis" for z in function.zeros)
        is_true = is_true and are_real and (zeros, poles) == (function.modes, 2 * function.modes)
        bare = function.undamped[0] if function.undamped else zeros
        needs_loss = needs_loss or bare != zeros
        shown += [
            f"{stem}, X_tip/F: {counted(poles, 'pole')} and {counted(zeros, 'zero')} more with "
            f"{counted(function.modes, 'mode')}, the zeros real; without dampers {counted(bare, 'zero')}.",
            "\n",
        ]
    shown.append("Condition: a damper beside each spring, which brings the zero at −k/b.")
    return judged(is_true, *shown, condition=needs_loss)


def _too_few_zeros(models: Models) -> Finding:
    chain = models["six_mass"].of("V_tip/F")
    fitted = models["polynomial_resonance"].of("A_tip/V_cmd")
    (zeros, poles), (more, _) = chain.added or (0, 0), fitted.added or (0, 0)
    return judged(
        zeros < more,
        f"With five modes the chain adds {counted(zeros, 'zero')} and {counted(poles, 'pole')}, the "
        f"resonances "
        f"fitted to the data {counted(more, 'zero')}.",
    )


def _base(models: Models) -> Finding:
    facts = models["base_flexure"]
    found = [facts.of(tf) for tf in ("V_tip/F", "V_motor/F")]
    is_true = all(f.counts == (2, 3) and f.added == (2, 2) for f in found)
    return judged(
        is_true,
        *(f"{f.tf}: {_counts(f)}. " for f in found),
        "Condition: as modelled here, where force and friction act between carriage and base; the "
        "drawing leaves "
        "that open.",
        condition=True,
    )


def _base_only_colocated(models: Models) -> Finding:
    found = [models["base_flexure"].of(tf) for tf in ("V_tip/F", "V_motor/F")]
    return judged(
        all(f.colocated for f in found), "Tip and motor are one rigid carriage, on which the force acts."
    )


def _infinity(models: Models) -> Finding:
    found = [models["sliding_free_beam"].of(tf) for tf in ("V_act/F", "V_tip/F")]
    return judged(all(f.is_infinite for f in found), "Both functions are transcendental.")


def _through_fifth_mode(models: Models) -> Finding:
    shown: list[Run] = []
    is_true = True
    for tf in ("V_act/F", "V_tip/F"):
        kept = models["sliding_free_beam"].of(tf).truncation
        if kept is None:
            raise KeyError(f"rational approximation of {tf}")
        is_true = is_true and kept.five_percent_hz >= kept.last_hz
        shown += [
            f"{tf}: the product of {kept.modes} modes, exact at s = 0, is within 1 % up to "
            f"{kept.one_percent_hz:.0f} Hz and within 5 % up to {kept.five_percent_hz:.0f} Hz "
            f"(sampled); mode "
            f"{kept.modes} is at {kept.last_hz:.0f} Hz.",
            "\n",
        ]
    shown.append(
        "Poles and zeros agree through the fifth mode, magnitudes do not: for those more modes must be kept."
    )
    return judged(is_true, *shown)


def _alternating(models: Models) -> Finding:
    function = models["sliding_free_beam"].of("V_act/F")
    return judged(
        function.alternates and function.certified,
        f"All {len(function.poles)} poles and {len(function.zeros)} zeros listed lie exactly on the "
        f"axis (proved) "
        "and take turns.",
    )


def _same_poles(models: Models) -> Finding:
    one, other = (models["sliding_free_beam"].of(tf) for tf in ("V_act/F", "V_tip/F"))
    is_true = len(one.poles) == len(other.poles) and all(
        abs(a.re - b.re) + abs(a.im - b.im) <= a.radius + b.radius
        for a, b in zip(one.poles, other.poles, strict=True)
    )
    on_axis = all(p.place in ("imaginary axis", "origin") for p in other.poles)
    return judged(
        is_true and on_axis, f"The {len(other.poles)} poles listed are the same, on the axis (proved)."
    )


def _real_zeros(models: Models) -> Finding:
    function = models["sliding_free_beam"].of("V_tip/F")
    right = [f"{z.re:.1f}" for z in function.zeros if z.is_in_right_half_plane]
    return judged(
        function.has_mirrored_real_zeros,
        f"The zeros listed are real, at ±{', ±'.join(right)} rad/s (proved).",
    )


def _no_phase(models: Models) -> Finding:
    function = models["sliding_free_beam"].of("V_tip/F")
    return judged(
        function.has_mirrored_real_zeros,
        "A pair ±z contributes s² − z² = −(ω² + z²) at s = jω: real and of one sign at every frequency.",
    )


def _not_in_lumped(models: Models) -> Finding:
    stems = ("two_mass", "six_mass", "base_flexure")
    found = [f for stem in stems for f in models[stem].functions]
    is_true = all(f.is_minimum_phase and f.condition == "always" for f in found)
    return judged(
        is_true, f"All {len(found)} functions of {', '.join(stems)} are minimum phase, for all values."
    )


def _bending_not_distribution(models: Models) -> Finding:
    chain, bar = models["six_mass"].of("X_tip/F"), models["lumped_bending_beam"].of("X_tip/F")
    return judged(
        chain.condition == "always" and not bar.is_minimum_phase,
        "Lumped and axial, six_mass: minimum phase for all values. Lumped and bending, lumped_bending_beam: "
        f"{counted(bar.right_half_plane_zeros, 'zero')} in the right half plane. ",
        *_bracket(bar),
        condition=bar.condition == "if positive",
    )


def _lumped_colocated(models: Models) -> Finding:
    function = models["lumped_bending_beam"].of("X_act/F")
    return judged(function.condition == "always", f"For all values: {function.reason}.")


def _lumped_noncolocated(models: Models) -> Finding:
    function = models["lumped_bending_beam"].of("X_tip/F")
    return judged(not function.is_minimum_phase, *_bracket(function), condition=bool(function.bracket))


def _lumped_pair(models: Models) -> Finding:
    function = models["lumped_bending_beam"].of("X_tip/F")
    zeros = ", ".join(f"{z.re:+.2f}" for z in function.zeros)
    return judged(
        function.has_mirrored_real_zeros and function.counts is not None and function.counts[0] == 2,  # noqa: PLR2004
        f"Its zeros are {zeros} rad/s. ",
        *_bracket(function),
        condition=bool(function.bracket),
    )


def _right_numbers(models: Models) -> Finding:
    function = models["sliding_free_beam"].of("V_act/F")
    zeros, poles = function.added or (0, 0)
    is_true = zeros == poles == _TWO_ZEROS_PER_MODE * function.modes
    return judged(
        is_true and function.alternates,
        f"Through mode {function.modes}: {counted(poles, 'pole')} and {counted(zeros, 'zero')}, in turns.",
    )


def _rigid_counts(models: Models) -> Finding:
    function = models["polynomial_resonance"].of("A_tip/V_cmd")
    zeros, poles = function.added or (0, 0)
    is_true = function.modes == len(MODES_HZ) and zeros == poles == _TWO_ZEROS_PER_MODE * function.modes
    return judged(is_true, f"Five resonances add {counted(poles, 'pole')} and {counted(zeros, 'zero')}.")


def _base_adds_two(models: Models) -> Finding:
    found = [models["base_flexure"].of(tf) for tf in ("V_tip/F", "V_motor/F")]
    is_true = all(f.added == (2, 2) for f in found)
    return judged(is_true, "V_tip/F and V_motor/F: two poles and two zeros more than with a rigid base.")


def _same_character(models: Models) -> Finding:
    lumped, beam = models["lumped_bending_beam"].of("X_tip/F"), models["sliding_free_beam"].of("V_tip/F")
    return judged(
        lumped.has_mirrored_real_zeros and beam.has_mirrored_real_zeros,
        "Both have real zeros only, each with its mirror image; the beam for all values. Lumped: ",
        *_bracket(lumped),
        condition=bool(lumped.bracket),
    )


def _equal_frequencies(models: Models) -> Finding:
    zeros = models["lumped_bending_beam"].of("X_tip/F").zeros
    sizes = ", ".join(f"{abs(z.re):.3f}" for z in zeros)
    return judged(
        models["lumped_bending_beam"].of("X_tip/F").has_mirrored_real_zeros,
        f"Sizes {sizes} rad/s: the numerator is even in s, so equal exactly. ",
        *_bracket(models["lumped_bending_beam"].of("X_tip/F")),
        condition=bool(models["lumped_bending_beam"].of("X_tip/F").bracket),
    )


def _unexamined(reason: str) -> Finding:
    return Finding("not examined", (reason,))


def _data(models: Models) -> tuple[list[tuple[str, DataFact]], bool]:
    """Return how far models are off measured responses, and whether these are measured at all."""
    told = [(stem, fact) for stem in EPPINGER_1988.models if stem in models for fact in models[stem].data]
    measured = [(stem, fact) for stem, fact in told if not fact.is_synthetic]
    return (measured, True) if measured else (told, False)


def _off(told: Sequence[tuple[str, DataFact]]) -> str:
    return "; ".join(f"{stem} is off by {f.decibels:.3g} dB, {f.degrees:.3g} degrees rms" for stem, f in told)


def _without_data(told: Sequence[tuple[str, DataFact]]) -> Finding:
    lacking = "The measured response is printed as a plot only; the comparison needs its numbers."
    if not told:
        return _unexamined(lacking)
    return _unexamined(
        f"{lacking} The stand-in in this report is synthetic and was computed from polynomial_resonance, "
        f"which fits it by construction; it tells nothing of the experiment. {_off(told)}."
    )


def _rigid_matches(models: Models) -> Finding:
    told, is_measured = _data(models)
    if not is_measured:
        return _without_data(told)
    return _unexamined(f"What counts as overall is not said. {_off(told)}.")


def _only_fit(models: Models) -> Finding:
    told, is_measured = _data(models)
    if not is_measured:
        return _without_data(told)
    good = {stem for stem, fact in told if fact.decibels < WELL_DB}
    return judged(
        good == {"polynomial_resonance"}, f"{_off(told)}. Well means here: within {WELL_DB:g} dB rms."
    )


def _high_gain(models: Models) -> Finding:
    """At high gain noncolocated loops are unstable, colocated ones are not, where there are such zeros."""
    shown: list[Run] = []
    is_true = True
    for stem in BENDING_BEAMS:
        force, position = (_loop(models, f"{stem}_{kind}") for kind in ("force", "position"))
        (_, end), *_ = force.stable
        has_right_zeros = any(f.right_half_plane_zeros for f in models[stem].functions)
        is_true = is_true and has_right_zeros and force.unstable_at_last > 0 and position.is_always_stable
        shown += [
            f"{stem}: force loop unstable for {force.gain} > {end or 0:.4g}, where poles cross at "
            f"{force.crossings_hz[0]:.4g} Hz; joint position loop stable for all gains examined",
            "\n",
        ]
    return judged(is_true, *shown[:-1])


def _dynamically_colocated(models: Models) -> Finding:
    base = _colocation(models, "base_flexure", "V_tip/F")
    first = _first_mode(models, "base_flexure", "V_tip/F")
    shown = f"base_flexure: V_tip/F and {base.reference} are together {_up_to(base)}; mode at {first:.4g} Hz."
    if not base.is_together or base.bandwidth_hz is None:
        return judged(base.is_together, shown)
    return Finding("holds with a condition", (shown, " Condition: below that frequency."))


def _base_against_link(models: Models) -> Finding:
    shown: list[Run] = []
    shares: list[float] = []
    for stem in ("base_flexure", "two_mass", "sliding_free_beam"):
        found = _colocation(models, stem, "V_tip/F")
        end = (found.bandwidth_hz or found.examined_hz) if found.is_together else 0.0
        shares.append(end / _first_mode(models, stem, "V_tip/F"))
        shown += [f"{stem}: together {_up_to(found)}, {shares[-1]:.2g} times its first mode", "\n"]
    return judged(shares[0] > max(shares[1:]), *shown[:-1])


def _loop(models: Models, stem: str) -> LoopFacts:
    for found in models[stem].loops:
        return found
    message = f"stable gains of {stem}"
    raise KeyError(message)


def _colocation(models: Models, stem: str, tf: str) -> ColocationFact:
    for found in models[stem].colocations:
        if found.tf == tf:
            return found
    raise KeyError(tf)


def _first_mode(models: Models, stem: str, tf: str) -> float:
    return min(p.frequency_hz for p in models[stem].of(tf).poles if p.is_oscillatory)


def _up_to(found: ColocationFact) -> str:
    within = f"within {found.phase_degrees:g} degrees and {found.magnitude_db:g} dB"
    if found.bandwidth_hz is None:
        return f"{within} up to {found.examined_hz:.4g} Hz, the end of the band"
    return f"{within} up to {found.bandwidth_hz:.4g} Hz"


def _counts(function: TransferFacts) -> str:
    zeros, poles = function.counts or (0, 0)
    return f"{counted(zeros, 'zero')} and {counted(poles, 'pole')}"


def _bracket(function: TransferFacts) -> Sequence[Run]:
    if function.bracket_mathematics is None:
        return (function.reason,)
    return ("Nonminimum phase exactly when ", function.bracket_mathematics, " < 0, as for these values.")


EPPINGER_1988: Final = Publication(
    "Eppinger & Seering 1988",
    "Modeling Robot Flexibility for Endpoint Force Control",
    (
        "rigid_body",
        "polynomial_resonance",
        "two_mass",
        "six_mass",
        "base_flexure",
        "sliding_free_beam",
        "lumped_bending_beam",
        "robot_axis",
    ),
    (
        Claim(
            "modes",
            EXPERIMENT,
            "The dominant structural modes appear to be roughly at 11, 38, 44, 67, and 77 Hz.",
            ("polynomial_resonance", "six_mass", "sliding_free_beam"),
            _modes,
        ),
        _printed("printed-rigid-body", "rigid_body", "V_tip/V_cmd"),
        Claim(
            "second-order",
            RIGID,
            "We have a second-order transfer function which becomes third order when endpoint position "
            "is made "
            "the output by adding a free integrator.",
            ("rigid_body",),
            _second_order,
        ),
        Claim(
            "fitted-array",
            POLYNOMIAL,
            "its pole-zero array includes the two poles of the rigid-body model, the zero at the origin "
            "[...], and "
            "the five pairs of poles and five pairs of zeros of the fitted-polynomial resonance model.",
            ("polynomial_resonance",),
            _polynomial_counts,
        ),
        Claim(
            "one-zero-per-mode",
            LUMPED,
            "for each mode of vibration modeled between the actuator and endpoint, two poles are added "
            "while only "
            "one zero is added in the actuator-to-endpoint transfer function.",
            ("two_mass", "six_mass"),
            _one_zero,
        ),
        Claim(
            "too-few-zeros",
            LUMPED,
            "The frequency response of this lumped-mass model cannot possibly match the data, since the "
            "transfer "
            "function has too few zeros!",
            ("six_mass", "polynomial_resonance"),
            _too_few_zeros,
        ),
        Claim(
            "two-zeros-three-poles",
            LUMPED,
            "The transfer function from force input to motor (or tip) output velocity now has two zeros "
            "and three "
            "poles. So two poles and two zeros have now been added to the original rigid-body "
            "lumped-mass model by "
            "the base dynamics.",
            ("base_flexure",),
            _base,
        ),
        Claim(
            "base-only-colocated",
            LUMPED,
            "it results in only colocated transfer functions.",
            ("base_flexure",),
            _base_only_colocated,
        ),
        _printed("printed-colocated", "sliding_free_beam", "V_act/F"),
        _printed(
            "printed-noncolocated",
            "sliding_free_beam",
            "V_tip/F",
            ", times the scale 1/(ρAa) that the print leaves out",
        ),
        Claim(
            "infinity",
            BENDING,
            "These transfer functions are non-polynomial, and have an infinity of poles and zeros.",
            ("sliding_free_beam",),
            _infinity,
        ),
        Claim(
            "fifth-mode",
            BENDING,
            "These polynomial transfer functions match the response of the real beam transfer functions "
            "perfectly "
            "through the 5th modes.",
            ("sliding_free_beam",),
            _through_fifth_mode,
        ),
        Claim(
            "alternating",
            BENDING,
            "The collocated beam transfer function has poles and zeros in alternating pairs along the "
            "jω axis.",
            ("sliding_free_beam",),
            _alternating,
        ),
        Claim(
            "same-poles",
            BENDING,
            "The noncollocated beam transfer function has pairs of poles along the jω axis (in the same "
            "locations, "
            "since the two transfer functions have the same characteristic equation),",
            ("sliding_free_beam",),
            _same_poles,
        ),
        Claim(
            "real-zeros",
            BENDING,
            "but the zeros are spread out symmetrically along the positive and negative real axes.",
            ("sliding_free_beam",),
            _real_zeros,
        ),
        Claim(
            "no-phase",
            BENDING,
            "The real zeros appear in these “pairs” so as to contribute no net phase shift.",
            ("sliding_free_beam",),
            _no_phase,
        ),
        Claim(
            "not-in-lumped",
            BENDING,
            "They are curious because they do not appear in any of the lumped-mass models derived above.",
            ("two_mass", "six_mass", "base_flexure"),
            _not_in_lumped,
        ),
        Claim(
            "bending",
            BENDING,
            "We hypothesize that the right-half plane zeros come from the bending effects and not the "
            "distributed "
            "nature of the model.",
            ("six_mass", "lumped_bending_beam"),
            _bending_not_distribution,
        ),
        Claim(
            "lumped-colocated",
            BENDING,
            "The colocated transfer function, from the force input to the position output, x_act, is "
            "minimum phase.",
            ("lumped_bending_beam",),
            _lumped_colocated,
        ),
        Claim(
            "lumped-noncolocated",
            BENDING,
            "The noncolocated transfer function, from the force input to the position output, x_tip, is "
            "nonminimum "
            "phase.",
            ("lumped_bending_beam",),
            _lumped_noncolocated,
        ),
        Claim(
            "lumped-pair",
            BENDING,
            "this noncolocated transfer function also has a “pair” of real zeros at equal frequencies on the "
            "positive and negative real axes.",
            ("lumped_bending_beam",),
            _lumped_pair,
        ),
        Claim(
            "right-numbers",
            BENDING,
            "The distributed-parameter beam model’s colocated transfer function has the right numbers "
            "of poles and "
            "zeros for each mode and the correct arrangement thereof in the s-plane.",
            ("sliding_free_beam",),
            _right_numbers,
        ),
        Claim(
            "rigid-matches",
            DISCUSSION,
            "The rigid-body robot model is capable of matching the overall frequency response, with the "
            "exception "
            "of the resonances.",
            ("polynomial_resonance", "rigid_body"),
            _rigid_matches,
        ),
        Claim(
            "two-and-two",
            DISCUSSION,
            "This model consists of the rigid-body model, cascaded with two poles and two zeros for "
            "each flexible "
            "mode.",
            ("polynomial_resonance",),
            _rigid_counts,
        ),
        Claim(
            "pair-and-one-zero",
            DISCUSSION,
            "When used to depict flexibility between the actuator and tip, these models add for each "
            "resonance a "
            "pair of poles, and only one zero",
            ("two_mass", "six_mass"),
            _one_zero,
        ),
        Claim(
            "base-two-zeros",
            DISCUSSION,
            "When used to describe flexure of the robot base or frame, these models add two zeros with "
            "each pair "
            "of poles.",
            ("base_flexure",),
            _base_adds_two,
        ),
        Claim(
            "high-gain",
            DISCUSSION,
            "The presence of these nonminimum phase zeros explains why at high gain the noncolocated control "
            "becomes unstable.",
            (*BENDING_BEAMS, *(f"{stem}_{loop}" for stem in BENDING_BEAMS for loop in ("force", "position"))),
            _high_gain,
        ),
        Claim(
            "same-character",
            DISCUSSION,
            "The lumped-parameter beam model showed the same nonminimum phase characteristics as its "
            "distributed-parameter counterpart.",
            ("lumped_bending_beam", "sliding_free_beam"),
            _same_character,
        ),
        Claim(
            "only-fit",
            DISCUSSION,
            "Only the polynomial resonance model matched the experimental data well.",
            ("polynomial_resonance",),
            _only_fit,
        ),
        Claim(
            "dynamically-colocated",
            DISCUSSION,
            "It is possible for a tip sensor and joint actuator to be physically noncolocated, but "
            "dynamically "
            "colocated.",
            ("base_flexure",),
            _dynamically_colocated,
        ),
        Claim(
            "equal-frequencies",
            DISCUSSION,
            "Even a lumped-mass model of a beam in bending displays nonminimum phase zeros at "
            "frequencies equal to "
            "the minimum phase zeros that appear.",
            ("lumped_bending_beam",),
            _equal_frequencies,
        ),
        Claim(
            "base-against-link",
            DISCUSSION,
            "base flexure allows the joint actuators and tip sensors to remain dynamically colocated, "
            "while link "
            "flexure may not.",
            ("base_flexure", "sliding_free_beam", "two_mass"),
            _base_against_link,
        ),
    ),
)
