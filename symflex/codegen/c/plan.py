"""How to compute a sum of exponentials of characteristic roots, as a table of numbers that C code follows.

Input: the frames of a sum.
Output: numbers in the order in which ``cx_modal`` reads them. What
:func:`~symflex.algebra.modal_sum.modal_amplitudes` finds out as it goes, which terms come together after
each slot, is in the table.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symflex.codegen.program.nodes import Frames


def modal_plan(frames: Frames) -> tuple[list[int], int]:
    """Return the table of a sum, and how many partial sums are kept at a time.

    Parameters
    ----------
    frames : tuple
        Slots, terms and keys of every frame, as in :class:`symflex.codegen.program.ModalValue`.

    Examples
    --------
    Two terms over the two roots of one mode, c_0 h + c_1 h':

    >>> modal_plan((((0,), (((0,), 0), ((1,), 1)), (((0,), 1), ((1,), 1))),))
    ([1, 1, 0, 2, 1, 0, 0, 1, 0, 2, 0, 1, 2, 0, 1, 1, 1], 3)
    """
    plan, most = [len(frames)], 0
    for slots, terms, keys in frames:
        plan += [len(slots), *slots]
        left = [orders for orders, _ in terms]
        kept = len(left)
        for _ in slots:
            rest = list(dict.fromkeys(orders[1:] for orders in left))
            places = {orders: i for i, orders in enumerate(rest)}
            plan += [len(left), len(rest)]
            for orders in left:
                plan += [orders[0], places[orders[1:]]]
            left = rest
            kept += len(left)
        most = max(most, kept)
        plan += [len(terms), *(i for _, i in terms), len(keys)]
        for key, divisor in keys:
            plan += [*key, divisor]
    return plan, most
