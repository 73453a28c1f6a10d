"""Rods with E A = rho A = l = 1, whose transfer functions have expansions in every textbook."""

import functools

from symflex import pipeline

# Clamped at one end, driven at the other: X/F = tanh(s)/s, and 1/cosh(s) of it arrives at the wall.
CLAMPED_ROD = """
symflex = 1
inputs.F = { force = "x" }
outputs = { X = "x", V = "s*x", F_wall = "bar.f" }
[elements]
bar = { type = "rod", between = ["x", "ground"], E = "1 N/m^2", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }
"""

# Free at both ends: Y/F = 1/(s*sinh(s)).
FREE_ROD = """
symflex = 1
elements.bar = { type = "rod", between = ["x", "y"], E = "1 N/m^2", A = "1 m^2", rho = "1 kg/m^3", l = "1 m" }
inputs.F = { force = "x" }
outputs.Y = "y"
"""


@functools.cache
def bound(text, tf):
    model = pipeline.loads(text)
    return pipeline.derive_bound(model, [tuple(tf.split("/"))])[0]


@functools.cache
def rational(expression):
    """Return y/u, bound, for y = expression * u."""
    return bound(f'symflex = 1\ninputs.u = {{}}\noutputs.y = "({expression})*u"', "y/u")
