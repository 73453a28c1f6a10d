"""One module per target of ``symflex export``."""
