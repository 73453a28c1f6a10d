"""Transfer functions as a Julia module."""

from symflex.emit.julia.module import JuliaExport, julia_module, module_name

__all__ = ["JuliaExport", "julia_module", "module_name"]
