"""What a person reads off a formula, in symbols, each statement with its proof.

Input: transfer functions, their certified roots, the boxes of their parameters. Output: short formulas with a
rigorous error bound, limits, dimensionless groups, roots and symbolic conditions.
"""
