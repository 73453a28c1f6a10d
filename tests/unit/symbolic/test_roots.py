"""Symbolic roots: formulas as books print them, kinds of roots against numpy, refusals."""

import re
from collections import Counter
from collections.abc import Sequence
from math import prod
from pathlib import Path
from random import Random

import numpy as np
import pytest
import sympy
from flint import fmpz_mpoly

from symflex import pipeline
from symflex.algebra import Ring
from symflex.expressions import format_expression
from symflex.symbolic.frequency_equation import symbolic_roots
from symflex.symbolic.roots import SymbolicFactor, _even_kinds, symbolic_text

CLASSICS = Path(__file__).parents[3] / "derivations" / "classics"


def part(name: str, kind: str, ends: str, **values: str) -> str:
    """Return a line for an element: a node, or two of them."""
    nodes = ends.split()
    where = f'at = "{ends}"' if len(nodes) == 1 else f"between = {nodes}".replace("'", '"')
    given = "".join(f', {key} = "{value}"' for key, value in values.items())
    return f'elements.{name} = {{ type = "{kind}", {where}{given} }}\n'


PUSH = 'inputs.F = { force = "x" }\noutputs.X = "x"\n'
TURN = 'inputs.T = { torque = "p" }\noutputs.P = "p"\n'
HELD = part("a", "mass", "x", m="m") + part("c", "spring", "x ground", k="k") + PUSH
CHAIN = part("a", "mass", "x", m="m_1") + part("b", "mass", "y", m="m_2") + part("c", "spring", "x y", k="k")
SHAFT = part("a", "inertia", "p", J="J_1") + part("b", "inertia", "q", J="J_2") + TURN
SHAFT += part("c", "torsion_spring", "p q", k="k")
SERIES = part("r", "resistor", "a b", R="R") + part("l", "inductor", "b c", L="L")
SERIES += part("k", "capacitor", "c ground", C="C") + 'inputs.v = { voltage = "a" }\noutputs.Y = "c"\n'
PARALLEL = part("r", "resistor", "a ground", R="R") + part("l", "inductor", "a ground", L="L")
PARALLEL += part("k", "capacitor", "a ground", C="C") + 'inputs.i = { current = "a" }\noutputs.Y = "a"\n'
CAR = part("a", "mass", "x", m="m_s") + part("b", "mass", "u", m="m_u") + part("c", "spring", "x u", k="k_s")
CAR += part("d", "spring", "u ground", k="k_t")
SCREW = part("a", "inertia", "p", J="J") + part("c", "torsion_spring", "p q", k="k_t") + TURN
SCREW += part("b", "mass", "x", m="m")
SCREW += 'elements.d = { type = "transformer", from = "q", to = "x", ratio = "r" }\n'
SPEAKER = part("a", "mass", "x", m="M") + part("c", "spring", "x ground", k="1/C")
SPEAKER += part("d", "damper", "x ground", b="R_m") + 'inputs.u = { voltage = "v" }\noutputs.X = "x"\n'
SPEAKER += 'elements.e = { type = "voice_coil", terminals = ["v", "ground"], mover = "x", '
SPEAKER += 'k_f = "B", R = "R_e", L = 0 }\n'
CART = (
    'inputs.F = {}\n[equations]\nunknowns = ["x", "a"]\n'
    'equations = ["(M + m)*s^2*x + m*l*s^2*a = F", "s^2*x + l*s^2*a - g*a = 0"]\n[outputs]\nX = "x"\n'
)
LINES = 'definitions.w = "sqrt(k/m)"\ndefinitions.b = "2*z*m*w"\n'
NECK = part("a", "mass", "x", m="rho*S*L") + part("c", "spring", "x ground", k="rho*c^2*S^2/V") + PUSH
TUBE = part("a", "mass", "x", m="rho*S*L") + part("c", "spring", "x ground", k="2*rho*g*S") + PUSH
LEVER = part("a", "mass", "x", m="m") + part("c", "spring", "y ground", k="k") + PUSH
LEVER += 'elements.d = { type = "transformer", from = "x", to = "y", ratio = "r" }\n'
ABSORBER = (
    part("a", "mass", "x", m="M") + part("b", "mass", "y", m="m") + part("c", "spring", "x ground", k="k")
)
ABSORBER += part("e", "mass", "z", m="M + m") + part("f", "spring", "z ground", k="k")
ABSORBER += 'inputs.F = { force = ["x", "z"] }\noutputs.D = "x - z"\n'
"""Free absorber and locked one: their sum is zero where the damper between makes no difference."""
FREE = ABSORBER + part("d", "spring", "x y", k="k_a")
TUNED = ABSORBER + part("d", "spring", "x y", k="k*M*m/(M + m)^2")
MIDDLE, REST = "M*k_a + m*k + m*k_a", "2*m*k*k_a*(2*M + m)"
SIGNAL = 'inputs.u = {{}}\noutputs.y = "{}"\n'
BOOKS = (
    # parameters, model, name, and what books print
    ("m_1 m_2 k", CHAIN + PUSH, "omega_z", "sqrt(k/m_2)"),  # antiresonance; Den Hartog's absorber
    ("m_1 m_2 k", CHAIN + PUSH, "omega_p", "sqrt(k*(m_1 + m_2)/(m_1*m_2))"),
    ("J_1 J_2 k", SHAFT, "omega_p", "sqrt(k*(J_1 + J_2)/(J_1*J_2))"),  # drive train
    ("J_1 J_2 k", SHAFT, "omega_z", "sqrt(k/J_2)"),
    ("m b k", HELD + part("d", "damper", "x ground", b="b"), "omega_p", "sqrt(k/m)"),
    ("m b k", HELD + part("d", "damper", "x ground", b="b"), "zeta_p", "b/(2*sqrt(k*m))"),
    ("m z k", LINES + HELD + part("d", "damper", "x ground", b="b"), "zeta_p", "z"),
    ("R L C", SERIES, "omega_p", "1/sqrt(L*C)"),
    ("R L C", SERIES, "zeta_p", "R/2*sqrt(C/L)"),
    ("R L C", SERIES, "Q_p", "sqrt(L/C)/R"),
    ("R L C", PARALLEL, "Q_p", "R*sqrt(C/L)"),
    ("m_s m_u k_s k_t", CAR + PUSH, "omega_z", "sqrt((k_s + k_t)/m_u)"),  # wheel hop
    ("J m k_t r", SCREW, "omega_z", "sqrt(k_t/(r**2*m))"),  # ball screw, motor held
    ("M C R_m R_e B", SPEAKER, "omega_p", "1/sqrt(M*C)"),  # Small 1972, omega_s and Q_ts
    ("M C R_m R_e B", SPEAKER, "Q_p", "sqrt(M/C)/(R_m + B**2/R_e)"),
    ("M m l g", CART, "sigma_p", "sqrt((M + m)*g/(M*l))"),  # pendulum on a cart
    ("M m l g", CART, "sigma_z", "sqrt(g/l)"),
    ("rho S L c V", NECK, "omega_p", "c*sqrt(S/(V*L))"),  # Helmholtz resonance
    ("rho S L g", TUBE, "omega_p", "sqrt(2*g/L)"),  # water in a U tube
    ("m k r", LEVER, "omega_p", "sqrt(r**2*k/m)"),  # stiffness behind a lever
    # Den Hartog 1934: fixed points, g^4 - 2 g^2 (1 + f^2 + mu f^2)/(2 + mu) + 2 f^2/(2 + mu) = 0
    ("M m k k_a", FREE, "omega_z1", f"sqrt(({MIDDLE} - sqrt(({MIDDLE})**2 - {REST}))/(m*(2*M + m)))"),
    ("M m k k_a", FREE, "omega_z2", f"sqrt(({MIDDLE} + sqrt(({MIDDLE})**2 - {REST}))/(m*(2*M + m)))"),
    ("M m k", TUNED, "omega_z1", "sqrt(k/(M + m)*(1 - sqrt(m/(2*M + m))))"),
    ("M m k", TUNED, "omega_z2", "sqrt(k/(M + m)*(1 + sqrt(m/(2*M + m))))"),
    ("a b T", SIGNAL.format("u*(a*s + b)/(s^2*T)"), "tau_z", "a/b"),
    ("a b", SIGNAL.format("u/(a*s - b)"), "s_p", "b/a"),
)


