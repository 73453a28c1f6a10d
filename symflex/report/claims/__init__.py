"""What publications claim about their models, judged from computed facts.

The spec language says what a model is and what was printed about it (``[published]``). What a text says in
words stands in a ``claims.toml`` beside the specifications: quotations with checks, each a predicate of a
registry, applied to the specifications whose ``source`` begins with the publication's name.
"""
