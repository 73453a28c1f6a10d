"""The values of a transfer function by every form it has, for the comparison with its model's equations.

Input: a transfer function, symbolic or with numbers.
Output: an :class:`Agreement`, which evaluates its forms at a point that the equations choose.

Example: ``1/(m s^2 + k)`` has a closed form and an expanded one; both must have the value of the equations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from flint import acb, acb_mat

from symflex.algebra import LAPLACE, NO_KERNELS, Dispersion, Factored, PolynomialMemo
from symflex.balls import Arithmetic, at_centre, current_bits, plan
from symflex.transfer.against_equations import Agreement
from symflex.transfer.bound import BoundTransferFunction
from symflex.transfer.direct_solve import GeneratorValues, Point, along_x, carried
from symflex.transfer.transfer_function import ClosedForm, TransferFunction


def agreement(tf: TransferFunction | BoundTransferFunction) -> Agreement:
    """Return what a transfer function says: in its closed form, in its expanded one, and by its two parts."""
    source = tf if isinstance(tf, TransferFunction) else tf.source
    # A definition that divides by s, as of a viscoelastic stiffness, adds poles once it is opened.
    definitions = source.solve.direct.equations.definitions if source.solve is not None else ()
    is_opened = not isinstance(tf, TransferFunction) and any(
        value.denominator().depends_on(LAPLACE) for _, value in definitions
    )
    determinant = partial(_determinant, tf) if tf.is_rational and not is_opened else None
    return Agreement((source.output.name, source.input.name), partial(_values, tf), determinant)


def _values(tf: TransferFunction | BoundTransferFunction, here: Point, known: Mapping[str, acb]) -> list[acb]:
    """Return the values of all forms; that of a large function is not opened."""
    values = []
    if (closed := _closed(tf)) is not None:
        num, den = _sides(closed, here, known)
        values.append(num / den)
    if not tf.is_rational:
        ratio, num, den = _with_kernels(tf, here, known)
        values += [ratio, num / den]
    elif not isinstance(tf, TransferFunction) or tf.reduced is not None:
        values.append(GeneratorValues(dict(known), here.whole)(tf.ratio))
    if not isinstance(tf, TransferFunction) and tf.is_rational:
        values.append(replace(tf.enclosed(current_bits()), root=None)(here.s()))
    return values


def _determinant(tf: TransferFunction | BoundTransferFunction, here: Point, known: Mapping[str, acb]) -> acb:
    """Return the denominator times what cancelled from it."""
    number, closed = GeneratorValues(dict(known), here.whole), _closed(tf)
    determinant = number(tf.den) if closed is None else _sides(closed, here, known)[1]
    if not tf.hidden:
        return determinant  # nothing is opened for the names of its ring
    ring = tf.ring if isinstance(tf, TransferFunction) else tf.ratio.ring
    for hidden in tf.hidden:
        determinant = determinant * number.polynomial(hidden.polynomial, ring.names) ** hidden.multiplicity
    return determinant


def _closed(tf: TransferFunction | BoundTransferFunction) -> ClosedForm | None:
    return tf.closed if isinstance(tf, TransferFunction) else None


def _sides(closed: ClosedForm, here: Point, known: Mapping[str, acb]) -> tuple[acb, acb]:
    number = GeneratorValues(dict(known), integers := dict(here.whole))
    for name, opened in closed.closure.sums if integers else ():
        if (integer := number.integer(opened, closed.closure.base.names)) is not None:
            integers[name] = int(integer)
    return closed.sides(number.values, number.polynomial)


def _with_kernels(
    tf: TransferFunction | BoundTransferFunction, here: Point, known: Mapping[str, acb]
) -> tuple[acb, acb, acb]:
    """Return the values of a transfer function with kernels, of its numerator and of its denominator."""
    from symflex.algebra.modal_sum import ModalSums  # only with beams
    from symflex.transfer.enclose_kernels import KernelValues

    ring, table = tf.ratio.ring, tf.kernels
    numbers: dict[str, Arithmetic] = {
        n: x.real if (x := known[n]).imag == 0 else x for n in ring.names if n in known and n != LAPLACE
    }
    kernels = KernelValues(ring.names, table, numbers, ModalSums(ring, NO_KERNELS), PolynomialMemo(plan))
    values = kernels.at(here.s())
    source = tf if isinstance(tf, TransferFunction) else tf.source
    along = along_x(source.model, source.constants)
    matrices: dict[tuple[Dispersion, Factored], acb_mat] = {}
    for kernel in table.kernels:
        law = kernel.dispersion
        if kernel.function == "entry":
            if (law, kernel.length) not in matrices:
                columns, reach = tuple(zip(*law.matrix, strict=True)), (law.start[0], kernel.length)
                matrices[law, kernel.length] = carried(
                    columns, reach, GeneratorValues(dict(known)), along, here
                )
            values[kernel.generator] = matrices[law, kernel.length][divmod(kernel.order, law.order)]
    ratio, above, below = (at_centre(kernels.value(x, values)) for x in (tf.ratio, tf.num, tf.den))
    return ratio, above, below
