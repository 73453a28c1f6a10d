"""Transfer functions as a MATLAB function file, which Octave runs as well."""

from symflex.codegen.matlab.function_file import MatlabExport, main_name, matlab_function_file

__all__ = ["MatlabExport", "main_name", "matlab_function_file"]
