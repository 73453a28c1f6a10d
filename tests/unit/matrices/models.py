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


def state_space(
    a: list[list[str]], b: list[list[str]], c: list[list[str]], d: list[list[str]] | None = None
) -> Model:
    """Return the model of state equations, whose numbers are written as decimals."""
    states, inputs = [f"x_{i}" for i in range(len(a))], [f"u_{j}" for j in range(len(b[0]))]

    def combined(rows: list[list[str]], more: list[list[str]]) -> list[str]:
        sums = []
        for row, others in zip(rows, more, strict=True):
            parts = zip([*row, *others], [*states, *inputs], strict=True)
            sums.append(" + ".join(f"({x})*{name}" for x, name in parts if float(x)) or "0")
        return sums

    laws = [f'"s*{x} = {e}"' for x, e in zip(states, combined(a, b), strict=True)]
    reads = combined(c, d or [["0"] * len(inputs) for _ in c])
    return model_of(
        "\n".join(
            [
                "symflex = 1",
                "[equations]",
                f"unknowns = [{', '.join(f'{chr(34)}{x}{chr(34)}' for x in states)}]",
                f"equations = [{', '.join(laws)}]",
                "[inputs]",
                *(f"{u} = {{}}" for u in inputs),
                "[outputs]",
                *(f'y_{i} = "{e}"' for i, e in enumerate(reads)),
            ]
        )
    )


def of_functions(*rows: list[str]) -> Model:
    """Return the model of a matrix of functions of s."""
    inputs = [f"u_{j}" for j in range(len(rows[0]))]
    sums = (" + ".join(f"({g})*{u}" for g, u in zip(row, inputs, strict=True)) for row in rows)
    return model_of(
        "\n".join(
            [
                "symflex = 1",
                "[inputs]",
                *(f"{u} = {{}}" for u in inputs),
                "[outputs]",
                *(f'y_{i} = "{e}"' for i, e in enumerate(sums)),
            ]
        )
    )


def numbers(text: str) -> list[list[str]]:
    """Return a matrix that is written with a row a line."""
    return [line.split() for line in text.strip().splitlines()]
