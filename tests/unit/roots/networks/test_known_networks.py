"""Networks of members whose roots are known, asked without a formula of the whole."""

from __future__ import annotations

from fractions import Fraction
from itertools import chain, pairwise
from math import sqrt

import pytest
from mpmath import cos, cosh, exp, log, mpc, mpf, pi, tan, tanh

from symflex import pipeline
from symflex.balls import UndecidedError
from symflex.roots.locate import locate
from symflex.roots.networks import poles_zeros
from symflex.roots.region import Band, Mode, Modes, Rectangle
from symflex.transfer.nested_form import bind_nested
from tests.unit.roots.known_roots import Case, cases, check, elements, on_axis, solved
from tests.unit.roots.networks.network_models import located, omegas, specification

BEAM = 'type = "beam", EI = 700, rhoA = 0.27'
UNIT = sqrt(700 / 0.27)
"""sqrt(E I/(rho A)) [m^2/s]."""
ROD = 'type = "rod", E = 1, A = 1, rho = 1'
"""Waves travel a metre in a second."""
CANTILEVER = (1.8751040687119611, 4.694091132974175)


class Network(Case):
    """A case that is searched without its formula."""

    def located(self):
        return located(self.text, self.region, self.digits, "Y")


def spans(count, supports, length="0.5"):
    """Return equal beams in a row from x_0 to x, with supports at nodes."""
    names = [*(f"x_{i}" for i in range(count)), "x"]
    rows = [
        f'b_{i} = {{ {BEAM}, between = ["{a}", "{b}"], l = {length} }}'
        for i, (a, b) in enumerate(pairwise(names))
    ]
    return "\n".join(
        [*rows, *(f's_{i} = {{ type = "{kind}", at = "{names[i]}" }}' for i, kind in supports.items())]
    )


def bending(length, equation, guess):
    """Return frequencies of a beam from the roots x of an equation."""
    scale = lambda x: (x / length) ** 2 * (mpf(700) / mpf("0.27")) ** mpf("0.5")  # noqa: E731
    return lambda: ((mpc(0, scale(x.imag)), 1) for x, _ in solved(equation, guess)())


def clamped_free(length):
    return bending(length, lambda x: cos(x) + 1 / cosh(x), lambda n: (n - mpf(1) / 2) * pi)


def clamped_pinned(length):
    return bending(length, lambda x: tan(x) - tanh(x), lambda n: (n + mpf(1) / 4) * pi)


def rods(*ends, more=""):
    """Return rods of half a metre from node to node, and what is attached to them."""
    rows = [
        f'r_{i} = {{ {ROD}, l = 0.5, between = ["{a}", "{b}"] }}' for i, (a, b) in enumerate(pairwise(ends))
    ]
    return elements("\n".join([*rows, more]))


def dashpot(b):
    return f'd = {{ type = "damper", between = ["x", "ground"], b = "{b} N*s/m" }}'


def in_line(b, first):
    """Return ln(abs((1 - b)/(1 + b)))/2 + j pi n."""
    return lambda: (mpc(log(abs((1 - mpf(b)) / (1 + mpf(b)))) / 2, pi * (n + mpf(first))) for n in range(60))


DAMPED = rods("ground", "m", "x", more=dashpot("0.3"))
STRINGS = """p = { between = ["ground", "x"], LIKE }
q = { between = ["x", "ground"], LIKE }"""
STRINGS = STRINGS.replace("LIKE", 'type = "string", N = 100, A = 1e-4, rho = 2500, l = 0.5')
FAST = 'type = "rod", E = "200 GPa", rho = 8000, A = 1e-4'


def fast(name, start, end, length):
    return f'{name} = {{ {FAST}, between = ["{start}", "{end}"], l = {length} }}'


def mass(node, value):
    return f'm_{node} = {{ type = "mass", at = "{node}", m = {value} }}'


