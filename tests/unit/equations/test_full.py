"""Full systems of numbers, against numpy."""

import numpy as np

from symflex import pipeline


def test_a_full_system_of_numbers_has_the_eigenvalues_of_its_matrix():
    random = np.random.default_rng(7)
    matrix, size = random.integers(-99, 99, (18, 18)), 18
    sums = [" + ".join(f"({c})*x_{j}" for j, c in enumerate(row)) for row in matrix]
    laws = [f'"s*x_{i} = {total} + u"' for i, total in enumerate(sums)]
    names = ", ".join(f'"x_{i}"' for i in range(size))
    model = pipeline.loads(
        f"symflex = 1\n[equations]\nunknowns = [{names}]\nequations = [{', '.join(laws)}]\n"
        '[inputs]\nu = {}\n[outputs]\ny = "x_0"\n'
    )
    (bound,) = pipeline.derive_bound(model, [("y", "u")])
    poles = pipeline.roots(bound, None, 12).poles
    found = np.sort_complex([complex(p.re.mid(), p.im.mid()) for p in poles for _ in range(p.multiplicity)])
    assert np.allclose(found, np.sort_complex(np.linalg.eigvals(matrix)), rtol=1e-9)
