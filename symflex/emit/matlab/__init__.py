"""Transfer functions as a MATLAB function file, which Octave runs as well."""

from symflex.emit.matlab.function_file import MatlabExport, main_name, matlab_function_file

__all__ = ["MatlabExport", "main_name", "matlab_function_file"]
