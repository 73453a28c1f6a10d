"""Models that tests of matrices share."""

from symflex.errors import Source
from symflex.model import Model, load_model

TWO_MASSES = """
symflex = 1
[parameters]
m_1 = "2 kg"
m_2 = "1 kg"
k_1 = "30 N/m"
k_2 = "20 N/m"
[elements]
one = { type = "mass", at = "x_1", m = "m_1" }
two = { type = "mass", at = "x_2", m = "m_2" }
base = { type = "spring", between = ["x_1", "ground"], k = "k_1" }
link = { type = "spring", between = ["x_1", "x_2"], k = "k_2" }
[inputs]
F_1 = { force = "x_1" }
F_2 = { force = "x_2" }
[outputs]
X_1 = "x_1"
X_2 = "x_2"
"""

BEAM = """
symflex = 1
[parameters]
EI = "800 N*m^2"
rhoA = "3.1 kg/m"
l = "0.9 m"
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' + rhoA*s^2*w = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "EI*w'''(l) = -F"]
[inputs]
F = {}
[outputs]
tip = "w(l)"
middle = "w(l/2)"
"""


def model_of(text: str) -> Model:
    return load_model(Source("model.toml", text))
