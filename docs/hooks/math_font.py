"""Make the mathematical font of pages: the glyphs of STIX Two Math that formulas of symflex can need.

    pip install -e ".[font]"
    python docs/hooks/math_font.py

The font comes from the package ziamath on PyPI. What is left holds the MATH table with its constants and, of
every sign that grows, all sizes and the parts it is assembled from. The same input gives the same bytes.
"""

from __future__ import annotations

import sys
from importlib import resources
from pathlib import Path
from typing import Final

from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont

from symflex.print.mathml import page_signs

SOURCE: Final = "ziamath"
FONT: Final = "fonts/STIXTwoMath-Regular.ttf"
FAMILY: Final = "symflex math"
TARGET: Final = Path(__file__).parents[2] / "symflex" / "report" / "fonts" / "symflex-math.woff2"
MOST_BYTES: Final = 60_000
NAMES_KEPT: Final = (0, 7, 13, 14)
"""Numbers of copyright, trademark and licence in a font's table of names."""


def make(source: Path, target: Path) -> int:
    """Write the subset of a font and return its size in bytes."""
    font = TTFont(source, recalcTimestamp=False)
    options = Options()
    options.layout_features = []  # letters drawn anew for scripts would double the size
    options.hinting = False
    options.name_IDs = list(NAMES_KEPT)
    options.drop_tables += ["DSIG", "GPOS", "GSUB"]
    options.flavor = "woff2"
    subsetter = Subsetter(options)
    subsetter.populate(unicodes=map(ord, page_signs()))
    subsetter.subset(font)
    # A name of its own: a page must not mix it up with the whole font of a machine.
    for number, text in {1: FAMILY, 2: "Regular", 4: FAMILY, 6: FAMILY.replace(" ", "-")}.items():
        font["name"].setName(text, number, 3, 1, 0x409)
    font.flavor = "woff2"
    target.parent.mkdir(parents=True, exist_ok=True)
    font.save(target)
    return target.stat().st_size


def main() -> None:
    """Make the font from the installed package."""
    with resources.as_file(resources.files(SOURCE) / FONT) as source:
        size = make(source, TARGET)
    if size > MOST_BYTES:
        sys.exit(f"the font has {size} bytes, and may have {MOST_BYTES}")


if __name__ == "__main__":
    main()
