"""One distributed element with lumped ones at its ends."""

from __future__ import annotations

from tests.independent.boundary_value import Form, Number, Values, rod, shaft, string, timoshenko
from tests.independent.distributed.case import (
    AXIAL,
    BEAM,
    BEAM_ELEMENT,
    LOSSES,
    ROD,
    ROD_ELEMENT,
    SHAFT,
    SHAFT_ELEMENT,
    SLENDER,
    STOCKY,
    STRING,
    STRING_ELEMENT,
    TAUT,
    THICK,
    THICK_ELEMENT,
    TORSION,
    Case,
    elements,
)
from tests.independent.distributed.span import (
    clamped,
    first_end,
    free,
    free_with_force,
    rayleigh,
    second_end,
    span,
)


def turning_force(w, slope, moment, shear, v, s):
    """A unit moment on the second end: +M = 1."""
    return moment - 1, shear


def hub(w, slope, moment, shear, v, s):
    """A hub of inertia J_h under a unit torque at a pinned first end: J_h s^2 theta = 1 + M."""
    return w, v["J_h"] * s**2 * slope - 1 - moment


def payload(w, slope, moment, shear, v, s):
    """A point mass at the second end: m s^2 w = V."""
    return moment, v["m"] * s**2 * w - shear


def body(w, slope, moment, shear, v, s):
    """A rigid body whose mass centre lies c beyond the second end, with a unit force at that end.

    m s^2 (w + c theta) = V + 1 and J s^2 theta = -M - c (V + 1), the moments taken about the mass centre.
    """
    force = shear + 1
    newton = v["m"] * s**2 * (w + slope * v["c"]) - force
    euler = v["J_b"] * s**2 * slope + moment + force * v["c"]
    return newton, euler


def guided(w, slope, moment, shear, v, s):
    """Mass and spring at a second end that does not turn, under a unit force."""
    return slope, (v["m"] * s**2 + v["k"]) * w - shear - 1


ARM = BEAM | {"J_h": "0.004 kg*m^2", "m": "0.25 kg"}
ARM_ELEMENTS = elements(
    hub='type = "inertia", at = "hub.theta", J = "J_h"',
    joint='type = "pin", at = "hub"',
    arm=f'{BEAM_ELEMENT}, between = ["hub", "tip"], l = "l"',
    load='type = "mass", at = "tip", m = "m"',
)

ELEMENTS_IN_BENDING = (
    Case(
        "beam element with damping, deflection under a moment",
        BEAM | LOSSES,
        elements(
            clamp='type = "fixed", at = "root"',
            arm=f'{BEAM_ELEMENT}, eta = "eta", c_f = "c_f", between = ["root", "tip"], l = "l"',
        ),
        "tip",
        *SLENDER,
        span(clamped, turning_force, second_end(0)),
        source='{ torque = "tip" }',
    ),
    Case(
        "beam element clamped at its second end",
        BEAM | LOSSES,
        elements(arm=f'{BEAM_ELEMENT}, eta = "eta", c_f = "c_f", between = ["tip", "ground"], l = "l"'),
        "tip.theta",
        *SLENDER,
        span(lambda w, slope, moment, shear, v, s: (moment, shear - 1), clamped, first_end(1)),
        source='{ force = "tip" }',
    ),
    Case(
        "moment a cantilever delivers to its clamp",
        BEAM | LOSSES,
        elements(arm=f'{BEAM_ELEMENT}, eta = "eta", c_f = "c_f", between = ["tip", "ground"], l = "l"'),
        "arm.tau",
        *SLENDER,
        # The moment on the beam's second end is +M; the clamp receives -M.
        span(
            lambda w, slope, moment, shear, v, s: (moment, shear - 1),
            clamped,
            lambda line, v: -line.at(v["l"])[2],
        ),
        source='{ force = "tip" }',
    ),
    Case(
        "one-link arm, tip",
        ARM,
        ARM_ELEMENTS,
        "tip",
        *SLENDER,
        span(hub, payload, second_end(0)),
        source='{ torque = "hub" }',
    ),
    Case(
        "beam element in tension on an elastic foundation, guided mass and spring",
        BEAM | {"N": "85 N", "k_f": "420 N/m^2", "m": "0.11 kg", "k": "900 N/m"},
        elements(
            arm=f'{BEAM_ELEMENT}, N = "N", k_f = "k_f", between = ["ground", "tip"], l = "l"',
            guide='type = "slider", at = "tip"',
            load='type = "mass", at = "tip", m = "m"',
            spring='type = "spring", between = ["tip", "ground"], k = "k"',
        ),
        "tip",
        *SLENDER,
        span(clamped, guided, second_end(0)),
        source='{ force = "tip" }',
    ),
    Case(
        "compressed beam element",
        BEAM | {"P": "75 N"},
        elements(arm=f'{BEAM_ELEMENT}, N = "-P", between = ["ground", "tip"], l = "l"'),
        "tip",
        *SLENDER,
        # Half the Euler load of the cantilever, pi^2 E I/(4 l^2) = 151 N.
        lambda v, s: span(clamped, free_with_force, second_end(0))(v | {"N": -v["P"]}, s),
        source='{ force = "tip" }',
    ),
    Case(
        "Rayleigh beam element with a rigid body",
        {name: THICK[name] for name in BEAM} | {"m": "0.8 kg", "J_b": "6e-4 kg*m^2", "c": "0.03 m"},
        elements(
            arm=f'{BEAM_ELEMENT}, theory = "rayleigh", between = ["ground", "tip"], l = "l"',
            body='type = "rigid_body", at = "tip", m = "m", J = "J_b", cg = "c"',
        ),
        "tip.theta",
        *STOCKY,
        span(clamped, body, second_end(1), rayleigh),
        source='{ force = "tip" }',
    ),
    Case(
        "Timoshenko element with all damping, clamped and pinned",
        THICK | {"eta": "3e-7 s", "c_f": "900 N*s/m^2", "k_f": "4e6 N/m^2"},
        elements(
            arm=f'{THICK_ELEMENT}, eta = "eta", c_f = "c_f", k_f = "k_f", l = "l", between = ["ground", "q"]',
            pin='type = "pin", at = "q"',
        ),
        "q.theta",
        *STOCKY,
        span(clamped, lambda w, slope, moment, shear, v, s: (w, moment - 1), second_end(1), timoshenko),
        source='{ torque = "q" }',
    ),
    Case(
        "free Timoshenko element, rotation across",
        THICK,
        elements(arm=f'{THICK_ELEMENT}, between = ["p", "q"], l = "l"'),
        "q.theta",
        *STOCKY,
        span(lambda w, slope, moment, shear, v, s: (moment, shear - 1), free, second_end(1), timoshenko),
        source='{ force = "p" }',
    ),
)


