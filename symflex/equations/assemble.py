"""From a model to its equations.

Input: a :class:`symflex.model.Model` and the transfer functions of its ``model`` blocks.
Output: :class:`Equations`; every element has left its stamp, parallel branches are added up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING

from symflex.algebra import (
    FUNCTIONS,
    LAPLACE,
    PRIME,
    Factored,
    Radicals,
    Ring,
    common_denominator,
    least_common_multiple,
    random_point,
    residue,
)
from symflex.budget import spend
from symflex.equations.against_text import error_of
from symflex.equations.equations import ConstantFunction, Continuum, Equations, OutputRow, radicals_of
from symflex.equations.evaluate import (
    ExactEvaluator,
    Opener,
    read_block,
    shared_by_sides,
    without_squares,
)
from symflex.errors import BudgetError, Diagnostic, ModelError, SymflexError
from symflex.expressions import (
    Call,
    Equation,
    Expression,
    Negative,
    Number,
    Sum,
    format_expression,
    names,
    names_among,
    substitute,
)
from symflex.library.blocks import ROOT
from symflex.library.elements import (
    COMPONENTS,
    ElementUse,
    EquationRow,
    LinearForm,
    Placing,
    PortTerminal,
    Stamp,
    Variable,
)
from symflex.library.elements.element import Role
from symflex.library.elements.line import LineElement
from symflex.model import Model, NetworkNode, NodeReference, PlacedBlock, PlacedElement, scope_of
from symflex.model.along import COORDINATE, is_tapered, varies_along_x
from symflex.model.boundary import varying_constants
from symflex.model.dynamics import Dynamics
from symflex.model.model import INPUT_KINDS
from symflex.model.network import variable_of

if TYPE_CHECKING:
    from symflex.equations.distributed import AlongPoint, Distributed, FieldSolution, State

Nested = Callable[[PlacedBlock, Ring], tuple[Factored, Factored]]
PI = "pi"
_NOTHING = LinearForm()
GENERATOR_LIMIT = 1_000  # names over a dense ring, with an exponent each per monomial; a round number
UNKNOWN_LIMIT = 2_500  # of a dense ring; a singular system is explained with 50 MB of doubles
SPARSE_LIMIT = 500_000  # names, and unknowns, of equations over a sparse ring


def assemble(
    model: Model,
    nested: Nested | None = None,
    *,
    is_nameless: bool = False,
    is_sparse: bool = False,
    is_cut: bool = False,
    is_followed: bool = False,
) -> Equations:
    """Stamp every element and signal of a model into one linear system.

    ``nested`` returns the transfer function of a ``model`` block, and what cancelled in it, over a given
    ring. With ``is_nameless`` no wavenumber has a name: a quotient with named and nameless ones has no
    form in which what cancels is seen. With ``is_sparse`` the ring has any number of names, nothing is
    expanded, and rows are not cleared of denominators; a distributed model has to be nameless, too. With
    ``is_cut`` states at points along x are unknowns, and what relates them, the laws of ``continua``, is
    not among the rows. With ``is_followed`` uniform line elements and fields beside others that taper are
    followed along x as those are, by fundamental matrices. Raises ModelError: SF224 division by zero,
    SF910 a function of s; with positions, all at once; BudgetError: SF502 when there are more names or
    more unknowns than can be computed with exactly.
    """
    if model.sampled is not None:
        from symflex.model.sampled import refused  # few models have one

        raise refused(model)
    constants = _constant_functions(model)
    count = len(model.parameters) + len(model.definitions) + len(constants)
    most = SPARSE_LIMIT if is_sparse else GENERATOR_LIMIT
    if count > most:
        message = f"{count} parameters, definitions and functions of them; at most {most} are allowed"
        raise _too_large(message, "write numbers in place of parameters that need no name")
    ring = Ring(
        (
            LAPLACE,
            *(p.name for p in model.parameters),
            *(d.name for d in model.definitions),
            PI,
            *([COORDINATE] if is_tapered(model) else []),
            *(c.generator for c in constants),
        ),
        is_sparse,
    )
    distributed = _Assembly(model, ring, constants, nested).survey(
        is_nameless=is_nameless, is_cut=is_cut, is_followed=is_followed
    )
    full_ring = ring if distributed is None else distributed.propagation.ring
    return _Assembly(model, full_ring, constants, nested, distributed, is_cut).run()


def _too_large(message: str, hint: str) -> BudgetError:
    return BudgetError(Diagnostic("SF502", f"the closed form is too large: {message}", None, hint))


def _constant_functions(model: Model) -> tuple[ConstantFunction, ...]:
    functions: dict[str, ConstantFunction] = {}
    for part in _with_submodels(model):
        opener = Opener({d.name: d.expression for d in part.definitions})
        for _, expression in part.expressions():
            for call in reversed(names(expression)):
                if isinstance(call, Call) and call.name in FUNCTIONS:
                    opened = opener.open(call)
                    text = format_expression(opened)
                    functions.setdefault(text, ConstantFunction(text, opened))
    if is_tapered(model):
        functions |= _of_the_coordinate(model, functions)
    return tuple(functions.values())


def _of_the_coordinate(model: Model, known: Mapping[str, ConstantFunction]) -> dict[str, ConstantFunction]:
    """Return the derivatives of functions of x, and their values at all points of the model."""
    scope, opener = scope_of(model), Opener({d.name: d.expression for d in model.definitions})
    calls = [c.expression for c in known.values() if varies_along_x(c.expression)]
    twins = {"sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh"}
    calls += [Call(twins[c.name], c.argument) for c in calls if c.name in twins]
    points = dict.fromkeys(
        n.argument
        for _, e in model.expressions()
        for n in names(e)
        if isinstance(n, Call) and (n.name in scope.unknowns or n.name in scope.along)
    )
    # At an end a stiffness may vanish, where solutions are told by what is beside it.
    ends = [end for field in model.fields for end in (field.start, field.end)]
    for use in model.elements:
        if isinstance(use.element, LineElement) and any(varies_along_x(e) for _, e in use.all_values):
            ends += [Number(Fraction(0)), dict(use.all_values)[use.element.length]]
    functions: dict[str, ConstantFunction] = {}
    for call in calls:
        for put_in in (call, *(substitute(call, {COORDINATE: p}) for p in (*points, *ends))):
            opened = opener.open(put_in) if isinstance(put_in, Call) else call
            text = format_expression(opened)
            functions.setdefault(text, ConstantFunction(text, opened))
    return functions


def _with_submodels(model: Model) -> Iterable[Model]:
    yield model
    for block in model.blocks:
        if block.submodel is not None:
            yield from _with_submodels(block.submodel)


@dataclass(frozen=True, eq=False)
class Cut:
    """A point of a line element or field, by its distance from the start, and the state there."""

    at: Factored
    state: tuple[Variable, ...]


@dataclass
class _Assembly:
    """The one mutable workbench of this package: collects stamps, then freezes them."""

    model: Model
    ring: Ring
    constants: tuple[ConstantFunction, ...]
    nested: Nested | None
    distributed: Distributed | None = None
    is_cut: bool = False
    problems: list[Diagnostic] = field(default_factory=list)
    branches: dict[tuple[Variable | None, Variable | None], Factored] = field(default_factory=dict)
    balance: dict[Variable, LinearForm] = field(default_factory=dict)
    unknowns: list[Variable] = field(default_factory=list)
    rows: list[EquationRow] = field(default_factory=list)
    through: dict[Variable, LinearForm] = field(default_factory=dict)
    continua: list[Continuum] = field(default_factory=list)
    states: dict[str, tuple[Variable | None, ...]] = field(default_factory=dict)
    lines: dict[str, tuple[LineElement, ElementUse]] = field(default_factory=dict)
    # Per line element or field, the points within at which it is cut.
    cuts: dict[str, list[Cut]] = field(default_factory=dict)

    def survey(self, *, is_nameless: bool, is_cut: bool, is_followed: bool) -> Distributed | None:
        """Return the model's distributed parts; this assembly is over the ring without kernels."""
        lines = any(isinstance(use.element, LineElement) for use in self.model.elements)
        delays = any(b.block is not None and b.block.kernel_time for b in self.model.blocks)
        if not (lines or delays or self.model.fields):
            return None
        from symflex.equations.distributed import survey  # only with beams

        evaluator, _ = self._evaluator(self._subsystems())
        if self.problems:
            raise ModelError(*self.problems)
        expressions = [e for _, e in self.model.expressions()]
        functions = None
        if is_tapered(self.model):
            functions = tuple(
                (c.generator, c.expression) for c in self.constants if varies_along_x(c.expression)
            )
        return survey(
            self.model,
            evaluator,
            expressions,
            is_nameless=is_nameless,
            is_cut=is_cut,
            is_followed=is_followed,
            functions=functions,
        )

    @cached_property
    def _radicals(self) -> Radicals:
        return radicals_of(self.ring, self.constants, self.model.parameters)

    @cached_property
    def _varying(self) -> frozenset[str]:
        definitions = varying_constants(self.model.definitions, self.model.blocks)
        if self.distributed is None:
            return definitions
        propagation = self.distributed.propagation
        return definitions.union(propagation.ring.names[len(propagation.base.names) :])

    def _evaluator(self, blocks: Mapping[str, Dynamics[Factored]]) -> tuple[ExactEvaluator, dict[str, int]]:
        """Return what reads expressions, and its point of a prime field; definitions are letters."""
        definitions = {d.name: d.expression for d in self.model.definitions}
        prime, point = self._radicals.point() or (PRIME, random_point(self.ring.names))
        point = {name: number for name, number in point.items() if name not in definitions}
        scope = scope_of(self.model)
        fields = {*scope.unknowns, *scope.along}
        value = None if self.distributed is None else self._at_point
        arguments = (
            self.ring,
            scope,
            blocks,
            self.through,
            definitions,
            point,
            prime,
            fields,
            self._radicals,
            value,
        )
        return ExactEvaluator(*arguments, root=self.model.root, varying=self._varying), point

    def _at_point(self, call: Call) -> LinearForm:
        """Return the value at a point along x that a call names."""
        if self.distributed is None:
            raise TypeError("without kernels nothing has a value at a point")
        if not self.is_cut:
            return self.distributed.value(call, self.states)
        along = self.distributed.place(call)
        return along.value(self._state_at(along), self.distributed.propagation)

    def _state_at(self, along: AlongPoint) -> State:
        """Return the state at a point, unknowns of its own unless the point is an end."""
        one = Factored.number(self.ring, 1)
        if along.at.is_zero:
            initial = along.initial or self.states[along.owner]
            return tuple((v, one) for v in initial)
        if along.owner in self.lines and (along.at - along.length).is_zero:
            element, use = self.lines[along.owner]
            return tuple(element.final_state(use))
        cuts = self.cuts.setdefault(along.owner, [])
        cut = next((c for c in cuts if (c.at - along.at).is_zero), None)
        if cut is None:
            names = along.medium.system.states
            cut = Cut(along.at, tuple(Variable("field", along.owner, f"{n}({len(cuts) + 1})") for n in names))
            cuts.append(cut)
            self.unknowns += cut.state
        return tuple((v, one) for v in cut.state)

    def _pieces(self) -> Iterable[Continuum]:
        """Return the distributed parts, cut where their states are unknowns."""
        from symflex.equations.distributed import guess  # loaded with what is cut

        numbers = {p.name: p.value for p in self.model.parameters}
        for continuum in self.continua:
            cuts = sorted(self.cuts.get(continuum.name, ()), key=lambda c: guess(c.at, numbers))
            at, state = continuum.start * 0, continuum.initial
            for cut in cuts:
                final = tuple((v, 1) for v in cut.state)
                yield replace(
                    continuum, start=continuum.start + at, length=cut.at - at, initial=state, final=final
                )
                at, state = cut.at, cut.state
            if continuum.final:
                yield replace(
                    continuum, start=continuum.start + at, length=continuum.length - at, initial=state
                )

    def run(self) -> Equations:
        """Return the finished equations."""
        subsystems = self._subsystems()
        evaluator, point = self._evaluator(subsystems)
        definitions = self._define(evaluator, point)
        self._check_blocks(subsystems, point, evaluator.prime)
        nodes = {n.name: n for n in self.model.nodes}
        for node in self.model.nodes:
            for component in node.components:
                self.balance[Variable("node", node.name, component)] = LinearForm()
        values: list[tuple[Variable, Expression]] = []
        for use in self.model.elements:
            stamp = self._stamp(use, evaluator, nodes, values)
            if stamp is not None:
                self._take(use, stamp, evaluator)
        self._take_inputs(nodes, evaluator)
        for variable, expression in values:
            self._equal(variable, expression, evaluator)
        for signal in self.model.signals:
            self._equal(Variable("signal", signal.name), signal.expression, evaluator)
        for solution in self._solutions():
            self._impose(solution, evaluator)
        self._count_conditions()
        outputs = [self._output(o.name, o.expression, evaluator) for o in self.model.outputs]
        if self.problems:
            spend()
            raise error_of(self.problems)
        count = len(self.balance) + len(self.unknowns)
        most = SPARSE_LIMIT if self.ring.is_sparse else UNKNOWN_LIMIT
        if count > most:
            raise _too_large(f"{count} unknowns; at most {most} are solved for", "split the model")
        equations = Equations(
            self.model,
            self.ring,
            definitions,
            self.constants,
            (*self.balance, *self.unknowns),
            tuple(Variable("input", i.name) for i in self.model.inputs),
            tuple(self._polynomial(row) for row in (*self._balances(), *self.rows)),
            tuple(o for o in outputs if o is not None),
            None if self.distributed is None else self.distributed.propagation,
            None if self.distributed is None or self.ring.is_sparse or self.is_cut else self._cleared(),
            tuple(self._pieces() if self.is_cut else self.continua),
            self.distributed is not None and self.distributed.is_split,
        )
        if not self.model.imposed:
            return equations
        from symflex.equations.imposed import impose  # few models are turned round

        return impose(equations, self.model.imposed)

    def _cleared(self) -> Factored:
        """Return the product of denominators of line elements and conditions: others are no dynamics."""
        transmissions = {} if self.distributed is None else self.distributed.transmissions
        waves = set() if self.distributed is None else {*self.distributed.propagation.table.wavenumbers}
        product = Factored.number(self.ring, 1)
        for row in self.rows:
            below = common_denominator(self.ring, row.form.coefficients)
            is_law = row.about.kind == "through" and row.about.owner in transmissions
            if not (is_law or row.role == "condition"):
                below = below.filter(lambda f: not waves.isdisjoint(self.ring.used_in([f])))
            product = product * below
        return product

    def _solutions(self) -> Iterable[FieldSolution]:
        """Return the fields' solutions, each once."""
        if self.distributed is None:
            return ()
        return {s.field.name: s for s in self.distributed.solutions.values()}.values()

    def _impose(self, solution: FieldSolution, evaluator: ExactEvaluator) -> None:
        """Take a field's state at its start as unknowns, and its conditions as rows."""
        self.unknowns += [v for v in solution.initial if v is not None]
        if self.distributed is not None:
            problem, start = solution.field, solution.origin
            ends = map(self.distributed.evaluator.constant, (problem.start, problem.end))
            length = sum((end - start for end in ends), start * 0)
            arguments = (solution.medium.system, start, length, solution.initial, solution.inputs)
            laws = solution.medium.laws(self.distributed.propagation)
            self.continua.append(Continuum(problem.name, "field", *arguments, parts=laws))
            for load, form in solution.filtered:
                embed = self.distributed.propagation.embed
                self._filtered(load, LinearForm(tuple((v, embed(c)) for v, c in form.terms)))
        field, inside = (
            solution.field,
            replace(evaluator, scope=evaluator.scope.within(solution.field.unknowns)),
        )
        for i, equation in enumerate(field.equations):
            reading = inside.read_linear(_difference(equation))
            shared = (inside.in_s(shared_by_sides(c)) for c in reading.value.coefficients)
            hidden = least_common_multiple(reading.hidden, shared)
            self._hide(Variable("field", field.name, f"equation_{i + 1}"), hidden)
        for i, condition in enumerate(field.conditions):
            about = Variable("field", field.name, f"condition {i + 1}")
            self._add_row(about, _difference(condition), evaluator, "condition")

    def _count_conditions(self) -> None:
        """Note conditions that are too many or too few where solutions have to be finite at a tip."""
        solutions = list(self._solutions())
        tips = [s for s in solutions if s.medium.held]
        wanted = sum(1 for s in solutions for v in s.initial if v is not None)
        given = sum(len(s.field.conditions) for s in solutions)
        if tips and given != wanted:
            name = tips[0].field.name
            message = (
                f"a stiffness of field '{name}' vanishes at an end: solutions that are finite there need "
                f"{wanted} conditions, and there are {given}"
            )
            hint = "leave out conditions that only keep the tip finite, such as forces of zero"
            self.problems.append(Diagnostic("SF243", message, tips[0].field.span, hint))

    def _define(self, evaluator: ExactEvaluator, point: dict[str, int]) -> tuple[tuple[str, Factored], ...]:
        """Return the definitions' values, each placed at the random point for those after it."""
        definitions = []
        for definition in self.model.definitions:
            try:
                value = evaluator.constant(definition.expression)
                point[definition.name] = residue(value, point, evaluator.prime)
            except SymflexError as error:
                self.problems.extend(error.diagnostics)
            except (ZeroDivisionError, KeyError):
                continue  # what it uses is reported where it stands
            else:
                definitions.append((definition.name, value))
        return tuple(definitions)

    def _check_blocks(
        self, read: Mapping[str, Dynamics[Factored]], point: Mapping[str, int], prime: int
    ) -> None:
        """Note every block that divides by zero once its definitions are opened."""
        for block in self.model.blocks:
            try:
                residue(read[block.name].value, point, prime)
            except ZeroDivisionError:
                self.problems.append(Diagnostic("SF224", f"block '{block.name}' divides by zero", block.span))
            except KeyError:
                continue

    def _subsystems(self) -> dict[str, Dynamics[Factored]]:
        """Return what blocks are read as, and definitions with poles: as letters these would hide them."""
        one = Factored.number(self.ring, 1)
        delays = {} if self.distributed is None else self.distributed.delays
        read = {name: Dynamics(delay, one) for name, delay in delays.items()}
        evaluator, _ = self._evaluator(read)
        blocks = {b.name: b for b in self.model.blocks}
        delayed = self._delayed if self.distributed is None else ()
        for name, expressions in self._constants_in_order.items():
            if name in read or name in delayed:
                continue  # over the ring without kernels a delay has no value
            if name not in blocks:
                read |= self._with_poles(name, expressions[0], evaluator)
                continue
            try:
                subsystem = self._block(blocks[name], evaluator)
                read |= {} if subsystem is None else {name: subsystem}
            except ZeroDivisionError:
                message = f"block '{name}' divides by zero"
                self.problems.append(Diagnostic("SF224", message, blocks[name].span))
                read[name] = Dynamics(one, one)
            except SymflexError as error:
                self.problems.extend(error.diagnostics)
                read[name] = Dynamics(one, one)
        return read

    def _block(self, block: PlacedBlock, evaluator: ExactEvaluator) -> Dynamics[Factored] | None:
        """Return what a block is read as; None of another model's where nothing derives it."""
        if block.block is ROOT:
            return Dynamics(Factored.generator(self.ring, LAPLACE), evaluator.one)
        if block.block is not None:
            reading = read_block(block, evaluator)
        elif self.nested is not None:
            ratio, hidden = self.nested(block, self.ring)
            reading = Dynamics(ratio, evaluator.in_s(ratio.denominator()) * hidden)
        else:
            return None
        return Dynamics(*map(self._radicals.tidy, (reading.value, reading.poles)))

    def _with_poles(
        self, name: str, written: Expression, evaluator: ExactEvaluator
    ) -> dict[str, Dynamics[Factored]]:
        """Return what a definition is read as by its name if it has poles."""
        if name not in self._varying:
            return {}
        try:
            reading = evaluator.read_constant(written)
        except BudgetError:
            raise
        except (SymflexError, ZeroDivisionError):
            return {}  # `_define` reports it
        return {} if reading.poles.is_one else {name: reading}

    @property
    def _delayed(self) -> set[str]:
        """The delay blocks, and the blocks and definitions made of them."""
        delayed = {b.name for b in self.model.blocks if b.block is not None and b.block.kernel_time}
        for name, expressions in self._constants_in_order.items():
            if any(names_among(e, delayed) for e in expressions):
                delayed.add(name)
        return delayed

    @cached_property
    def _constants_in_order(self) -> dict[str, list[Expression]]:
        """Return what blocks and definitions are made of, each after those it uses; SF215 in a circle."""
        by_name = {b.name: b for b in self.model.blocks}
        expressions = {d.name: [d.expression] for d in self.model.definitions}
        expressions |= {b.name: [e for _, e in b.values] for b in self.model.blocks}
        graph = {
            name: [n for e in expression_list for n in names_among(e, expressions)]
            for name, expression_list in expressions.items()
        }
        try:
            order = list(TopologicalSorter(graph).static_order())
        except CycleError as error:
            circle = error.args[1]
            location = next((by_name[n].span for n in circle if n in by_name), None)
            message = f"blocks refer to each other in a circle: {' -> '.join(reversed(circle))}"
            raise ModelError(Diagnostic("SF215", message, location)) from None
        return {name: expressions[name] for name in order}

    def _stamp(
        self,
        use: PlacedElement,
        evaluator: ExactEvaluator,
        nodes: Mapping[str, NetworkNode],
        values: list[tuple[Variable, Expression]],
    ) -> Stamp | None:
        signal_ports = {p.name for p in use.element.parameters if p.signal}
        constants: dict[str, Factored] = {}
        forms: dict[str, LinearForm] = {}
        one = Factored.number(self.ring, 1)
        for name, expression in use.all_values:
            if name in signal_ports:
                variable = Variable("value", use.name, name)
                values.append((variable, expression))
                forms[name] = LinearForm.of((variable, one))
                continue
            try:
                reading = evaluator.along_x().read_constant(expression)
            except SymflexError as error:
                self.problems.extend(error.diagnostics)
                return None
            constants[name] = reading.value
            hidden = reading.hidden
            if isinstance(use.element, LineElement):
                # Laws of waves divide by what sums leave in both sides; rows keep it for the determinant.
                hidden = hidden * evaluator.in_s(shared_by_sides(reading.value))
            self._hide(Variable("value", use.name, name), hidden)
        terminals = {
            port: tuple(self._terminal(r, dict(use.domains)[port], nodes) for r in references)
            for port, references in use.nodes
        }
        s = evaluator.s
        transmissions = {} if self.distributed is None else self.distributed.transmissions
        element_use = ElementUse(
            use.name,
            s,
            terminals,
            dict(use.domains),
            constants,
            forms,
            dict(use.choices),
            transmissions.get(use.name, ()),
            self.distributed is not None and use.name in self.distributed.turned,
            self._varying,
        )
        if isinstance(use.element, LineElement):
            self.lines[use.name] = (use.element, element_use)
            if self.distributed is not None:
                medium, length = self.distributed.lines[use.name]
                state = use.element.initial_state(element_use)
                final = tuple((v, int(c.unit)) for v, c in use.element.final_state(element_use))
                kind, start = use.element.type_name, length * 0
                if element_use.is_turned:
                    final = tuple((v, 1) for v in state)
                    state, start, length = use.element.tip_state(element_use), length, -length
                self.states[use.name] = state
                arguments = (use.name, kind, medium.system, start, length, state)
                laws = medium.laws(self.distributed.propagation)
                self.continua.append(Continuum(*arguments, final=final, parts=laws))
        return use.element.stamp(element_use)

    @staticmethod
    def _terminal(
        reference: NodeReference, domain: Placing, nodes: Mapping[str, NetworkNode]
    ) -> PortTerminal:
        if reference.is_ground:
            return PortTerminal()
        node = nodes[reference.node]
        if domain in COMPONENTS:
            name = reference.node
            moving = {c: Variable("node", name, c) for c in COMPONENTS[domain]}
            return PortTerminal(None, moving["y"], moving["theta"], moving.get("x"))
        return PortTerminal(variable_of(reference, node, domain))

    def _take(self, use: PlacedElement, stamp: Stamp, evaluator: ExactEvaluator) -> None:
        for branch in stamp.branches:
            key = (branch.b, branch.a) if (branch.b, branch.a) in self.branches else (branch.a, branch.b)
            earlier = self.branches.get(key)
            self.branches[key] = branch.admittance if earlier is None else earlier + branch.admittance
        for number, injection in enumerate(stamp.injections):
            if injection.node is None:
                continue
            form, below = injection.form, common_denominator(self.ring, injection.form.coefficients)
            if not evaluator.in_s(below).is_one:
                # A filter with states of its own, even where another with the same poles acts on the node.
                form = self._filtered(Variable("value", use.name, f"delivered_{number + 1}"), form)
            balance = self.balance[injection.node]
            self.balance[injection.node] = _side_by_side(balance, form * Factored.number(self.ring, -1))
        self.unknowns += stamp.unknowns
        self.rows += stamp.rows
        for quantity, form in stamp.through:
            self.through[Variable("through", use.name, quantity)] = form

    def _filtered(self, variable: Variable, form: LinearForm) -> LinearForm:
        """Return an unknown that equals a combination whose coefficients have poles."""
        below = common_denominator(self.ring, form.coefficients)
        self.unknowns.append(variable)
        law = form * below + LinearForm.of((variable, -below))
        self.rows.append(EquationRow(variable, law, "signal"))
        return LinearForm.of((variable, Factored.number(self.ring, 1)))

    def _balances(self) -> list[EquationRow]:
        """Return each node's balance: what flows out through branches minus what is delivered."""
        balance = dict(self.balance)
        for (a, b), admittance in self.branches.items():
            for here, there in ((a, b), (b, a)):
                if here is not None:
                    out = LinearForm.of((here, admittance), (there, -admittance))
                    balance[here] = _side_by_side(balance[here], out)
        return [EquationRow(node, form, "balance") for node, form in balance.items()]

    def _take_inputs(self, nodes: Mapping[str, NetworkNode], evaluator: ExactEvaluator) -> None:
        one = Factored.number(self.ring, 1)
        for source in self.model.inputs:
            if source.kind == "signal":
                continue
            kind, variable = INPUT_KINDS[source.kind], Variable("input", source.name)
            ends = [self._terminal(r, kind.domain, nodes).across for r in source.nodes]
            signs = [one, -one]
            if kind.order is not None:
                delivered = kind.delivered(source.name)
                rate = evaluator.s**kind.order
                moved = LinearForm.of(*zip(ends, signs, strict=False)) * rate
                self.unknowns.append(delivered)
                self.rows.append(
                    EquationRow(delivered, moved + LinearForm.of((variable, -one)), "constraint")
                )
                self.through[delivered] = LinearForm.of((delivered, one))
                variable = delivered
            for end, sign in zip(ends, signs, strict=False):
                if end is not None:
                    form = LinearForm.of((variable, -sign))
                    self.balance[end] = _side_by_side(self.balance[end], form)

    def _polynomial(self, row: EquationRow) -> EquationRow:
        if self.ring.is_sparse:
            return row  # nothing is expanded, and rows scaled differently would lose their symmetry
        # Elements multiply what was evaluated: the torque constant of a motor with itself.
        form = without_squares(row.form, self._radicals)
        below = common_denominator(self.ring, form.coefficients)
        return replace(row, form=form if below.is_one else form * below)

    def _equal(self, variable: Variable, expression: Expression, evaluator: ExactEvaluator) -> None:
        """Add the row ``variable = expression``, or an equation that stands in its place."""
        self.unknowns.append(variable)
        if isinstance(expression, Equation):
            self._add_row(variable, _difference(expression), evaluator, "equation")
        else:
            given = LinearForm.of((variable, -evaluator.one))
            self._add_row(variable, expression, evaluator, "signal", given)

    def _add_row(
        self,
        about: Variable,
        expression: Expression,
        evaluator: ExactEvaluator,
        role: Role,
        given: LinearForm = _NOTHING,
    ) -> None:
        """Add the row ``given + expression = 0``, cleared of the poles that the expression has."""
        try:
            reading = evaluator.read_linear(expression)
        except SymflexError as error:
            self.problems.extend(error.diagnostics)
            return
        self._hide(about, reading.hidden)
        self.rows.append(EquationRow(about, (given + reading.value) * reading.kept, role))

    def _hide(self, about: Variable, poles: Factored) -> None:
        """Add the states that cancelled where something was read: modes that no input moves."""
        if not poles.is_one:
            state = replace(about, kind="value", component=f"{about.component}_hidden".lstrip("_"))
            self.unknowns.append(state)
            self.rows.append(EquationRow(state, LinearForm.of((state, poles)), "hidden"))

    def _output(self, name: str, expression: Expression, evaluator: ExactEvaluator) -> OutputRow | None:
        try:
            reading = evaluator.read_linear(expression)
        except SymflexError as error:
            self.problems.extend(error.diagnostics)
            return None
        # A filter in an output is the output's own: as an unknown it would be a mode of all the others.
        divisor = reading.below * reading.hidden
        return OutputRow(name, reading.value * divisor, divisor, reading.poles)


def _difference(equation: Equation) -> Expression:
    return Sum((equation.left, Negative(equation.right)), span=equation.span)


def _side_by_side(left: LinearForm, right: LinearForm) -> LinearForm:
    """Return the sum without adding coefficients of equal variables, so that each branch stays one symbol."""
    return LinearForm((*left.terms, *right.terms))
