"""Input shapers: impulses by which a command is convolved, so that modes of a structure do not ring after it.

Input: certified poles, and which kind of shaper. Output: times and amplitudes, enclosed.

With the pole p = -sigma + j omega, tau = pi/omega and K = exp(-sigma tau), half a period later a motion has
the opposite sign and K times the size, so that two impulses cancel each other:

    zv     1, K            over 1 + K        at 0, tau           no vibration at p
    zvd    1, 2 K, K^2     over (1 + K)^2    at 0, tau, 2 tau    nor does it grow linearly with an error of p
    ei     1 + W, 2 (1 - W) K, (1 + W) K^2   at 0, tau, 2 tau    V is left at p, and less on both sides

Several modes take the convolution of their shapers. ZV and ZVD are of Singer and Seering (1990, Preshaping
command inputs to reduce system vibration), EI of Singhose, Seering and Singer (1990, Shaping inputs to reduce
vibration: a vector diagram approach); without damping W is V, with it W is such that the residual at p is V.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from flint import acb, arb

from symflex.analysis.time_response.step_info import TEXT_DIGITS
from symflex.balls import bits_for_digits, precision
from symflex.errors import Diagnostic, ModelError, counted, no_such, refused
from symflex.model.loss_factors import check_causal
from symflex.print.notebook import Printed
from symflex.print.roots import SHORT_DIGITS, TERMINAL_COLUMNS, PrintedRoot
from symflex.print.text import Passage
from symflex.roots import Everything, Modes, Root, decimals, figure
from symflex.roots.locate import locate
from symflex.transfer import AnyBoundFunction

SCHEMA = "symflex.shape/1"
TOLERANCE = 0.05  # residual vibration V that an EI shaper allows: the usual one in its literature
MORE_DIGITS = 24  # digits of poles beyond those printed: responses to long inputs lose a few
MORE_MODES = 8  # searched beyond those asked for, as some may not oscillate
MOST_IMPULSES = 2187  # most impulses: those of seven modes with three each
LEAST = 1e-300  # the smallest bound that is printed


def _ei(k: arb) -> tuple[arb, ...]:
    # The residual at p is W K^2 over the sum of the amplitudes; this makes it V.
    width = TOLERANCE * (1 + k) ** 2 / (4 * k * k - TOLERANCE * (1 - k) ** 2)
    return (1 + width, 2 * (1 - width) * k, (1 + width) * k * k)


SHAPERS: Mapping[str, Callable[[arb], tuple[arb, ...]]] = {
    "zv": lambda k: (arb(1), k),
    "zvd": lambda k: (arb(1), 2 * k, k * k),
    "ei": _ei,
}  # sizes of impulses, half a period apart, of each kind, from K


@dataclass(frozen=True, eq=False)
class InputShaper(Printed):
    """Impulses that sum to one, for the modes of one transfer function."""

    tf: str  # ``"OUT/IN"``
    kind: str  # a key of :data:`SHAPERS`
    poles: tuple[Root, ...]  # of the modes shaped for, with positive imaginary part
    impulses: tuple[tuple[arb, arb], ...]  # time [s] and amplitude of each
    digits: int
    bits: int  # of the precision all this was computed at
    note: str = ""  # what was requested and is not done

    @property
    def title(self) -> str:
        """What it is, such as ``ZVD shaper``."""
        return f"{self.kind.upper()} shaper"

    @property
    def times(self) -> tuple[float, ...]:
        """The times [s], to double precision."""
        return tuple(float(t.mid()) for t, _ in self.impulses)

    @property
    def amplitudes(self) -> tuple[float, ...]:
        """The amplitudes, to double precision."""
        return tuple(float(a.mid()) for _, a in self.impulses)

    def residual(self, pole: acb) -> arb:
        """Return the residual vibration of a mode relative to one impulse, for all poles in the ball."""
        with precision(self.bits):
            total = sum((a * (-pole * t).exp() for t, a in self.impulses), acb(0))
            return abs(total) * (pole.real * self.impulses[-1][0]).exp()

    def to_json_dict(self) -> dict[str, object]:
        """Return the shaper as ``symflex shape --json`` prints it."""

        def told(name: str, value: arb) -> dict[str, str]:
            printed = decimals(value, arb(0), self.digits)
            return {name: printed.re, f"{name}_radius": printed.radius}

        modes: list[dict[str, object]] = []
        for pole in self.poles:
            decimal = pole.decimal(self.digits)
            modes.append(
                {
                    "re": decimal.re,
                    "im": decimal.im,
                    "radius": decimal.radius,
                    "frequency_hz": pole.frequency_hz(),
                    "damping_ratio": pole.damping_ratio(),
                    **told("residual", self.residual(pole.enclosure())),
                }
            )
        impulses = [told("time", time) | told("amplitude", size) for time, size in self.impulses]
        of = {"tf": self.tf, "kind": self.kind, "joint": False}
        return {"schema": SCHEMA, **of, "modes": modes, "impulses": impulses}

    def __repr__(self) -> str:
        least = min(pole.frequency_hz() for pole in self.poles)
        many = f"{len(self.impulses)} impulses in {self.times[-1]:.4g} s"
        return f"<InputShaper {self.tf}: {self.title} from {least:.4g} Hz, {many}>"

    def passages(self) -> list[Passage]:
        """Return the modes with what is left of them, and the impulses."""
        digits = min(self.digits, TEXT_DIGITS)
        lines = []
        for pole in self.poles:
            residual = self.residual(pole.enclosure())
            # A bound below the range of doubles is none of 0.
            most = max(float(residual.upper()), LEAST)
            said = (
                f"at most {most:.2g}"
                if residual.contains(0)
                else figure(residual, SHORT_DIGITS, trimmed=True)
            )
            *_, frequency, damping = PrintedRoot(pole, is_pair=True).cells(TERMINAL_COLUMNS, digits)
            lines.append(f"  mode at {frequency} Hz, zeta {damping}: residual vibration {said}")
        rows = [("t [s]", "amplitude")]
        rows += [(figure(t, digits), figure(a, digits)) for t, a in self.impulses]
        heading = f"{self.tf}   {self.title}, {len(self.impulses)} impulses"
        notes = [f"  {self.note}"] if self.note else []
        return [Passage([heading, *notes]), Passage(lines), Passage([], rows)]


def input_shaper(
    bound: AnyBoundFunction, modes: int = 1, kind: str = "zv", digits: int = 15, *, joint: bool = False
) -> InputShaper:
    """Return a shaper for the lowest modes that oscillate.

    Parameters
    ----------
    bound : BoundTransferFunction or BoundNested
        Whose poles they are; proved.
    modes : int
        How many of them, by natural frequency.
    kind : str
        ``zv``, ``zvd`` or ``ei``.
    digits : int
        Of poles, times and amplitudes.
    joint : bool
        Older versions looked for one shaper for all modes together. It is the convolution either way, and a
        note says so.

    Raises
    ------
    UsageError
        SF902 for an unknown kind, or more modes than there are.
    ModelError
        SF814 where a mode cannot be distinguished from another, or is damped too much for the kind.

    Examples
    --------
    >>> from symflex import loads
    >>> arm = loads('symflex = 1' + chr(10) + 'inputs.u = {}' + chr(10) + 'outputs.y = "u/(s^2 + 9)"')
    >>> shaper = input_shaper(arm.transfer_function("y", "u").bind().bound)
    >>> [round(t, 6) for t in shaper.times], shaper.amplitudes  # half a period, and halves
    ([0.0, 1.047198], (0.5, 0.5))
    """
    if kind not in SHAPERS:
        raise no_such("shaper", kind, SHAPERS, "kinds")
    check_causal(bound.source.model, "an input shaper")
    region = Everything() if bound.is_rational else Modes(modes + MORE_MODES)
    located = locate(bound, region, digits + MORE_DIGITS).complete()
    ringing = [root for root in located.poles if root.im > 0]
    if modes < 1 or len(ringing) < modes:
        few = f"only {counted(len(ringing), 'oscillatory mode')}" if ringing else "no oscillatory mode"
        raise refused(f"{bound.name} has {few}, and --modes {modes} asks for {modes}")
    chosen = tuple(ringing[:modes])
    if not all(root.certified for root in chosen):
        message = f"modes of {bound.name} cannot be separated: none of them has a shaper of its own"
        raise ModelError(Diagnostic("SF814", message))
    bits = max(root.working_bits() for root in chosen) + bits_for_digits(digits)
    with precision(bits):
        impulses = [(arb(0), arb(1))]
        for root in chosen:
            of_mode = _of_mode(bound, root, kind)
            if len(impulses) * len(of_mode) > MOST_IMPULSES:
                message = f"the modes together need more than {MOST_IMPULSES} impulses"
                raise refused(message, "shape fewer modes")
            impulses = [(t + u, a * b) for t, a in impulses for u, b in of_mode]
        impulses.sort(key=lambda impulse: impulse[0].mid())
    note = "joint shapers are not computed: one for each mode, in series" if joint and modes > 1 else ""
    return InputShaper(bound.name, kind, chosen, tuple(impulses), digits, bits, note)


def _of_mode(bound: AnyBoundFunction, root: Root, kind: str) -> list[tuple[arb, arb]]:
    half = arb.pi() / root.im
    sizes = SHAPERS[kind]((root.re * half).exp())
    total = sum(sizes, arb(0))
    if not all(size / total > 0 for size in sizes):
        message = (
            f"the mode of {bound.name} at {root.frequency_hz():g} Hz is too strongly damped for '{kind}'"
        )
        raise ModelError(Diagnostic("SF814", message, None, "use zv, or no shaper: the mode hardly rings"))
    return [(half * i, size / total) for i, size in enumerate(sizes)]
