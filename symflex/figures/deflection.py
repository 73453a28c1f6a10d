"""Operating deflection shapes: how a model moves at a frequency under an input, drawn as mode shapes are."""

from __future__ import annotations

from cmath import phase
from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING

from symflex.analysis.modes import Deflection, deflection
from symflex.errors import Diagnostic, ModelError, refused
from symflex.figures.axes import Canvas
from symflex.figures.modes import draw_shapes, label_of_value, unit_of_reference
from symflex.figures.runs import panels_of
from symflex.figures.style import TIGHT_DOT, label_of_name, label_of_unit, power_of_ten
from symflex.transfer.transfer_function import quotient_of_units

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from symflex.model.model import Input
    from symflex.transfer import AnyBoundFunction


def draw_deflections(bounds: Sequence[AnyBoundFunction], canvas: Canvas) -> Figure:
    """Draw the motion under each input of these functions at each frequency that is asked for.

    What moves in phase with the input is drawn in full, what moves in quadrature dashed.
    """
    if not canvas.frame.at or canvas.band_hz:
        hint = 'as in --at 30Hz, or at = "30 Hz" in [figures]'
        raise refused("a deflection needs frequencies, and takes no band", hint)
    model = bounds[0].source.model
    of_inputs = {bound.source.input.name: bound for bound in bounds}.values()
    pairs = [(bound.source.input, deflection(bound, at)) for bound in of_inputs for at in canvas.frame.at]
    shapes = [shape for _, shape in pairs]
    if not panels_of(model, shapes):
        raise ModelError(Diagnostic("SF402", "nothing that moves could be drawn"))
    return draw_shapes(model, shapes, [_heading(*pair) for pair in pairs], canvas)


def _heading(source: Input, shape: Deflection) -> str:
    """Return the frequency, and the largest displacement over the input with its phase."""
    amplitude = complex(shape.amplitude)
    unit = label_of_unit(quotient_of_units(unit_of_reference(shape) or "1", source.unit or "1"))
    size = f"${power_of_ten(f'{abs(amplitude):.3g}', TIGHT_DOT)}$ {unit}".rstrip()
    turned = f"${label_of_value(degrees(phase(amplitude)), 3).replace('-180', '180')}$\N{DEGREE SIGN}"
    hertz = f"${label_of_value(float(shape.frequency_hz), 4)}$ Hz"
    return f"{hertz}, largest {size}, {turned} from ${label_of_name(source.name)}$"
