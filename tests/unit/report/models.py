"""Models for the tests of reports, small and odd."""

SMALL = """
symflex = 1
title = "Two masses"
parameters = { m_1 = "3 kg", m_2 = "2 kg", k = "24 N/m", b = "0.1 N*s/m" }
inputs  = { F = { force = "x" } }
outputs = { X = "x", Y = "y" }
[elements]
one  = { type = "mass", at = "x", m = "m_1" }
two  = { type = "mass", at = "y", m = "m_2" }
link = { type = "spring", between = ["x", "y"], k = "k" }
loss = { type = "damper", between = ["x", "y"], b = "b" }
[analysis]
band = ["0.1 Hz", "2 Hz"]
[figures.one]
kind = "poles_zeros"
of = ["X/F"]
"""

# Everything that a person can write freely is written so that it would do harm where it is not escaped.
HOSTILE = r"""
symflex = 1
title = "</title><script>alert(1)</script>\" onload=\"x \\input{/etc/passwd} $x$ %{}_^~#& \u202e"
source = "<img src=http://evil/x> \\write18{ls} ]]> <!-- javascript:alert(1)"
[parameters]
m = { value = "2 kg", doc = "</td></table><script src='//evil'></script> \\end{document} \\write18{id}" }
k = { value = "18 N/m", doc = "中文 emoji 😀" }
[elements]
body = { type = "mass", at = "x", m = "m" }
wall = { type = "spring", between = ["x", "ground"], k = "k" }
[inputs]
F = { force = "x" }
[outputs]
X = "x"
script = "s*x"
[published."X/F"]
expr = "1/(m*s^2 + 2*k)"
source = "<script>alert(2)</script> \\csname end\\endcsname"
[analysis]
band = ["0.1 Hz", "2 Hz"]
[figures.f]
kind = "poles_zeros"
title = "<script>alert(3)</script> $\\frac{ \\input{x}"
of = ["X/F"]
[figures.later]
kind = "nyquist"
[ports]
hand = { at = "x", doc = "<script>alert(4)</script> \\input{x}" }
"""

SYMBOLIC = """
symflex = 1
parameters = { m = {} }
inputs  = { F = { force = "x" } }
outputs = { X = "x" }
[elements]
one  = { type = "mass", at = "x", m = "m" }
"""

PENDULUM = """
symflex = 1
parameters = { J = "2 kg*m^2", w = "3 N*m", q = "30 deg" }
inputs  = { tau = { unit = "N*m" } }
outputs = { Theta = "theta" }
[equations]
unknowns  = ["theta"]
equations = ["J*theta'' + w*sin(theta) = tau"]
[operating_point]
theta = "q"
solve = ["tau"]
"""
