"""The gallery, and formulas in the pages, derived while the site is built: nothing in them can lag behind.

A page asks with a comment on a line of its own: ``<!-- gallery -->``; or for one formula, which the page has
in LaTeX for those who read it in a clone, ``<!-- formula: FILE OUT/IN -->`` to ``<!-- end of formula -->``,
where FILE is one of the repository or one that the page titles.
An equation as specifications write it, ``<!-- equation: y = x^2 -->``, is typeset likewise, and within a
sentence what stands between backticks after ``<!-- math -->``. On a page with ``<!-- drawings -->`` every
specification is followed by its drawing. ``<!-- elements -->`` is the catalogue of all elements.

What is derived or drawn is kept in ``.site_cache``, by what it was made from: the program, this file and the
specification. If only a page changes, nothing is made again.
"""

from __future__ import annotations

import hashlib
import html
import pickle
import re
import tomllib
from base64 import b64encode
from dataclasses import dataclass, replace
from functools import cache, partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeVar

from matplotlib import mathtext, textpath
from mkdocs.structure.files import File, Files

from symflex import pipeline
from symflex.budget import Silent
from symflex.drawing import draw_model
from symflex.errors import SymflexError, Text
from symflex.expressions import parse, parse_equation
from symflex.figures import draw, render
from symflex.library.elements import ELEMENTS
from symflex.live.page import live_page
from symflex.loops.of_model import characteristic_loop
from symflex.print.forms import print_form, with_hidden
from symflex.print.mathml import EQUALS, math_element, mathml_expression, transfer_function_mathml

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from matplotlib.figure import Figure
    from mkdocs.config.defaults import MkDocsConfig

    from symflex.library.elements import Element
    from symflex.model import Model
    from symflex.transfer import AnyBoundFunction, AnyTransferFunction

T = TypeVar("T")
ROOT: Final = Path(__file__).parents[2]
MODELS: Final = ROOT / "derivations"
FONTS: Final = ROOT / "symflex" / "report" / "fonts"
FOLDERS: Final = {
    "eppinger1988": "One axis of a robot, and what bends in it",
    "eppinger1988/loops": "Loops around it, of position and of force",
    "classics": "Textbooks",
    "mechatronics": "Drives, loops and machines that touch",
    "transducers": "Transducers",
    "nonlinear": "Nonlinear equations and energies, about an operating point",
    "tapers": "Members that change along x",
    "frames": "Plane frames",
    "distributed": "Lines, ducts and pipes",
    "measured": "Machines that were measured",
}
"""Sections of the gallery."""
MOVING: Final = {
    "eppinger1988/two_mass.toml",
    "eppinger1988/six_mass.toml",
    "eppinger1988/sliding_free_beam.toml",
    "eppinger1988/loops/two_mass_position.toml",
    "classics/quarter_car.toml",
    "classics/clamped_free.toml",
}
"""Models that have a page with sliders too."""
FUNCTIONS_SHOWN: Final = 2
LONGEST: Final = 12_000
"""Characters of MathML: some eight lines."""
LONG_NUMBER: Final = re.compile(r"\d{12}")
"""Of models whose parameters are numbers of many digits."""
SHORTHANDS: Final = {"EI", "EA", "GJ", "rhoA", "rhoI", "rhoJ", "kappaGA"}
"""Parameters that replace a product of two others."""
GAIN: Final = "K"
"""Closes the loops in ``derivations/``."""
FORMULA: Final = re.compile(
    r"^<!-- (formula|equation): (.+) -->$.*?^<!-- end of formula -->$", re.MULTILINE | re.DOTALL
)
INLINE: Final = re.compile(r"<!-- math -->`([^`]+)`")
SPECIFICATION: Final = re.compile(
    r'^```toml title="([\w.]+)"\n(symflex = 1\n.*?)^```$', re.MULTILINE | re.DOTALL
)


# Every SVG has a parser of mathematics of its own; one for all remembers labels that many figures have.
textpath.MathTextParser = cache(mathtext.MathTextParser)  # type: ignore[attr-defined, assignment]


