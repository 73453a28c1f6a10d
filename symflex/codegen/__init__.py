"""Generated code: one program tree, and what prints it in each language."""
