"""What a transfer function does not see: where ``roots`` says unstable or not known, nothing says stable.

Each model hides a pole whose place is known by hand. In its twin one value differs and the pole lies on the
left, and all commands call it stable.
"""

from cmath import cos, cosh, exp, sin, sinh, sqrt
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import log, pi

import mpmath
import pytest

import symflex
from symflex import pipeline
from symflex.codegen.javascript import JAVASCRIPT, RESERVED
from symflex.figures.loops import verdict_of_closed
from symflex.live import page
from symflex.loops import of_model
from symflex.loops.chart import StabilityChart
from symflex.loops.over import stability_over
from symflex.loops.spread import stability_spread
from symflex.model import Model
from symflex.options import StabilityOptions
from symflex.roots import Modes
from symflex.sweep.points import VERDICTS
from symflex.symbolic.routh import conditions

LAMBERT = float(mpmath.lambertw(mpmath.exp(0.5)) / 0.5 - 1)  # s + 1 = 2 exp(-s/2)


@dataclass(frozen=True)
class Case:
    """A model whose parameter ``p`` makes it unstable with ``bad``, and stable with ``good``."""

    text: str
    bad: str
    good: str
    hidden: Callable[[complex], complex]  # vanishes at a pole that is hidden with ``bad``
    pole: complex  # where that is, in the right half-plane
    unit: str = ""
    is_lumped: bool = True  # there are symbolic conditions
    is_followed: bool = True  # over any parameter, as not with roots of s

    def written(self, value: str) -> str:
        return (
            f'symflex = 1\nparameters.p = {{ value = "{value} {self.unit}", assume = "real" }}\n'
            'parameters.K = 1\nparameters.T = "1 s"\n' + self.text
        )

    def model(self, value: str) -> Model:
        return pipeline.loads(self.written(value))


