"""HTML for notebooks: tables of parameters and roots. No text of a model becomes markup or mathematics."""

from symflex.print.html.bound import bound_html
from symflex.print.html.model import model_html
from symflex.print.html.roots import roots_html
from symflex.print.html.text import escape_html

__all__ = ["bound_html", "escape_html", "model_html", "roots_html"]
