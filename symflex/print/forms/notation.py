"""Symbols and lines of what a form abbreviates: wavenumbers, kernels and the functions of laws along x."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count

from symflex.algebra import LAPLACE, Dispersion, Factored, Kernel, KernelTable, Ring
from symflex.expressions import (
    Call,
    Derivative,
    Equation,
    Expression,
    Name,
    Product,
    Quotient,
    names_in,
    negative,
    number,
    power,
    product_of,
    quotient,
    sum_of,
)
from symflex.print.forms.arrange import Arranger, ProductPrinter, length_sides
from symflex.print.forms.arranged import Arranged
from symflex.print.forms.kept import KeptDefinitions
from symflex.print.forms.naming import ALPHA, BETA, GAMMA, LAMBDA, Naming
from symflex.transfer import TransferFunction

Line = tuple[str, Expression]


@dataclass(frozen=True, slots=True, eq=False)
class Angle:
    """A wavenumber times a length, and the generators of its kernels by function."""

    wavenumber: str
    dispersion: Dispersion
    length: Factored
    kernels: Mapping[str, str]


@dataclass(frozen=True, slots=True, eq=False)
class Notation:
    """Symbols for generators, and the lines and laws that explain them."""

    symbols: Mapping[str, Expression]
    lines: tuple[Line, ...]
    laws: tuple[tuple[str, Equation], ...] = ()
    closed: tuple[tuple[Expression, Expression], ...] = ()  # what functions that laws determine are


def angles_of(table: KernelTable, used: Collection[str] | None = None) -> tuple[Angle, ...]:
    """Return the angles of which a kernel is used, in the order of the table."""
    groups: dict[tuple[str, Factored], list[Kernel]] = {}
    for kernel in table.kernels:
        if kernel.wavenumber:
            groups.setdefault((kernel.wavenumber, kernel.length), []).append(kernel)
    return tuple(
        Angle(w, kernels[0].dispersion, kernels[0].length, {k.function: k.generator for k in kernels})
        for (w, _), kernels in groups.items()
        if used is None or any(k.generator in used for k in kernels)
    )


def plain_printer(
    tf: TransferFunction, ring: Ring | None = None, arranged: Arranged | None = None
) -> ProductPrinter:
    """Return a printer for values of s and parameters alone."""
    own = ring or tf.ring
    arranger = Arranger.plain(own, constant_symbols(tf), (), KeptDefinitions.of(tf, own))
    return (arranged or Arranged()).printer(arranger)


def notation_of(
    tf: TransferFunction, used: Collection[str], naming: Naming, table: KernelTable | None = None
) -> Notation:
    """Return names for the arguments ``q = beta*l``, the wavenumbers and what these are made of."""
    printer = plain_printer(tf)
    angles = angles_of(table or tf.kernels, used)
    symbols: dict[str, Expression] = {}
    lines: list[Line] = []
    arguments = naming.take("q", len(angles))
    for q, angle in zip(arguments, angles, strict=True):
        symbols |= {g: Call(f, Name(q)) for f, g in angle.kernels.items()}
    waves = wave_notation(tf, [d for d in tf.kernels.dispersions if _occurs(d, used, angles)], naming)
    for q, angle in zip(arguments, angles, strict=True):
        wave = waves.symbols[angle.wavenumber]
        sharing = [a for a in angles if a.wavenumber == angle.wavenumber]
        is_alone = len(sharing) == 1 and angle.wavenumber not in used
        if is_alone and angle.dispersion.kind != "pair" and not angle.wavenumber.startswith(BETA):
            root = next(e for n, e in waves.lines if Name(n) == wave)
            waves = Notation(waves.symbols, tuple(line for line in waves.lines if Name(line[0]) != wave))
            lines.append((q, times_length(printer, root, angle.length)))
        else:
            lines.append((q, wave_times_length(printer, wave, angle.length)))
    decays, laws = other_kernels(tf, used, naming, printer)
    entries = entries_of_matrices(tf, used, naming, printer)
    symbols |= {**waves.symbols, **decays, **entries.symbols}
    return Notation(symbols, (*lines, *waves.lines), (*laws, *entries.laws), entries.closed)


def entries_of_matrices(
    tf: TransferFunction, used: Collection[str], naming: Naming, printer: ProductPrinter
) -> Notation:
    """Return entries of fundamental matrices, ``Z_12(l)``, what determines them, and their closed forms."""
    symbols: dict[str, Expression] = {}
    lines: list[tuple[str, Equation]] = []
    closed: list[tuple[Expression, Expression]] = []
    for d in tf.kernels.dispersions:
        kernels = [k for k in tf.kernels.kernels_of(d) if k.function == "entry" and k.generator in used]
        if not kernels:
            continue
        n, (start,) = d.order, d.start
        stem = next(s for s in _stems() if not any(name.startswith(f"{s}_") for name in naming.taken))
        apart = "" if n < 10 else "_"  # noqa: PLR2004  (indices of two digits need one between them)
        names_of_column = [f"{stem}_{i}{apart}j" for i in range(1, n + 1)]
        naming.keep([*names_of_column, f"{stem}_ij"])
        places: dict[Factored, list[tuple[int, int, Expression]]] = {}
        for kernel in kernels:
            i, j = divmod(kernel.order, n)
            place = printer.quotient(start + kernel.length)
            called = symbols[kernel.generator] = Call(f"{stem}_{i + 1}{apart}{j + 1}", place)
            places.setdefault(kernel.length, []).append((i, j, called))
        for name, row in zip(names_of_column, d.matrix, strict=True):
            terms = [
                product_of([printer.quotient(c), Name(other)])
                for c, other in zip(row, names_of_column, strict=True)
                if not c.is_zero
            ]
            lines.append((name, Equation(Derivative(name, 1), sum_of(terms))))
        first = number(0) if start.is_zero else printer.quotient(start)
        ends = Call(f"{stem}_ij", first)
        lines.append((ends.name, Equation(ends, Name("delta_ij"))))
        for j in () if d.singular is None else d.singular.free:
            for i, row in enumerate(d.singular.at_start() if d.singular else ()):
                if i != j and not row[j].is_zero:
                    entry = Call(f"{stem}_{i + 1}{apart}{j + 1}", first)
                    lines.append((entry.name, Equation(entry, printer.quotient(row[j]))))
        from symflex.print.forms.closed import closed_entries  # few members have laws along x

        closed += closed_entries(tf, d, places, naming, printer)
    return Notation(symbols, (), tuple(lines), tuple(closed))


def _stems() -> Iterator[str]:
    """Yield letters for matrices, and then several of them."""
    for length in count(1):
        yield from (letter * length for letter in "ZYXWV")


def _occurs(dispersion: Dispersion, used: Collection[str], angles: Iterable[Angle]) -> bool:
    return any(w in used for w in dispersion.wavenumbers) or any(a.dispersion is dispersion for a in angles)


def wave_times_length(printer: ProductPrinter, wave: Expression, length: Factored) -> Expression:
    """Return a wavenumber times a length."""
    above, below = length_sides(printer, length)
    return quotient(product_of([wave, above]), below)


def times_length(printer: ProductPrinter, root: Expression, length: Factored) -> Expression:
    """Return a length times what a wavenumber is, s in front."""
    above, below = length_sides(printer, length)
    top, bottom = (root.numerator, root.denominator) if isinstance(root, Quotient) else (root, number(1))
    factors = list(top.factors) if isinstance(top, Product) else [top]
    s = Name(LAPLACE)
    front = [s] if s in factors else []
    rest = [factor for factor in factors if factor != s]
    return quotient(product_of([*front, above, *rest]), product_of([below, bottom]))


def wave_notation(tf: TransferFunction, dispersions: Iterable[Dispersion], naming: Naming) -> Notation:
    """Return names for the wavenumbers, each with the line of its own definition before what that needs."""
    printer = plain_printer(tf)
    by_kind: dict[str, list[Dispersion]] = {"bending": [], "wave": [], "pair": []}
    for dispersion in dispersions:
        if dispersion.kind in by_kind:
            by_kind[dispersion.kind].append(dispersion)
    symbols: dict[str, Expression] = {}
    lines: list[Line] = []
    of_beta, bending = (
        [d for d in by_kind["bending"] if d.wavenumbers[0].startswith(BETA) is own] for own in (True, False)
    )
    for name, d in zip(naming.take(BETA, len(of_beta)), of_beta, strict=True):
        symbols[d.wavenumbers[0]] = Name(name)
        lines.append((name, fourth_root(printer.quotient(d.characteristic[0] / 4))))
    lossless = [d for d in bending if speed_squared(d) is not None]
    speeds = dict(zip(lossless, naming.take("a", len(lossless)), strict=True))
    for name, d in zip(naming.take(ALPHA, len(bending)), bending, strict=True):
        symbols[d.wavenumbers[0]] = Name(name)
        square = speed_squared(d)
        if square is None:
            lines.append((name, Call("sqrt", printer.square_root(d.characteristic[0] / 4))))
        else:
            a = speeds[d]
            lines.append((name, Call("sqrt", quotient(Name(LAPLACE), product_of([number(2), Name(a)])))))
            lines.append((a, printer.square_root(square)))
    for name, d in zip(naming.take(GAMMA, len(by_kind["wave"])), by_kind["wave"], strict=True):
        symbols[d.wavenumbers[0]] = Name(name)
        lines.append((name, printer.square_root(-d.characteristic[0])))
    pairs = by_kind["pair"]
    lambdas = naming.take(LAMBDA, 2 * len(pairs))
    deltas = naming.take("delta", len(pairs))
    for i, d in enumerate(pairs):
        names_of_pair = (lambdas[2 * i], lambdas[2 * i + 1])
        symbols |= {w: Name(n) for w, n in zip(d.wavenumbers, names_of_pair, strict=True)}
        own = pair_lines(names_of_pair, deltas[i], naming, [printer.quotient(c) for c in d.characteristic])
        position = next(k for k, known in enumerate(tf.kernels.dispersions) if known is d)
        symbols |= {coefficient_name(position, n): Name(own[-1 - n // 2][0]) for n in (0, 2)}
        lines += own
    return Notation(symbols, tuple(lines))


def fourth_root(value: Expression) -> Expression:
    """Return the fourth root of a value."""
    return Call("sqrt", Call("sqrt", value))


def pair_lines(
    waves: Sequence[str], delta: str, naming: Naming, printed: Sequence[Expression], *, on_axis: bool = False
) -> list[Line]:
    """Return the lines of a pair of wavenumbers, delta, ``c_2`` and ``c_0``; on the axis one wave travels."""
    c0, _, c2 = map(Name, naming.family("cbde", 3))
    half, root = quotient(c2, number(2)), Name(delta)
    return [
        (waves[0], Call("sqrt", sum_of([root, negative(half)]))),
        (waves[1], Call("sqrt", sum_of([root, half] if on_axis else [negative(half), negative(root)]))),
        (delta, Call("sqrt", sum_of([quotient(power(c2, 2), number(4)), negative(c0)]))),
        (c2.name, printed[2]),
        (c0.name, printed[0]),
    ]


def coefficient_name(dispersion: int, order: int) -> str:
    """Return the generator of a coefficient of a pair's characteristic polynomial."""
    return f"c{order}[{dispersion}]"


