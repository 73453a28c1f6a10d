"""Models whose roots are known in closed form."""

import symflex

OSCILLATOR = """
symflex = 1
title = "Mass on a spring and a damper"
[parameters]
m = "1 kg"
k = "1 N/m"
b = { value = "0.5 N*s/m", assume = "nonnegative" }
f = "2 Hz"
[elements]
mass   = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
damper = { type = "damper", between = ["x", "ground"], b = "b" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
W = "f*x"
"""

TWO_RESONANCES = """
symflex = 1
[parameters]
k_1 = 1
k_2 = 4
[signals]
y = "(1/(s^2 + k_1) + 1/(s^2 + k_2))*u"
[inputs]
u = {}
[outputs]
Y = "y"
"""

STEEL = """
symflex = 1
[parameters]
E = "200 GPa"
I = "4000 mm^4"
rho = "7850 kg/m^3"
A = "480 mm^2"
"""
BEAM = (
    STEEL
    + """l = "1.086 m"
m = { value = "1 kg", assume = "nonnegative" }
[elements]
arm   = { type = "beam", between = ["p", "q"], E = "E", I = "I", rho = "rho", A = "A", l = "l" }
slide = { type = "slider", at = "p" }
tip   = { type = "mass", at = "q", m = "m" }
[inputs]
F = { force = "p" }
[outputs]
V = "s*p"
"""
)

SLIDING_FREE = BEAM.replace('tip   = { type = "mass", at = "q", m = "m" }\n', "").replace(
    'm = { value = "1 kg", assume = "nonnegative" }\n', ""
)

LOOP = """
symflex = 1
[parameters]
K = 1
T = 1
[signals]
y = "K/(s*(T*s + 1)*(s + 2))*(r - y)"
[inputs]
r = {}
[outputs]
Y = "y"
"""


# Y/u is 1/((s + 1)(1 - c)): there is none at c = 1.
ALGEBRAIC = """
symflex = 1
[parameters]
c = { value = 0.5, assume = "real" }
[signals]
y = "u/(s + 1) + c*y"
[inputs]
u = {}
[outputs]
Y = "y"
"""


def oscillator():
    return symflex.loads(OSCILLATOR)
