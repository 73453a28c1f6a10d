"""Matrices of transfer functions: exact, in symbols and with numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import index
from typing import TYPE_CHECKING, Any, NoReturn, SupportsIndex

from symflex import matrices as matrices_layer
from symflex.api.analyses import band_in_hertz, budget_of
from symflex.api.root import Root, RootTable
from symflex.api.toolboxes import refuse_attribute
from symflex.api.transfer_function import (
    BoundNestedTransferFunction,
    BoundTransferFunction,
    NestedTransferFunction,
    Number,
    TransferFunction,
)
from symflex.errors import no_such, refused
from symflex.expressions import Name, quotient
from symflex.model import Model
from symflex.options import RootsOptions, checked_digits
from symflex.print.forms import print_part
from symflex.print.read_back import read_back
from symflex.print.sympy import symbols_of, to_sympy
from symflex.roots.region import region_of
from symflex.transfer import BoundNested
from symflex.transfer import NestedTransferFunction as Nested

if TYPE_CHECKING:
    import numpy as np
    import sympy
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from symflex.analysis.norms.closed_loops import ClosedLoops
    from symflex.analysis.norms.energy import H2Norm
    from symflex.analysis.norms.reduced import ReducedModel
    from symflex.figures import AxesGiven
    from symflex.loops.peak import Peak
    from symflex.options import Ends, Stated

Place = int | str


def _position(place: object, names: tuple[str, ...], what: str) -> int:
    if isinstance(place, str):
        if place not in names:
            raise no_such(what, place, names)
        return names.index(place)
    if isinstance(place, slice | Sequence) or place is Ellipsis:
        hint = "transfer_matrix(outputs, inputs) has the rows and columns that you name"
        raise refused(f"an entry has one {what}, not several", hint)
    if isinstance(place, bool) or not isinstance(place, SupportsIndex):
        raise refused(f"{what}s have names and whole numbers, not {place!r}"[:200])
    number = index(place)
    if not -len(names) <= number < len(names):
        raise refused(f"there is no {what} {number}: they count from 0 to {len(names) - 1}")
    return number % len(names)


class _Indexed:
    """What both kinds of matrices tell of themselves."""

    if TYPE_CHECKING:

        @property
        def exact(self) -> matrices_layer.TransferMatrix | matrices_layer.BoundMatrix:
            """The matrix of :mod:`symflex.matrices`."""

        @property
        def outputs(self) -> tuple[str, ...]:
            """Names of the outputs, a row each."""

        @property
        def inputs(self) -> tuple[str, ...]:
            """Names of the inputs, a column each."""

    @property
    def shape(self) -> tuple[int, int]:
        """How many outputs and how many inputs there are."""
        return self.exact.shape

    def _pair(self, key: object) -> Any:  # noqa: ANN401 (one of four functions)
        if not isinstance(key, tuple) or len(key) != 2:  # noqa: PLR2004 (row and column)
            raise refused("an entry has two indices", 'write G[0, 1] or G["y", "u"]')
        i, j = _position(key[0], self.outputs, "output"), _position(key[1], self.inputs, "input")
        return self.exact.pairs[i][j]


@dataclass(frozen=True)
class TransferMatrix(_Indexed):
    """``y = N(s)/d(s) u``: all functions of some outputs and inputs, exact, over one denominator.

    Parameters
    ----------
    exact : symflex.matrices.TransferMatrix
        The matrix.

    Examples
    --------
    >>> import symflex
    >>> model = symflex.loads('''
    ... symflex = 1
    ... parameters = { m_1 = {}, m_2 = {}, k = {} }
    ... elements.motor = { type = "mass", at = "x", m = "m_1" }
    ... elements.tip = { type = "mass", at = "y", m = "m_2" }
    ... elements.link = { type = "spring", between = ["x", "y"], k = "k" }
    ... inputs = { F = { force = "x" }, P = { force = "y" } }
    ... outputs = { X = "x", Y = "y" }
    ... ''')
    >>> G = model.transfer_matrix()
    >>> G.shape, G["Y", "F"].num, G.den
    ((2, 2), k, s**2*(k*(m_1 + m_2) + m_1*m_2*s**2))
    >>> G.num
    Matrix([
    [k + m_2*s**2,            k],
    [           k, k + m_1*s**2]])
    >>> G.inverse().to_sympy()
    Matrix([
    [k + m_1*s**2,           -k],
    [          -k, k + m_2*s**2]])
    >>> G.det()
    1/(s**2*(k*(m_1 + m_2) + m_1*m_2*s**2))
    """

    exact: matrices_layer.TransferMatrix

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            refuse_attribute(self, name, BoundTransferMatrix)

    def __reduce__(self) -> tuple[object, ...]:
        return _derive_again, (self.exact.model, self.outputs, self.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, a row each."""
        return tuple(o.name for o in self.exact.outputs)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, a column each."""
        return tuple(i.name for i in self.exact.inputs)

    def __getitem__(self, key: tuple[Place, Place]) -> TransferFunction | NestedTransferFunction:
        """Return one function, by the numbers or the names of its output and input."""
        tf = self._pair(key)
        return NestedTransferFunction(tf) if isinstance(tf, Nested) else TransferFunction(tf)

    @cached_property
    def _form(self) -> matrices_layer.MatrixForm:
        return matrices_layer.print_matrix(self.exact)

    @cached_property
    def _symbols(self) -> dict[str, sympy.Symbol]:
        return symbols_of(self.exact.model)

    @property
    def den(self) -> sympy.Expr:
        """The common denominator d(s); 1 where nested functions have several."""
        return to_sympy(self._form.den, self._symbols)

    @property
    def num(self) -> sympy.ImmutableMatrix:
        """The numerators over it."""
        import sympy

        rows, columns = self.shape
        entries = [[self._form.entry(i, j).num for j in range(columns)] for i in range(rows)]
        return sympy.ImmutableMatrix([[to_sympy(e, self._symbols) for e in row] for row in entries])

    @property
    def where(self) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
        """The names that ``num`` and ``den`` introduce or keep, with their expressions."""
        lines = self._form.where
        return tuple((to_sympy(Name(n), self._symbols), to_sympy(e, self._symbols)) for n, e in lines)

    def to_sympy(self) -> sympy.ImmutableMatrix:
        """Return the matrix in SymPy, each entry its numerator over the common denominator."""
        return matrices_layer.matrix_sympy(self.exact, self._form)

    def latex(self, form: str | None = None, *, width: float | str | None = None) -> str:
        """Return the matrix in LaTeX: on one line, or as a display for a column of a width in mm."""
        from symflex.print.latex import width_of

        made = self._form if form is None else matrices_layer.print_matrix(self.exact, form)
        if width is None:
            return matrices_layer.matrix_latex(self.exact, made)
        return matrices_layer.matrix_display(self.exact, made, width_of(width))

    def to_latex(self) -> str:
        """Return the matrix in LaTeX on one line, as :meth:`latex`."""
        return self.latex()

    def to_json_dict(self, form: str | None = None) -> dict[str, object]:
        """Return what ``symflex derive --matrix --json`` prints."""
        made = self._form if form is None else matrices_layer.print_matrix(self.exact, form)
        return matrices_layer.matrix_json(self.exact, made)

    def __str__(self) -> str:
        return matrices_layer.matrix_text(self.exact, self._form)

    def __repr__(self) -> str:
        rows, columns = self.shape
        return f"<TransferMatrix {rows} x {columns}: {', '.join(self.outputs)} / {', '.join(self.inputs)}>"

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def det(self) -> sympy.Expr:
        """Return the determinant of a square matrix, exact and in lowest terms; 0 where it is singular.

        Raises
        ------
        UsageError
            SF902 when the matrix is not square.
        """
        tf = matrices_layer.determinant(self.exact)
        form = print_part(tf)
        read_back(tf, form)
        whole = to_sympy(quotient(form.num, form.den), self._symbols)
        lines = {to_sympy(Name(n), self._symbols): to_sympy(e, self._symbols) for n, e in form.where}
        for name in reversed(lines):
            whole = whole.subs(name, lines[name])
        return whole

    @property
    def normal_rank(self) -> int:
        """The rank at almost every s, proved: so many outputs can be imposed by as many inputs."""
        return matrices_layer.impose_all(self.exact).rank

    def smith_mcmillan(self) -> tuple[sympy.Expr, ...]:
        """Return the entries on the diagonal of the Smith-McMillan form but for zeros, in symbols.

        They are up to factors without s. Denominators have the poles, numerators the zeros.

        Raises
        ------
        ModelError
            SF910 for beams, rods, delays and roots of s.
        BudgetError
            SF501 for too many minors.
        """
        form = matrices_layer.smith_mcmillan(self.exact)
        entries = matrices_layer.in_expressions(self.exact, form)
        return tuple(to_sympy(entry, self._symbols) for entry in entries)

    def inverse(self) -> TransferMatrix:
        """Return the inputs that follow from imposed outputs, exact and in lowest terms.

        Raises
        ------
        UsageError
            SF902 when the matrix is not square.
        ModelError
            SF237 when it is singular at every s, with its normal rank.
        """
        return TransferMatrix(matrices_layer.inverse(self.exact))

    def return_difference(self) -> TransferMatrix:
        """Return I + L for a square matrix L of open loops, which minus closes from outputs to inputs.

        ``det()`` of it is zero at the poles of the closed loops, and its ``inverse()`` is their sensitivity.

        Examples
        --------
        >>> import symflex
        >>> L = symflex.loads('''
        ... symflex = 1
        ... parameters = { k = {}, q = {} }
        ... inputs = { u = {}, v = {} }
        ... outputs = { y = "k*u/s + q*v/s", z = "k*v/s - q*u/s" }
        ... ''').transfer_matrix()
        >>> L.return_difference().det()
        (k**2 + 2*k*s + q**2 + s**2)/s**2

        Raises
        ------
        UsageError
            SF902 when the matrix is not square.
        """
        return TransferMatrix(matrices_layer.return_difference(self.exact))

    def interaction(self) -> matrices_layer.Interaction:
        """Return static gains, static decoupling and relative gains at s = 0; ``print`` shows them.

        Raises
        ------
        ModelError
            SF237 as :meth:`inverse`; SF910 for beams, rods and roots of s.
        """
        return matrices_layer.interaction(self.exact)

    def export(self, target: str = "numpy", name: str = "") -> str:
        """Return code of all functions and of the matrix, as ``symflex export --matrix`` writes it.

        Parameters
        ----------
        target : str
            ``numpy``, ``array-api``, ``jax``, ``c``, ``matlab``, ``julia`` or ``js``.
        name : str
            The file's name without suffix.

        Raises
        ------
        UsageError
            SF902 for another target.
        """
        from symflex.codegen.export import Language  # imports numpy
        from symflex.codegen.exporters import EXPORTERS

        exporter = EXPORTERS.get(target)
        if not isinstance(exporter, Language):
            known = [key for key, language in EXPORTERS.items() if isinstance(language, Language)]
            raise no_such("target", target, known)
        model = self.exact.model
        rows = tuple(tuple(f"{y}/{u}" for u in self.inputs) for y in self.outputs)
        made = matrices_layer.derive_matrix(model, self.outputs, self.inputs, solves=exporter.solves)
        return replace(exporter, rows=rows).export(model, made.each, name).text

    def bind(self, **values: Number) -> BoundTransferMatrix:
        """Return the matrix with the declared values, or the given ones, as a function does."""
        return BoundTransferMatrix(self.exact.bind(values))

    def at(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Return values with the declared parameters; see :meth:`BoundTransferMatrix.at`."""
        return self.bind().at(s)


