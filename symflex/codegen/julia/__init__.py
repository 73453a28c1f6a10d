"""Transfer functions as a Julia module."""

from symflex.codegen.julia.module import JuliaExport, julia_module, module_name

__all__ = ["JuliaExport", "julia_module", "module_name"]
