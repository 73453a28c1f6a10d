// The page: a model on the left, and on the right its formula, roots and plots. Nothing leaves the browser.
import { Editor } from "./editor.js";
import { bode, drawn, rootMap, step as stepPlot } from "./plots.js";
import { model as ofLink, link } from "./link.js";

const here = (id) => document.getElementById(id);
const body = (id) => here(id).querySelector(".body");
const PAUSE = 180; // after the last key, before a model is examined [ms]
const TARGETS = {
    LaTeX: ["derive", "--format", "latex"],
    "plain text": ["derive"],
    numpy: ["export", "--to", "numpy"],
    JavaScript: ["export", "--to", "js"],
    C: ["export", "--to", "c"],
    JSON: ["derive", "--json"],
    Typst: ["derive", "--format", "typst"],
};
const MATHML = "http://www.w3.org/1998/Math/MathML";
const MATHEMATICS = new Set("math mrow mi mn mo mfrac msup msub msubsup msqrt mroot mtext mspace mover munder munderover mtable mtr mtd mstyle mpadded mphantom".split(" "));
const ATTRIBUTES = new Set("class display displaystyle mathvariant lspace rspace width stretchy fence minsize maxsize columnalign scriptlevel accent symmetric".split(" "));

/** Addresses of this folder's scripts, the only ones that start. */
const scripts = window.trustedTypes?.createPolicy("symflex", {
    createScriptURL: (address) => {
        const { protocol, origin } = new URL(address, location);
        if (protocol !== "blob:" && origin !== location.origin) throw new TypeError(address);
        return address;
    },
});
const trusted = (address) => (scripts ? scripts.createScriptURL(address) : address);

function made(name, attributes = {}, ...children) {
    const node = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.append(...children);
    return node;
}

// ------------------------------------------------------------------------------------------------ worker

/** The thread that computes. Stopping ends it, and starts another one. */
class Thread {
    constructor() {
        this.number = 0;
        this.start();
    }

    start() {
        this.waiting = new Map();
        // A thread made of a blob is bound by the policy of this page.
        const blob = new Blob([`import ${JSON.stringify(new URL("worker.js", import.meta.url).href)};`], { type: "text/javascript" });
        const address = URL.createObjectURL(blob);
        this.worker = new Worker(trusted(address), { type: "module" });
        this.ready = new Promise((resolve, reject) => {
            this.worker.onerror = (event) => reject(new Error(event.message || "the thread did not start"));
            this.worker.onmessage = ({ data }) => {
                if (data.doing) say(data.doing, true);
                else if (data.ready) resolve();
                else if (data.failed && !data.number) reject(new Error(data.failed));
                else {
                    const { resolve, reject } = this.waiting.get(data.number) ?? {};
                    this.waiting.delete(data.number);
                    if (data.failed) reject?.(new Error(data.failed));
                    else resolve?.(JSON.parse(data.found));
                }
            };
        });
        this.ready.catch(() => {});
    }

    ask(question, given) {
        const number = ++this.number;
        this.worker.postMessage({ number, question, given: JSON.stringify(given) });
        return new Promise((resolve, reject) => this.waiting.set(number, { resolve, reject }));
    }

    stop() {
        this.worker.terminate();
        for (const { reject } of this.waiting.values()) reject(new Stopped());
        this.start();
    }
}

class Stopped extends Error {}

// ------------------------------------------------------------------------------------------------ status

let began = 0, doing = "", ticking = 0;

function say(what, isBusy = false) {
    doing = what;
    document.body.classList.toggle("busy", isBusy);
    here("stop").disabled = !isBusy || !isLoaded;
    began = performance.now();
    clearInterval(ticking);
    here("doing").textContent = what;
    if (isBusy)
        ticking = setInterval(() => {
            const seconds = Math.round((performance.now() - began) / 1000);
            if (seconds > 1) here("doing").textContent = `${doing}, ${seconds} s`;
        }, 1000);
}

// ------------------------------------------------------------------------------------------------ panels

const refusal = (message) => made("p", { class: "refused" }, message);
const firstError = (err) => err.split("\n").filter((line) => line && !/^showing /.test(line)).join("\n").replace(/^error(\[SF\d+\])?: /, "");

/** Mathematics of nested lists, of the elements that are mathematics and no others. */
function mathematics([name, attributes, children]) {
    const node = MATHEMATICS.has(name) ? document.createElementNS(MATHML, name) : document.createElement("span");
    for (const [key, value] of Object.entries(attributes)) if (ATTRIBUTES.has(key)) node.setAttribute(key, value);
    node.append(...children.map((child) => (typeof child === "string" ? child : mathematics(child))));
    return node;
}

