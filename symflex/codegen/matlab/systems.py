"""Rational transfer functions as objects of the Control System Toolbox.

Input: a transfer function without kernels, but for one dead time of all of it.
Output: a function of its coefficients, and one that makes ``tf``, ``zpk`` or ``ss`` of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from symflex.algebra import LAPLACE, Factored
from symflex.codegen.matlab.expression import WIDTH, continued
from symflex.codegen.module_text import FORMULA_TERMS
from symflex.codegen.program import identifiers, wrapped
from symflex.expressions import Name, format_expression, number, substitute, sum_of
from symflex.print.forms.arrange import Arranger, coefficients
from symflex.print.forms.notation import constant_symbols, plain_printer
from symflex.transfer import TransferFunction

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping

    from flint import fmpz_mpoly

    from symflex.expressions import Expression
    from symflex.transfer import AnyTransferFunction

MOST_COEFFICIENTS: Final = 200


@dataclass(frozen=True, slots=True)
class RationalSystem:
    """A quotient of polynomials in s, and a dead time."""

    tf: TransferFunction  # what it is
    # num and den: coefficients by descending powers of s.
    num: tuple[Expression, ...]
    den: tuple[Expression, ...]
    delay: Expression  # [s]; the number 0 without one

    @staticmethod
    def of(tf: AnyTransferFunction) -> RationalSystem | None:
        """Return a transfer function as a rational one, None where it is none or too long to write out."""
        if not isinstance(tf, TransferFunction) or tf.is_large or tf.length > FORMULA_TERMS or tf.is_zero:
            return None
        exponentials = {k.generator: k for k in tf.kernels.kernels if k.function == "exp"}
        ring = tf.ratio.ring
        others = {*tf.kernels.generators, *(w for d in tf.kernels.dispersions for w in d.wavenumbers)}
        rest = Factored.number(ring, tf.ratio.unit)
        delays: list[Expression] = []
        for factor, exponent in tf.ratio.factors:
            one = Factored.polynomial(ring, factor)
            kernel = next((k for g, k in exponentials.items() if factor == ring.generator(g)), None)
            if kernel is None:
                if any(one.depends_on(name) for name in others if name in ring.index):
                    return None
                rest = rest * one**exponent
                continue
            delay = kernel.dispersion.shift * kernel.length * exponent
            delay = delay / Factored.generator(delay.ring, LAPLACE)
            if exponent < 0 or delay.depends_on(LAPLACE):
                return None
            delays.append(plain_printer(tf).quotient(delay))
        num, den = (_descending(tf, side.expand()) for side in (rest.numerator(), rest.denominator()))
        if max(len(num), len(den)) > MOST_COEFFICIENTS:
            return None
        return RationalSystem(tf, num, den, sum_of(delays) if delays else number(0))


def _descending(tf: TransferFunction, polynomial: fmpz_mpoly) -> tuple[Expression, ...]:
    """Return the coefficients of all powers of s, the highest first."""
    ring = tf.ratio.ring
    arranger = Arranger.plain(ring, constant_symbols(tf))
    parts = coefficients(ring, polynomial)
    return tuple(
        arranger.coefficient(parts[k]) if k in parts else number(0) for k in range(max(parts), -1, -1)
    )


def system_functions(
    system: RationalSystem,
    names: tuple[str, str],
    parameters: Mapping[str, str],
    reserved: Collection[str],
    string: Callable[[str], str],
) -> list[str]:
    """Return the function of the coefficients, and the one that makes a system of them.

    Parameters
    ----------
    system : RationalSystem
        What is written.
    names : (str, str)
        Of the two functions.
    parameters : mapping of str to str
        What the model's parameters are called in the code.
    reserved : collection of str
        Names that variables cannot have.
    string : callable
        Makes a literal of a text.
    """
    tf = system.tf
    used = [parameters[p.name] for p in tf.parameters]
    local = identifiers({n: n for n in ("num", "den", "delay")}, {*reserved, *parameters.values()})
    renamed: dict[str, Expression] = {name: Name(own) for name, own in parameters.items()}

    def text(expression: Expression) -> str:
        return format_expression(substitute(expression, renamed))

    def row(values: tuple[Expression, ...]) -> str:
        return f"[{', '.join(map(text, values))}]"

    made, read = names
    quoted = ", ".join(f"'{name}'" for name in used)
    lines = [
        *continued(f"function [{', '.join(local.values())}] = {read}(varargin)", ""),
        *wrapped(
            f"%{read.upper()}  Coefficients by descending powers of s, dead time [s].",
            WIDTH,
            "",
            "%   ",
        ),
        *continued(f"given = numbers(varargin, {{{quoted}}});", "  "),
    ]
    if used:
        lines += continued(f"[{', '.join(used)}] = given{{:}};", "  ")
    for name, value in zip(
        local.values(), (row(system.num), row(system.den), text(system.delay)), strict=True
    ):
        lines += continued(f"{name} = {value};", "  ")
    ends = f"{{{string(tf.input.name)}, {string(tf.output.name)}}}"
    units = ", ".join(
        string("" if end.dimension is None else str(end.dimension)) for end in (tf.input, tf.output)
    )
    more = [
        *continued(f"function value = {made}(varargin)", ""),
        *wrapped(
            f"%{made.upper()}  A system of kind 'tf', or of that named first: 'zpk', 'ss'.", WIDTH, "", "%   "
        ),
        "  kind = 'tf';",
        "  if mod(numel(varargin), 2) == 1 && ischar(varargin{1})",
        "    kind = varargin{1};",
        "    varargin(1) = [];",
        "  end",
        *continued(f"[num, den, delay] = {read}(varargin{{:}});", "  "),
        f"  ends = {ends};",  # strings are not broken over lines
        f"  units = {{{units}}};",
        "  value = system_of(kind, num, den, delay, ends, units);",
    ]
    return ["\n".join([*lines, "end", ""]), "\n".join([*more, "end", ""])]
