"""The sliding-free beam with any printed formula.

The right formulas are those of Eppinger & Seering 1988, with 6*C^2 and 1/2 in the colocated one, as an
independent boundary-value solve confirms to 30 digits.
"""

from functools import cache

from symflex import pipeline
from symflex.audit import audit

COLOCATED = "-1/2*sqrt(2/p)*((S^2 + C^2)^2 + 2*S^2 + 6*C^2 + 1)/((S^2 + C^2)^2 - 4*C*S - 1)"
TIP = "-2*sqrt(2/p)*C*(S^2 + C^2 + 1)/((S^2 + C^2)^2 - 4*C*S - 1)"
SCALE = "1/(rho*A*a)"
VAUGHAN = {
    "S": "exp(-sqrt(T*p))*sin(sqrt(T*p))",
    "C": "exp(-sqrt(T*p))*cos(sqrt(T*p))",
    "p": "s/a",
    "a": "sqrt(E*I/(rho*A))",
    "T": "l^2/2",
}
KRYLOV = {"mu": "(rho*A*s^2/(4*E*I))^(1/4)", "q": "mu*l"}

VALUES = {"E": "200 GPa", "I": "4000 mm^4", "rho": "7850 kg/m^3", "A": "480 mm^2", "l": "1.086 m"}
_BEAM = """
symflex = 1
parameters = { %s }
[elements]
arm   = { type = "beam", between = ["act", "tip"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
slide = { type = "slider", at = "act" }
[inputs]
F = { force = "act" }
[outputs]
V_act = "s*act"
V_tip = "s*tip"
[analysis]
band = ["0.1 Hz", "1 kHz"]
"""


def specification(output, expr, where=None, scale=None, *, has_values=True):
    lines = [f'[published."{output}/F"]', f'expr = "{expr}"']
    if where:
        lines += ["where = { " + ", ".join(f'{n} = "{e}"' for n, e in where.items()) + " }"]
    if scale:
        lines += [f'scale = "{scale}"']
    parameters = ", ".join(f'{n} = "{value}"' if has_values else f"{n} = {{}}" for n, value in VALUES.items())
    return _BEAM % parameters + "\n".join(lines) + "\n"


def audited(output, expr, where=None, scale=None):
    """Return what is found without values: nothing is measured, which takes most of the time."""
    return _audited(specification(output, expr, where, scale, has_values=False))


def measured(output, expr, where=None, scale=None):
    """Return what is found with values, deviations and laws of the imaginary axis included."""
    return _audited(specification(output, expr, where, scale))


@cache
def _audited(text):
    (found,) = audit(pipeline.loads(text))
    return found