function showFormula({ found, err }) {
    if (err) return [refusal(err)];
    if (!found) return [made("p", { class: "quiet" }, "The formula is long: copy it as plain text below.")];
    return found.map(({ where, math }) => {
        const row = mathematics(math);
        row.className = where ? "row where" : "row";
        return row;
    });
}

const digits = (x, count = 7) => {
    const number = Number(x);
    if (!number) return "0";
    const size = Math.abs(number);
    return (size >= 1e-3 && size < 1e6 ? String(+number.toPrecision(count)) : number.toExponential(count - 1)).replaceAll("-", "\u2212");
};

function rootTable(roots, name) {
    const upper = roots.filter((r) => !r.im.startsWith("-"));
    const rows = upper.slice(0, 40).map((r) => {
        const isReal = r.is_real || Number(r.im) === 0;
        const value = isReal ? digits(r.re) : `${Number(r.re) ? `${digits(r.re, 6)} ` : ""}± ${digits(r.im, 6)} j`;
        const zeta = r.damping_ratio === null ? "" : digits(r.damping_ratio, 4);
        const times = r.multiplicity > 1 ? ` ×${r.multiplicity}` : "";
        return made("tr", {}, ...[value + times, digits(r.frequency_hz, 6), zeta, r.radius === "0" ? "exact" : digits(r.radius, 2)].map((c) => made("td", {}, c)));
    });
    if (!rows.length) return made("p", { class: "quiet" }, `no ${name}`);
    const head = made("tr", {}, ...[`s [rad/s]`, "f [Hz]", "ζ", "within"].map((c) => made("th", { scope: "col" }, c)));
    return made("table", {}, made("caption", {}, name), made("thead", {}, head), made("tbody", {}, ...rows));
}

function verdicts(map) {
    const found = [];
    const { verdict, reason, right_half_plane: right } = map.stability ?? {};
    if (verdict) {
        const kind = verdict === "stable" ? "good" : verdict === "unstable" ? "bad" : "";
        const why = reason || (right ? `${right} in the right half-plane` : "");
        found.push(made("span", { class: `verdict ${kind}` }, why ? `${verdict}: ${why}` : verdict));
    }
    found.push(made("span", { class: `verdict ${map.certified ? "good" : ""}` }, map.certified ? "certified: none is missing" : "not certified"));
    return found;
}

function showRoots({ code, out, err }) {
    if (!out) return [refusal(firstError(err))];
    const map = JSON.parse(out);
    const hidden = map.hidden?.length ? [made("p", { class: "quiet" }, `${map.hidden.length} hidden: cancelled in this function`)] : [];
    return [...verdicts(map), rootMap(map.poles, map.zeros), rootTable(map.poles, "poles"), rootTable(map.zeros, "zeros"), ...hidden];
}

const said = (text) => made("pre", { class: "said", tabindex: 0 }, text);

// ---------------------------------------------------------------------------------------------- a round

let isLoaded = false, round = 0, timer = 0, settled = Promise.resolve();
const results = {}; // what the commands printed, for copying and for tests
const thread = new Thread();
const editor = new Editor(here("editor"), {
    changed: () => {
        here("example").value = "";
        later();
    },
    complete: async (text, offset) => (isLoaded ? thread.ask("complete", { text, offset }).catch(() => null) : null),
});

function later() {
    clearTimeout(timer);
    timer = setTimeout(run, PAUSE);
}

/** Show everything of the model as it is now. */
function run() {
    clearTimeout(timer);
    timer = 0;
    settled = work(++round).catch((error) => {
        if (error instanceof Stopped) return;
        say(`It failed: ${error.message.trim().split("\n").at(-1)}`);
    });
    return settled;
}

const PANELS = ["drawing", "formula", "roots", "bode", "step", "stability", "code"];
const fade = (isStale) => PANELS.forEach((id) => here(id).classList.toggle("stale", isStale));

async function work(own) {
    await thread.ready;
    isLoaded = true;
    const text = editor.text;
    const isOld = () => own !== round;
    const step = async (what, question, given) => {
        say(what, true);
        const found = await thread.ask(question, { text, ...given });
        if (isOld()) throw new Stopped();
        return found;
    };
    const start = performance.now();
    fade(true);
    results.text = null;
    const model = await step("Checking", "examine", {});
    editor.mark(model.problems);
    showProblems(model.problems);
    results.problems = model.problems;
    if (!model.functions) {
        results.text = text;
        return say(`${model.problems.length} problem${model.problems.length > 1 ? "s" : ""}`);
    }
    const pair = choose("pair", model.functions, model.functions[0]);
    const show = (id, ...nodes) => {
        here(id).classList.remove("stale");
        body(id).replaceChildren(...nodes);
    };
    if (pair) {
        const command = (what, ...options) => step(what, "command", { arguments: options });
        show("formula", ...showFormula(await step(`Deriving ${pair}`, "formula", { pair: pair.split("/") })));
        results.first ??= performance.now();
        await showDrawing(step, show);
        const located = await command(`Proving poles and zeros of ${pair}`, "roots", "--tf", pair, "--json");
        results.roots = located;
        show("roots", ...showRoots(located));
        await showResponse(step, show, pair, model.band, located.out ? JSON.parse(located.out) : null);
        await showStability(command, show, model);
        await showCode(command, show, pair);
        await showStep(command, show, pair, located.out ? JSON.parse(located.out) : null);
    }
    results.text = text;
    fade(false);
    say(`Done in ${((performance.now() - start) / 1000).toFixed(1)} s`);
}

