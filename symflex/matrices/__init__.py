"""Several inputs and outputs at once: the transfer matrix of a model, and what is asked of a whole matrix.

Input: a model, with the names of outputs and inputs. Output: the numerators of all pairs over one common
denominator, and what follows from these.
"""

from symflex.matrices.interaction import Interaction, interaction, interaction_json, interaction_text
from symflex.matrices.inverse import Imposed, determinant, impose_all, inverse, return_difference
from symflex.matrices.matrix_roots import DecouplingZero, MatrixRoots, ZeroDirection
from symflex.matrices.notations import (
    matrix_display,
    matrix_json,
    matrix_latex,
    matrix_mathml,
    matrix_sympy,
    matrix_text,
)
from symflex.matrices.printed import MatrixForm, print_matrix
from symflex.matrices.smith_mcmillan import in_expressions, smith_mcmillan
from symflex.matrices.transfer_matrix import BoundMatrix, TransferMatrix, derive_matrix
from symflex.matrices.zeros import locate_matrix
