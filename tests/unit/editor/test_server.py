"""The language server as an editor drives it: messages over a pipe, counted in UTF-16 as in the protocol."""

import json
import subprocess
import sys
import threading

import pytest

from symflex.editor import examined
from tests.house.repository import ROOT
from tests.unit.editor.test_document import MODEL

FILE = ROOT / "a.toml"
URI = FILE.as_uri()
LAYOUT = {"tabSize": 2, "insertSpaces": True}
PATIENCE = 60  # seconds after which a server that does not answer is ended


class Editor:
    """A client that asks and waits."""

    def __init__(self):
        self.number = 0
        self.process = subprocess.Popen(
            [sys.executable, "-m", "symflex", "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT
        )
        self.end = threading.Timer(PATIENCE, self.process.kill)
        self.end.start()
        self.offers = self.ask("initialize", processId=None, rootUri=None, capabilities={})["capabilities"]
        self.tell("initialized")

    def send(self, **message):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
        self.process.stdin.flush()

    def receive(self):
        length = 0
        while line := self.process.stdout.readline().strip():
            if line.lower().startswith(b"content-length"):
                length = int(line.split(b":")[1])
        return json.loads(self.process.stdout.read(length))

    def tell(self, method, **params):
        self.send(method=method, params=params)

    def ask(self, method, **params):
        self.number += 1
        self.send(id=self.number, method=method, params=params)
        while (message := self.receive()).get("id") != self.number:
            pass
        if "error" in message:
            raise KeyError(message["error"]["message"])
        return message["result"]

    def problems(self):
        while (message := self.receive()).get("method") != "textDocument/publishDiagnostics":
            pass
        return message["params"]["diagnostics"]

    def opened(self, text):
        document = {"uri": URI, "languageId": "toml", "version": 1, "text": text}
        self.tell("textDocument/didOpen", textDocument=document)
        return self.problems()

    def about(self, method, at, **more):
        return self.ask(f"textDocument/{method}", textDocument={"uri": URI}, position=at, **more)


@pytest.fixture(scope="module")
def editor():
    client = Editor()
    with client.process:
        yield client
        client.end.cancel()
        client.process.kill()


def position(text, offset):
    line = text.rfind("\n", 0, offset) + 1
    return {"line": text.count("\n", 0, offset), "character": len(text[line:offset].encode("utf-16-le")) // 2}


def edited(text, edits):
    """Return a text after edits of the protocol."""
    lines = text.splitlines(keepends=True)

    def offset(at):
        line = lines[at["line"]] if at["line"] < len(lines) else ""
        before = line.encode("utf-16-le")[: 2 * at["character"]].decode("utf-16-le")
        return sum(map(len, lines[: at["line"]])) + len(before)

    for edit in sorted(edits, key=lambda e: -offset(e["range"]["start"])):
        start, end = offset(edit["range"]["start"]), offset(edit["range"]["end"])
        text = text[:start] + edit["newText"] + text[end:]
    return text


def test_problems_of_each_state_are_those_of_a_check_with_their_ranges(editor):
    slips = [
        ('"3 kg"', '"3 kgg"'),
        ('"mass"', '"mas"'),
        ('(k/m)"', '(k/m"'),
        ("[inputs]", ""),
        ("doc =", "dok ="),
    ]
    text, version = "# \U0001d714 omega\n" + MODEL, 1
    assert editor.opened(text) == []
    for old, new in slips:
        for before, after in ((old, new), (new, old)) if new else ((old, new),):
            start, version = text.index(before), version + 1
            change = {
                "range": {"start": position(text, start), "end": position(text, start + len(before))},
                "text": after,
            }
            document = {"uri": URI, "version": version}
            editor.tell("textDocument/didChange", textDocument=document, contentChanges=[change])
            text = text[:start] + after + text[start + len(before) :]
            shown = editor.problems()
            assert [(d["code"], d["range"]["start"], d["range"]["end"]) for d in shown] == [
                (p.code, position(text, p.span.start), position(text, max(p.span.end, p.span.start + 1)))
                for p in examined(text, str(FILE)).problems
            ]


def test_an_editor_applies_fix_rename_and_layout_and_the_file_checks(editor):
    slipped = MODEL.replace('"3 kg"', '"3 kgg"')
    (problem,) = editor.opened(slipped)
    context = {"diagnostics": [problem]}
    (action,) = editor.ask(
        "textDocument/codeAction", textDocument={"uri": URI}, range=problem["range"], context=context
    )
    assert edited(slipped, action["edit"]["changes"][URI]) == MODEL
    editor.opened(MODEL)
    at = position(MODEL, MODEL.index("omega_0"))
    renamed = edited(MODEL, editor.about("rename", at, newName="w_n")["changes"][URI])
    assert renamed.count("w_n") == 2 and examined(renamed, "a.toml").problems == ()
    with pytest.raises(KeyError, match="'m' is a name of this specification"):
        editor.about("rename", at, newName="m")
    assert editor.ask("textDocument/formatting", textDocument={"uri": URI}, options=LAYOUT) == []


def test_an_editor_shows_formulas_definitions_and_completions(editor):
    editor.opened(MODEL)
    output = position(MODEL, MODEL.index('"X"') + 1)
    assert "X/F" in editor.about("hover", output)["contents"]["value"]
    used = position(MODEL, MODEL.index("omega_0^2"))
    (defined,) = editor.about("definition", used)
    assert defined["range"]["start"] == position(MODEL, MODEL.index("omega_0"))
    inside = position(MODEL, MODEL.index('"mass"') + 3)
    assert {"mass", "massless_beam"} <= {c["label"] for c in editor.about("completion", inside)}
    assert editor.ask("textDocument/foldingRange", textDocument={"uri": URI})[0] == {
        "startLine": 2,
        "endLine": 4,
    }


def test_a_file_that_is_not_open_has_no_answers_and_a_session_ends_well():
    client = Editor()
    with client.process:
        assert client.about("hover", {"line": 0, "character": 0}) is None
        assert client.ask("shutdown") is None
        client.send(method="exit")
        assert client.process.wait(PATIENCE) == 0
        client.end.cancel()