function showProblems(problems) {
    const rows = problems.map((problem, i) => {
        const at = problem.line ? `${problem.line}:${problem.column}` : "";
        const button = made("button", { type: "button", class: problem.severity }, made("span", { class: "at" }, at), made("b", {}, problem.message));
        if (problem.hint) button.append(made("small", {}, problem.hint));
        button.addEventListener("click", () => editor.go(problems.slice(0, i).filter((p) => p.line).length));
        return made("li", {}, button);
    });
    here("problems").replaceChildren(...rows);
}

/** Fill a select, keep what is chosen where it is still there, and return that. */
function choose(id, names, fallback) {
    const select = here(id), before = select.value;
    const same = select.options.length === names.length && names.every((n, i) => select.options[i].value === n);
    if (!same) select.replaceChildren(...names.map((n) => made("option", { value: n }, n || "nothing")));
    select.value = names.includes(before) && before ? before : fallback ?? "";
    return select.value;
}

async function showDrawing(step, show) {
    const { found } = await step("Drawing", "drawing", {});
    here("drawing").hidden = !found;
    if (found) show("drawing", drawn(found));
}

async function showResponse(step, show, pair, band, map) {
    const roots = map ? [...map.poles, ...map.zeros] : [];
    const sizes = roots.map((r) => Math.hypot(Number(r.re), Number(r.im)) / (2 * Math.PI)).filter((f) => f > 0);
    const [low, high] = band.length ? band : sizes.length ? [Math.min(...sizes) / 30, Math.max(...sizes) * 3] : [0.1, 100];
    const count = 240, grid = new Set();
    for (let i = 0; i <= count; i++) grid.add(low * (high / low) ** (i / count));
    // A resonance is narrower than the grid.
    for (const root of roots) {
        const f = Math.abs(Number(root.im)) / (2 * Math.PI), wide = Math.max(Math.abs(Number(root.re)) / (2 * Math.PI), 1e-4 * f);
        const isOnAxis = Number(root.re) === 0; // where the response is infinite, or zero
        for (const share of [-6, -3, -1.5, -0.7, -0.3, 0, 0.3, 0.7, 1.5, 3, 6]) if (share || !isOnAxis) grid.add(f + share * wide);
    }
    const hertz = [...grid].filter((f) => f >= low && f <= high).sort((a, b) => a - b);
    const { found, err } = await step(`Evaluating ${pair}`, "response", { pair: pair.split("/"), frequencies: hertz });
    const plot = found && bode(hertz, found, "");
    show("bode", plot || refusal(err || "the function is zero"));
}

/** Measures of a step response: names as tables of controls have them, and what a value is multiplied by. */
const MEASURES = {
    final: ["final value"], peak: ["peak"], peak_time: ["peak time", "s"], overshoot: ["overshoot", "%", 100],
    rise_time: ["rise time", "s"], settling_time: ["settling time", "s"],
};

const GROWTHS = 5; // times that the fastest unstable mode grows by e before the plot ends

async function showStep(command, show, pair, map) {
    const growth = Math.max(0, ...(map?.poles ?? []).map((root) => Number(root.re)));
    const until = growth ? ["--until", `${(GROWTHS / growth).toPrecision(2)} s`] : [];
    const options = ["respond", "--tf", pair, ...until, "--json"];
    const { out, err } = results.step = { options, ...await command(`Proving the step response of ${pair}`, ...options) };
    if (!out) return show("step", refusal(firstError(err)));
    const { certified, time, value, unit: said, step_info: measures } = JSON.parse(out);
    const unit = said === "1" ? "" : said;
    const rows = Object.entries(MEASURES).filter(([key]) => measures?.[key]).map(([key, [name, own, factor = 1]]) => {
        const { value, radius } = measures[key];
        const cells = [name, `${digits(factor * value)} ${own ?? unit}`, digits(factor * radius, 2)];
        return made("tr", {}, ...cells.map((c) => made("td", {}, c)));
    });
    const head = made("tr", {}, ...["", "value", "within"].map((c) => made("th", { scope: "col" }, c)));
    show("step",
        made("span", { class: `verdict ${certified ? "good" : ""}` }, certified ? "every value is proved" : "not certified"),
        stepPlot(time, value.map(Number), unit),
        ...(rows.length ? [made("table", {}, made("thead", {}, head), made("tbody", {}, ...rows))] : []));
}

