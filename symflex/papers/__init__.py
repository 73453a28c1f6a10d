"""What papers print, as they are typed in LaTeX: labels, formulas, whole files and equations of motion.

Input: LaTeX. Output: the trees of :mod:`symflex.expressions`, each node with its place in the file.
"""