LOOP = 'y = "K*(r - y)/(s + 1)"'
SEEN = "inputs.r = {}\noutputs.Y = 'y'\n"
TWO = "inputs.r = {}\ninputs.d = {}\noutputs.Y = 'y'\noutputs.V = 'v'\n"
BEAM = 'EI = "1 N*m^2", rhoA = "1 kg/m", l = "1 m", eta = "eta"'
PUSHED = "inputs.r = {}\ninputs.F.force = 'x'\noutputs.Y = 'y'\noutputs.X = 'x'\n"
CASES = {
    "a block's pole that the next one cancels": Case(
        'signals = { u = "(r - y)/(s - p)", y = "(s - p)*K*u/(s + 1)" }\n' + SEEN,
        "1",
        "-1",
        lambda s: s - 1,
        1,
    ),
    "a factor with a delay": Case(
        'signals = { u = "(r - y)/(1 - p*exp(-s*T))", y = "(1 - p*exp(-s*T))*K*u/(s + 1)" }\n' + SEEN,
        "2",
        "0.5",
        lambda s: 1 - 2 * exp(-s),
        log(2) + 2j * pi,
        is_lumped=False,
    ),
    "a factor with an exponential of a root of s": Case(
        'signals = { u = "(r - y)/(1 - p*exp(-sqrt(s*T)))", y = "(1 - p*exp(-sqrt(s*T)))*K*u/(s + 1)" }\n'
        + SEEN,
        "2",
        "0.5",
        lambda s: 1 - 2 * exp(-sqrt(s)),
        log(2) ** 2,
        is_lumped=False,
        is_followed=False,
    ),
    "a root of s alone": Case(
        'signals = { u = "(r - y)/(sqrt(s*T) - p)", y = "(sqrt(s*T) - p)*K*u/(s + 1)" }\n' + SEEN,
        "1",
        "-1",
        lambda s: sqrt(s) - 1,
        1,
        is_lumped=False,
        is_followed=False,
    ),
    "a second loop": Case(
        f'signals = {{ {LOOP}, v = "(p*v + d)/(s + 1)" }}\n' + TWO, "2", "0.5", lambda s: s - 1, 1
    ),
    "a second loop with a delay": Case(
        f'signals = {{ {LOOP}, v = "(p*exp(-s*T/2)*v + d)/(s + 1)" }}\n' + TWO,
        "2",
        "0.5",
        lambda s: s + 1 - 2 * exp(-s / 2),
        LAMBERT,
        is_lumped=False,
    ),
    "two loops with delays": Case(
        'signals = { y = "K*exp(-s*T/2)/(s + 2)*(r - y)", v = "(p*exp(-s*T/2)*v + d)/(s + 1)" }\n' + TWO,
        "2",
        "0.5",
        lambda s: s + 1 - 2 * exp(-s / 2),
        LAMBERT,
        is_lumped=False,
    ),
    "a filter of another input": Case(
        'signals = { y = "K/(s + 1)*(r + d/(s - p) - y)" }\ninputs.d = {}\n' + SEEN,
        "1",
        "-1",
        lambda s: s - 1,
        1,
    ),
    "a filter of another output": Case(
        f"signals = {{ {LOOP} }}\n{SEEN}outputs.Z = 'y/(s - p)'", "1", "-1", lambda s: s - 1, 1
    ),
    "a delayed filter of another output": Case(
        f"signals = {{ {LOOP} }}\n{SEEN}outputs.Z = 'y/(1 - p*exp(-s*T))'",
        "2",
        "0.5",
        lambda s: 1 - 2 * exp(-s),
        log(2),
        is_lumped=False,
    ),
    "the only output's own filter": Case(
        f"signals = {{ {LOOP} }}\ninputs.r = {{}}\noutputs.Z = 'y/(s - p)'", "1", "-1", lambda s: s - 1, 1
    ),
    "an oscillator": Case(
        f"""signals = {{ {LOOP} }}
        elements.m = {{ type = "mass", at = "x", m = "1 kg" }}
        elements.k = {{ type = "spring", between = ["x", "ground"], k = "4 N/m" }}
        elements.f = {{ type = "force_source", at = "x", f = "p*s*x" }}\n"""
        + PUSHED,
        "0.1",
        "-0.1",
        lambda s: s * s - 0.1 * s + 4,
        complex(0.05, (4 - 0.05**2) ** 0.5),
        "N*s/m",
    ),
    "a damped beam": Case(
        f"""signals = {{ {LOOP} }}
        parameters.eta = "0.001 s"
        elements.f = {{ type = "force_source", at = "x", f = "p*s*x" }}
        elements.b = {{ type = "beam", between = ["ground", "x"], {BEAM} }}\n"""
        + PUSHED,
        "0.1",
        "-0.1",
        # A cantilever with a dashpot, whose damping is negative, at its tip.
        lambda s: (
            (1 + 1e-3 * s) * (k := sqrt(sqrt(-s * s / (1 + 1e-3 * s)))) ** 3 * (1 + cosh(k) * cos(k))
            - 0.1 * s * (cosh(k) * sin(k) - sinh(k) * cos(k))
        ),
        0.194 + 3.51j,
        "N*s/m",
        is_lumped=False,
    ),
    "a rod as a field": Case(
        f"""signals = {{ {LOOP} }}
        parameters.eta = "0.1 s"
        inputs.r = {{}}
        inputs.F.unit = "N"
        outputs.Y = "y"
        outputs.X = "w(l)"
        parameters.l = "1 m"
        parameters.A = "1 m^2"
        parameters.E = "1 Pa"
        parameters.rho = "1 kg/m^3"
        [fields.w]
        domain = ["0", "l"]
        equation = "E*A*(1 + eta*s)*w'' = rho*A*s^2*w"
        conditions = ["w(0) = 0", "E*A*(1 + eta*s)*w'(l) = F + p*s*w(l)"]""",
        "0.6",
        "-0.6",
        lambda s: (1 + 0.1 * s) * (g := s / sqrt(1 + 0.1 * s)) * cosh(g) - 0.6 * s * sinh(g),
        0.56 + 1.6j,
        "N*s/m",
        is_lumped=False,
    ),
}


QUICK = {"a block's pole that the next one cancels", "a second loop", "an oscillator", "a root of s alone"}
EACH = [pytest.param(name, marks=[pytest.mark.slow] * (name not in QUICK)) for name in CASES]


def of_roots(model: Model) -> set[str]:
    """Return what ``roots`` says of the transfer functions of a model."""
    bounds = (pipeline.derive_for_roots(model, [pair])[0] for pair in model.transfer_functions)
    return {pipeline.roots(bound).verdict.word for bound in bounds}