async function showStability(command, show, model) {
    const over = choose("over", ["", ...model.parameters], model.gain ?? "");
    if (!over) return show("stability", made("p", { class: "quiet" }, "Choose a parameter: for which of its values is the model stable?"));
    const { out, err } = results.stability =
        await command(`Proving for which ${over} it is stable`, "stability", over === model.gain ? "--gain" : "--over", over);
    show("stability", out ? said(out) : refusal(firstError(err)));
}

async function showCode(command, show, pair) {
    const target = choose("target", Object.keys(TARGETS), "LaTeX");
    const { out, err } = results.code = await command(`Writing ${target}`, ...TARGETS[target], "--tf", pair);
    show("code", out ? said(out) : refusal(firstError(err)));
}

// -------------------------------------------------------------------------------------------- the header

async function copy(button, text) {
    await navigator.clipboard.writeText(text);
    const label = button.textContent;
    button.textContent = "Copied";
    setTimeout(() => (button.textContent = label), 1200);
}

function setTheme(theme) {
    document.documentElement.dataset.theme = theme;
}

const preferred = matchMedia("(prefers-color-scheme: dark)");
const kept = () => { try { return localStorage.getItem("symflex-theme"); } catch { return null; } };
setTheme(kept() ?? (preferred.matches ? "dark" : "light"));
preferred.addEventListener("change", () => kept() ?? setTheme(preferred.matches ? "dark" : "light"));
here("dark").addEventListener("click", () => {
    const theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    setTheme(theme);
    try { localStorage.setItem("symflex-theme", theme); } catch { /* a page without storage forgets it */ }
});
here("stop").addEventListener("click", () => {
    round++;
    isLoaded = false;
    thread.stop();
    say("Stopped; starting again", true);
    thread.ready.then(() => {
        isLoaded = true;
        say("Stopped. It runs again after the next change.");
    });
});
here("link").addEventListener("click", async () => {
    const address = await link(editor.text);
    history.replaceState(null, "", address);
    await copy(here("link"), location.href);
});
here("code").querySelector(".copy").addEventListener("click", (event) => copy(event.target, results.code?.out ?? ""));
for (const id of ["pair", "over", "target"]) here(id).addEventListener("change", run);
addEventListener("hashchange", () => begin());

async function parts() {
    try {
        return await (await fetch("parts.json")).json();
    } catch {
        return {};
    }
}

/** Have everything kept that the page loaded, for a time without a network. */
async function keepAll(program) {
    await navigator.serviceWorker?.register(trusted(new URL("offline.js", import.meta.url).href));
    const { active } = (await navigator.serviceWorker?.ready) ?? {};
    const loaded = performance.getEntriesByType("resource").map(({ name }) => name).filter((name) => !name.startsWith("blob:"));
    active?.postMessage([location.pathname, "worker.js", ...loaded, ...program]);
}

let examples = [];

async function begin() {
    const given = await ofLink(location.hash);
    if (given !== null) {
        here("example").value = "";
        editor.text = given;
    } else if (!editor.text) {
        here("example").value = 0;
        editor.text = examples[0]?.text ?? "";
    }
    return run();
}

async function start() {
    const known = await parts();
    if (!known.kept) {
        say("Not included");
        document.querySelector("main").replaceChildren(made("div", { class: "notice" },
            made("p", {}, "This copy of the documentation was built without the files that run symflex in a browser. Build it with them:"),
            made("pre", {}, "npm install --prefix runtime pyodide@314.0.7\npip download --no-deps --only-binary=:all: --dest runtime --python-version 3.14 --abi cp314 --abi none --platform pyemscripten_2026_0_wasm32 --platform any python-flint click mpmath\nSYMFLEX_WEBASSEMBLY=$PWD/runtime mkdocs build"),
        ));
        return;
    }
    examples = known.examples;
    here("example").append(...examples.map(({ title }, i) => made("option", { value: i }, title)));
    here("example").addEventListener("change", ({ target }) => {
        if (target.value === "") return;
        history.replaceState(null, "", location.pathname);
        editor.text = examples[target.value].text;
        for (const id of ["pair", "over"]) here(id).replaceChildren();
        run();
    });
    thread.ready.catch((error) => say(`symflex did not start: ${error.message}`));
    await begin();
    await keepAll(known.kept).catch(() => {}); // a browser that keeps nothing shows the page all the same
}

say("Starting", true);
window.symflex = {
    ready: start(),
    results,
    settled: async () => {
        for (let own = -1; own !== round || timer;) {
            while (timer) await new Promise((done) => setTimeout(done, 20));
            own = round;
            await settled;
        }
    },
    ask: (question, given) => thread.ask(question, given),
};
