// A client of `symflex lsp` for Visual Studio Code, without dependencies.
"use strict";
const vscode = require("vscode");
const { spawn } = require("child_process");

const LANGUAGES = ["symflex", "toml"];
const SELECTOR = LANGUAGES.map((language) => ({ scheme: "file", language }));
const KINDS = { 3: "Function", 6: "Variable", 7: "Class", 10: "Property", 11: "Unit", 12: "Value" };

// A specification: a file of our language, or TOML that names the schema or its version.
const isOurs = (document) =>
    document.languageId === "symflex" ||
    (document.languageId === "toml" && /^(#:schema .*symflex|symflex\s*=\s*1\b)/m.test(document.getText().slice(0, 2000)));

class Server {
    constructor(command, onProblems) {
        this.waiting = new Map();
        this.number = 0;
        this.buffer = Buffer.alloc(0);
        this.onProblems = onProblems;
        this.process = spawn(command, ["lsp"]);
        this.process.stdout.on("data", (data) => this.received(data));
        this.process.on("error", (error) => {
            vscode.window.showErrorMessage(`symflex cannot be started (${error.message}): pip install 'symflex[editor]'`);
        });
        this.process.stdin.on("error", () => {});
        this.ready = this.ask("initialize", { processId: process.pid, rootUri: null, capabilities: {} });
        this.ready.then(() => this.tell("initialized", {}));
    }

    send(message) {
        const body = Buffer.from(JSON.stringify({ jsonrpc: "2.0", ...message }));
        this.process.stdin.write(`Content-Length: ${body.length}\r\n\r\n`);
        this.process.stdin.write(body);
    }

    tell(method, params) {
        this.send({ method, params });
    }

    ask(method, params) {
        const id = ++this.number;
        this.send({ id, method, params });
        return new Promise((resolve) => this.waiting.set(id, resolve));
    }

    received(data) {
        this.buffer = Buffer.concat([this.buffer, data]);
        for (;;) {
            const end = this.buffer.indexOf("\r\n\r\n");
            if (end < 0) return;
            const length = Number(/content-length: *(\d+)/i.exec(this.buffer.subarray(0, end).toString())[1]);
            if (this.buffer.length < end + 4 + length) return;
            const message = JSON.parse(this.buffer.subarray(end + 4, end + 4 + length).toString());
            this.buffer = this.buffer.subarray(end + 4 + length);
            if (message.method === "textDocument/publishDiagnostics") this.onProblems(message.params);
            else if (message.method === "window/showMessage") vscode.window.showWarningMessage(message.params.message);
            else if (this.waiting.has(message.id)) {
                if (message.error) vscode.window.showWarningMessage(message.error.message);
                this.waiting.get(message.id)(message.result ?? null);
                this.waiting.delete(message.id);
            }
        }
    }
}

const place = (at) => new vscode.Position(at.line, at.character);
const range = ({ start, end }) => new vscode.Range(place(start), place(end));
const edits = (changes) => {
    const edit = new vscode.WorkspaceEdit();
    for (const [uri, list] of Object.entries(changes))
        for (const one of list) edit.replace(vscode.Uri.parse(uri), range(one.range), one.newText);
    return edit;
};

function activate(context) {
    const problems = vscode.languages.createDiagnosticCollection("symflex");
    const shown = ({ uri, diagnostics }) => {
        const list = diagnostics.map((one) => {
            const severity = one.severity === 1 ? vscode.DiagnosticSeverity.Error : vscode.DiagnosticSeverity.Warning;
            const found = new vscode.Diagnostic(range(one.range), one.message, severity);
            Object.assign(found, { code: one.code, source: "symflex" });
            return found;
        });
        problems.set(vscode.Uri.parse(uri), list);
    };
    const server = new Server(vscode.workspace.getConfiguration("symflex").get("command"), shown);
    const about = (document, more) => ({ textDocument: { uri: document.uri.toString() }, ...more });
    const ask = (method, document, more) =>
        isOurs(document) ? server.ask(`textDocument/${method}`, about(document, more)) : Promise.resolve(null);
    const opened = (document) => {
        if (!isOurs(document)) return;
        const { languageId, version } = document;
        const item = { uri: document.uri.toString(), languageId, version, text: document.getText() };
        server.ready.then(() => server.tell("textDocument/didOpen", { textDocument: item }));
    };
    const changed = ({ document, contentChanges }) => {
        if (!isOurs(document) || !contentChanges.length) return;
        const textDocument = { uri: document.uri.toString(), version: document.version };
        const whole = [{ text: document.getText() }];
        server.ready.then(() => server.tell("textDocument/didChange", { textDocument, contentChanges: whole }));
    };
    const { languages } = vscode;
    context.subscriptions.push(
        problems,
        { dispose: () => server.process.kill() },
        vscode.workspace.onDidOpenTextDocument(opened),
        vscode.workspace.onDidChangeTextDocument(changed),
        vscode.workspace.onDidCloseTextDocument((document) => problems.delete(document.uri)),
        languages.registerHoverProvider(SELECTOR, {
            provideHover: async (document, position) => {
                const found = await ask("hover", document, { position });
                return found && new vscode.Hover(new vscode.MarkdownString(found.contents.value));
            },
        }),
        languages.registerCompletionItemProvider(
            SELECTOR,
            {
                provideCompletionItems: async (document, position) =>
                    ((await ask("completion", document, { position })) ?? []).map((one) =>
                        Object.assign(new vscode.CompletionItem(one.label, vscode.CompletionItemKind[KINDS[one.kind]]), {
                            detail: one.detail,
                        }),
                    ),
            },
            '"',
            "[",
            " ",
        ),
        languages.registerDefinitionProvider(SELECTOR, {
            provideDefinition: async (document, position) =>
                ((await ask("definition", document, { position })) ?? []).map(
                    (one) => new vscode.Location(vscode.Uri.parse(one.uri), range(one.range)),
                ),
        }),
        languages.registerRenameProvider(SELECTOR, {
            provideRenameEdits: async (document, position, newName) => {
                const found = await ask("rename", document, { position, newName });
                return found && edits(found.changes);
            },
        }),
        languages.registerCodeActionsProvider(SELECTOR, {
            provideCodeActions: async (document, where) => {
                const context = { diagnostics: [] };
                return ((await ask("codeAction", document, { range: where, context })) ?? []).map((one) =>
                    Object.assign(new vscode.CodeAction(one.title, vscode.CodeActionKind.QuickFix), {
                        edit: edits(one.edit.changes),
                    }),
                );
            },
        }),
        languages.registerFoldingRangeProvider(SELECTOR, {
            provideFoldingRanges: async (document) =>
                ((await ask("foldingRange", document, {})) ?? []).map(
                    (one) => new vscode.FoldingRange(one.startLine, one.endLine),
                ),
        }),
        languages.registerDocumentFormattingEditProvider(SELECTOR, {
            provideDocumentFormattingEdits: async (document) => {
                const options = { tabSize: 2, insertSpaces: true };
                return ((await ask("formatting", document, { options })) ?? []).map((one) =>
                    vscode.TextEdit.replace(range(one.range), one.newText),
                );
            },
        }),
    );
    vscode.workspace.textDocuments.forEach(opened);
}

module.exports = { activate };
