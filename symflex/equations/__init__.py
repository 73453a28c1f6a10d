"""The linear equations ``A(s) x + B u = 0`` of a model, over an exact ring."""

from symflex.equations.assemble import assemble
from symflex.equations.equations import ConstantFunction, Continuum, Equations, radicals_of
