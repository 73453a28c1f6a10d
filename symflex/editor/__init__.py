"""What an editor asks of a specification as it is typed: problems, fixes, names, completion, formulas.

Input: the text of a specification, right or not. Output: what a language server answers with, in offsets of
characters. ``symflex lsp`` serves it over the Language Server Protocol.
"""

from symflex.editor.completion import Completion, completions
from symflex.editor.document import Occurrence, OpenDocument, examined
from symflex.editor.fixes import Fix, fixes
from symflex.editor.hover import hover
from symflex.editor.layout import folds, tidied
from symflex.editor.rename import renamed

__all__ = [
    "Completion",
    "Fix",
    "Occurrence",
    "OpenDocument",
    "completions",
    "examined",
    "fixes",
    "folds",
    "hover",
    "renamed",
    "tidied",
]  # fmt: skip
