"""Beams written as fields."""

from tests.independent.distributed.case import BEAM, DAMPED, EULER, LOSSES, SLENDER, STOCKY, THICK, Case, ode
from tests.independent.distributed.span import (
    beam_with_load,
    clamped,
    first_end,
    free,
    free_with_force,
    inside,
    pinned,
    rayleigh,
    second_end,
    sliding,
    sliding_with_force,
    span,
    tip_mass_and_dashpot,
)

FIELDS_IN_BENDING = (
    Case(
        "sliding-free, tip",
        BEAM,
        ode(EULER, "w'(0) = 0", "E*I*w'''(0) = u", "w''(l) = 0", "w'''(l) = 0"),
        "s*w(l)",
        *SLENDER,
        lambda v, s: s * span(sliding_with_force, free, second_end(0))(v, s),
    ),
    Case(
        "clamped-free, driving point",
        BEAM,
        ode(EULER, "w(0) = 0", "w'(0) = 0", "w''(l) = 0", "E*I*w'''(l) = -u"),
        "w(l)",
        *SLENDER,
        span(clamped, free_with_force, second_end(0)),
    ),
    Case(
        "clamped-free with damping, deflection inside",
        BEAM | LOSSES | {"x_s": "0.35 m"},
        ode(DAMPED, "w(0) = 0", "w'(0) = 0", "w''(l) = 0", "E*I*(1 + eta*s)*w'''(l) = -u"),
        "w(x_s)",
        *SLENDER,
        span(clamped, free_with_force, inside(0, "x_s")),
    ),
    Case(
        "clamped-sliding under a distributed load, moment at the clamp",
        BEAM | LOSSES,
        ode(
            "E*I*(1 + eta*s)*w'''' + (rho*A*s^2 + c_f*s)*w = u",
            "w(0) = 0",
            "w'(0) = 0",
            "w'(l) = 0",
            "w'''(l) = 0",
        ),
        "E*I*(1 + eta*s)*w''(0)",
        *SLENDER,
        span(clamped, sliding, first_end(2), beam_with_load),
    ),
    Case(
        "clamped-pinned, base motion, reaction at the pin",
        BEAM,
        ode(EULER, "w(0) = u", "w'(0) = 0", "w(l) = 0", "w''(l) = 0"),
        "-E*I*w'''(l)",
        *SLENDER,
        span(
            lambda w, slope, moment, shear, v, s: (w - 1, slope), pinned, lambda line, v: -line.at(v["l"])[3]
        ),
    ),
    Case(
        "Kelvin-Voigt cantilever with tip mass and dashpot",
        BEAM | LOSSES | {"m": "0.11 kg", "b": "0.6 N*s/m"},
        ode(
            DAMPED, "w(0) = 0", "w'(0) = 0", "w''(l) = 0", "E*I*(1 + eta*s)*w'''(l) = (m*s^2 + b*s)*w(l) - u"
        ),
        "w(l)",
        *SLENDER,
        span(clamped, tip_mass_and_dashpot, second_end(0)),
    ),
    Case(
        "cantilever in tension",
        BEAM | {"N": "85 N"},
        ode(
            "E*I*w'''' - N*w'' + rho*A*s^2*w = 0",
            "w(0) = 0",
            "w'(0) = 0",
            "w''(l) = 0",
            "E*I*w'''(l) - N*w'(l) = -u",
        ),
        "w(l)",
        *SLENDER,
        span(clamped, free_with_force, second_end(0)),
    ),
    Case(
        "sliding-pinned Rayleigh beam",
        {name: THICK[name] for name in BEAM},
        ode(
            "E*I*w'''' - rho*I*s^2*w'' + rho*A*s^2*w = 0",
            "w'(0) = 0",
            "E*I*w'''(0) = u",
            "w(l) = 0",
            "w''(l) = 0",
        ),
        "w(0)",
        *STOCKY,
        # The end does not turn, so the rotary inertia's part of V vanishes there.
        span(sliding_with_force, pinned, first_end(0), rayleigh),
    ),
    Case(
        "beam on an elastic and viscous foundation",
        BEAM | {"k_f": "420 N/m^2", "c_f": "1.3 N*s/m^2"},
        ode(
            "E*I*w'''' + (rho*A*s^2 + c_f*s + k_f)*w = 0",
            "w''(0) = 0",
            "E*I*w'''(0) = u",
            "w''(l) = 0",
            "w'''(l) = 0",
        ),
        "w(l)",
        *SLENDER,
        span(lambda w, slope, moment, shear, v, s: (moment, shear - 1), free, second_end(0)),
    ),
)