CACHE: Final = ROOT / ".site_cache"


@cache
def program() -> bytes:
    """Return what identifies the program and this file: a digest of their text."""
    sources = [
        *sorted((ROOT / "symflex").rglob("*.py")),
        *sorted((ROOT / "symflex").rglob("*.js")),
        Path(__file__),
    ]
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).digest()


def kept(made_from: str | bytes, make: Callable[[], T]) -> T:
    """Return what is made from a text by the program as it is, from an earlier build if there is one."""
    text = made_from if isinstance(made_from, bytes) else made_from.encode("utf-8")
    path = CACHE / hashlib.sha256(program() + text).hexdigest()
    if path.exists():
        found: T = pickle.loads(path.read_bytes())
        return found
    result = make()
    CACHE.mkdir(exist_ok=True)
    path.write_bytes(pickle.dumps(result))
    return result


@dataclass(frozen=True)
class Entry:
    """A model in the gallery."""

    path: str  # below derivations/
    title: str
    source: str
    doc: str
    formula: str  # HTML
    figures: tuple[tuple[str, bytes], ...]  # what each shows, and the drawing

    @property
    def stem(self) -> str:
        """Of the names of its files."""
        return self.path.removesuffix(".toml").replace("/", "_")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the font of formulas, and the figures and specifications of the gallery, to the site."""
    for font in sorted(FONTS.iterdir()):
        files.append(File.generated(config, f"stylesheets/{font.name}", content=font.read_bytes()))
    for name in ("CHANGELOG", "CONTRIBUTING", "SECURITY"):  # the repository's own pages
        page = (ROOT / f"{name}.md").read_text("utf-8").replace("](docs/", "](")
        files.append(File.generated(config, f"{name.lower()}.md", content=page))
    for entry in entries():
        text = (MODELS / entry.path).read_bytes()
        files.append(File.generated(config, f"gallery/{entry.stem}.toml", content=text))
        if entry.path in MOVING:
            moving = kept(b"live " + text, partial(moving_page, entry.path))
            files.append(File.generated(config, f"gallery/{entry.stem}.html", content=moving))
        for name, content in entry.figures:
            files.append(File.generated(config, f"gallery/{entry.stem}_{name}.svg", content=content))
    return files


def moving_page(path: str) -> str:
    """Return the page of a model with sliders."""
    model = pipeline.load(MODELS / path)
    return live_page([(model, model.transfer_functions[:FUNCTIONS_SHOWN])], Silent())


def on_page_markdown(markdown: str, **_: object) -> str:
    """Put the gallery and the formulas where a page asks for them."""
    titled = dict(SPECIFICATION.findall(markdown))
    if "<!-- gallery -->" in markdown:
        markdown = markdown.replace("<!-- gallery -->", "\n".join(_sections()))
    if "<!-- elements -->" in markdown:
        markdown = markdown.replace("<!-- elements -->", catalogue())
    if "<!-- drawings -->" in markdown:
        markdown = SPECIFICATION.sub(
            lambda match: f"{match[0]}\n\n{drawing_html(match[1], match[2])}\n", markdown
        )
    # Markdown would take <math> at the start of a line for a paragraph of its own.
    markdown = INLINE.sub(lambda match: f"<span>{typeset(match[1], is_display=False)}</span>", markdown)
    return FORMULA.sub(lambda match: _typeset_row(match[1], match[2], titled), markdown)


def _typeset_row(kind: str, asked: str, titled: Mapping[str, str]) -> str:
    if kind == "equation":
        return equation_html(asked)
    return kept(f"formula {asked} {titled}", lambda: formula_html(function_of(titled, *asked.split())))


def drawing_html(name: str, text: str) -> str:
    """Return the drawing of a specification as a picture."""
    return kept(f"drawing {name} {text}", lambda: picture(pipeline.loads(text), name))


def picture(model: Model, name: str) -> str:
    """Return the drawing of a model, to be written into a page."""
    content = b64encode(render(draw_model(model), "svg")).decode("ascii")
    alt = html.escape(f"{model.title or name}, drawn", quote=True)
    return f'<img class="drawing" src="data:image/svg+xml;base64,{content}" alt="{alt}">'


def catalogue() -> str:
    """Return all elements as cards: the drawing of each alone, its name and what it is."""
    cards = []
    for name, element in ELEMENTS.items():
        drawing = kept(f"element {alone(element)}", partial(drawn_alone, element))
        link = f'<a href="#{name}"><code>{name}</code></a>'
        cards.append(f"<figure>{drawing}<figcaption>{link} {element.summary}</figcaption></figure>")
    return "\n".join(('<div class="elements">', *cards, "</div>"))


def drawn_alone(element: Element) -> str:
    """Return the drawing of an element without arrows for an input that it does not need."""
    model = pipeline.loads(alone(element))
    return picture(
        replace(model, inputs=model.inputs if element.is_source else (), outputs=()), element.type_name
    )


def alone(element: Element) -> str:
    """Return a specification that holds one element and nothing else."""
    nodes = iter("abcdefgh")
    keys = [f'type = "{element.type_name}"']
    for port in element.ports:
        if port.default is None:
            listed = ", ".join(f'"{next(nodes)}"' for _ in range(port.terminals))
            keys.append(f"{port.name} = [{listed}]" if port.terminals > 1 else f"{port.name} = {listed}")
    needed = [p.name for p in element.parameters if p.default is None and not p.only]
    names = [name for name in needed if name not in SHORTHANDS or "rho" not in needed]
    keys += [f'{name} = "{name}"' for name in names]
    declared = "inputs" if element.is_source else "parameters"
    values = ", ".join(f"{name} = {{}}" for name in names)
    rest = "parameters = {}" if element.is_source else "inputs = { u = {} }"
    output = names[0] if element.is_source else "u"
    return f"""symflex = 1
{declared} = {{ {values} }}
{rest}
outputs = {{ y = "{output}" }}
elements = {{ {element.type_name.replace("_", "")} = {{ {", ".join(keys)} }} }}
"""


def typeset(text: str, *, is_display: bool) -> str:
    """Return an expression or equation in the notation of specifications as MathML."""
    whole = Text.alone("a page", text)
    if "=" in text:
        equation = parse_equation(whole)
        written = EQUALS.join(mathml_expression(side, {}) for side in (equation.left, equation.right))
    else:
        written = mathml_expression(parse(whole), {})
    return math_element(f"<mrow>{written}</mrow>", is_display=is_display)


def equation_html(text: str) -> str:
    """Return an equation in the notation of specifications, typeset on a line of its own."""
    return f'<div class="formula"><div class="row">{typeset(text, is_display=True)}</div></div>'


def function_of(titled: Mapping[str, str], path: str, pair: str) -> AnyTransferFunction:
    """Return a transfer function of a specification of the page, or in the repository."""
    model = pipeline.loads(titled[path]) if path in titled else pipeline.load(ROOT / path)
    return pipeline.derive_all(model, pipeline.pick_pairs(model, [pair]))[0]


@cache
def entries() -> tuple[Entry, ...]:
    """Return all models that are solvable, in the order of their sections."""
    paths = [path for folder in FOLDERS for path in sorted((MODELS / folder).glob("*.toml"))]
    shown = [path for path in paths if path.name != "claims.toml"]
    return tuple(Entry(*kept(_texts_of(path), partial(entry_of, path))) for path in shown)


def _texts_of(path: Path) -> bytes:
    """Return the text of a specification and of those beside it that it may read."""
    beside = sorted(path.parent.rglob("*.toml"))
    return b"\0".join([b"entry", path.name.encode("utf-8"), *(each.read_bytes() for each in beside)])


def entry_of(path: Path) -> tuple[str, str, str, str, str, tuple[tuple[str, bytes], ...]]:
    """Derive and draw one model: what an Entry has."""
    model = pipeline.load(path)
    name = path.relative_to(MODELS).as_posix()
    found = pipeline.derive_for_roots(model, model.transfer_functions[:FUNCTIONS_SHOWN])
    bounds = [bound for bound in found if not bound.is_zero]
    figures = tuple(_figures(model, bounds, is_loop="loops" in name))
    (symbolic,), _ = pipeline.derive_as(model, model.transfer_functions[:1])
    doc = tomllib.loads(path.read_text(encoding="utf-8")).get("doc", "")
    return name, model.title, model.source, doc, formula_html(symbolic, LONGEST), figures


def _figures(
    model: Model, bounds: Sequence[AnyBoundFunction], *, is_loop: bool
) -> Iterator[tuple[str, bytes]]:
    """Draw what can be drawn of a model."""
    kinds: dict[str, Callable[[], Figure]] = {
        "drawing": lambda: draw_model(model),
        "map": lambda: draw("poles_zeros", bounds),
        "bode": lambda: draw("bode", bounds),
    }
    if is_loop:
        kinds["map"] = lambda: draw("locus", characteristic_loop(model, GAIN))
    for name, drawing in kinds.items():
        try:
            yield name, render(drawing(), "svg")
        except SymflexError as problem:
            print(f"gallery: no {name} of {model.title}: {problem.diagnostics[0].message}")  # noqa: T201


def formula_html(tf: AnyTransferFunction, longest: float = inf) -> str:
    """Return a transfer function in its shortest form, typeset without any program but the browser."""
    form, _ = with_hidden(tf, print_form(tf))
    rows = transfer_function_mathml(tf, form) or ()
    markup = "".join(row.left + "".join(row.pieces) for row in rows)
    if not 0 < len(markup) <= longest or (longest < inf and LONG_NUMBER.search(markup)):
        return f"<p>The formula of {html.escape(tf.name)} takes a page: symflex derive prints it.</p>"
    lines = ['<div class="formula">']
    first = next((row for row in rows if row.is_where), None)
    for row in rows:
        word = "where " * (row is first)
        left = math_element(f"<mrow>{row.left}{EQUALS}</mrow>", is_display=True)
        right = " ".join(math_element(f"<mrow>{piece}</mrow>", is_display=True) for piece in row.pieces)
        lines.append(f'<div class="row{" where" if row.is_where else ""}">{word}{left} {right}</div>')
    return "\n".join((*lines, "</div>"))


CAPTIONS: Final = {"drawing": "the model", "map": "poles and zeros", "bode": "frequency response"}


def _sections() -> Iterator[str]:
    """Yield each section as thumbnails that open their entries; pictures are loaded when they are seen."""
    for folder, title in FOLDERS.items():
        yield f'\n## {title}\n\n<div class="thumbnails">'
        for entry in entries():
            if Path(entry.path).parent.as_posix() == folder:
                yield from _entry(entry)
        yield "</div>\n"


def _entry(entry: Entry) -> Iterator[str]:
    title, pictures = html.escape(entry.title), dict(entry.figures)
    first = next(iter(pictures), "")
    yield f'<details id="{entry.stem}"><summary>{_picture(entry, first)}<span>{title}</span></summary>'
    yield from (f"<p>{html.escape(line)}</p>" for line in (entry.source, entry.doc) if line)
    yield '<div class="gallery">'
    if "drawing" in pictures:
        yield _picture(entry, "drawing")
    yield entry.formula
    yield from (_picture(entry, name) for name in pictures if name != "drawing")
    moves = f'<a href="{entry.stem}.html">Move its parameters</a> · ' if entry.path in MOVING else ""
    yield f'</div><p>{moves}<a href="{entry.stem}.toml">Specification</a></p></details>'


def _picture(entry: Entry, name: str) -> str:
    shown = "root locus" if name == "map" and "loops" in entry.path else CAPTIONS.get(name, "")
    alt = html.escape(f"{entry.title}: {shown}", quote=True)
    return f'<img class="{name}" src="{entry.stem}_{name}.svg" alt="{alt}" loading="lazy">' if name else ""
