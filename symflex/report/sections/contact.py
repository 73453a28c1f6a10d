"""Whether the model is passive where it is touched, at each of its declared ports."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Final, TypeAlias

from symflex.contact.hybrid import HybridPassivity, find_hybrid
from symflex.contact.passivity import PortPassivity, driving_function, find_passivity
from symflex.contact.two_ports import find_two_ports
from symflex.errors import SymflexError, UncertifiedError
from symflex.figures import draw
from symflex.report.document import (
    Badge,
    Block,
    ChapterPart,
    Notice,
    Section,
    as_printed,
    code_of,
    marked,
    parted,
    picture,
)
from symflex.report.study import Study, attempt, said

if TYPE_CHECKING:
    from symflex.contact.two_ports import TwoPorts
    from symflex.model import Model

Judged: TypeAlias = "PortPassivity | HybridPassivity | TwoPorts"
MARKS: Final = {
    True: Badge("passive", "good"),
    False: Badge("active", "bad"),
    None: Badge("not decided", "bad"),
}
STABLE: Final = "With every passive thing that touches it there, the whole is stable."
BOTH: Final = 2  # ports that are judged together, too


def contact_section(study: Study) -> ChapterPart | None:
    """Return whether the model is passive at its ports, what repairs it, and what it is unstable with."""
    model = study.model
    if not model.ports:
        return None
    asked: list[tuple[str, Callable[[], Judged]]] = [
        (port.name, partial(_at, model, port.name)) for port in model.ports
    ]
    if len(model.ports) == BOTH and model.sampled is None:
        names = [port.name for port in model.ports]
        asked.append((" and ".join(names), partial(find_two_ports, model, names)))
    sections: list[Section] = []
    documents, warnings, files, code = [], list[str](), dict[str, bytes](), 0
    for i, (name, judge) in enumerate(asked):
        found = attempt(judge)
        anchor = f"{study.stem}-port-{i + 1}"
        if isinstance(found, SymflexError):
            sections.append(Section(f"Port {name}", (Notice(said(found)),), anchor))
            warnings.append(f"{study.stem}, port {name}: {said(found)}")
            code = max(code, code_of(found))
            continue
        blocks = _said_of(found)
        if isinstance(found, PortPassivity):
            function = attempt(partial(driving_function, model, name))
            drawn = (
                function
                if isinstance(function, SymflexError)
                else attempt(partial(draw, "passivity", [function]))
            )
            if not isinstance(drawn, SymflexError):
                caption = f"Real part at port {name}; it is negative in shaded bands"
                blocks.append(picture(f"{study.stem}_port_{name}", drawn, caption, files))
        sections.append(
            Section(f"Port {name}" if i < len(model.ports) else f"Ports {name}", tuple(blocks), anchor)
        )
        documents.append(found.to_json_dict())
        if found.passive is None:
            warnings.append(f"{study.stem}: whether it is passive at {name} is not certified")
            code = max(code, UncertifiedError.exit_code)
    content = {"schema": "symflex.report-ports/1", "ports": documents}
    files[f"data/{study.stem}_ports.json"] = json.dumps(content, indent=1).encode()
    return ChapterPart("In contact", parted(sections), files, tuple(warnings), code)


def _at(model: Model, name: str) -> PortPassivity | HybridPassivity:
    return find_passivity(model, name) if model.sampled is None else find_hybrid(model, name)


def _said_of(found: Judged) -> list[Block]:
    """Return the verdict as a badge, and below it what the command prints."""
    first, *others = found.passages()
    verdict = marked(MARKS[found.passive], STABLE if found.passive else "")
    return [verdict, *as_printed([first._replace(lines=first.lines[1:]), *others])]
