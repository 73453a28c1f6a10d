// Runs symflex in a thread of its own: Python in WebAssembly, from files beside the page.

// Pyodide tries whether there is such a function, which the policy of the page forbids.
globalThis.importScripts = undefined;
const say = (doing) => postMessage({ doing });

async function bytes(name) {
    const found = await fetch(new URL(name, import.meta.url));
    if (!found.ok) throw new Error(`${name}: ${found.status}`);
    return new Uint8Array(await found.arrayBuffer());
}

async function started() {
    const { wheels } = JSON.parse(new TextDecoder().decode(await bytes("parts.json")));
    say("Loading Python");
    const packed = Promise.all(wheels.map(bytes));
    const sources = Promise.all(["answers.py", "arrays.py", "letters.py", "letters.json"].map(bytes));
    const { loadPyodide } = await import("./runtime/pyodide.mjs");
    const python = await loadPyodide({ indexURL: new URL("runtime/", import.meta.url).href });
    say("Unpacking symflex");
    for (const wheel of await packed) python.unpackArchive(wheel, "zip", { extractDir: "/package" });
    const [answers, arrays, letters, widths] = await sources;
    python.FS.writeFile("/package/answers.py", answers);
    python.FS.writeFile("/package/letters.py", letters);
    python.FS.writeFile("/package/letters.json", widths);
    if (!wheels.some((name) => /^wheels\/numpy-/.test(name))) python.FS.writeFile("/package/numpy.py", arrays);
    say("Starting symflex");
    return python.runPython(`
import sys
sys.path.insert(0, "/package")
from answers import answer
answer
`);
}

const answer = started();
answer.then(() => postMessage({ ready: true }), (error) => postMessage({ failed: String(error) }));

onmessage = async ({ data: { number, question, given } }) => {
    try {
        postMessage({ number, found: (await answer)(question, given) });
    } catch (error) {
        postMessage({ number, failed: String(error) });
    }
};
