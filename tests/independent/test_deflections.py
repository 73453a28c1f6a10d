"""Operating deflection shapes against closed forms, dense matrices and dynamic stiffness."""

from fractions import Fraction

import numpy as np
import pytest
from mpmath import cos, cosh, degrees, mp, nstr, pi, sin, sinh, sqrt

from symflex import loads, pipeline
from symflex.analysis.modes import deflection
from symflex.errors import SymflexError

from .plane_frames import Member, clamped, response

BAR = 'E = "210 GPa", I = "1e-8 m^4", A = "1e-4 m^2", rho = "7800 kg/m^3", l = "0.5 m", eta_s = 0.02 }\n'
HEAD = 'symflex = 1\ninputs.F = { force = "p" }\noutputs.X = "p"\n'
MASS = f'{HEAD}elements.m = {{ type = "mass", at = "p", m = "2 kg" }}\n'
OSCILLATOR = MASS + 'elements.k = { type = "spring", between = ["p", "ground"], k = "8 N/m" }\n'


def test_a_cantilever_moves_in_full_and_dashed_lines_as_its_receptance():
    text = f'{HEAD}elements.b = {{ type = "beam", between = ["ground", "p"], {BAR}'
    (axes,) = loads(text).transfer_function("X", "F").bind().deflection_plot("116 Hz").axes
    ei = 2100 * (1 + 0.02j)
    beta = sqrt(2 * pi * 116 * sqrt(0.78 / ei))
    lam = beta / 2
    below = 2 * ei * beta**3 * (1 + cos(lam) * cosh(lam))

    def receptance(x):  # Bishop & Johnson, The Mechanics of Vibration (1960), table 7.1
        first, second = sin(lam) + sinh(lam), cos(lam) + cosh(lam)
        return (first * (cosh(x) - cos(x)) - second * (sinh(x) - sin(x))) / below

    size, turned = nstr(abs(receptance(lam)), 3), nstr(degrees(mp.arg(receptance(lam))), 3)
    said = rf"$116.0$ Hz, largest ${size}$ $\mathrm{{m/N}}$, ${turned}$" + "\N{DEGREE SIGN} from $F$"
    assert axes.get_title(loc="left") == said
    for curve, part in zip(axes.lines[1:], (mp.im, mp.re), strict=True):
        x, y = (points[::60] for points in curve.get_data())
        wanted = [float(part(receptance(beta * z) / abs(receptance(lam)))) for z in x]
        assert y == pytest.approx(wanted, abs=1e-9)


def test_a_damped_portal_moves_as_its_dynamic_stiffness_says():
    ends = {
        "a": '["ground", "p"], angle = "90 deg"',
        "b": '["ground", "q"], angle = "90 deg"',
        "c": '["p", "q"]',
    }
    members = [f'elements.{n} = {{ type = "frame", between = {at}, {BAR}' for n, at in ends.items()]
    (bound,) = pipeline.derive_bound(
        model := pipeline.loads(HEAD.replace('"p"', '"p.x"') + "".join(members)), model.transfer_functions
    )
    shape = deflection(bound, Fraction(414))
    middle = map(complex, shape.along("c").state_at_share(Fraction(1, 2)))
    moved = {
        ("p", "x"): complex(shape.motion("p.x").value),
        ("m", "x"): next(middle),
        ("m", "y"): next(middle),
    }
    steel = {"E": 210e9 * (1 + 0.02j), "I": 1e-8, "A": 1e-4, "rho": 7800}
    frame = [Member(g, top, **steel, l=0.5, angle=np.pi / 2) for g, top in ("gp", "hq")]
    frame += [Member(first, second, **steel, l=0.25) for first, second in ("pm", "mq")]
    for freedom, value in moved.items():
        wanted = response(frame, clamped("g", "h"), ("p", "x"), freedom, 828j * np.pi)
        assert value * abs(complex(shape.amplitude)) == pytest.approx(wanted, rel=1e-9), freedom


def test_no_deflection_where_it_is_infinite_or_not_asked_for():
    for text, at, reason in (
        (OSCILLATOR, "2 rad/s", r"SF406.*no deflection at 0.31831 Hz.*resonance.*infinite"),
        (OSCILLATOR.replace("8 N/m", "8*pi^2 N/m"), 1, "SF406.*infinite"), (MASS, 0, "SF406.*free to move"),
        (OSCILLATOR.replace(' N/m" }', ' N/m", eta_s = 0.1 }'), 0, "SF251"),
        (OSCILLATOR, -1, "SF902.*not negative"), (OSCILLATOR, "2 kg", "SF902.*found '2 kg'"),
    ):  # fmt: skip
        with pytest.raises(SymflexError, match=reason):
            loads(text).transfer_function("X", "F").bind().deflection_plot(at)
