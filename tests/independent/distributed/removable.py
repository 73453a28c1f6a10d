"""Points where a wavenumber, or a difference of two, vanishes: 0/0 in formulas, nothing in the physics."""

from tests.independent.boundary_value import rod, string, timoshenko
from tests.independent.distributed.case import (
    BEAM,
    BEAM_ELEMENT,
    ROD,
    ROD_ELEMENT,
    STRING,
    STRING_ELEMENT,
    THICK,
    THICK_ELEMENT,
    Case,
    elements,
)
from tests.independent.distributed.elements_alone import held
from tests.independent.distributed.span import clamped, free_with_force, rayleigh, second_end, span

ALL_ONE = (1.0, (0.0, 0.0))


def pulled(motion, force, v, s):
    """A unit force on the second end of a rod or string."""
    return (force - 1,)


def cantilever(name, parameters, element, options, respond):
    """Return the driving point of a part held at one end, its parameters all one but for those given."""
    ones = {key: "1 " + written.partition(" ")[2] for key, written in parameters.items()}
    given = "".join(f', {key} = "{key}"' for key in options)
    part = elements(part=f'{element}{given}, between = ["ground", "q"], l = "l"')
    return Case(name, ones | options, part, "q", *ALL_ONE, respond, '{ force = "q" }')


BENDING = span(clamped, free_with_force, second_end(0))
RAYLEIGH = span(clamped, free_with_force, second_end(0), rayleigh)
SHEAR = span(clamped, free_with_force, second_end(0), timoshenko)
AXIAL = span(held, pulled, second_end(0), rod)
TAUT = span(held, pulled, second_end(0), string)

REMOVABLE = (
    # mu = 0
    (cantilever("beam", BEAM, BEAM_ELEMENT, {}, BENDING), 0),
    (cantilever("beam on a foundation", BEAM, BEAM_ELEMENT, {"k_f": "1 N/m^2"}, BENDING), 1j),
    (cantilever("beam in a viscous bed", BEAM, BEAM_ELEMENT, {"c_f": "1 N*s/m^2"}, BENDING), 0),
    (cantilever("beam in a viscous bed", BEAM, BEAM_ELEMENT, {"c_f": "1 N*s/m^2"}, BENDING), -1),
    # gamma = 0
    (cantilever("rod", ROD, ROD_ELEMENT, {}, AXIAL), 0),
    (cantilever("rod in a bed", ROD, ROD_ELEMENT, {"c_f": "2 N*s/m^2", "k_f": "1 N/m^2"}, AXIAL), -1),
    (cantilever("string on a foundation", STRING, STRING_ELEMENT, {"k_f": "1 N/m^2"}, TAUT), -1j),
    # lambda_1 = lambda_2 and both zero
    (cantilever("Timoshenko beam", THICK, THICK_ELEMENT, {}, SHEAR), 0),
    # lambda_1 = 0 alone: the cut-off frequency of shear, and the static beam in tension
    (cantilever("Timoshenko beam", THICK, THICK_ELEMENT, {}, SHEAR), 1j),
    (cantilever("beam in tension", BEAM, BEAM_ELEMENT, {"N": "2 N"}, BENDING), 0),
    # lambda_1^2 = lambda_2^2: N^2 = 4 E I rho A s^2, and N + rho I s^2 likewise
    (cantilever("beam in tension", BEAM, BEAM_ELEMENT, {"N": "2 N"}, BENDING), 1),
    (cantilever("beam in tension", BEAM, BEAM_ELEMENT, {"N": "2 N"}, BENDING), -1),
    (cantilever("Rayleigh beam", BEAM, BEAM_ELEMENT + ', theory = "rayleigh"', {}, RAYLEIGH), 2),
    (
        cantilever(
            "Rayleigh beam in tension", BEAM, BEAM_ELEMENT + ', theory = "rayleigh"', {"N": "1 N"}, RAYLEIGH
        ),
        1,
    ),
)
"""(case, s)"""