def said_of(parameters: str, text: str, seed: int = 3) -> tuple[list[SymbolicFactor], dict[str, float]]:
    """Return what is said of the first function of a model whose parameters have random values."""
    draw = Random(seed)
    values = {name: draw.randint(1, 60) / 8 for name in parameters.split()}
    given = ", ".join(f"{name} = {value}" for name, value in values.items())
    (tf,) = pipeline.derive_all(pipeline.loads(f"symflex = 1\nparameters = {{ {given} }}\n{text}"))
    bound = pipeline.bind(tf)
    return [*symbolic_roots(tf, bound, pipeline.roots(bound))], values


def test_formulas_are_those_of_books() -> None:
    wrong = []
    for parameters, text, name, book in BOOKS:
        found, _ = said_of(parameters, text)
        said = {f.name: format_expression(f.expression) for each in found for f in each.formulas}
        letters = {n: sympy.Symbol(n, positive=True) for n in parameters.split()}
        ours, theirs = (sympy.sympify(e.replace("^", "**"), letters) for e in (said.get(name, "0"), book))
        if sympy.simplify(ours**2 - theirs**2) != 0:  # each is positive
            wrong.append((name, book, said))
    assert not wrong


def test_formulas_are_reduced_and_take_their_minus_sign_into_a_difference() -> None:
    """By hand: zeta = b/(2*sqrt(a*c)) of a*s^2 + b*s + c, what is positive divided out of b and the root."""
    lines = 'definitions.T = "1/f"\n'
    sampled = "(1 + T*(m*(1 - D) - 1/2)*s + T^2*s^2/pi^2)"
    cases = (
        ("f D m", lines + SIGNAL.format(f"u/{sampled}"), "zeta_p", "pi*(2*m*(1 - D) - 1)/4"),
        ("f D m", lines + SIGNAL.format(f"u/{sampled}"), "Q_p", "2/(pi*(2*m*(1 - D) - 1))"),
        ("m b k K h", SIGNAL.format("u/(m*s^2 + b*(h - K)*s + k)"), "zeta_p", "b*(h - K)/(2*sqrt(m*k))"),
        ("a b c", SIGNAL.format("u*(a*b*s^2 - a*b*(a + c)*s + a*b*c)/s^3"), "zeta_z", "-(a + c)/(2*sqrt(c))"),
        ("a b c", SIGNAL.format("u/(a*s + c - b)"), "s_p", "(b - c)/a"),
        ("a b c", SIGNAL.format("u*((b - a)*s^2 + c)/s^3"), "omega_z", "sqrt(c/(b - a))"),
        ("a b c", SIGNAL.format("u*((b - a)*s^2 + c)/s^3"), "sigma_z", "sqrt(c/(a - b))"),
    )
    wrong = []
    for parameters, text, name, expected in cases:
        said = {
            f.name: format_expression(f.expression)
            for seed in (3, 5)  # of either sign
            for each in said_of(parameters, text, seed)[0]
            for f in each.formulas
        }
        wrong += [(expected, said)] if said.get(name) != expected else []
    assert not wrong


