// Packs what a browser loads, in place: node pack.mjs FOLDER PACKING MODEL, with runtime/ and wheels/ in FOLDER.
import fs from "node:fs";
import path from "node:path";

const [folder, packing, model] = process.argv.slice(2);
const read = (name) => new Uint8Array(fs.readFileSync(path.join(folder, name)));
const wheels = fs.readdirSync(path.join(folder, "wheels")).map((name) => `wheels/${name}`);
process.on("uncaughtException", ({ message }) => {
    console.error(message); // without the source line, which is all of the runtime
    process.exit(1);
});
const { loadPyodide } = await import(path.join(folder, "runtime/pyodide.mjs"));
const python = await loadPyodide({ indexURL: path.join(folder, "runtime/") });
for (const wheel of wheels) python.unpackArchive(read(wheel), "zip", { extractDir: "/package" });
python.FS.writeFile("/packing.py", fs.readFileSync(packing, "utf8"));
python.globals.set("text", fs.readFileSync(model, "utf8"));
const packed = python.runPython(`
import json, sys
sys.path[:0] = ["/package", "/"]
from answers import answer
def ask(question, **given):
    return json.loads(answer(question, json.dumps({"text": text, **given})))
model = ask("examine")
name, pair = model["functions"][0], model["functions"][0].split("/")
ask("formula", pair=pair)
ask("drawing")
ask("command", arguments=["roots", "--tf", name, "--json"])
ask("response", pair=pair, frequencies=[1.0])
ask("command", arguments=["respond", "--tf", name, "--json"])
ask("command", arguments=["stability", "--gain", model["gain"]])
ask("command", arguments=["derive", "--tf", name, "--format", "latex"])
places = [getattr(module, "__file__", None) or "" for module in sys.modules.values()]
roots = "/package/", "/lib/python%d%d.zip/" % sys.version_info[:2]
imported = {place.removeprefix(root) for place in places for root in roots}
from packing import packed
lambda archives: packed(archives.to_py(), imported)
`);
const archives = ["runtime/python_stdlib.zip", ...wheels];
const found = packed(Object.fromEntries(archives.map((name) => [name, read(name)])));
for (const [name, bytes] of Object.entries(found.toJs())) fs.writeFileSync(path.join(folder, name), bytes);
