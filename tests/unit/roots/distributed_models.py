"""Distributed models for tests of roots, with values that make dimensionless numbers show."""

import functools

from symflex import pipeline

BEAM = 'E = "E", I = "I", rho = "rho", A = "A"'
PARAMETERS = """
symflex = 1
[parameters]
E   = "1 N/m^2"
I   = "1 m^4"
rho = "1 kg/m^3"
A   = "1 m^2"
l   = "1 m"
"""

# E I = rho A = l = 1: omega = x^2 with the textbooks' x = beta l, and s = 2 q^2 with the source's q.
SLIDING_FREE = f"""{PARAMETERS}
[elements]
arm   = {{ type = "beam", between = ["p", "q"], {BEAM}, l = "l" }}
slide = {{ type = "slider", at = "p" }}
[inputs]
F = {{ force = "p" }}
[outputs]
V_act = "s*p"
V_tip = "s*q"
"""

FREE = f"""{PARAMETERS}
[elements]
arm = {{ type = "beam", between = ["p", "q"], {BEAM}, l = "l" }}
[inputs]
F = {{ force = "p" }}
[outputs]
Y = "p"
"""

# c = sqrt(E/rho) = 1; the tip mass is half the rod's: x tan x = mu = rho A l/m = 2.
ROD = """
symflex = 1
[elements]
bar = { type = "rod", between = ["ground", "x"], E = "1 N/m^2", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }
tip = { type = "mass", at = "x", m = "0.5 kg" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""

# Both ends pinned: mode n has s^2 + eta omega^2 s + omega^2 = 0 with omega = (n pi)^2.
KELVIN_VOIGT = f"""{PARAMETERS}
eta = "0.004 s"
[elements]
arm  = {{ type = "beam", between = ["p", "q"], {BEAM}, l = "l", eta = "eta" }}
near = {{ type = "pin", at = "p" }}
far  = {{ type = "pin", at = "q" }}
[inputs]
M = {{ torque = "p.theta" }}
[outputs]
angle = "p.theta"
"""

# A loaded string on an elastic foundation, driven at the load: the wavenumber vanishes at s = +-j, no mode.
ON_A_FOUNDATION = """
symflex = 1
[elements]
load = { type = "mass", at = "x", m = "2 kg" }
[elements.line]
type    = "string"
between = ["ground", "x"]
N       = "1 N"
rho     = "1 kg/m^3"
A       = "1 m^2"
l       = "1 m"
k_f     = "1 N/m^2"
[inputs]
F = { force = "x" }
[outputs]
X = "x"
"""

# A line with series loss: sinh(gamma)/gamma over cosh(gamma), gamma^2 = (s + 1)(s + 3).
LINE = """
symflex = 1
[fields.v]
domain = ["0", "l"]
equation = "v'' = (s*T + 1)*(s*T + 3)/l^2*v"
conditions = ["v(0) = 0", "v'(l) = (s*T + 1)*u"]
[parameters]
T = "1 s"
l = "1 m"
[inputs]
u = { }
[outputs]
y = "v(l)"
"""

# s + 2 exp(-s/2) = 0, so s/2 = W_k(-1) for every branch k of Lambert's function.
DELAY_LOOP = """
symflex = 1
[signals]
y = "(r - 2*D*y)/s"
[blocks]
D = { type = "delay", T = "0.5 s" }
[inputs]
r = {}
[outputs]
out  = "y"
late = "D*y"
"""


@functools.cache
def bound(text, number=0):
    """Return the transfer function of a specification with its numbers."""
    model = pipeline.loads(text)
    return pipeline.derive_bound(model, model.transfer_functions)[number]