def test_conditions_of_kinds_begin_with_no_minus_sign() -> None:
    """By hand: the discriminant of s^2 + pi^2*f*(m*(1 - D) - 1/2)*s + pi^2*f^2, squares divided out."""
    text = SIGNAL.format("u/(s^2 + pi^2*f*(m*(1 - D) - 1/2)*s + pi^2*f^2)")
    kinds = {
        words.partition(" if ")[0]: shown
        for each in said_of("f D m", text)[0]
        for words, _, shown in each.kinds
    }
    d, m = sympy.symbols("D m")
    spread = sympy.pi**2 * (2 * m * (1 - d) - 1) ** 2 - 16
    for words, sign in (("a complex pair", -1), ("two real roots", 1)):
        (shown,) = kinds[words]
        assert "-" not in (str(shown)[0], str(shown).partition(" > ")[2][0])
        left, right = (sympy.sympify(side.replace("^", "**"), {"D": d}) for side in str(shown).split(" > "))
        assert sympy.expand(left - right - sign * spread) == 0


def kind_of(polynomial: np.ndarray) -> dict[str, int]:
    """Return how many pairs of roots of an even polynomial are imaginary, real, or half a quartet."""
    squares = np.roots(polynomial)  # of z = s^2
    is_real = abs(squares.imag) < 1e-7 * abs(squares)
    return {
        "imaginary": int((is_real & (squares.real < 0)).sum()),
        "real": int((is_real & (squares.real > 0)).sum()),
        "quartet": int((~is_real).sum()) // 2,
    }


