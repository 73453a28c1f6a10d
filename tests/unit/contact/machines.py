"""Machines whose driving-point functions are known by hand."""

from symflex import pipeline

LAGGED = """symflex = 1
[parameters]
K = "20.5 N/m"
tau = "50 ms"
b = "1 N*s/m"
[elements]
body = { type = "mass", at = "x", m = "1 kg" }
friction = { type = "damper", between = ["x", "ground"], b = "b" }
motor = { type = "force_source", at = "x", f = "-K/(tau*s + 1)*x" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
[ports]
tip = { at = "x" }
"""
"""``Re Z = b - K tau/(1 + (omega tau)^2)``."""
DELAYED = LAGGED.replace("-K/(tau*s + 1)*x", "-K*exp(-s*tau)*x")
"""``Re Z = b - K sin(omega tau)/omega``."""
ARM = """symflex = 1
[parameters]
T = "0.2 s"
EI = "1 N*m^2"
eta = "0.002 s"
[elements]
hub = { type = "inertia", at = "h.theta", J = "0.05 kg*m^2" }
pin = { type = "pin", at = "h" }
arm = { type = "beam", between = ["h", "tip"], EI = "EI*(1 + eta*s)", rhoA = "1 kg/m", l = "1 m" }
servo = { type = "torque_source", at = "h.theta", tau = "-(K + D*s)*exp(-s*T)*h.theta" }
[definitions]
K = "4 N*m"
D = "0.4 N*m*s"
[inputs]
F = { force = "tip" }
[outputs]
X = "tip"
[ports]
tip = { at = "tip" }
"""
"""A pinned beam with a hub, PD control with a delay and damping in the beam."""


def machine(text=LAGGED, **values):
    return pipeline.loads(text, settings={name: str(value) for name, value in values.items()})