def over(model: Model, *ranges: tuple[str, str, str]) -> str:
    """Return what holds at the declared values in a search over one parameter or two."""
    found = stability_over(model, StabilityOptions(over=tuple(name for name, *_ in ranges), ranges=ranges))
    return str(found.at_nominal) if isinstance(found, StabilityChart) else found.verdict.word


def of_commands(model: Model, *, is_followed: bool) -> dict[str, str]:
    """Return the word that every other command has for the whole model."""
    found = of_model.stability(model, StabilityOptions("K"))
    said: dict[str, str] = {"--gain": found.verdict.word, "ranges": "stable" if found.stable else "none"}
    if is_followed:
        value = next(p.value.rational for p in model.parameters if p.name == "p" and p.value)
        low, high = sorted((value * Fraction(9, 10), value * Fraction(11, 10)))
        gain, own = ("K", "0.5", "2"), ("p", str(float(low)), str(float(high)))
        said |= {"--over K": over(model, gain), "--over p": over(model, own)}
        said["--over K --over p"] = over(model, gain, own)
        said["--spread"] = stability_spread(model, StabilityOptions(spread="0.01")).word
    return said


@pytest.mark.parametrize("name", EACH)
def test_no_command_calls_a_model_stable_that_hides_an_unstable_pole(name: str) -> None:
    case = CASES[name]
    pole = mpmath.findroot(case.hidden, case.pole)
    assert pole.real > 0
    assert abs(complex(pole) - case.pole) < 0.01
    model = case.model(case.bad)
    is_seen = "output" in name  # one output's own poles are no other's
    assert "unstable" in of_roots(model) <= {"unstable", "stable" if is_seen else "unstable"}
    said = of_commands(model, is_followed=case.is_followed)
    assert said["--gain"] == "unstable"
    assert not {"stable", "marginal"} & set(said.values()), said


@pytest.mark.parametrize("name", EACH)
def test_all_commands_call_the_twin_stable(name: str) -> None:
    case = CASES[name]
    model = case.model(case.good)
    assert of_roots(model) == {"stable"}
    said = of_commands(model, is_followed=case.is_followed)
    assert set(said.values()) == {"stable"}, said


def test_a_loop_is_unstable_for_every_gain_beside_a_second_one_that_is_late_and_unstable() -> None:
    found = of_model.stability(CASES["a second loop with a delay"].model("2"), StabilityOptions("K"))
    assert (found.verdict.word, found.verdict.right, found.stable) == ("unstable", 1, ())
    assert found.certified


def test_a_hidden_factor_that_waits_has_poles_without_end() -> None:
    assert of_roots(CASES["a factor with a delay"].model("2")) == {"unstable"}
    assert of_roots(CASES["a factor with a delay"].model("0.5")) == {"stable"}


@pytest.mark.parametrize("name", [n for n, case in CASES.items() if case.is_lumped])
def test_symbolic_conditions_hold_for_the_twin_alone(name: str) -> None:
    case = CASES[name]
    (condition,) = conditions(case.model(case.bad)).conditions
    left, sign, right = str(condition).split()
    values = [
        [{"p": float(value)}.get(x) or float(x) for x in (left, right)] for value in (case.bad, case.good)
    ]
    assert sign == ">"
    assert [a > b for a, b in values] == [False, True]


def test_the_poles_of_an_output_have_the_conditions_they_have_in_a_signal() -> None:
    # +-0.5 +- 0.866j for a = b = 1 (numpy.roots([1, 0, 1, 0, 1])).
    text = "symflex = 1\nparameters = { a = 1, b = 1 }\ninputs.r = {}\n"
    quotient = "r/(s^4 + a*s^2 + b)"
    body = """
    elements.m = { type = "mass", at = "x", m = "a" }
    elements.k = { type = "spring", between = ["x", "ground"], k = "b" }
    inputs.F.force = "x"
    outputs.X = "x"
    """
    for more in (
        f'outputs.Y = "{quotient}"',
        f'signals.v = "{quotient}"\noutputs.Y = "v"',
        'blocks.G = "1/(s^4 + a*s^2 + b)"\noutputs.Y = "G*r"',
        f'{body}\noutputs.Y = "{quotient}"',
    ):
        found = conditions(pipeline.loads(text + more))
        assert [str(c) for c in found.conditions] == ["a^2 > 4*b"], more


