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
    const { kept } = JSON.parse(new TextDecoder().decode(await bytes("parts.json")));
    say("Loading Python");
    const packed = Promise.all(kept.filter((name) => name.includes("/wheels/")).map(bytes));
    const runtime = new URL(kept.find((name) => name.endsWith("/pyodide.mjs")), import.meta.url).href;
    const { loadPyodide } = await import(runtime);
    const python = await loadPyodide({ indexURL: new URL(".", runtime).href });
    say("Unpacking symflex");
    for (const wheel of await packed) python.unpackArchive(wheel, "zip", { extractDir: "/package" });
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
