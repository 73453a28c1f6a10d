"""Models that between them need everything a program tree can ask of a language."""

from functools import cache
from importlib.abc import InspectLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

from symflex import pipeline
from symflex.codegen.program.build import build_nested
from symflex.codegen.program.distributed import Pieces, series_uses
from tests.house.repository import specifications

DERIVATIONS = {p.stem: p for p in specifications(Path(__file__).parents[3] / "derivations", "**/*.toml")}

BAR = 'E = "70 GPa"\nI = "1e-8 m^4"\nrho = "2700 kg/m^3"\nA = "1e-4 m^2"\nl = "1 m"\n'
BEAM = 'type = "beam", E = "E", I = "I", rho = "rho", A = "A"'

# Two wavenumbers, pieces of complex s in a response in real arithmetic, and a definition that takes a name.
TWO_BEAMS = f"""symflex = 1
[parameters]
{BAR}l_2 = "0.3 m"
I_2 = "3e-8 m^4"
[elements]
arm = {{ {BEAM}, between = ["ground", "q"], l = "l" }}
end = {{ type = "beam", between = ["q", "r"], E = "E", I = "I_2", rho = "rho", A = "A", l = "l_2" }}
[inputs]
F = {{ force = "r" }}
[outputs]
X = "r"
"""

TENSION = f"""symflex = 1
[parameters]
{BAR}N = "500 N"
k_f = "1 kN/m^2"
[elements]
arm = {{ {BEAM}, between = ["ground", "q"], l = "l", N = "N", k_f = "k_f" }}
[inputs]
F = {{ force = "q" }}
[outputs]
X = "q"
"""

DELAY = """symflex = 1
parameters = { m = "2 kg", k = "300 N/m", g = "5 N*s/m", T_s = "5 ms" }
blocks.D = { type = "delay", T = "T_s" }
inputs.F = { force = "x" }
outputs.X = "x"
[elements]
body = { type = "mass", at = "x", m = "m" }
spring = { type = "spring", between = ["x", "ground"], k = "k" }
feedback = { type = "force_source", at = "x", f = "-g*D*s*x" }
"""

# Wavenumbers without a formula: sums over characteristic roots, power series, means over a circle.
PIPE = """symflex = 1
parameters = { EI = "100 N*m^2", m = "3 kg/m", m_f = "1 kg/m", U = "5 m/s", l = "2 m" }
inputs.p = { unit = "N/m" }
outputs.Y = "w(l/2)"
analysis.band = ["0.1 Hz", "20 Hz"]
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' + m_f*U^2*w'' + 2*m_f*U*s*w' + m*s^2*w = p"
conditions = ["w(0) = 0", "w''(0) = 0", "w(l) = 0", "w''(l) = 0"]
"""

# Roots that are equal at every s.
MASSLESS = """symflex = 1
parameters = { EI = "4e-3 N*m^2", N = "1 N", m = "0.1 kg", l = "1 m" }
inputs.F = { unit = "N" }
outputs.Y = "w(l)"
[fields.w]
domain = ["0", "l"]
equation = "EI*w'''' - N*w'' = 0"
conditions = ["w(0) = 0", "w'(0) = 0", "w''(l) = 0", "EI*w'''(l) - N*w'(l) = m*s^2*w(l) - F"]
"""


def _chain(count):
    """Return a chain of masses so long that powers of s overflow: it has a far branch."""
    lines = ["symflex = 1", "[parameters]", 'm = "1 kg"', 'k = "100 N/m"', 'b = "0.1 N*s/m"', "[elements]"]
    for i in range(count):
        below = f"x{i - 1}" if i else "ground"
        lines += [
            f'm{i} = {{ type = "mass", at = "x{i}", m = "m" }}',
            f'k{i} = {{ type = "spring", between = ["x{i}", "{below}"], k = "k" }}',
            f'b{i} = {{ type = "damper", between = ["x{i}", "ground"], b = "b" }}',
        ]
    lines += ["[inputs]", 'F = { force = "x0" }', "[outputs]", 'X = "x0"']
    return "\n".join([*lines, "[analysis]", 'band = ["0.1 Hz", "100 Hz"]', ""])


def free_chain(count, m="2 kg", k="3 kN/m", b="", outputs=None):
    """Return a chain of equal masses that a force drives at one end, with dampers where they have a value."""
    parameters = {"m": m, "k": k} | ({"b": b} if b else {})
    lines = ["symflex = 1", "[parameters]", *(f'{name} = "{value}"' for name, value in parameters.items())]
    lines += ["[elements]", *(f'M{i} = {{ type = "mass", at = "x{i}", m = "m" }}' for i in range(count))]
    for i in range(count - 1):
        between = f'between = ["x{i}", "x{i + 1}"]'
        lines.append(f'K{i} = {{ type = "spring", {between}, k = "k" }}')
        lines += [f'B{i} = {{ type = "damper", {between}, b = "b" }}'] if b else []
    lines += ["[inputs]", 'F = { force = "x0" }', "[outputs]", outputs or f'X = "x{count - 1}"']
    return "\n".join([*lines, ""])


SPECS = {
    "two_beams": TWO_BEAMS,
    "tension": TENSION,
    "delayed": DELAY,
    "pipe_with_flow": PIPE,
    "massless_beam": MASSLESS,
    "chain": _chain(12),
}


@cache
def derived(name):
    """Return a model and its transfer functions."""
    model = pipeline.load(DERIVATIONS[name]) if name in DERIVATIONS else pipeline.loads(SPECS[name])
    return model, pipeline.derive_all(model)


def program_of(tf):
    """Return the program of a function with kernels that is used where nothing is measured."""
    if tf.is_nameless:
        (solved,) = pipeline.derive_nested(tf.model, [(tf.output.name, tf.input.name)])
        return build_nested(solved)
    return Pieces(tf).of_s(series_uses(tf, is_measured=False)[0])


def public_name(tf):
    return f"{tf.output.name}_over_{tf.input.name}"


class _Loader(InspectLoader):
    """Loads a module from text."""

    def __init__(self, text):
        self.text = text

    def get_source(self, fullname):
        return self.text

    def is_package(self, fullname):
        return False


def executed(text):
    """Return what generated Python defines."""
    loader = _Loader(text)
    module = module_from_spec(spec_from_loader("generated", loader))
    loader.exec_module(module)
    return vars(module)