@pytest.mark.slow
def test_a_page_says_of_poles_it_does_not_see_that_they_may_be_hidden() -> None:
    model = CASES["a second loop with a delay"].model("0.5")
    pair = model.transfer_functions[0]
    contents = JAVASCRIPT.contents(model, pipeline.derive_all(model, [pair]))
    (shown,) = page._data(contents, contents.names(RESERVED)[1], [pair])["functions"]
    assert (shown["hides"], shown["verdict"]["word"]) == (True, "stable")


UNDAMPED = """
symflex = 1
parameters = { K = 1, EI = "1 N*m^2" }
signals = { y = "K*(r - y)/(s + 1)" }
elements.b = { type = "beam", between = ["ground", "x"], EI = "EI", rhoA = "1 kg/m", l = "1 m" }
inputs = { r = {}, F = { force = "x" } }
outputs = { Y = "y", X = "x" }
"""


def test_a_hidden_beam_without_damping_leaves_a_loop_stable_and_is_named() -> None:
    # Nothing supplies energy: its poles lie on the axis, for every EI.
    model = pipeline.loads(UNDAMPED)
    (bound,) = pipeline.derive_for_roots(model, [("Y", "r")])
    found = [pipeline.roots(bound).verdict, of_model.stability(model, StabilityOptions("K")).verdict]
    assert {(v.word, v.hidden) for v in found} == {("stable", "hidden poles on the imaginary axis")}
    followed = stability_over(model, StabilityOptions(over=("EI",), ranges=(("EI", "0.5", "2"),))).verdict
    assert (followed.word, followed.hidden) == ("stable", "hidden poles on the imaginary axis")


def test_the_modes_of_a_hidden_beam_are_listed_beside_all_poles_of_the_loop() -> None:
    (bound,) = pipeline.derive_for_roots(pipeline.loads(UNDAMPED), [("Y", "r")])
    located = pipeline.roots(bound)
    assert [complex(p) for p in located.poles] == [-2]
    lowest = sorted(complex(h.root).imag for h in located.hidden if complex(h.root).imag > 0)
    # 1 + cosh(k) cos(k) = 0 with omega = k^2: 1.8751, 4.6941 (Blevins 1979, table 8-1).
    expected = [
        float(mpmath.findroot(lambda k: 1 + mpmath.cosh(k) * mpmath.cos(k), x)) ** 2 for x in (1.9, 4.7)
    ]
    assert lowest[:2] == pytest.approx(expected, rel=1e-9)
    assert located.hides_more


@pytest.mark.slow
@pytest.mark.parametrize(("value", "word"), [("2", "unstable"), ("0.5", "stable")])
def test_sweeps_nyquist_plots_and_python_give_the_verdict_of_roots(value: str, word: str) -> None:
    model = symflex.loads(CASES["a second loop with a delay"].written(value))
    loop = of_model.characteristic_loop(model.resolved, "K")
    assert verdict_of_closed(loop, Fraction(1)).word == word
    swept = model.sweep({"K": [0.5, 1.0]}, tf="Y/r")
    assert {VERDICTS[i] for i in swept["verdict"]} == {word}
    assert model.transfer_function("Y", "r").bind().pole_zero_map().verdict.word == word


def test_all_hidden_roots_that_grow_are_listed_on_their_sheet() -> None:
    text = CASES["a factor with an exponential of a root of s"].written("2000")
    (bound,) = pipeline.derive_bound(pipeline.loads(text), [("Y", "r")])
    hidden = [complex(h.root) for h in pipeline.roots(bound, Modes(1)).hidden]
    # sqrt(s) = ln(2000) + 2 pi j k, and Re s > 0 for k = -1, 0, 1
    expected = [complex(log(2000), 2 * pi * k) ** 2 for k in (-1, 0, 1)]
    growing = sorted((s for s in hidden if s.real > 0), key=lambda s: s.imag)
    assert growing == pytest.approx(expected, rel=1e-9)
