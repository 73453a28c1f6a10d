"""The playground: what runs symflex in a browser, laid beside the page when there is a folder with it.

``SYMFLEX_WEBASSEMBLY`` names the folder, with Pyodide from npm and wheels for it, as ``.ci/run`` fetches
them. Without one the site has the page, which says how to build it whole. What a browser keeps lies in a
folder named by what is in it. ``python docs/hooks/playground.py FOLDER`` lays out the page alone, to be
served from there.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

ROOT: Final = Path(__file__).parents[2]
PAGE: Final = ROOT / "docs" / "playground"
FONT: Final = "symflex-math.woff2"
RUNTIME: Final = "pyodide.mjs pyodide.asm.mjs pyodide.asm.wasm python_stdlib.zip pyodide-lock.json".split()
"""Files of Pyodide that a page asks for."""
EXAMPLES: Final = (
    "eppinger1988/loops/two_mass_position", "eppinger1988/two_mass", "mechatronics/elastic_joint",
    "classics/quarter_car", "classics/rod_tip_mass", "classics/one_link_arm", "classics/clamped_free",
    "eppinger1988/sliding_free_beam", "classics/sallen_key", "transducers/loudspeaker_closed_box",
    "mechatronics/acc_benchmark", "nonlinear/furuta_pendulum", "mechatronics/delayed_pendulum",
)  # fmt: skip
SIGNS: Final = (
    0xB0, 0xB1, 0xB7, 0xD7, *range(0x391, 0x3CA), 0x3D1, 0x3D5, 0x3F5, 0x2026, *range(0x2032, 0x2035), 0x2113,
    0x2192, 0x2202, 0x2212, 0x2218, 0x221A, 0x221E, 0x2248, 0x2264, 0x2265, 0x22C5,
)  # fmt: skip
"""Letters and signs of drawings beside those of ASCII."""
MOMENT: Final = (1980, 1, 1, 0, 0, 0)
"""The date of all files in an archive, so that the same sources make the same bytes."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Lay the parts of the playground beside its page."""
    from mkdocs.structure.files import File

    for name, content in parts():
        files.append(File.generated(config, f"playground/{name}", content=content))
    return files


def parts() -> Iterator[tuple[str, bytes]]:
    """Yield names and contents of the files beside the page's own."""
    runtime = os.environ.get("SYMFLEX_WEBASSEMBLY")
    known: dict[str, object] = {"examples": [example(name) for name in EXAMPLES]}
    if runtime:
        kept = packed(dict(program(Path(runtime))))
        folder = hashlib.sha256(b"".join(kept.values())).hexdigest()[:16]
        known["kept"] = [f"{folder}/{name}" for name in kept]
        yield from ((f"{folder}/{name}", content) for name, content in kept.items())
    yield "parts.json", json.dumps(known, ensure_ascii=False).encode()


def program(runtime: Path) -> Iterator[tuple[str, bytes]]:
    """Yield names and contents of what runs symflex."""
    for name in RUNTIME:
        yield f"runtime/{name}", (runtime / "node_modules" / "pyodide" / name).read_bytes()
    wheels = sorted(runtime.glob("*.whl"))
    for wheel in wheels:
        yield f"wheels/{wheel.name}", wheel.read_bytes()
    yield "wheels/symflex.zip", package(any(wheel.name.startswith("numpy-") for wheel in wheels))


def packed(files: dict[str, bytes]) -> dict[str, bytes]:
    """Return the files such that a browser starts sooner, where there is a program that packs them so."""
    node = shutil.which("node")
    if node is None:
        return files
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for name, content in files.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_bytes(content)
        hooks = ROOT / "docs" / "hooks"
        model = ROOT / "derivations" / f"{EXAMPLES[0]}.toml"
        subprocess.run([node, hooks / "pack.mjs", folder, hooks / "packing.py", model], check=True)
        return {name: (folder / name).read_bytes() for name in files}


def example(name: str) -> dict[str, str]:
    """Return a model as the page offers it, without the line that names its schema's file."""
    text = (ROOT / "derivations" / f"{name}.toml").read_text("utf-8")
    lines = [line for line in text.splitlines(keepends=True) if not line.startswith("#:schema")]
    return {"title": str(tomllib.loads(text).get("title", name)), "text": "".join(lines)}


def widths() -> dict[str, dict[str, float]]:
    """Return how wide letters of drawings are, as shares of their size, by face."""
    from matplotlib.font_manager import FontProperties, findfont
    from matplotlib.ft2font import FT2Font, LoadFlags

    found = {}
    faces = {
        "upright": FontProperties(family="STIXGeneral"),
        "italic": FontProperties(family="STIXGeneral", style="italic"),
        "bold": FontProperties(family="STIXGeneral", weight=700),
    }
    for face, properties in faces.items():
        font = FT2Font(findfont(properties))
        font.set_size(1000, 72)
        known = font.get_charmap()
        letters = [chr(c) for c in [*range(32, 127), *SIGNS] if c in known]
        advances = (font.load_char(ord(c), flags=LoadFlags.NO_HINTING).linearHoriAdvance for c in letters)
        found[face] = {c: round(a / 65536 / 1000, 4) for c, a in zip(letters, advances, strict=True)}
    return found


def package(has_numpy: bool) -> bytes:
    """Return symflex, and the page's own part in Python, as an archive."""
    sources = {
        path.relative_to(ROOT).as_posix(): path.read_bytes()
        for path in sorted((ROOT / "symflex").rglob("*"))
        if path.is_file() and path.suffix != ".pyc"
    }
    for name in ("answers.py", "letters.py"):
        sources[name] = (PAGE / name).read_bytes()
    if not has_numpy:
        sources["numpy.py"] = (PAGE / "arrays.py").read_bytes()
    sources["letters.json"] = json.dumps(widths()).encode()
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in sources.items():
            entry = zipfile.ZipInfo(name, MOMENT)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return out.getvalue()


def lay_out(folder: Path) -> None:
    """Write the page and its parts as the site has them."""
    files = {
        f"playground/{path.name}": path.read_bytes()
        for path in sorted(PAGE.iterdir())
        if path.is_file() and path.suffix != ".py"
    }
    files |= {f"playground/{name}": content for name, content in parts()}
    files[f"stylesheets/{FONT}"] = (ROOT / "symflex" / "report" / "fonts" / FONT).read_bytes()
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


if __name__ == "__main__":
    lay_out(Path(sys.argv[1]))
