"""The structure of chains, found again in their determinants."""

from symflex import pipeline
from symflex.codegen.program.polynomials import SumStep, plan_recurrences


def chain(count):
    lines = ["symflex = 1", "[parameters]"]
    lines += [f'm{i} = "1 kg"\nk{i} = "1 N/m"\nb{i} = "1 N*s/m"' for i in range(count)]
    lines += ["[elements]", *(f'M{i} = {{ type = "mass", at = "x{i}", m = "m{i}" }}' for i in range(count))]
    for i in range(count - 1):
        between = f'between = ["x{i}", "x{i + 1}"]'
        lines.append(f'K{i} = {{ type = "spring", {between}, k = "k{i}" }}')
        lines.append(f'B{i} = {{ type = "damper", {between}, b = "b{i}" }}')
    lines += ["[inputs]", 'F = { force = "x0" }', "[outputs]", f'A = "x0"\nX = "x{count - 1}"']
    return pipeline.derive_all(pipeline.loads("\n".join(lines)))


def test_a_chain_takes_two_sums_of_two_terms_for_each_mass():
    """As Holzer (1921) does it from the far end: one sum for a force, one for a displacement."""
    for count in (2, 3, 6):
        colocated, _ = chain(count)
        closed = colocated.closed
        plan = plan_recurrences(closed.closure.ring, (closed.num, closed.den))
        assert all(isinstance(step, SumStep) and len(step.parts) == 2 for step in plan.steps)
        # The last mass alone has no sum but that with its spring, and the first one no spring before it.
        assert len(plan.steps) == 2 * (count - 1)
