"""The extension for Visual Studio Code, run in Node with a stand-in for the editor; nothing is downloaded."""

import json
import subprocess
import sys
import zipfile

import pytest

from tests.house.repository import ROOT

FOLDER = ROOT / "editors" / "vscode"
EDITOR = """
const Module = require("module"), providers = {}, kept = {};
const load = Module._load;
const given = (name) => (selector, provider) => { providers[name] = provider; return { dispose() {} }; };
class Plain { constructor(...given) { this.given = given; } }
const event = () => ({ dispose() {} });
const vscode = {
    Position: Plain, Range: Plain, Diagnostic: Plain, Hover: Plain, MarkdownString: Plain,
    FoldingRange: Plain, CompletionItem: Plain, CodeAction: Plain,
    Location: Plain, WorkspaceEdit: class { replace() {} },
    TextEdit: { replace: (...one) => one },
    DiagnosticSeverity: { Error: 0, Warning: 1 }, CompletionItemKind: {},
    CodeActionKind: { QuickFix: "quickfix" },
    Uri: { parse: (uri) => uri },
    window: { showErrorMessage: console.error, showWarningMessage: console.error },
    languages: new Proxy({ createDiagnosticCollection: () => ({ set: problems, delete() {} }) }, {
        get: (known, name) => known[name] ?? given(name),
    }),
    workspace: {
        getConfiguration: () => ({ get: () => process.argv[2] }), textDocuments: [],
        onDidOpenTextDocument: event, onDidChangeTextDocument: event, onDidCloseTextDocument: event,
    },
};
Module._load = (name, ...more) => (name === "vscode" ? vscode : load(name, ...more));
const text = require("fs").readFileSync(process.argv[3], "utf8");
const document = {
    languageId: "toml", version: 1, uri: { toString: () => "file:///a.toml" }, getText: () => text,
};
vscode.workspace.textDocuments.push(document);
async function problems(uri, list) {
    const where = { start: { line: 0, character: 0 }, end: { line: 9, character: 0 } };
    const actions = await providers.registerCodeActionsProvider.provideCodeActions(document, where);
    console.log(JSON.stringify([list.map((one) => one.code), actions.map((a) => a.given[0])]));
    process.exit(0);
}
require(process.argv[4]).activate({ subscriptions: [] });
"""
BROKEN = (
    'symflex = 1\n[parameters]\nm = "3 kgg"\n[inputs]\nF = { force = "x" }\n[outputs]\nX = "x"\n[elements]\n'
)


@pytest.mark.slow
@pytest.mark.needs_tool("node")
def test_the_extension_shows_problems_and_fixes(tmp_path):
    (tmp_path / "editor.js").write_text(EDITOR)
    model = tmp_path / "a.toml"
    model.write_text(BROKEN + 'body = { type = "mass", at = "x", m = "m" }\n')
    start = tmp_path / "symflex"
    start.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m symflex "$@"\n')
    start.chmod(0o755)
    command = ["node", "editor.js", str(start), str(model), str(FOLDER / "extension.js")]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    codes, fixes = json.loads(done.stdout)
    assert codes == ["SF201"] and fixes == ["Write kg"]


def test_the_extension_is_packed_without_network(tmp_path):
    command = [sys.executable, str(FOLDER / "pack.py"), str(tmp_path / "symflex.vsix")]
    subprocess.run(command, check=True)
    with zipfile.ZipFile(tmp_path / "symflex.vsix") as archive:
        packed = set(archive.namelist())
    listed = {f"extension/{path.name}" for path in FOLDER.iterdir() if path.suffix in {".js", ".json"}}
    assert packed == listed | {"[Content_Types].xml", "extension.vsixmanifest"}
