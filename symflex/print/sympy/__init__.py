"""Expressions and systems of SymPy, made only when a user asks for them."""
