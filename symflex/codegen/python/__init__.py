"""Transfer functions as Python modules: of numpy, of any library of arrays, of jax."""

from symflex.codegen.python.module import ARRAY_API, JAX, NUMPY

__all__ = ["ARRAY_API", "JAX", "NUMPY"]