def held(motion: Form, force: Form, v: Values, s: Number) -> tuple[Form]:
    """An end that does not move."""
    return (motion,)


def loose(motion: Form, force: Form, v: Values, s: Number) -> tuple[Form]:
    """An end without load."""
    return (force,)


ELEMENTS_IN_TENSION_AND_TORSION = (
    Case(
        "rod element with a tip mass",
        ROD | {"m": "0.3 kg"},
        elements(
            bar=f'{ROD_ELEMENT}, between = ["ground", "tip"], l = "l"',
            load='type = "mass", at = "tip", m = "m"',
        ),
        "s*tip",
        *AXIAL,
        lambda v, s: (
            s * span(held, lambda u, f, v, s: (f + v["m"] * s**2 * u - 1,), second_end(0), rod)(v, s)
        ),
        source='{ force = "tip" }',
    ),
    Case(
        "rod element with damping on a spring and a damper",
        ROD | {"eta": "3e-7 s", "c_f": "700 N*s/m^2", "k_f": "4e6 N/m^2", "k": "2e7 N/m", "b": "900 N*s/m"},
        elements(
            bar=f'{ROD_ELEMENT}, eta = "eta", c_f = "c_f", k_f = "k_f", between = ["p", "q"], l = "l"',
            spring='type = "spring", between = ["p", "ground"], k = "k"',
            damper='type = "damper", between = ["p", "ground"], b = "b"',
        ),
        "p",
        *AXIAL,
        span(
            # Tension pulls the first end forward, spring and damper hold it back.
            lambda u, tension, v, s: (tension - (v["k"] + v["b"] * s) * u,),
            lambda u, tension, v, s: (tension - 1,),
            first_end(0),
            rod,
        ),
        source='{ force = "q" }',
    ),
    Case(
        "shaft element with damping",
        SHAFT | {"eta": "8e-7 s", "c_f": "0.02 N*m*s/m", "k_f": "300 N*m/m"},
        elements(
            axle=f'{SHAFT_ELEMENT}, eta = "eta", c_f = "c_f", k_f = "k_f", between = ["p", "q"], l = "l"'
        ),
        "q",
        *TORSION,
        span(loose, lambda angle, torque, v, s: (torque - 1,), second_end(0), shaft),
        source='{ torque = "q" }',
    ),
    Case(
        "string element with a mass and a dashpot at its end",
        STRING | {"m": "0.002 kg", "b": "0.4 N*s/m", "c_f": "0.15 N*s/m^2"},
        elements(
            wire=f'{STRING_ELEMENT}, c_f = "c_f", between = ["ground", "q"], l = "l"',
            bead='type = "mass", at = "q", m = "m"',
            loss='type = "damper", between = ["q", "ground"], b = "b"',
        ),
        "q",
        *TAUT,
        span(
            held,
            lambda w, force, v, s: (force + (v["m"] * s**2 + v["b"] * s) * w - 1,),
            second_end(0),
            string,
        ),
        source='{ force = "q" }',
    ),
)
