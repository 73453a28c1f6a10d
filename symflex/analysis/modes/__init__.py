"""Motion of everything at a pole or under an input, taken from the equations and enclosed in balls."""

from symflex.analysis.modes.deflection import deflection
from symflex.analysis.modes.find import lowest_modes, mode_shape, mode_shapes
from symflex.analysis.modes.shape import Deflection, DistributedShape, EnclosedModeShape, EnclosedShape
