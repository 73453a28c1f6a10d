"""Sensitivities of a loop, ``S = 1/(1 + L)`` and ``T = L/(1 + L)``, with their certified peaks."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from math import log10
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from symflex.analysis.response import default_band, grid_about
from symflex.errors import UncertifiedError
from symflex.figures.axes import Canvas, add_legend_above, root_figure, set_frequency_axis, write_title
from symflex.figures.loops import verdict_of_closed
from symflex.figures.style import COLOURS, COLUMN_INCHES, LINE_INCHES, QUIET, number_label, title_lines
from symflex.loops import AnyLoop, Loop, NetworkLoop, closed_loop_roots, loop_gain, nominal_gain
from symflex.loops.locus import is_straight
from symflex.loops.peak import loop_peaks
from symflex.roots import Band

HEIGHT_INCHES: Final = 2.4
LOWEST_DB: Final = 63.0  # magnitudes are shown from so far below 0 dB


def draw_sensitivity(loop: AnyLoop, canvas: Canvas) -> Figure:
    """Draw the sensitivities of a loop at its nominal gain, with their peaks where it is proved stable."""
    gain, width = nominal_gain(loop), canvas.width or COLUMN_INCHES
    verdict = verdict_of_closed(loop, gain)
    is_stable = verdict.word == "stable"
    said = None if is_stable and not canvas.frame.has_verdict else f"closed loop {verdict.headline}"
    lines = [line for one in (canvas.title, said) for line in title_lines(one, width)]
    axes = canvas.one_panel(HEIGHT_INCHES + LINE_INCHES * (len(lines) + 1))
    frequency, values = _loop_gains(loop, gain, canvas)
    found = None
    if is_stable and isinstance(loop, Loop) and is_straight(loop):
        with suppress(UncertifiedError):  # curves without marks then
            found = loop_peaks(loop, gain)
    peaks = (found.sensitivity, found.complementary_sensitivity) if found else ()
    axes.axhline(0, color=QUIET, linewidth=0.5, zorder=1)
    for i, (name, curve) in enumerate((("S", 1 / (1 + values)), ("T", values / (1 + values)))):
        label = f"$|{name}|$"
        if peaks and peaks[i].magnitude.is_finite():
            size = float(peaks[i].magnitude.mid())
            label += f", $M_{name} = {number_label(size)}$"
            axes.plot(peaks[i].frequency_hz, 20 * log10(size), "o", color=COLOURS[i], markersize=3, zorder=3)
        levels = 20 * np.log10(np.maximum(np.abs(curve), 1e-30))
        axes.plot(frequency, levels, color=COLOURS[i], linestyle=("-", "--")[i], label=label, zorder=2)
    low, high = axes.get_ylim()
    axes.set_ylim(*(canvas.frame.y or (max(low, -LOWEST_DB), high)))
    set_frequency_axis(axes, *(canvas.frame.x or (float(frequency[0]), float(frequency[-1]))))
    axes.grid(visible=True)
    axes.set_ylabel("Magnitude [dB]")
    add_legend_above(axes, 2, "\n".join(lines) if canvas.axes else None)
    if not canvas.axes:
        write_title(root_figure(axes), lines)
    return root_figure(axes)


def _loop_gains(
    loop: AnyLoop, gain: Fraction, canvas: Canvas
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.complex128]]:
    """Return frequencies [Hz], on which no peak of the closed loop is missed, and the loop gain there."""
    ends = (Fraction(0), gain)
    low, high = canvas.band_of(loop.model) or default_band(*(closed_loop_roots(loop, k) for k in ends))

    def values(omega: npt.NDArray[np.float64]) -> npt.NDArray[np.complex128]:
        if isinstance(loop, NetworkLoop):
            return np.array(loop.gains(gain, omega.tolist()), dtype=np.complex128)
        bound = loop_gain(loop, gain)
        return np.array([bound(1j * w) for w in omega.tolist()], dtype=np.complex128)

    band = Band(Fraction(low), Fraction(high))
    omega = np.union1d(*(grid_about(closed_loop_roots(loop, k, band), values, low, high) for k in ends))
    found = values(omega)
    kept = np.isfinite(found)
    return omega[kept] / (2 * np.pi), found[kept]
