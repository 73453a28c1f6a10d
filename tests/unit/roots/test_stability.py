"""Verdicts on models whose poles in the right half-plane are known, wherever the requested region lies."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import mpmath
import pytest

from symflex.print.roots import roots_text
from symflex.roots import Band, Mode, Modes, Rectangle
from symflex.roots.locate import locate
from symflex.roots.pole_zero_map import ON_AXIS
from tests.unit.roots.distributed_models import bound
from tests.unit.roots.known_roots import UNIT, along, elements, late, member


@dataclass(frozen=True)
class Said:
    """What is said of a model's stability.

    ``word`` and ``right``, the number of poles in the right half-plane, ``None`` where it is not known; some
    of these poles; a part of the sentence that gives the reason.
    """

    text: str
    word: str
    right: int | None = 0
    growing: tuple = ()
    because: str = ""
    region: object = None


def lumped(den):
    return f'symflex = 1\ninputs.u = {{}}\noutputs.y = "u/({den})"'


def hayes(gain):
    """Return a loop around an integrator and a delay of 1 s: s + K exp(-s) = 0."""
    return late("y", more=f'signals.y = "{gain}*D/s*(u - y)"')


ROD = 'rod = { type = "rod", between = ["ground", "x"], E = 1, A = 1, rho = 1, l = 1 }\n'
ARM = 'arm = { type = "beam", between = ["ground", "x"], EI = 1, rhoA = 1, l = 1, eta = 0.01 }\n'


def ended(b):
    return elements(f'{ROD}b = {{ type = "damper", between = ["x", "ground"], b = "{b} N*s/m" }}')


def lossy(line, output):
    return elements(ARM, output=output, more=line)


def driven(force):
    push = f'push = {{ type = "force_source", at = "x", f = "{force}" }}'
    return elements(ARM + push, "u = {}", more='definitions.C = "1/(s - 100)"')


def followed(sign):
    more = 'parameters = { K = "3 N/m", x_s = "0.5 m" }'
    loop = f'loop = {{ type = "force_source", at = "x", f = "{sign}K*rod.u(x_s)" }}'
    return elements(ROD + loop, more=more)


NEGATIVE_MASS = elements(
    f'{ROD}m = {{ type = "mass", at = "x", m = "m" }}',
    more='parameters.m = { value = "-0.2 kg", assume = "real" }',
)
STRINGS = """one = { type = "string", between = ["ground", "a"], N = 1, rhoA = 1, l = 0.3 }
two = { type = "string", between = ["a", "x"], N = 1, rhoA = 1, l = 0.15 }
three = { type = "string", between = ["x", "ground"], N = 1, rhoA = 1, l = 0.55 }
loss = { type = "damper", between = ["a", "ground"], b = 0.5 }"""
PICKUP = f"""{ROD}body = {{ type = "mass", at = "x", m = 1 }}
pickup = {{ type = "transformer", from = "x", to = "v", ratio = 1 }}
coil = {{ type = "inductor", between = ["v", "ground"], L = 1 }}"""
UNSEEN = """arm = { type = "beam", between = ["ground", "tip"], EI = 6, rhoA = 35, l = 1 }
m = { type = "mass", at = "x", m = 1 }
k = { type = "spring", between = ["x", "ground"], k = "STIFF N/m" }"""
EXCHANGER = """symflex = 1
inputs.T_0 = {}
outputs.Y = "T(2)"
[fields.pipe]
unknowns = ["T", "W"]
domain = [0, 2]
equations = ["T' + s*T + RATE*(T - W) = 0", "-W' + s*W + RATE*(W - T) = 0"]
conditions = ["T(0) = T_0", "W(2) = 0"]
"""


def moving(damping):
    return along(
        "s^2*w + 4*s*w' + 4*w'' = 25*w''", "w(0) = 0", f"25*w'(1) + {damping}*s*w(1) = F", output="w(1/3)"
    )


def root_near(equation, guess):
    return lambda: complex(mpmath.findroot(equation, guess))


def pushing(s):
    return s * mpmath.cosh(s) - 3 * mpmath.sinh(s / 2)


def warmed(s):
    k = mpmath.sqrt((s - 2) ** 2 - 4)
    return mpmath.cosh(2 * k) + (s - 2) * mpmath.sinh(2 * k) / k


LN_2 = 0.34657359027997264
OWN = {  # {} stands for s - 100 or s + 100
    "a quotient": ("", "x/({})"),
    "a definition": ('definitions.C = "1/({})"', "x*(1 + C)"),
    "a block": ('blocks.P = {{ type = "tf", num = [1], den = "{}" }}', "P*x"),
    "a signal": ('signals.u = "x/({})"', "u"),
}
CASES = {
    "a pole on the left": Said(lumped("s + 1"), "stable"),
    "a pole at 0": Said(lumped("s"), "marginal", because="a pole at 0"),
    "a pair on the axis": Said(lumped("s^2 + 4"), "marginal", because="poles on the imaginary axis"),
    "a pole on the right": Said(lumped("s - 1"), "unstable", 1, (1,)),
    # Hayes 1950: a pair enters as K T passes (2 n + 1/2) pi; s = W_k(-K).
    "a delay and a gain of 1": Said(hayes(1), "stable"),
    "a delay and a gain of 2": Said(hayes(2), "unstable", 2, (lambda: complex(mpmath.lambertw(-2)),)),
    "a delay and a gain of 10": Said(
        hayes(10), "unstable", 4, tuple(lambda k=k: complex(mpmath.lambertw(-10, k)) for k in (0, 1))
    ),
    # Roots of s = -exp(s), without end to the right (Bellman & Cooke 1963, section 12.12).
    "a delay with the highest power": Said(late("u/(1 + s*D)"), "unstable", None, because="infinitely many"),
    # Stable, as 1/2 < 1 and Re s >= 0 leaves abs(s) <= 2, where no root is.
    "a delay with half the highest power": Said(late("u/(s + s*D/2 + 1)"), "stable"),
    # Its roots come closer to the axis without end.
    "a delay with as much": Said(late("u/(s + s*D + 1)"), "unknown", None, because="have no bound"),
    # At ln 2 + j pi (2 n + 1), all along a line.
    "delays without a power": Said(late("u/(1 + 2*D)"), "unstable", None, (complex(2 * LN_2, mpmath.pi),)),
    "a rod": Said(member("rod", UNIT), "marginal", because="passive"),
    "a rod with a damper": Said(ended(3), "stable", because="passive"),
    "a rod with a damper of no loss": Said(ended(0), "marginal", because="passive"),
    # cosh s - 3 sinh s = 0, so exp(2 s) = 2.
    "a rod with a negative damper": Said(ended(-3), "unstable", None, (LN_2,)),
    # Ended by -m s^2: coth(s) = s/5, above what was asked for.
    **{
        f"a rod with a negative mass, {region}": Said(
            NEGATIVE_MASS, "unstable", None, (root_near(lambda s: mpmath.coth(s) - s / 5, 5),), region=region
        )
        for region in (None, Band(0, Fraction(1, 100)), Mode(1))
    },
    # What acts at the end is told by the middle: no energy is conserved.
    "a field told by its middle": Said(
        along("w'' = s^2*w", "w(0) = 0", "w'(1) = F - w(1/2)/10"), "unknown", None,
        because="poles on the imaginary axis; known up to",
    ),
    # A passive structure says nothing of what its output or its drive adds.
    **{
        f"{kind} with s {sign} 100 beside a damped arm": Said(
            lossy(*(part.format(f"s {sign} 100") for part in OWN[kind])),
            "unstable" if sign == "-" else "stable", sign == "-", (100,) * (sign == "-"),
            region=Modes(1),
        )
        for kind in OWN for sign in "-+"
    },
    "a quotient driving a damped arm": Said(driven("u/(s - 100)"), "unstable", 1, (100,), region=Modes(1)),
    "a definition driving a damped arm": Said(driven("C*u"), "unstable", 1, (100,), region=Modes(1)),
    # The modes are sin(n pi x): the tenth rests at x = 0.3, and moves at x = 0.45.
    "a mode that no damper feels": Said(elements(STRINGS), "unknown", 0, because="passive", region=Modes(2)),
    "a damper that every mode feels": Said(
        ended("0.5"), "stable", because="stable: passive, nothing supplies energy", region=Modes(1)
    ),
    # A voltage that follows a motion: an inductor is an integral of it then, m s^2 + s coth(s) + 1/s.
    "a coil behind a pickup": Said(
        elements(PICKUP), "unstable", None,
        (root_near(lambda s: s**2 + s * mpmath.coth(s) + 1 / s, 0.3 + 0.9j),), region=Modes(1),
    ),
    # A force that follows a point of a member: cosh(s) + K sinh(s/2)/s, of either sign no spring.
    "a force that pushes on": Said(
        followed(""), "unstable", None, (root_near(pushing, 1),), region=Modes(1),
    ),
    "a force that pulls back": Said(followed("-"), "unknown", None, region=Modes(1)),
    # Waves at speeds 5 + 2 and 5 - 2: their quotient, abs((d - 25/7)/(d + 25/3)), is 1 for d = -50/21.
    **{
        f"a string that moves along, with {d} at its end": Said(
            moving(d), "stable" if d > -50 / 21 else "unstable", 0 if d > -50 / 21 else None, region=Modes(1)
        )
        for d in (3, 0, -2.3, -2.5)
    },
    # Counterflow: k^2 = (s + h)^2 - h^2, cosh(2 k) + (s + h) sinh(2 k)/k = 0.
    "counterflow": Said(EXCHANGER.replace("RATE", "0.3"), "stable", region=Modes(1)),
    "counterflow that warms what is warmer": Said(
        EXCHANGER.replace("RATE", "(-2)"), "unstable", None,
        (root_near(warmed, 3.7),),
        region=Modes(1),
    ),
    # The mass on the negative spring falls away, as a hidden pole of the function, which is 0.
    "a mass that nothing sees": Said(elements(UNSEEN.replace("STIFF", "1"), output="tip"), "stable"),
    "a mass that falls and nothing sees": Said(
        elements(UNSEEN.replace("STIFF", "-1"), output="tip"), "unstable", None
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_verdict_is_that_of_the_poles(case):
    shown = locate(bound(case.text), case.region, 15)
    verdict = shown.verdict
    assert verdict.word == case.word, verdict
    if case.right is not None or case.word == "unknown":
        assert verdict.right == case.right, verdict
    assert verdict.certified is (case.word != "unknown")
    assert case.because in verdict.sentence
    found = [complex(p) for p in shown.all_poles]
    for each in case.growing:
        s = each() if callable(each) else complex(each)
        assert s.real > 0
        assert min(abs(p - s) for p in found) < 1e-9 * abs(s), (s, found)
    if case.word != "unstable":
        assert not any(p.re > 0 for p in shown.all_poles)
    elif case.growing:
        assert "passive" not in verdict.reason


LUMPED = lumped("(s + 1)*(s + 2)*((s - 1/2)^2 + 10000)")


def test_poles_right_of_the_axis_outside_of_what_is_asked_for_are_a_part_of_their_own():
    for region in [Modes(2), Mode(1), Band(0, 1), Rectangle(-9, -1, 0, 1)]:
        shown = locate(bound(LUMPED), region)
        assert not any(p.re > 0 for p in shown.poles), region
        assert [complex(p) for p in shown.unstable] == [0.5 + 100j, 0.5 - 100j], region
        assert "in the right half-plane, outside the requested region" in roots_text(shown, 15), region


def test_whatever_is_asked_for_the_unstable_poles_of_a_delay_are_those_of_lambert():
    every = [complex(mpmath.lambertw(-10, k)) for k in range(-5, 6)]
    wanted = sorted((s for s in every if s.real > 0), key=lambda s: (round(abs(s), 6), s.imag))
    for region in (Modes(1), Mode(3), Band(0, 1), Rectangle(-9, -1, 0, 1)):
        right = [complex(p) for p in locate(bound(hayes(10)), region).all_poles if p.re > 0]
        right.sort(key=lambda s: (round(abs(s), 6), s.imag))
        assert right == pytest.approx(wanted, rel=1e-12), region


def test_an_unstable_mode_that_cancels_is_listed_and_counted():
    text = 'symflex = 1\ninputs.u = {}\nsignals.x = "u/(s - 3)^3"\noutputs.y = "(s - 3)^2*x/(s + 1)"'
    shown = locate(bound(text), Band(0, Fraction(1, 5)))
    assert shown.verdict.right == 3
    assert [(float(h.root.re), h.root.multiplicity, h.cause) for h in shown.hidden] == [(3, 2, "cancelled")]


def test_a_part_not_told_from_zero_is_not_printed_as_zero():
    # s + pi/2 exp(-s) has the roots +-j pi/2, exactly (Hayes 1950), which no enclosure can tell.
    shown = locate(bound(hayes("pi/2")), Modes(1))
    assert shown.poles[0].decimal(15).re.startswith("0e-")
    assert "  ~0" in roots_text(shown, 15)
    # All others are proved to lie in the left half-plane, though the count along it meets these two.
    assert (shown.verdict.word, shown.verdict.reason) == ("unknown", ON_AXIS)


def test_poles_right_of_the_axis_are_not_counted_again(monkeypatch):
    # exp(-s)/(s + 1) with gain 5: one pair in the right half-plane, at 2.03 to 2.5 rad/s.
    loop = bound(late("y", more='signals.y = "5*D*(u - y)/(s + 1)"'))
    fresh, lowest = locate(loop, Band(1, 2)), locate(loop, Modes(2))
    monkeypatch.setattr("symflex.roots.locate.search_right", None)
    found = locate(loop, Band(1, 2), judged=lowest)
    assert (found.verdict, found.verdict.found) == (fresh.verdict, 2)
    assert [complex(p) for p in found.unstable] == [complex(p) for p in fresh.unstable] != []
