"""Several inputs and outputs at once: the transfer matrix of a model, and what is asked of a whole matrix.

Input: a model, with the names of outputs and inputs. Output: the numerators of all pairs over one common
denominator, and what follows from these.
"""