def test_fixed_points_of_a_tuned_absorber_have_one_height_whatever_its_damper() -> None:
    """Den Hartog 1934: sqrt(1 + 2/mu)/k, for an absorber tuned to 1/(1 + mu)."""
    found, v = said_of("M m k", TUNED)
    frequencies = [float(f.value.mid()) for each in found if each.kind == "zeros" for f in each.formulas]
    spring = v["k"] * v["M"] * v["m"] / (v["M"] + v["m"]) ** 2
    heights = []
    for w, c in ((w, c) for w in frequencies for c in (0.01, 0.4, 3, 50)):
        link = spring + 1j * c * w
        heights.append(abs(1 / (v["k"] - v["M"] * w**2 - link * v["m"] * w**2 / (link - v["m"] * w**2))))
    assert len(frequencies) == 2
    assert heights == pytest.approx([np.sqrt(1 + 2 * v["M"] / v["m"]) / v["k"]] * 8, rel=1e-9)


def test_quartets_of_three_masses_are_where_a_discriminant_by_hand_is_negative() -> None:
    """Rath and Awtar 2021: a rigid-body mode and two flexible ones with residues of both signs."""
    output = SIGNAL.format("u*(a_0/s^2 - a_1/(s^2 + w_1^2) + a_2/(s^2 + w_2^2))")
    found, _ = said_of("w_1 w_2 a_0 a_1 a_2", output)
    kinds = {text.partition(" if ")[0]: shown for each in found for text, _, shown in each.kinds}
    assert {"two imaginary pairs", "two real pairs", "a quartet", "an imaginary and a real pair"} <= {*kinds}
    left, right = (sympy.sympify(x.replace("^", "**")) for x in str(*kinds["a quartet"]).split(" > "))
    a_0, a_1, a_2, w_1, w_2 = sympy.symbols("a_0 a_1 a_2 w_1 w_2")
    square = (a_0 * (w_2**2 - w_1**2) - a_1 * w_2**2 - a_2 * w_1**2) ** 2
    assert sympy.expand(left - right + square - 4 * a_1 * a_2 * w_1**2 * w_2**2) == 0


NUMBERS = {"a": 1, "an": 1, "two": 2, "three": 3, "four": 4}


def counts_in(words: str) -> dict[str, int]:
    """Return the same of what is said: ``a quartet and two imaginary pairs``."""
    counts = dict.fromkeys(("imaginary", "real", "quartet"), 0)
    for match in re.finditer(r"(an?|two|three|four) (imaginary|real|quartet)", words):
        counts[match[2]] += NUMBERS[match[1]]
    return counts