def speed_squared(dispersion: Dispersion) -> Factored | None:
    """Return ``s^2/c_0`` of a bending beam when it is free of s: E I/(rho A) without damping."""
    c0 = dispersion.characteristic[0]
    square = Factored.generator(c0.ring, LAPLACE) ** 2 / c0
    return None if square.depends_on(LAPLACE) else square


def other_kernels(
    tf: TransferFunction, used: Collection[str], naming: Naming, printer: ProductPrinter
) -> tuple[dict[str, Expression], tuple[tuple[str, Equation], ...]]:
    """Return exponentials, and fundamental functions with the laws that determine them."""
    symbols: dict[str, Expression] = {}
    for kernel in tf.kernels.kernels:
        if kernel.function == "exp":
            exponent = printer.quotient(kernel.dispersion.shift * kernel.length)
            symbols[kernel.generator] = Call("exp", negative(exponent))
    general = [
        d
        for d in tf.kernels.dispersions
        if any(k.function == "fundamental" and k.generator in used for k in tf.kernels.kernels_of(d))
    ]
    laws = []
    for name, d in zip(naming.take("h", len(general)), general, strict=True):
        for kernel in tf.kernels.kernels_of(d):
            if kernel.function == "fundamental":
                symbols[kernel.generator] = Call(name, printer.quotient(kernel.length), kernel.order)
        terms: list[Expression] = [Derivative(name, d.order)]
        for order in reversed(range(d.order)):
            c = d.characteristic[order]
            if not c.is_zero:
                terms.append(
                    product_of([printer.quotient(c), Derivative(name, order) if order else Name(name)])
                )
        laws.append((name, Equation(sum_of(terms), number(0))))
    return symbols, tuple(laws)


def wavenumber_laws(tf: TransferFunction) -> dict[str, Factored]:
    """Return per wavenumber a product of its power with s and parameters that is one."""
    laws = {}
    for d in tf.kernels.dispersions:
        if d.kind == "bending":
            (w,) = d.wavenumbers
            laws[w] = Factored.generator(tf.ratio.ring, w) ** 4 * 4 / d.characteristic[0]
        elif d.kind == "wave":
            (w,) = d.wavenumbers
            laws[w] = Factored.generator(tf.ratio.ring, w) ** 2 / -d.characteristic[0]
    return laws


def reachable(parts: Iterable[Expression], lines: Iterable[Line]) -> tuple[Line, ...]:
    """Return the lines whose names the parts use, or the lines they need, in the given order."""
    meanings = dict(lines)
    pending, used = list(parts), set()
    while pending:
        for node in names_in(pending.pop()):
            if isinstance(node, Name) and node.name in meanings and node.name not in used:
                used.add(node.name)
                pending.append(meanings[node.name])
    return tuple((name, e) for name, e in meanings.items() if name in used)


def constant_symbols(tf: TransferFunction) -> dict[str, Expression]:
    """Return what the generators of functions of constants print as."""
    return {c.generator: c.expression for c in tf.constants}
