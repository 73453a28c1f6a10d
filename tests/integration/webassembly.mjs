// Runs commands of symflex in WebAssembly: node webassembly.mjs RUNTIME PACKAGE FOLDER JOBS ANSWERS
import fs from "fs";
import path from "path";

const [runtime, packed, folder, jobs, answers] = process.argv.slice(2);
const { loadPyodide } = await import(path.join(runtime, "node_modules/pyodide/pyodide.mjs"));
const python = await loadPyodide({ indexURL: path.join(runtime, "node_modules/pyodide/") });
for (const name of fs.readdirSync(runtime).filter((name) => name.endsWith(".whl")))
    python.unpackArchive(new Uint8Array(fs.readFileSync(path.join(runtime, name))), "wheel", { extractDir: "/package" });
python.unpackArchive(new Uint8Array(fs.readFileSync(packed)), "zip", { extractDir: "/package" });
process.on("uncaughtException", ({ message }) => {
    console.error(message); // without the source line, which is all of the runtime
    process.exit(1);
});
python.mountNodeFS("/models", folder);
const run = python.runPython(`
import contextlib, io, os, sys
sys.path.insert(0, "/package")
from symflex.cli import run as command

def run(file, *arguments):
    os.chdir(os.path.join("/models", os.path.dirname(file)))
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = command([arguments[0], os.path.basename(file), *arguments[1:]])
    return code, out.getvalue(), err.getvalue()

run
`);
const found = JSON.parse(fs.readFileSync(jobs)).map((job) => run(...job).toJs());
fs.writeFileSync(answers, JSON.stringify(found));
