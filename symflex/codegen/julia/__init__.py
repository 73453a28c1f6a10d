"""Transfer functions as a Julia module."""

from symflex.codegen.julia.module import JULIA, module_name

__all__ = ["JULIA", "module_name"]
