"""Transfer functions as a function file for MATLAB and Octave."""

from symflex.codegen.matlab.function_file import MATLAB, main_name

__all__ = ["MATLAB", "main_name"]
