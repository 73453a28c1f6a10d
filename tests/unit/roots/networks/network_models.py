"""Networks the tests of this folder share, and their maps."""

from symflex import pipeline
from symflex.model import with_numbers
from symflex.roots.networks.network import network_of
from symflex.roots.networks.poles_zeros import locate_in_network
from symflex.roots.passivity import energy_proof
from symflex.roots.region import Modes

BEAM = 'type = "beam", E = "70 GPa", I = "1e-8 m^4", rho = "2700 kg/m^3", A = "1e-4 m^2"'
"""E I = 700 N m^2, rho A = 0.27 kg/m."""


def specification(elements, inputs='F = { force = "a" }', outputs='X = "a"'):
    """Return a model of elements, one a line, with an input and an output."""
    return f"symflex = 1\n[elements]\n{elements}\n[inputs]\n{inputs}\n[outputs]\n{outputs}\n"


def equations_of(text):
    """Return the equations with numbers in place."""
    return pipeline.assemble_sparse(with_numbers(pipeline.loads(text), in_kernels=True))


def network(text, output="X", source="F"):
    """Return the network between an input and an output."""
    return network_of(
        equations := equations_of(text), output, source, is_passive=energy_proof(equations.model).is_passive
    )


def located(text, region=None, digits=12, output="X", source="F"):
    """Return poles and zeros."""
    pair = (output, source)
    where = region or Modes(4)
    equations = equations_of(text)
    return locate_in_network(
        equations, "/".join(pair), pair, where, digits, is_default=False, energy=energy_proof(equations.model)
    )


def omegas(roots):
    """Return the imaginary parts above 0, as doubles."""
    return [float(root.im) for root in roots if root.im > 0]
