"""What a user may call a mode by: its number, or a root."""

from __future__ import annotations

from symflex.api.root import Root
from symflex.roots import HiddenRoot
from symflex.roots import Root as CertifiedRoot

Mode = int | Root | CertifiedRoot | HiddenRoot


def plain_mode(mode: Mode) -> int | CertifiedRoot:
    """Return a mode as :mod:`symflex.analysis.modes` takes it: its number, or its root.

    Examples
    --------
    >>> plain_mode(2)
    2
    """
    if isinstance(mode, Root):
        return mode.certified_root
    return mode.root if isinstance(mode, HiddenRoot) else mode
