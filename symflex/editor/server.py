"""``symflex lsp``: a language server for specifications, over standard input and output.

Input: messages of the Language Server Protocol 3.17 from an editor. Output: problems with their ranges,
quick fixes, hover, completion, definitions, rename, folding and layout, all by the other modules of this
package. One process keeps every open document as it was last examined, so that a question after a keystroke
parses nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final
from urllib.parse import unquote, urlparse

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer

from symflex.editor.completion import completions
from symflex.editor.document import OpenDocument, examined
from symflex.editor.fixes import fixes
from symflex.editor.hover import hover
from symflex.editor.layout import folds, tidied
from symflex.editor.rename import renamed
from symflex.errors import Diagnostic, UsageError

KINDS: Final = {
    "key": types.CompletionItemKind.Property,
    "type": types.CompletionItemKind.Class,
    "name": types.CompletionItemKind.Variable,
    "unit": types.CompletionItemKind.Unit,
    "function": types.CompletionItemKind.Function,
    "value": types.CompletionItemKind.Value,
}
SEVERITIES: Final = {"error": types.DiagnosticSeverity.Error, "warning": types.DiagnosticSeverity.Warning}


def language_server(version: str) -> LanguageServer:
    """Return a server that is ready to start."""
    server = LanguageServer("symflex", version)
    answers = _Answers(server)
    for method, answer in (
        (types.TEXT_DOCUMENT_DID_OPEN, answers.changed),
        (types.TEXT_DOCUMENT_DID_CHANGE, answers.changed),
        (types.TEXT_DOCUMENT_DID_CLOSE, answers.closed),
        (types.TEXT_DOCUMENT_HOVER, answers.hover),
        (types.TEXT_DOCUMENT_CODE_ACTION, answers.actions),
        (types.TEXT_DOCUMENT_DEFINITION, answers.definition),
        (types.TEXT_DOCUMENT_REFERENCES, answers.references),
        (types.TEXT_DOCUMENT_RENAME, answers.rename),
        (types.TEXT_DOCUMENT_FOLDING_RANGE, answers.folding),
        (types.TEXT_DOCUMENT_FORMATTING, answers.formatting),
    ):
        server.feature(method)(
            _plain(answer if method == types.TEXT_DOCUMENT_DID_CLOSE else answers.of_open(answer))
        )
    triggers = types.CompletionOptions(trigger_characters=['"', "[", " "])
    server.feature(types.TEXT_DOCUMENT_COMPLETION, triggers)(_plain(answers.of_open(answers.completion)))
    return server


def _plain(answer: Callable[[Any], object]) -> Callable[[Any], object]:
    """Return a function in place of a method, on which pygls can note what it answers."""

    def plain(params: Any) -> object:  # noqa: ANN401 (each message has its own type)
        return answer(params)

    return plain


Asked = (
    types.HoverParams
    | types.CompletionParams
    | types.DefinitionParams
    | types.ReferenceParams
    | types.RenameParams
)


class _Answers:
    """What is answered, from the documents that are open."""

    def __init__(self, server: LanguageServer) -> None:
        self.server = server
        self.documents: dict[str, OpenDocument] = {}

    def of_open(self, answer: Callable[[Any], object]) -> Callable[[Any], object]:
        """Return what answers questions about open documents, and nothing to those about others."""

        def of_this(params: Any) -> object:  # noqa: ANN401 (each message has its own type)
            is_open = params.text_document.uri in self.server.workspace.text_documents
            return answer(params) if is_open else None

        return of_this

    def _document(self, uri: str) -> OpenDocument:
        text = self.server.workspace.get_text_document(uri).source
        known = self.documents.get(uri)
        if known is None or known.source.text != text:
            known = self.documents[uri] = examined(text, _file_of(uri))
        return known

    def _position(self, uri: str, offset: int) -> types.Position:
        return self.server.workspace.get_text_document(uri).client_position_at_offset(offset)

    def _range(self, uri: str, start: int, end: int) -> types.Range:
        return types.Range(start=self._position(uri, start), end=self._position(uri, end))

    def _asked(self, params: Asked) -> tuple[str, OpenDocument, int]:
        uri = params.text_document.uri
        offset = self.server.workspace.get_text_document(uri).offset_at_position(params.position)
        return uri, self._document(uri), offset

    def _shown(self, uri: str, problem: Diagnostic) -> types.Diagnostic:
        """Return a problem; one in another file, or without a place, stands at the first character."""
        span = problem.span.origin if problem.span else None
        is_here = span is not None and span.source.text == self.documents[uri].source.text
        start, end = (span.start, max(span.end, span.start + 1)) if span is not None and is_here else (0, 1)
        hint = f"\n{problem.hint}" if problem.hint else ""
        return types.Diagnostic(
            range=self._range(uri, start, end),
            message=problem.message + hint,
            severity=SEVERITIES[problem.severity],
            code=problem.code,
            source="symflex",
        )

    def changed(self, params: types.DidOpenTextDocumentParams | types.DidChangeTextDocumentParams) -> None:
        uri = params.text_document.uri
        problems = [self._shown(uri, problem) for problem in self._document(uri).problems]
        self._publish(uri, problems)

    def closed(self, params: types.DidCloseTextDocumentParams) -> None:
        self.documents.pop(params.text_document.uri, None)
        self._publish(params.text_document.uri, [])

    def _publish(self, uri: str, problems: Sequence[types.Diagnostic]) -> None:
        self.server.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri=uri, diagnostics=problems)
        )

    def hover(self, params: types.HoverParams) -> types.Hover | None:
        _, document, offset = self._asked(params)
        said = hover(document, offset)
        if said is None:
            return None
        return types.Hover(contents=types.MarkupContent(kind=types.MarkupKind.Markdown, value=said))

    def completion(self, params: types.CompletionParams) -> list[types.CompletionItem]:
        _, document, offset = self._asked(params)
        return [
            types.CompletionItem(label=c.text, kind=KINDS[c.kind], detail=c.says or None)
            for c in completions(document, offset)
        ]

    def actions(self, params: types.CodeActionParams) -> list[types.CodeAction]:
        uri = params.text_document.uri
        document = self._document(uri)
        wanted = (params.range.start.line, params.range.end.line)
        found = []
        for problem in document.problems:
            shown = self._shown(uri, problem)
            if not wanted[0] <= shown.range.start.line <= wanted[1]:
                continue
            for fix in fixes(document, problem):
                edit = types.TextEdit(range=self._range(uri, fix.start, fix.end), new_text=fix.text)
                found.append(
                    types.CodeAction(
                        title=fix.title,
                        kind=types.CodeActionKind.QuickFix,
                        diagnostics=[shown],
                        edit=types.WorkspaceEdit(changes={uri: [edit]}),
                    )
                )
        return found

    def _places(self, params: Asked, *, all_of_them: bool) -> list[types.Location]:
        uri, document, offset = self._asked(params)
        name = document.at(offset)
        return [
            types.Location(uri=uri, range=self._range(uri, each.span.start, each.span.end))
            for each in document.names
            if name is not None and each.name == name.name and (each.is_definition or all_of_them)
        ]

    def definition(self, params: types.DefinitionParams) -> list[types.Location]:
        return self._places(params, all_of_them=False)

    def references(self, params: types.ReferenceParams) -> list[types.Location]:
        return self._places(params, all_of_them=True)

    def rename(self, params: types.RenameParams) -> types.WorkspaceEdit | None:
        uri, document, offset = self._asked(params)
        name = document.at(offset)
        if name is None:
            return None
        try:
            text = renamed(document, name.name, params.new_name)
        except UsageError as error:
            reason = error.diagnostics[0].message
            raise JsonRpcException(reason, types.LSPErrorCodes.RequestFailed) from None
        return types.WorkspaceEdit(changes={uri: self._whole(uri, document, text)})

    def _whole(self, uri: str, document: OpenDocument, text: str) -> list[types.TextEdit]:
        return [types.TextEdit(range=self._range(uri, 0, len(document.source.text)), new_text=text)]

    def folding(self, params: types.FoldingRangeParams) -> list[types.FoldingRange]:
        document = self._document(params.text_document.uri)
        return [types.FoldingRange(start_line=first, end_line=last) for first, last in folds(document)]

    def formatting(self, params: types.DocumentFormattingParams) -> list[types.TextEdit]:
        uri = params.text_document.uri
        document = self._document(uri)
        text = tidied(document)
        return [] if text == document.source.text else self._whole(uri, document, text)


def _file_of(uri: str) -> str:
    """Return the path of a document, beside which its ``model`` blocks are read."""
    parsed = urlparse(uri)
    return str(Path(unquote(parsed.path))) if parsed.scheme == "file" else "<editor>"
