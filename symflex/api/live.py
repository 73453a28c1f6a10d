"""A page with sliders as a Python user holds it: shown in a notebook, or written to a file."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, Final

from symflex.errors.optional import installed
from symflex.files.write import write_atomically

HEIGHT: Final = "56rem"  # height of a page in a notebook: sliders, stability and four plots
WIDGET: Final = """
export default { render({ model, el }) {
    const frame = document.createElement("iframe");
    Object.assign(frame, { srcdoc: model.get("page"), sandbox: "allow-scripts allow-downloads" });
    Object.assign(frame.style, { width: "100%%", height: "%s", border: "0" });
    const heard = ({ source, data }) => {
        if (source !== frame.contentWindow || !data.symflex) return;
        model.set("values", data.symflex);
        model.save_changes();
    };
    addEventListener("message", heard);
    el.append(frame);
    return () => removeEventListener("message", heard);
} };
"""


@dataclass(frozen=True, slots=True)
class LivePage:
    """A page with a slider for every parameter, as ``symflex live`` writes it; a notebook shows it.

    Parameters
    ----------
    html : str
        The whole page, which needs nothing else.
    """

    html: str

    def __repr__(self) -> str:
        return f"<LivePage: {len(self.html) / 1000:.0f} kB>"

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.html)}" sandbox="allow-scripts allow-downloads" '
            f'style="width:100%;height:{HEIGHT};border:0"></iframe>'
        )

    def save(self, path: str | Path) -> None:
        """Write the page to a file; UsageError: SF903 if that cannot be written."""
        write_atomically(Path(path), self.html.encode())

    def widget(self) -> Any:  # noqa: ANN401 (anywidget is optional)
        """Return the page as an anywidget, whose ``values`` are those of the sliders [SI units].

        Raises
        ------
        UsageError
            SF902 if anywidget is not installed: ``pip install 'symflex[notebook]'``.
        """
        anywidget, traits = installed("anywidget"), installed("traitlets")
        tags = {"sync": True}
        body = {
            "_esm": WIDGET % HEIGHT,
            "page": traits.Unicode(self.html).tag(**tags),
            "values": traits.Dict().tag(**tags),
        }
        return type("LiveWidget", (anywidget.AnyWidget,), body)()
