"""Transfer functions as Python modules: of numpy, of any library of arrays, of jax."""