TRAIN = "\n".join(
    [
        fast("r1", "x", "b", 1),
        mass("b", 1),
        fast("r2", "b", "c", 0.7),
        mass("c", 2),
        fast("r3", "c", "d", 1.3),
    ]
)
SHAFT = 'type = "shaft", G = "80 GPa", J = 1e-8, rho = 7800, eta = 1e-7'
ABSORBED = f"""s1 = {{ {SHAFT}, between = ["x", "b"], l = 0.3 }}
s2 = {{ {SHAFT}, between = ["b", "c"], l = 0.4 }}
J_a = {{ type = "inertia", at = "x", J = 1e-3 }}
J_b = {{ type = "inertia", at = "b", J = 1e-3 }}
J_c = {{ type = "inertia", at = "c", J = 1e-3 }}
bearing = {{ type = "rotary_damper", between = ["b", "ground"], b = 0.1 }}
soft = {{ type = "torsion_spring", between = ["b", "d"], k = 100 }}
loss = {{ type = "rotary_damper", between = ["b", "d"], b = 0.2 }}
load = {{ type = "inertia", at = "d", J = 1e-2 }}"""
DELAYED = """m = { type = "mass", at = "x", m = 1 }
d = { type = "damper", between = ["x", "ground"], b = 2 }
f = { type = "force_source", at = "x", f = "K*D*(F - x)" }"""
SPEED = 5000
CASES = {
    **{
        f"a cantilever in {n} pieces": Network(
            elements(spans(n, {0: "fixed"})), clamped_free(mpf(n) / 2), clamped_pinned(mpf(n) / 2),
            region=Modes(4), digits=12, word="marginal",
        )
        for n in (1, 2, 4)
    },
    "forty digits of one": Network(
        elements(spans(2, {0: "fixed"})), clamped_free(1), region=Modes(1), digits=40
    ),
    "its seventh mode": Network(
        elements(spans(3, {0: "fixed"})), clamped_free(1.5), region=Mode(7), digits=12, slow=True
    ),
    "a band of it": Network(
        elements(spans(3, {0: "fixed"})), clamped_free(1.5), region=Band(10, 400), digits=12, slow=True
    ),
    "nothing beside the axis": Network(
        elements(spans(3, {0: "fixed"})), clamped_free(1.5), region=Rectangle(1, 5, 0, 5000), digits=12
    ),
    "a free beam in three pieces, with two motions at rest of which a force sees one": Network(
        elements(spans(3, {})),
        bending(1.5, lambda x: cos(x) - 1 / cosh(x), lambda n: (n + mpf(1) / 2) * pi), at_zero=2,
        hidden=lambda: [(0, 2)], region=Modes(5), digits=12,
    ),
    "a string driven in its middle": Network(
        elements(STRINGS),
        on_axis(lambda n: (2 * n - 1) * 20 * pi), on_axis(lambda n: 2 * n * 20 * pi), digits=12,
        hidden=lambda: [mpc(0, 2 * n * 20 * pi) for n in (1, 2)],
    ),
    # Losses, loops and delays.
    **{
        f"a rod with a dashpot of {b}": Network(
            rods("ground", "m", "x", more=dashpot(b)), in_line(b, 0.5), on_axis(lambda n: n * pi), digits=12,
            word="stable" if float(b) > 0 else "unstable",
        )
        for b in ("0.3", "-0.3")
    },
    "forty digits of a rod with a strong dashpot": Network(
        rods("ground", "m", "x", more=dashpot(3)), in_line(3, 0), region=Modes(2), digits=40
    ),
    "a band of a damped rod": Network(DAMPED, in_line("0.3", 0.5), region=Band(Fraction(1, 5), 1), digits=12),
    "a rectangle of it": Network(
        DAMPED, in_line("0.3", 0.5), region=Rectangle(-1, 0, 0, 8), digits=12
    ),
    "its third mode": Network(DAMPED, in_line("0.3", 0.5), region=Mode(3), digits=12),
    "a free rod with a dashpot, which comes to rest anywhere": Network(
        rods("y", "x", more=dashpot("0.3")),
        lambda: (mpc(log(mpf("0.7") / mpf("1.3")), 2 * pi * n) for n in range(9)), at_zero=1,
        region=Modes(2), digits=12,
    ),
    "the force in a rod at its end, without zeros": Network(
        elements(f'r = {{ {ROD}, l = 1, between = ["x", "ground"] }}', output="r.f"),
        on_axis(lambda n: (n - mpf(1) / 2) * pi), lambda: [], region=Band(0, 1), digits=12,
    ),
    "a delayed loop on a mass": Network(
        elements(DELAYED, "F = {}", more='parameters.K = 3\nblocks.D = { type = "delay", T = 0.5 }'),
        equation=lambda z: z * z + 2 * z + 3 * exp(-z / 2), region=Band(0, 3), digits=12,
    ),
    # Zeros between places that one path joins: what stands beside it, and behind its ends.
    "a train read at its other end": Network(
        elements(TRAIN, output="d"), zeros=lambda: [], region=Modes(5), digits=12, at_zero=2
    ),
    "a train with a branch": Network(
        elements("\n".join([TRAIN, fast("branch", "c", "e", 0.9)]), output="d"),
        zeros=on_axis(lambda k: (k - mpf(1) / 2) * pi * SPEED / mpf("0.9")), region=Modes(4), digits=12,
        at_zero=2, slow=True,
    ),
    "a train between two walls": Network(
        elements(f"{fast('r0', 'ground', 'x', 0.5)}\n{TRAIN}\n{fast('r4', 'd', 'ground', 0.6)}", output="d"),
        zeros=lambda: (mpc(0, k * pi * SPEED / mpf(x)) for x in ("0.5", "0.6") for k in range(1, 9)),
        region=Band(0, Fraction(95493, 10)), digits=12,
    ),
    "a spring between a beam and what is read": Network(
        elements(
            f'beam = {{ {BEAM}, between = ["ground", "x"], l = 1 }}\n{mass("d", 1)}\n'
            's = { type = "spring", between = ["x", "d"], k = 100 }', output="d",
        ),
        zeros=clamped_pinned(1), region=Modes(2), digits=12,
    ),
    "an absorber on a train with damping": Network(  # J s^2 + b s + k = 0: -10 +- j sqrt(9900)
        elements(ABSORBED, 'F = { torque = "x" }', "c"), zeros=lambda: [mpc(-10, mpf(9900) ** mpf("0.5"))],
        region=Modes(4), digits=12, at_zero=1, slow=True,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", cases(CASES))
def test_poles_zeros_and_hidden_modes_are_those_of_the_formula(case):
    check(case)


def test_equal_spans_on_pins_have_pass_bands_between_those_of_one_span():
    # The lowest band of a beam on many pins begins with the pinned span, beta l = pi, and ends below the
    # clamped one, 4.730; each holds as many frequencies as there are spans (Miles 1956, Proc. ASCE 82 EM1).
    text = elements(spans(5, dict.fromkeys(range(6), "pin")), 'F = { torque = "x_0" }', "x_0.theta")
    found = located(text, Modes(10), output="Y")
    betas = [sqrt(w / UNIT) * 0.5 for w in omegas(found.poles)]
    assert found.certificate.certified
    assert (betas[0], betas[5]) == (pytest.approx(float(pi)), pytest.approx(float(2 * pi)))
    assert max(betas[:5]) < 4.730040744862704 < min(betas[5:]) < max(betas) < 7.853204624095838


def test_zeros_of_a_sensor_elsewhere_may_be_real():
    # Force at a cantilever's tip, deflection in its middle: zeros +-sigma (Spector & Flashner 1990).
    found = located(elements(spans(2, {0: "fixed"}), output="x_1.y"), Modes(3), output="Y")
    assert found.certificate.certified
    assert any(zero.is_real for zero in found.zeros)
    assert all(zero.is_real or zero.on_imaginary_axis for zero in found.zeros)
    assert all(pole.on_imaginary_axis for pole in found.poles)


@pytest.mark.slow
def test_poles_and_zeros_alternate_where_a_force_acts():
    rows = [
        f'b_{i} = {{ {BEAM}, between = ["n_{i}", "n_{i + 1}"], l = {0.3 + 0.05 * i:.2f} }}\n'
        f'k_{i} = {{ type = "spring", between = ["n_{i + 1}.y", "ground"], k = {100 * (i + 1)} }}'
        for i in range(6)
    ]
    found = located(specification("\n".join(rows), 'F = { force = "n_3" }', 'X = "n_3"'), Modes(8))
    merged = sorted(chain(((w, 0) for w in omegas(found.poles)), ((w, 1) for w in omegas(found.zeros))))
    assert all(a != b for (_, a), (_, b) in pairwise(merged))


@pytest.mark.slow
def test_a_rate_has_one_pole_at_rest_less_and_one_zero_more():
    beams = elements(spans(2, {0: "fixed"}), output="s*x")
    free, held = (
        elements(each, output="s*d") for each in (TRAIN, f"{fast('r0', 'ground', 'x', 1)}\n{TRAIN}")
    )
    slides = elements(spans(2, {0: "slider"}), 'F = { force = "x_0" }', "s*x_0.y")
    for text, poles, zeros in ((beams, [], [1]), (free, [1], []), (held, [], [1]), (slides, [1], [])):
        found = located(text, Modes(2), output="Y")
        at_rest = [[r.multiplicity for r in roots if r.is_zero] for roots in (found.poles, found.zeros)]
        assert at_rest == [poles, zeros], text


@pytest.mark.slow
def test_what_the_counts_of_a_network_do_not_settle_is_searched_in_its_formula(monkeypatch):
    def undecided(*_, **__):
        raise UndecidedError

    monkeypatch.setattr(poles_zeros, "roots_in_disc", undecided)
    loss = 'd = { type = "damper", between = ["x_1", "ground"], b = "1e-9 N*s/m" }'
    lines = spans(2, {0: "fixed"}, '"L"') + f"\n{loss}"
    (tf,) = pipeline.derive_nested(pipeline.loads(elements(lines, more='parameters.L = "0.5 m"')))
    # The formula has the values the network had: a beam of half the length is four times as fast.
    for given, scale in (({}, 1), ({"L": "0.25"}, 4)):
        found = locate(bind_nested(tf, given), Modes(2), 12)
        assert found.certificate.certified, given
        expected = [scale * b**2 * UNIT for b in CANTILEVER]
        assert [float(p.im) for p in found.poles if p.im > 0] == pytest.approx(expected, rel=1e-9), given