def test_kinds_of_roots_of_even_polynomials_are_those_numpy_finds() -> None:
    """Coefficients of both signs; every condition that holds says what numpy finds, and most are met."""
    held, wrong, draws = 0, [], [(pairs, seed) for pairs in (1, 2, 3, 4) for seed in range(12)]
    for pairs, seed in draws:
        names, signs = "abcde"[: pairs + 1], Random(seed)
        chosen = [signs.choice("++-") for _ in names]
        text = "".join(f"{sign}{n}*s^{2 * i}" for i, (sign, n) in enumerate(zip(chosen, names, strict=True)))
        found, values = said_of(" ".join(names), SIGNAL.format(f"u*({text.lstrip('+')})/s^{2 * pairs}"), seed)
        numbers = [values[n] * (1 if sign == "+" else -1) for sign, n in zip(chosen, names, strict=True)]
        true = [
            text.partition(" if ")[0]
            for each in found
            if each.kind == "zeros"
            for text, holds, _ in each.kinds
            if holds
        ]
        held += bool(true)
        wrong += [(text, words) for words in true if counts_in(words) != kind_of(np.array(numbers[::-1]))]
    assert not wrong
    assert held > len(draws) // 2


def test_signs_that_imply_a_kind_of_roots_hold_for_roots_of_this_kind_alone() -> None:
    """Roots are drawn by kind, scales apart and alike; every kind but two quartets near an axis is told."""
    random, ring = np.random.default_rng(5), Ring(("s", *"abcde"))
    names = [ring.generator(name) for name in "abcde"]
    kinds = {pairs: _even_kinds(ring, names[: pairs + 1]) for pairs in (1, 2, 3, 4)}
    told: Counter[str] = Counter()
    for _ in range(800):
        pairs = int(random.choice([1, 2, 3, 4], p=[0.1, 0.2, 0.3, 0.4]))
        quartets = int(random.integers(0, pairs // 2 + 1))
        sizes = 10.0 ** random.uniform(-1, 1, pairs)
        sign = random.choice([-1, 1]) if random.random() < 0.5 else random.choice([-1, 1], pairs)
        squares = [*(sizes * sign)[2 * quartets :]]
        for size in sizes[:quartets]:
            turned = size * np.exp(1j * random.uniform(0.05, np.pi - 0.05))
            squares += [turned, turned.conjugate()]
        numbers = (random.choice([-1, 1]) * np.poly(squares).real)[::-1]
        for words, conditions in kinds[pairs]:
            if all(sign * evaluated(f, numbers) > 0 for f, sign in conditions):
                assert counts_in(words) == kind_of(numbers[::-1]), (words, numbers)
                told[words] += 1
    assert min(told.values()) > 5 and len(told) == 2 + 4 + 4 + 6


def evaluated(polynomial: fmpz_mpoly, values: Sequence[float]) -> float:
    """Return a polynomial in s, which is not in it, and a, b, ..."""
    terms = polynomial.terms()
    return sum(int(n) * prod(x ** int(e) for x, e in zip(values, m[1:], strict=False)) for m, n in terms)


def test_a_condition_says_where_a_pair_becomes_real() -> None:
    said = symbolic_text(said_of("m b k", HELD + part("d", "damper", "x ground", b="b"))[0], 200)
    assert "a complex pair if 4*m*k > b^2" in said
    assert "two real roots if b^2 > 4*m*k" in said


def test_the_tip_of_the_bending_beam_has_real_zeros_for_a_long_overhang() -> None:
    """Eppinger and Seering's lumped beam: 2 J + 2 c^2 m_2 + c l m_2 < 2 c h m_2 + h l m_2."""
    model = pipeline.load("derivations/eppinger1988/lumped_bending_beam.toml")
    (tf,) = pipeline.derive_all(model, [("X_tip", "F")])
    bound = pipeline.bind(tf)
    found = symbolic_roots(tf, bound, pipeline.roots(bound))
    (real,) = (
        text for each in found for text, holds, _ in each.kinds if holds and text.startswith("a real pair")
    )
    names = sympy.symbols("J c h l m_2", positive=True)
    sides = real.removeprefix("a real pair if ").replace("^", "**").split(" > ")
    left, right = (sympy.sympify(side, {str(n): n for n in names}) for side in sides)
    j, c, h, length, m = names
    theirs = 2 * c * h * m + h * length * m - (2 * j + 2 * c**2 * m + c * length * m)
    assert sympy.expand(left - right - theirs) == 0


def test_what_has_no_short_letters_says_so() -> None:
    found, _ = said_of("a b c d", SIGNAL.format("u/(a*s^3 + b*s^2 + c*s + d)"))
    assert [each.note for each in found] == ["a factor of degree 3 in s has no short formula"]
    found, _ = said_of("", SIGNAL.format("u/(s + 1)"))
    assert [each.note for each in found] == ["no factor has symbols"]


def test_a_square_of_a_difference_stays_below_its_root() -> None:
    """omega is abs(a - b), whichever is larger."""
    (zeros, *_), _ = said_of("a b", SIGNAL.format("u*(s^2 + (a - b)^2)/s^3"))
    assert str(zeros.formulas[0]) == "omega_z = sqrt((a - b)^2)"


def test_the_equation_of_a_factor_keeps_definitions_closed_and_begins_brackets_with_no_minus_sign() -> None:
    # Sampling poles of peak-current mode (Ridley 1991): s^2 + pi^2 f K s + (pi f)^2, K half a sum.
    text = """definitions = { K = "m*(1 - D) - 1/2" }
inputs.u = {}
outputs.y = "u/(1 + K/f*s + s^2/(pi*f)^2)"
"""
    ((factor,), _) = said_of("f m D", text)
    assert factor.factor is not None
    assert format_expression(factor.factor) == "s^2 + pi^2*f*K*s + pi^2*f^2"
    said = [*factor.lines()]
    assert any(line.startswith("omega_p = pi*f") for line in said)
    assert any(" if 4 > pi^2*K^2" in line for line in said)


def test_modes_of_a_quarter_car_have_the_approximate_formulas_of_books() -> None:
    # Rajamani 2012, section 10.3: the body on both springs in series, the wheel on both side by side.
    model = pipeline.load(CLASSICS / "quarter_car.toml")
    tf = pipeline.derive_all(model, [("Z_body", "z_road")])[0]
    bound = pipeline.bind(tf)
    located = pipeline.roots(bound)
    (factor, *_) = symbolic_roots(tf, bound, located)
    about = {f.name: f for f in factor.approximations}
    assert format_expression(about["omega_p1"].expression) == "sqrt(k_s*k_t/(m_s*(k_s + k_t)))"
    assert format_expression(about["omega_p2"].expression) == "sqrt((k_s + k_t)/m_u)"
    # What it says of their error is that of the certified roots: 300 kg, 40 kg, 20 kN/m, ... by numpy.
    given = {p.name: float(p.value.nearly) for p in model.parameters if p.value is not None}
    m_s, m_u, c_s, k_s, k_t = (given[name] for name in ("m_s", "m_u", "c_s", "k_s", "k_t"))
    total = m_s + m_u
    sizes = sorted(abs(np.roots([m_s * m_u, total * c_s, m_s * k_t + total * k_s, c_s * k_t, k_s * k_t])))
    for name, size, formula in (
        ("omega_p1", sizes[0], np.sqrt(k_s * k_t / (m_s * (k_s + k_t)))),
        ("omega_p2", sizes[-1], np.sqrt((k_s + k_t) / m_u)),
    ):
        assert float(about[name].off.mid()) == pytest.approx(formula / size - 1, rel=1e-9)
    assert any(
        line.startswith("omega_p2 ~ sqrt((k_s + k_t)/m_u), 1.6 % above 69.6095 rad/s")
        for line in factor.lines()
    )
