"""What functions that are printed together share: printers, signs and definitions, each made once.

Input: the arranger of a form. Output: a printer that arranges a polynomial once, whichever function it is of.
Example: the functions of a model have one denominator, which is arranged for the first one.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from symflex.expressions import format_expression
from symflex.model import Model
from symflex.print.forms.arrange import Arranger, ProductPrinter
from symflex.print.forms.shapes import SumSigns
from symflex.transfer.derive import ClosedDefinitions
from symflex.transfer.of_model import UNASKED


@dataclass(frozen=True, eq=False)
class Arranged:
    """Printers of functions that are printed together; those of equal symbols are one, and arrange once."""

    _printers: dict[object, ProductPrinter] = field(default_factory=dict)
    _signs: dict[int, tuple[Model, SumSigns]] = field(default_factory=dict)
    definitions: ClosedDefinitions = field(default_factory=lambda: ClosedDefinitions(UNASKED))

    def printer(self, arranger: Arranger) -> ProductPrinter:
        """Return a printer that prints as a new one of the arranger does."""
        symbols = tuple((name, format_expression(e)) for name, e in sorted(arranger.names.items()))
        kept = arranger.kept and (arranger.kept.source.names, arranger.kept.place, arranger.kept.values)
        key = (arranger.ring.names, symbols, tuple(sorted(arranger.degrees.items())), arranger.apart, kept)
        return self._printers.setdefault(key, ProductPrinter(arranger))

    def signs(self, model: Model) -> SumSigns:
        """Return what turns sums of a model's formulas."""
        if id(model) not in self._signs:
            self._signs[id(model)] = model, SumSigns.of(model)
        return self._signs[id(model)][1]