@dataclass(frozen=True)
class BoundTransferMatrix(_Indexed):
    """A transfer matrix with numbers.

    Parameters
    ----------
    exact : symflex.matrices.BoundMatrix
        The matrix.
    """

    exact: matrices_layer.BoundMatrix

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            refuse_attribute(self, name)

    def __reduce__(self) -> tuple[object, ...]:
        values = {name: value for bound in self.exact.each for name, value in bound.values}
        return _bind_again, (TransferMatrix(self.exact.source), values)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, a row each."""
        return tuple(o.name for o in self.exact.source.outputs)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, a column each."""
        return tuple(i.name for i in self.exact.source.inputs)

    def __getitem__(self, key: tuple[Place, Place]) -> BoundTransferFunction | BoundNestedTransferFunction:
        """Return one function, by the numbers or the names of its output and input."""
        bound = self._pair(key)
        if isinstance(bound, BoundNested):
            return BoundNestedTransferFunction(bound.source, bound.values)
        return BoundTransferFunction(bound)

    def __repr__(self) -> str:
        rows, columns = self.shape
        names = f"{', '.join(self.outputs)} / {', '.join(self.inputs)}"
        return f"<BoundTransferMatrix {rows} x {columns}: {names}>"

    def at(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Return values to double precision, an array of the matrix's shape followed by that of s [rad/s]."""
        return self.exact.at(s)

    def __call__(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Return :meth:`at`."""
        return self.at(s)

    def rga(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Return the relative gain array at complex frequencies [rad/s], of the shape of :meth:`at`.

        Not a number where the matrix is singular, or has a pole.

        Examples
        --------
        >>> import symflex
        >>> model = symflex.loads('''
        ... symflex = 1
        ... inputs = { u = {}, v = {} }
        ... outputs = { y = "(u + v)/(s + 1)", z = "(u - v)/(s + 2)" }
        ... ''')
        >>> model.transfer_matrix().bind().rga(0).real
        array([[0.5, 0.5],
               [0.5, 0.5]])
        """
        return self.exact.relative_gains(s)

    def characteristic_loci(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Return the eigenvalues of a square matrix at points [rad/s] in a row, of shape (n, points).

        Each is followed from point to point. On a Nyquist contour they encircle -1, all together, as often
        as det(I + L) does 0.
        """
        return self.exact.characteristic_loci(s)

    def roots(
        self,
        modes: int | None = None,
        *,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> matrices_layer.MatrixRoots:
        """Return poles and zeros of the whole matrix, with its normal rank, and the directions of its zeros.

        Parameters and errors are those of :meth:`BoundTransferFunction.poles`. What is returned prints as a
        table; see :class:`symflex.matrices.MatrixRoots`.

        Examples
        --------
        >>> import symflex
        >>> model = symflex.loads('''
        ... symflex = 1
        ... inputs = { u = {}, v = {} }
        ... outputs = { y = "u/(s + 1) + 2*v/(s + 3)", z = "u/(s + 1) + v/(s + 1)" }
        ... ''')
        >>> roots = model.transfer_matrix().bind().roots()
        >>> [complex(zero) for zero in roots.located.zeros], roots.normal_rank
        ([(1+0j)], 2)
        >>> [complex(x) for x in roots.directions[0].inputs]
        [(1+0j), (-1+0j)]
        """
        given = RootsOptions(None, modes, mode, band)
        with budget_of(budget).besides().entered():
            found = matrices_layer.locate_matrix(
                self._stated, self.outputs, self.inputs, region_of(given), checked_digits(digits)
            )
        found.located.complete()
        return found

    def poles(
        self,
        modes: int | None = None,
        *,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> tuple[Root, ...]:
        """Return the poles of the matrix, as often as in the minors of the matrix; see :meth:`roots`."""
        located = self.roots(modes, mode=mode, band=band, digits=digits, budget=budget).located
        return RootTable(map(Root, located.all_poles))

    def zeros(
        self,
        modes: int | None = None,
        *,
        mode: int | None = None,
        band: tuple[float, float] | None = None,
        digits: int = 15,
        budget: float | None = None,
    ) -> tuple[Root, ...]:
        """Return the transmission zeros; see :meth:`roots`."""
        located = self.roots(modes, mode=mode, band=band, digits=digits, budget=budget).located
        return RootTable(map(Root, located.zeros))

    @property
    def _stated(self) -> Model:
        """The model with these values."""
        model = self.exact.source.model
        values = {name: value for bound in self.exact.each for name, value in bound.values}
        stated = tuple(replace(p, value=values.get(p.name, p.value)) for p in model.parameters)
        return replace(model, parameters=stated)

    def singular_values(self, s: ArrayLike) -> NDArray[np.float64]:
        """Return all singular values at complex frequencies [rad/s], the largest first.

        The array has the shape (how many) + that of s; not a number at poles.

        Examples
        --------
        >>> import symflex
        >>> model = symflex.Model(inputs={"u": {}, "v": {}}, outputs={"y": "3*u", "z": "4*v"})
        >>> model.transfer_matrix().bind().singular_values(0)
        array([4., 3.])
        """
        import numpy as np  # binding needs none of it

        rows, columns = self.shape
        values = np.moveaxis(self.at(s), (0, 1), (-2, -1))
        is_known = np.isfinite(values).all(axis=(-2, -1))
        found = np.full((*is_known.shape, min(rows, columns)), np.nan)
        found[is_known] = np.linalg.svd(values[is_known], compute_uv=False)
        return np.moveaxis(found, -1, 0)

    def condition_number(self, s: ArrayLike) -> NDArray[np.float64]:
        """Return the largest over the smallest singular value at complex frequencies [rad/s]."""
        import numpy as np  # binding needs none of it

        values = self.singular_values(s)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(values[0] / values[-1])

    def sigma_plot(self, *, band: Ends | None = None, ax: AxesGiven | None = None) -> Figure:
        """Return a figure of the singular values over frequency, in a band [Hz]."""
        return self._drawn("sigma", band, ax)

    def rga_plot(self, *, band: Ends | None = None, ax: AxesGiven | None = None) -> Figure:
        """Return a figure of the magnitudes of all relative gains over frequency, in a band [Hz]."""
        return self._drawn("rga", band, ax)

    def poles_zeros_plot(self, *, band: Ends | None = None, ax: AxesGiven | None = None) -> Figure:
        """Return a figure of poles and transmission zeros in the s plane, up to the end of a band [Hz]."""
        return self._drawn("poles_zeros", band, ax)

    def nyquist_plot(self, *, band: Ends | None = None, ax: AxesGiven | None = None) -> Figure:
        """Return a figure of the characteristic loci, with the point -1, in a band [Hz]."""
        return self._drawn("nyquist", band, ax)

    def _drawn(self, kind: str, band: Ends | None, ax: AxesGiven | None) -> Figure:
        from symflex.figures import draw

        each = [pair for pair in self.exact.each if not pair.is_zero]
        return draw(kind, each, band_hz=band_in_hertz(band), ax=ax, model=self._stated, is_matrix=True)

    def peak(self, *, band: Ends | None = None) -> Peak:
        """Return the largest singular value over all frequencies, or in a band [Hz], enclosed.

        Examples
        --------
        >>> import symflex
        >>> outputs = {"y": "(u + v)/(s + 1)", "z": "(u - v)/(s + 1)"}
        >>> model = symflex.Model(inputs={"u": {}, "v": {}}, outputs=outputs)
        >>> float(model.transfer_matrix().bind().peak().magnitude.mid())  # sqrt(2)
        1.41421...
        """
        from symflex.analysis.norms.matrix_peak import find_matrix_peak

        return find_matrix_peak(self.exact.pairs, band)

    def closed_loops(self) -> ClosedLoops:
        """Close a loop from each output to the input in its place, with minus, all at once.

        Returns whether they are stable together, how often det(I + L) encircles 0 clockwise, and the largest
        singular values of S, T and S - T with the disk margin, all proved.

        Examples
        --------
        >>> import symflex
        >>> outputs = {"y": "u/(s + 1) + 2*v/(s + 3)", "z": "u/(s + 1) + v/(s + 1)"}
        >>> loops = symflex.Model(inputs={"u": {}, "v": {}}, outputs=outputs).transfer_matrix().bind()
        >>> found = loops.closed_loops()
        >>> found.closed.word, found.encirclements, round(float(found.peaks.disk["alpha"].mid()), 4)
        ('stable', 0, 1.5299)
        """
        from symflex import pipeline

        return pipeline.closed_loops(self._stated, self.outputs, self.inputs)

    def h2(self, noise: str = "") -> H2Norm:
        """Return the H2 norm of the matrix; see :meth:`BoundTransferFunction.h2`."""
        from symflex.analysis.norms.energy import find_h2_norm, noise_filter

        return find_h2_norm(self.exact.pairs, noise_filter(self.exact.source.model, noise), noise)

    def reduced(
        self, modes: int | None = None, *, error: Stated | None = None, band: Ends | None = None
    ) -> ReducedModel:
        """Return state equations of a few modes, with a proved error of the matrix and of each pair.

        Parameters and errors are those of :meth:`BoundTransferFunction.reduced`.
        """
        from symflex.analysis.norms.reduced import reduced_model

        return reduced_model(self.exact.pairs, modes, error, band_in_hertz(band))

    def dcgain(self) -> NDArray[np.float64]:
        """Return the limits for s -> 0 from the right, each proved to the last digit."""
        import numpy as np

        rows, columns = self.shape
        gains = [[self[i, j].dcgain() for j in range(columns)] for i in range(rows)]
        return np.array(gains, dtype=float)

    def to_control(self) -> object:
        """Return a ``control.TransferFunction`` with all inputs and outputs, named.

        Coefficients are the doubles nearest to the exact ones; :meth:`Model.state_space` loses fewer digits.

        Raises
        ------
        ModelError
            SF235 for beams, rods and delays; SF233 when a coefficient does not fit in double precision.
        UsageError
            SF902 when python-control is not installed.
        """
        rows, columns = self.shape
        single: list[list[Any]] = [[self[i, j].to_control() for j in range(columns)] for i in range(rows)]
        kind = type(single[0][0])
        num = [[system.num[0][0] for system in row] for row in single]
        den = [[system.den[0][0] for system in row] for row in single]
        return kind(num, den, inputs=list(self.inputs), outputs=list(self.outputs))


def _derive_again(model: Model, outputs: tuple[str, ...], inputs: tuple[str, ...]) -> TransferMatrix:
    """Return a matrix for a copy, or for another process: its ring cannot be pickled."""
    return TransferMatrix(matrices_layer.derive_matrix(model, outputs, inputs))


def _bind_again(matrix: TransferMatrix, values: dict[str, Any]) -> BoundTransferMatrix:
    return matrix.bind(**values)
