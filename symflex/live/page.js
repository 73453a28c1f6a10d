// The page: values of parameters, roots that follow them, and what is drawn of both.

const SVG = "http://www.w3.org/2000/svg", TAU = 2 * Math.PI, COLOURS = 6, PLOTS = ["magnitude", "phase", "map", "step", "nyquist"];
const VIEW = 4, MOST = 1500;  // how far about 0 a Nyquist plot is drawn smoothly, with at most so many lines
const NOTCHES = 400, LINES = 400, INSTANTS = 400, NODES = 64;
const AROUND = [-30, -10, -4, -2, -1, -0.5, 0.5, 1, 2, 4, 10, 30];  // lines about a resonance, in its half widths

const over = (a, b, c, d) => [(a * c + b * d) / (c * c + d * d), (b * c - a * d) / (c * c + d * d)];
const far = (p, q) => Math.hypot(p.re - q.re, p.im - q.im);
const length = (p) => Math.hypot(p.re, p.im);
const isOrigin = (p) => p.re === 0 && p.im === 0;

// What a prover offers, for a function that it refuses: the roots at the declared values, which Python proved, and
// none at others, unless the function does not move either.
function standing(f, declared, why) {
    const roots = (list) => list.map(([re, im, multiplicity]) => ({ re, im, radius: NaN, proved: f.certified, multiplicity }));
    const certified = { poles: f.certified, zeros: f.certified }, none = { poles: false, zeros: false };
    const held = { poles: roots(f.poles), zeros: roots(f.zeros), certified, why, stability: "unknown", isKnown: !f.why };
    const isHere = (values) => f.fixed || Object.keys(declared).every((name) => values[name] === declared[name]);
    return {
        begin: () => held,
        moved: (_, values) => (isHere(values) ? held : { ...held, poles: [], zeros: [], certified: none, isKnown: false }),
    };
}

// The principal parts of G(s)/s, sums of c/(s - p)^(k + 1). The numbers c are means over a circle that lies closer to p
// than to any other pole.
function partsOf(f, values, listed) {
    const poles = [{ re: 0, im: 0, multiplicity: 1 }];
    for (const p of listed) {
        const same = poles.find((r) => far(r, p) <= 1e-7 * length(p));
        if (same) same.multiplicity += p.multiplicity;
        else poles.push({ ...p });
    }
    return poles.map((p) => {
        const room = Math.min(p.im ? 2 * p.im : Infinity, ...poles.filter((r) => r !== p).map((r) => far(r, p)));
        const radius = Number.isFinite(room) ? room / 2 : 1, turns = Array.from({ length: NODES }, (_, k) => TAU * (k + 0.5) / NODES);
        const [x, z] = [Math.cos, Math.sin].map((g) => turns.map((a) => radius * g(a)));
        const s = [Float64Array.from(x, (v) => v + p.re), Float64Array.from(z, (v) => v + p.im)], [g, h] = f.at(s, values);
        const terms = turns.map((_, i) => over(g[i], h[i], s[0][i], s[1][i])), parts = [];
        for (let k = 0; k < p.multiplicity; k++) {
            terms.forEach(([u, v], i) => { terms[i] = [u * x[i] - v * z[i], u * z[i] + v * x[i]]; });
            parts.push([0, 1].map((part) => terms.reduce((n, term) => n + term[part] / NODES, 0)));
        }
        return { p, parts };
    });
}

// The response to a unit step: each principal part is c t^k/k! exp(p t) in time. Before its delay it is zero, which
// a sum of finitely many modes is not.
function stepOf(f, values, listed, times) {
    const y = new Float64Array(times.length), late = f.infinite ? delayOf(f, values, listed) : 0;
    for (const { p, parts } of partsOf(f, values, listed)) {
        const weight = p.im ? 2 : 1;
        for (let k = 0, factorial = 1; k < parts.length; factorial *= ++k) {
            const [a, b] = parts[k].map((v) => weight * v / factorial);
            times.forEach((t, i) => { y[i] += t ** k * Math.exp(p.re * t) * (a * Math.cos(p.im * t) - b * Math.sin(p.im * t)); });
        }
    }
    return y.map((v, i) => (times[i] < late ? 0 : v));
}

// T of a function that behaves as c s^n exp(-s T) far out on the positive axis: ln G at s, 2s and 4s gives it. What bends
// without a fastest wave has exp(-c sqrt(s)) there, and two triples that disagree: no delay.
function delayOf(f, values, listed) {
    const tall = Math.max(1, ...listed.map(length));
    for (let s = 1e4 * tall; s > tall / 8; s /= 4) {
        const [re, im] = f.at([Float64Array.of(s, 2 * s, 4 * s, 8 * s), new Float64Array(4)], values), logs = re.map((x) => Math.log(Math.abs(x)));
        if (![...logs].every(Number.isFinite) || im.some((x, i) => Math.abs(x) > 1e-9 * Math.abs(re[i]))) continue;
        const [one, two] = [0, 1].map((k) => (2 * logs[k + 1] - logs[k] - logs[k + 2]) / (s * 2 ** k));
        return two > 0 && Math.abs(one / two - 1) < 0.02 && two * tall > 1e-9 ? 0.98 * Math.min(one, two) : 0;
    }
    return 0;
}

// The loop gain of what closes a loop with a gain that its denominator is linear in: D(s, K) = D(s, 0) (1 + L). Nothing
// where it is not linear, or where there is no loop without it.
function loopGain(f, values, gain, omega) {
    const s = [new Float64Array(omega.length), omega], K = values[gain];
    const [one, none, twice] = [K, 0, 2 * K].map((x) => f.at.denominator(s, { ...values, [gain]: x })), re = [], im = [];
    for (let k = 0; k < omega.length; k++) {
        const [a, b] = over(one[0][k], one[1][k], none[0][k], none[1][k]), [c, d] = over(twice[0][k], twice[1][k], none[0][k], none[1][k]);
        if (Math.hypot(c - 2 * a + 1, d - 2 * b) > 1e-6 * (1 + Math.hypot(c, d))) return null;
        re.push(a - 1);
        im.push(b);
    }
    return re.some((x, k) => Math.hypot(x, im[k]) > 1e-9) ? { w: [...omega], re, im } : null;
}

// The same at more lines, so that its curve bends little between two of them where it is near -1.
function loopCurve(f, values, gain, omega) {
    let found = loopGain(f, values, gain, omega);
    for (let pass = 0; found && pass < 5; pass++) {
        const { w, re, im } = found, size = re.map((x, k) => Math.hypot(x, im[k]));
        const isWide = (k) => Math.min(size[k], size[k + 1]) < 3 * VIEW && Math.hypot(re[k + 1] - re[k], im[k + 1] - im[k]) > 0.1 * Math.max(0.5, Math.min(size[k], size[k + 1]));
        const more = w.slice(1).flatMap((v, k) => (v > w[k] && isWide(k) ? [Math.sqrt(v * w[k])] : []));
        if (!more.length || w.length + more.length > MOST) break;
        found = loopGain(f, values, gain, Float64Array.from([...w, ...more]).sort());
    }
    return found;
}

// Where the loop gain crosses the unit circle and the negative axis, and which line is closest to -1. A crossing is halved
// until doubles end.
function marginsOf({ w, re, im }, at) {
    const onCircle = (x, y) => Math.log(Math.hypot(x, y)), onAxis = (x, y) => (x < 0 ? y : NaN), phases = [], factors = [];
    const crossed = (k, g) => {
        let [lo, hi] = [w[k - 1], w[k]];
        if (!(g(re[k - 1], im[k - 1]) * g(re[k], im[k]) < 0)) return null;
        const isLow = g(re[k - 1], im[k - 1]) > 0;
        for (let pass = 0; pass < 48; pass++) {
            const middle = Math.sqrt(lo * hi);
            if (g(...at(middle)) > 0 === isLow) lo = middle; else hi = middle;
        }
        return [...at(lo), lo];
    };
    let [nearest, where] = [Infinity, 0];
    for (let k = 0; k < w.length; k++) {
        const away = Math.hypot(re[k] + 1, im[k]), phase = k && crossed(k, onCircle), factor = k && crossed(k, onAxis);
        if (away < nearest) [nearest, where] = [away, w[k]];
        if (phase) phases.push([Math.atan2(-phase[1], -phase[0]) * 180 / Math.PI, phase[2]]);
        if (factor) factors.push([-1 / factor[0], factor[2]]);
    }
    const least = (list, size) => list.reduce((best, one) => (!best || size(one[0]) < size(best[0]) ? one : best), null);
    return { phase: least(phases, Math.abs), factor: least(factors, (x) => Math.abs(Math.log(x))), nearest: [nearest, where] };
}

// ------------------------------------------------------------------------------------------------- plots

function drawn(name, attributes = {}, text = "") {
    const e = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
    e.append(...(text ? [text] : []));
    return e;
}

const spelled = (x) => (x && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e6) ? x.toExponential() : String(x));
const short = (x, digits = 4) => spelled(Number(x.toPrecision(digits))).replace("-", "−").replace("e-", "e−").replace("e+", "e");
const decade = (n) => (n >= -2 && n <= 4 ? String(Number(`1e${n}`))
    : `10${String(n).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻")}`);
const nice = (x) => [1, 2, 5, 10].map((m) => m * 10 ** Math.floor(Math.log10(x))).find((m) => m >= 0.999 * x);

// Ticks [place, label] between two ends; on a logarithmic axis places are exponents.
function ticks(lo, hi, room, isLog) {
    const many = Math.max(2, Math.floor(room)), found = [], isFine = Boolean(isLog) && hi - lo < 1.5;
    const step = isLog ? Math.ceil((hi - lo) / many) : nice((hi - lo) / many);
    for (let k = Math.ceil(lo / step - 1e-9 - isFine); k * step <= hi + 1e-9 * step; k++) {
        for (const m of isFine ? [1, 2, 5] : [1]) {
            const at = k * step + Math.log10(m);
            if (at >= lo - 1e-9 * step && at <= hi + 1e-9 * step) found.push([at, isFine ? short(10 ** at, 1) : isLog ? decade(at) : short(at, 6)]);
        }
    }
    return found;
}

// Ends of an axis around values: the last ones where they still serve, so that curves move and not the axis.
function ends(values, last, isWhole = false) {
    let [lo, hi] = [Infinity, -Infinity];
    for (const x of values) [lo, hi] = [x < lo ? x : lo, x > hi ? x : hi];
    if (!(hi >= lo)) return last ?? [0, 1];
    if (last && lo >= last[0] && hi <= last[1] && hi - lo > 0.4 * (last[1] - last[0])) return last;
    if (isWhole) return [Math.floor(lo - 0.1), Math.ceil(hi + 0.1)];
    const room = 0.12 * (hi - lo) || 0.5 * Math.abs(hi) || 1;
    return [lo - room, hi + room];
}

class Plot {
    constructor(svg, name) {
        const id = `${svg.closest("main").id}-${name}`, clip = drawn("clipPath", { id: `${id}-clip` });
        Object.assign(this, { svg, key: "", desc: drawn("desc", { id: `${id}-desc` }), grid: drawn("g"), clip: drawn("rect") });
        this.inner = drawn("g", { "clip-path": `url(#${id}-clip)` });
        this.over = drawn("g", { class: "reading" });
        svg.setAttribute("role", "img");
        svg.setAttribute("aria-labelledby", `${id}-title ${id}-desc`);
        clip.append(this.clip);
        svg.append(drawn("title", { id: `${id}-title` }, svg.parentElement.firstChild.textContent), this.desc, clip, this.grid, this.inner, this.over);
    }

    // Call with a place in the plot, in its units, wherever the pointer is; with nothing when it leaves.
    follow(read) {
        this.svg.addEventListener("pointermove", (e) => {
            const box = this.svg.getBoundingClientRect(), x = e.clientX - box.left, y = e.clientY - box.top;
            if (!this.x || x < this.left || x > this.right) return this.over.replaceChildren();
            const [lo, hi] = this.x.ends, [low, high] = this.y.ends;
            const said = read(lo + (x - this.left) / (this.right - this.left) * (hi - lo), low + (this.bottom - y) / (this.bottom - this.top) * (high - low));
            this.over.replaceChildren(...(said ? [drawn("path", { class: "axis", d: `M${this.px(said.at)} ${this.top}V${this.bottom}` }),
                drawn("text", { x: this.left + 8, y: this.top + 16 }, said.text)] : []));
        });
        this.svg.addEventListener("pointerleave", () => this.over.replaceChildren());
    }

    // Draw axes between ends, when they or the size changed.
    axes(x, y) {
        const width = this.svg.clientWidth || 400, height = this.svg.clientHeight || 240, key = JSON.stringify([x, y, width, height]);
        if (key === this.key) return;
        const [left, right, top, bottom] = [58, Math.max(width - 18, 60), 8, height - 40], middle = (top + bottom) / 2;
        Object.assign(this, { key, left, right, top, bottom, x, y });
        this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
        const area = { x: left, y: top, width: right - left, height: bottom - top }, parts = [];
        for (const [k, v] of Object.entries(area)) this.clip.setAttribute(k, v);
        const label = (text, at, anchor) => parts.push(drawn("text", { ...at, "text-anchor": anchor }, text));
        for (const [at, text] of ticks(...x.ends, area.width / 70, x.isLog)) {
            parts.push(drawn("path", { class: "grid-line", d: `M${this.px(at)} ${top}V${bottom}` }));
            label(text, { x: this.px(at), y: bottom + 16 }, "middle");
        }
        for (const [at, text] of y.ticks ?? ticks(...y.ends, area.height / 40, y.isLog)) {
            parts.push(drawn("path", { class: "grid-line", d: `M${left} ${this.py(at)}H${right}` }));
            label(text, { x: left - 6, y: this.py(at) + 4 }, "end");
        }
        label(x.label, { x: (left + right) / 2, y: height - 6 }, "middle");
        label(y.label, { transform: `translate(12 ${middle}) rotate(-90)` }, "middle");
        this.grid.replaceChildren(...parts, drawn("rect", { class: "frame", ...area }));
    }

    px(x) {
        const [lo, hi] = this.x.ends;
        return Math.round(10 * (this.left + (x - lo) / (hi - lo) * (this.right - this.left))) / 10;
    }

    py(y) {
        const [lo, hi] = this.y.ends, at = this.bottom - (y - lo) / (hi - lo) * (this.bottom - this.top);
        return Math.round(10 * Math.max(-1e5, Math.min(1e5, at))) / 10;
    }

    // A curve; it is interrupted where it is not finite, and where it jumps by more than `jump`.
    curve(xs, ys, kind, jump = Infinity) {
        const d = [];
        let last = NaN;
        xs.forEach((x, i) => {
            if (Number.isFinite(ys[i])) d.push(Math.abs(ys[i] - last) <= jump ? "L" : "M", this.px(x), " ", this.py(ys[i]));
            last = ys[i];
        });
        return drawn("path", { class: `curve ${kind}`, d: d.join("") });
    }

    marks(roots, isPole, kind) {
        const places = roots.flatMap((r) => (r.im ? [r.im, -r.im] : [0]).map((im) => [this.px(r.re), this.py(im)]));
        const d = places.map(([x, y]) => (isPole ? `M${x - 5} ${y - 5}l10 10m0-10l-10 10` : `M${x - 5} ${y}a5 5 0 1 0 10 0a5 5 0 1 0-10 0`));
        return drawn("path", { class: `${isPole ? "pole" : "zero"} ${kind}`, d: d.join("") });
    }

    show(children, desc) {
        this.inner.replaceChildren(...children);
        if (this.desc.textContent !== desc) this.desc.textContent = desc;
    }
}

// Plots as one picture: what the style sheet says becomes attributes, which every program reads.
function picture(plots) {
    const whole = drawn("svg", { xmlns: SVG }), keys = ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "font-family", "font-size"];
    let [top, widest] = [0, 0];
    for (const svg of plots) {
        const copy = svg.cloneNode(true), { width, height } = svg.getBoundingClientRect(), copied = copy.querySelectorAll("*");
        svg.querySelectorAll("*").forEach((e, i) => {
            const style = getComputedStyle(e);
            for (const key of keys) copied[i].setAttribute(key, style.getPropertyValue(key));
        });
        for (const [k, v] of Object.entries({ x: 0, y: top, width, height })) copy.setAttribute(k, v);
        whole.append(copy);
        [top, widest] = [top + height + 16, Math.max(widest, width)];
    }
    whole.prepend(drawn("rect", { width: widest, height: top, fill: getComputedStyle(document.body).backgroundColor }));
    whole.setAttribute("viewBox", `0 0 ${widest} ${top}`);
    return new XMLSerializer().serializeToString(whole);
}

// ------------------------------------------------------------------------------------------------- a model

function model(main, { PARAMETERS, TRANSFER_FUNCTIONS, data }) {
    const one = (selector) => main.querySelector(selector), all = (selector) => [...main.querySelectorAll(selector)];
    const parameters = data.parameters, functions = data.functions.map((f) => ({ ...f, at: TRANSFER_FUNCTIONS[f.name] }));
    const declared = Object.fromEntries(parameters.map((p) => [p.id, p.value])), shown = new Set([0]), earlier = [], later = [], held = [];
    const plots = Object.fromEntries(PLOTS.map((name) => [name, new Plot(one(`svg.${name}`), name)]));
    const [sliders, fields, rows, checks] = ["input[type=range]", ".parameter > input[type=number]", ".parameter", ".checks input"].map(all);
    let values = { ...declared }, committed = declared, focus = 0, until = 0, wanted = false, axes = {}, zoom = 1, wrong = "";
    const isSame = (a, b) => parameters.every((p) => a[p.id] === b[p.id]), say = (text) => { one(".said").textContent = text; };
    const lacking = (at) => parameters.filter((p) => p.moves && at[p.id] === null).map((p) => p.name);

    // The state of every function's roots: as declared, as drawn last, as asked for last.
    const provers = functions.map((f) => {
        const made = proverOf(f.tape), prover = made.refused ? standing(f, declared, f.why || made.refused) : made, last = {};
        const first = () => (last.first ??= prover.begin(declared));
        return { first, moved: (at, who) => (last[who] = prover.moved(last[who] ?? first(), at)) };
    });

    // ------------------------------------------------------------------------------------------ values

    const isAllowed = (p, x) => Number.isFinite(x) && (p.assume === "real" || x > 0 || (x === 0 && p.assume === "nonnegative"));
    const isLog = (p) => p.low * p.high > 0 && !p.isLinear, written = (p, x = values[p.id]) => (x === null ? NaN : Number((x / p.scale).toPrecision(12)));
    const place = (p, x) => {
        const [a, b, y] = [p.low, p.high, x].map((v) => (isLog(p) ? Math.log(Math.abs(v)) : v));
        return NOTCHES * (y - a) / (b - a);
    };
    const at = (p, t) => Number((isLog(p) ? p.low * (p.high / p.low) ** t : p.low + (p.high - p.low) * t).toPrecision(4));
    const sync = () => {
        parameters.forEach((p, i) => {
            const x = written(p), isThere = !Number.isNaN(x);
            if (document.activeElement !== fields[i]) fields[i].value = isThere ? String(Number(x.toPrecision(6))) : "";
            sliders[i].value = isThere ? place(p, x) : NOTCHES / 2;
            sliders[i].setAttribute("aria-valuetext", isThere ? `${short(x, 6)} ${p.unit}` : "no value");
        });
        one(".undo").disabled = !earlier.length;
        one(".redo").disabled = !later.length;
        one(".clear").hidden = !held.length;
        one(".reset").disabled = isSame(values, declared);
    };
    const put = (next) => {
        wrong = "";
        values = { ...values, ...next };
        sync();
        ask();
    };
    const commit = () => {
        if (isSame(values, committed)) return;
        earlier.push(committed);
        later.length = 0;
        settle();
    };
    const settle = () => {
        committed = { ...values };
        keep();
        put({});
        if (parent !== window) parent.postMessage({ symflex: values }, "*");
    };
    const step = (from, to) => {
        if (!from.length) return;
        to.push(committed);
        values = { ...from.pop() };
        settle();
    };
    const back = () => step(earlier, later), forth = () => step(later, earlier);
    parameters.forEach((p, i) => {
        sliders[i].disabled = fields[i].disabled = !p.moves;
        rows[i].classList.toggle("fixed", !p.moves);
        if (!p.moves) rows[i].title = "fixed: the functions contain its number";
        const [low, high, linear] = [".low", ".high", ".linear"].map((name) => rows[i].querySelector(name));
        linear.addEventListener("change", () => { p.isLinear = linear.checked; sync(); });
        [low.value, high.value] = [short(p.low, 4), short(p.high, 4)].map((x) => x.replaceAll("−", "-"));
        for (const input of [low, high]) {
            input.addEventListener("change", () => {
                const [a, b] = [Number(low.value), Number(high.value)], isGood = Number.isFinite(a) && Number.isFinite(b) && a < b && isAllowed(p, a);
                input.setCustomValidity(isGood ? "" : `the ends of ${p.name}: lower, then upper, each ${p.assume}`);
                if (!isGood) return say(input.validationMessage);
                [p.low, p.high] = [a, b];
                sync();
            });
        }
        sliders[i].addEventListener("input", () => put({ [p.id]: at(p, Number(sliders[i].value) / NOTCHES) * p.scale }));
        fields[i].addEventListener("input", () => {
            const x = fields[i].value === "" ? NaN : Number(fields[i].value);
            const isGood = isAllowed(p, x);
            fields[i].setCustomValidity(isGood ? "" : `${p.name} is ${p.assume}`);
            if (isGood) return put({ [p.id]: x * p.scale });
            wrong = fields[i].value === "" ? `${p.name} has no value.` : `${p.name} = ${fields[i].value} is not possible: it is ${p.assume}.`;
            ask();
        });
        for (const input of [sliders[i], fields[i]]) input.addEventListener("change", commit);
    });

    const still = parameters.filter((p) => !p.moves).map((p) => p.name);
    one(".fixed-names").hidden = !still.length;
    one(".fixed-names").textContent = `Fixed here, because the functions contain their numbers: ${still.join(", ")}.`;

    // ------------------------------------------------------------------------------------------ buttons

    const pressed = (name, run) => one(`.${name}`).addEventListener("click", run);
    const copy = async (text, what) => {
        try {
            await navigator.clipboard.writeText(text);
        } catch {
            const area = Object.assign(document.createElement("textarea"), { value: text });
            main.append(area);
            area.select();
            document.execCommand("copy");
            area.remove();
        }
        say(`${what} is on the clipboard.`);
    };
    const specification = () => data.specification.map((piece) => {
        if (typeof piece === "string") return piece;
        const [i, unit, text, end] = piece, p = parameters[i], x = String(Number(written(p).toPrecision(6))), value = unit ? `"${x} ${unit}"` : x;
        return values[p.id] === declared[p.id] ? text : end ? `value = ${value}${end}` : value;
    }).join("");
    // The state as the link holds it.
    const isInside = location.protocol === "about:";  // in the frame of a notebook, where links would lead out
    const keep = () => {
        if (isInside) return;
        const changed = parameters.filter((p) => values[p.id] !== declared[p.id]).map((p) => [p.name, String(written(p))]);
        const number = main.id.slice(6), words = [...(number === "0" ? [] : [["@model", number]]), ...(focus ? [["@tf", functions[focus].name]] : [])];
        const hash = new URLSearchParams([...changed, ...words]).toString();
        if (location.hash.slice(1) !== hash) location.replace(`#${hash}`);
    };
    const recall = () => {
        const words = new URLSearchParams(location.hash.slice(1)), next = { ...declared };
        for (const p of parameters) {
            const x = Number(words.get(p.name) ?? NaN);
            if (p.moves && Number.isFinite(x)) next[p.id] = x === written(p, p.value) ? p.value : x * p.scale;
        }
        const named = functions.findIndex((f) => f.name === words.get("@tf"));
        if (named >= 0 && named !== focus) choose(named);
        if (isSame(next, values)) return sync();
        committed = next;
        put(next);
    };
    pressed("reset", () => { put(declared); commit(); });
    pressed("undo", back);
    pressed("redo", forth);
    pressed("hold", () => { held.push({ ...values }); say(`These values are kept as dashed curves, ${held.length} in all.`); put({}); });
    pressed("clear", () => { held.length = 0; say("No values are kept."); put({}); });
    for (const [name, factor] of [["closer", 2], ["wider", 0.5]]) pressed(name, () => { zoom *= factor; axes.re = axes.im = null; ask(); });
    pressed("copy", () => copy(specification(), "The specification"));
    one(".link").hidden = isInside;
    pressed("link", () => { keep(); copy(location.href, "The link"); });
    const file = (one("h1").textContent.match(/[\p{L}\p{N}]+/gu) ?? ["symflex"]).slice(0, 8).join("_");
    const save = (content, name) => {
        Object.assign(document.createElement("a"), { href: URL.createObjectURL(content), download: name }).click();
        say(`${name} is saved.`);
    };
    const visible = () => Object.values(plots).map((p) => p.svg).filter((svg) => svg.clientWidth);
    const drawing = () => new Blob([picture(visible())], { type: "image/svg+xml" });
    pressed("save", () => save(drawing(), `${file}.svg`));
    pressed("png", () => {
        const image = new Image(), canvas = document.createElement("canvas"), boxes = visible().map((svg) => svg.getBoundingClientRect());
        image.onload = () => {
            canvas.width = 2 * Math.max(...boxes.map((b) => b.width));
            canvas.height = 2 * boxes.reduce((sum, b) => sum + b.height + 16, 0);
            canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
            canvas.toBlob((content) => save(content, `${file}.png`), "image/png");
        };
        image.onerror = () => say("This browser draws no PNG here: save the SVG.");
        image.src = URL.createObjectURL(drawing());
    });
    main.addEventListener("keydown", (e) => {
        const key = e.key.toLowerCase(), isBack = key === "z" && !e.shiftKey, isForth = key === "y" || (key === "z" && e.shiftKey);
        if (!(e.ctrlKey || e.metaKey) || !(isBack || isForth) || e.target.type === "number") return;
        e.preventDefault();
        (isBack ? back : forth)();
    });

    // ------------------------------------------------------------------------------------------ what is shown

    const isHertz = () => one(".hertz").selectedIndex === 0, isDecibels = () => one(".decibels").selectedIndex === 1, isWrapped = () => one(".angles").selectedIndex === 0;
    const choose = (i) => {
        focus = i;
        one(".focus").selectedIndex = i;
        shown.add(i);
        checks.forEach((c, k) => { c.checked = shown.has(k); });
        all(".formulas > *").forEach((e, k) => { e.hidden = k !== i; });
        [axes, until, zoom] = [{}, 0, 1];
        one(".gain select").replaceChildren(...functions[i].gains.map((k) => new Option(parameters[k].name, k)));
        ask();
    };
    one(".gain select").addEventListener("change", () => { axes.loop = null; ask(); });
    checks.forEach((c, k) => {
        c.parentElement.classList.add(`k${k % COLOURS + 1}`);
        c.addEventListener("change", () => { shown[c.checked ? "add" : "delete"](k); axes.size = null; ask(); });
    });
    one(".focus").addEventListener("change", () => { choose(one(".focus").selectedIndex); keep(); });
    for (const s of all(".switches select")) s.addEventListener("change", () => { axes.size = null; ask(); });
    one(".until input").addEventListener("input", (e) => { until = Number(e.target.value) || until; ask(); });
    one(".chooser").hidden = one(".checks").hidden = functions.length < 2;
    new ResizeObserver(() => ask()).observe(one(".grid"));

    const ask = () => {
        if (!wanted) requestAnimationFrame(() => { wanted = false; draw(); });
        wanted = true;
    };
    const draw = () => {
        const names = lacking(values), isGhost = !lacking(declared).length && !isSame(values, declared), isStopped = names.length > 0 || wrong !== "";
        one(".missing").hidden = !isStopped;
        one(".plots").hidden = one(".stability").hidden = isStopped;
        one(".missing").textContent = wrong || `The plots need values of ${names.join(", ")}: type them, or move the sliders.`;
        if (isStopped) return;
        const state = display(provers[focus].moved(values, "drawn"));
        const kept = held.filter((at) => !isSame(at, values)).map((at, i) => [at, display(provers[focus].moved(at, `held ${i}`)), " ghost held"]);
        const sets = [[values, state, ""], ...kept, ...(isGhost ? [[declared, display(provers[focus].first()), " ghost"]] : [])].reverse();
        bode(sets);
        plane(sets, state);
        response(sets);
        nyquist(sets);
        words(state, functions[focus]);
    };
    // A real part that the radius does not tell from zero is shown as zero.
    const display = (state) => {
        const snapped = (r) => (Math.abs(r.re) <= r.radius ? { ...r, re: 0 } : r);
        return { ...state, poles: state.poles.map(snapped), zeros: state.zeros.map(snapped) };
    };
    const colour = (i) => `s${i % COLOURS + 1}`;
    const unitOf = (f) => (f.unit && f.unit !== "1" ? ` [${f.unit}]` : "");

    // Angular frequencies: evenly on a logarithmic axis, and around every root.
    const lines = (state) => {
        const [lo, hi] = data.band.map((f) => TAU * f), list = Array.from({ length: LINES + 1 }, (_, k) => lo * (hi / lo) ** (k / LINES));
        for (const r of [...state.poles, ...state.zeros]) list.push(...AROUND.map((k) => r.im + k * Math.max(Math.abs(r.re), 1e-5 * r.im)));
        return Float64Array.from(list.filter((w) => w >= lo && w <= hi * 1.000001)).sort();
    };

    // A continuous phase, from next to 0 on. Between lines it may turn more than once, as behind a delay: its slope says
    // how often.
    const unwrap = (angle, lines, f, given) => {
        const w = Float64Array.of(1e-6 * lines[0], ...lines), near = w.map((v) => v * (1 + 1e-7));
        const [[re, im], [x, y]] = [w, near].map((v) => f.at([new Float64Array(v.length), v], given));
        const slope = w.map((v, k) => 180 / Math.PI * Math.atan2(...over(x[k], y[k], re[k], im[k]).reverse()) / (near[k] - v));
        let last = Math.atan2(im[0], re[0]) * 180 / Math.PI;
        angle.forEach((a, k) => {
            const due = last + (slope[k] + slope[k + 1]) / 2 * (w[k + 1] - w[k]);
            if (Number.isFinite(due)) last = angle[k] = a + 360 * Math.round((due - a) / 360);
        });
    };
    const bode = (sets) => {
        const curves = [], sizes = [], per = isDecibels() ? 20 : 1;
        for (const [given, state, ghost] of sets) {
            const w = lines(state), x = w.map((v) => Math.log10(isHertz() ? v / TAU : v));
            for (const i of shown) {
                const [re, im] = functions[i].at([new Float64Array(w.length), w], given), y = w.map((_, k) => per * Math.log10(Math.hypot(re[k], im[k])));
                const angle = w.map((_, k) => (Math.atan2(im[k], re[k]) * 180 / Math.PI + 180.1) % 360 - 180.1);
                if (!isWrapped()) unwrap(angle, w, functions[i], given);
                curves.push({ i, kind: colour(i) + ghost, x, y, angle });
                // Peaks of undamped resonances do not set the axis.
                const sorted = y.filter(Number.isFinite).sort(), cut = Math.floor(0.04 * sorted.length), n = sorted.length - 1;
                if (n >= 0) sizes.push(Math.max(sorted[0], sorted[cut] - 2 * per), Math.min(sorted[n], sorted[n - cut] + 2 * per));
            }
        }
        const units = new Set([...shown].map((i) => unitOf(functions[i]))), name = isHertz() ? "Hz" : "rad/s";
        axes.size = ends(sizes, axes.size, per === 1);
        const x = { ends: data.band.map((f) => Math.log10(isHertz() ? f : TAU * f)), isLog: true, label: `frequency [${name}]` };
        plots.magnitude.axes(x, { ends: axes.size, isLog: per === 1, label: per === 20 ? "magnitude [dB]" : `magnitude${units.size === 1 ? [...units][0] : ""}` });
        const angles = curves.flatMap((c) => [...c.angle].filter(Number.isFinite)), [least, most] = isWrapped() || !angles.length ? [-180, 180]
            : [Math.min(...angles), Math.max(...angles)].map((v, k) => 90 * (k ? Math.ceil : Math.floor)(v / 90 + (k ? -0.01 : 0.01)));
        const turn = 90 * Math.max(1, Math.ceil((most - least) / 90 / 6)), marks = Array.from({ length: Math.floor((most - least) / turn) + 1 }, (_, k) => least + k * turn);
        plots.phase.axes(x, { ends: [least - 10, most + 10], label: "phase [°]", ticks: marks.map((v) => [v, short(v)]) });
        reading = { curve: curves.findLast((c) => c.i === focus && !c.kind.includes("ghost")) ?? curves.at(-1), per, name };
        const spoken = curves.filter((c) => !c.kind.endsWith("ghost") && c.y.length).map((c) => {
            const peak = c.y.reduce((best, v, k) => (v > c.y[best] ? k : best), 0);
            const told = (k) => `${per === 20 ? `${short(c.y[k])} dB` : short(10 ** c.y[k])} at ${short(10 ** c.x[k])} ${name}`;
            return `${functions[c.i].name}: ${told(0)}, largest ${told(peak)}, ${told(c.y.length - 1)}.`;
        });
        plots.magnitude.show(curves.map((c) => plots.magnitude.curve(c.x, c.y, c.kind)), spoken.join(" "));
        plots.phase.show(curves.map((c) => plots.phase.curve(c.x, c.angle, c.kind, isWrapped() ? 200 : Infinity)), `Phase between ${short(least)}° and ${short(most)}° over the same frequencies.`);
    };
    let reading = {};
    const read = (x) => {
        const { curve: c, per, name } = reading;
        if (!c?.x.length) return null;
        const k = c.x.reduce((best, v, i) => (Math.abs(v - x) < Math.abs(c.x[best] - x) ? i : best), 0);
        const size = per === 20 ? `${short(c.y[k])} dB` : short(10 ** c.y[k]);
        return { at: c.x[k], text: `${short(10 ** c.x[k], 5)} ${name}: ${size}, ${short(c.angle[k])}°` };
    };
    for (const plot of [plots.magnitude, plots.phase]) plot.follow(read);
    plots.map.follow((x, y) => {
        const [lo, hi] = axes.re, [low, high] = axes.im, away = (r) => Math.hypot((r.re - x) / (hi - lo), (r.im - Math.abs(y)) / (high - low));
        const every = [["pole", nearby.poles], ["zero", nearby.zeros]].flatMap(([kind, list]) => list.map((r) => ({ ...r, kind }))).sort((a, b) => away(a) - away(b));
        const r = every[0], size = r && length(r);
        if (!r || away(r) > 0.06) return null;
        const place = `${short(r.re, 5)}${r.im ? ` ± ${short(r.im, 5)}j` : ""} rad/s`;
        return { at: r.re, text: `${r.kind} ${place}${size ? `, ${short(size / TAU, 5)} Hz, damping ratio ${short(-r.re / size || 0)}` : ""}` };
    });

    let nearby = { poles: [], zeros: [] };
    const plane = (sets, state) => {
        const plot = plots.map, every = sets.flatMap(([, s]) => [...s.poles, ...s.zeros]), poles = sets.flatMap(([, s]) => s.poles).map(length);
        // A zero far from all poles would leave them in a corner.
        nearby = state;
        const tall = Math.max(1e-9, ...(Math.max(...poles) > 0 ? poles : every.map(length))) / zoom, roots = every.filter((r) => length(r) <= 3 * tall);
        const beyond = [...state.poles, ...state.zeros].filter((r) => length(r) > 3 * tall).length;
        axes.re = ends([...roots.map((r) => r.re), -0.02 * tall, 0.02 * tall], axes.re);
        axes.im = ends([-1, 1].map((k) => k * Math.max(...roots.map((r) => r.im), 0.2 * tall)), axes.im);
        plot.axes({ ends: axes.re, label: "Re s [rad/s]" }, { ends: axes.im, label: "Im s [rad/s]" });
        const zero = plot.px(0), { left, right, top, bottom } = plot;
        const parts = [drawn("rect", { class: "right", x: zero, y: top, width: Math.max(right - zero, 0), height: bottom - top }),
            drawn("path", { class: "axis", d: `M${zero} ${top}V${bottom}M${left} ${plot.py(0)}H${right}` })];
        if (beyond) parts.push(drawn("text", { x: left + 8, y: bottom - 8 }, `${beyond} ${zoom > 1 ? "root" : "zero"}${beyond > 1 ? "s" : ""} beyond`));
        for (const [, s, ghost] of sets) parts.push(...[s.zeros, s.poles].map((list, k) => plot.marks(list, k === 1, colour(focus) + ghost)));
        plot.show(parts, `${state.poles.length} poles and ${state.zeros.length} zeros in the upper half-plane and on the real axis; a table lists the poles.`);
    };

    // A time in which the slowest motion shows that contributes a hundredth of the largest: ten periods, or until it has decayed.
    const usual = (f, given, listed) => {
        const sizes = partsOf(f, given, listed).filter(({ p }) => !isOrigin(p)).map(({ p, parts }) => [p, Math.hypot(...parts[0])]);
        const most = Math.max(...sizes.map(([, size]) => size)), moving = sizes.filter(([, size]) => !(size < most / 100)).map(([p]) => p);
        const slow = Math.min(...moving.map((p) => Math.abs(p.re)));
        return moving.length ? nice(Math.min(10 * TAU / Math.min(...moving.map(length)), 7 / slow)) : 1;
    };
    const response = (sets) => {
        const f = functions[focus], plot = plots.step, known = sets.filter(([, s]) => s.isKnown !== false);
        if (!until) {
            until = usual(f, sets[0][0], sets[0][1].poles);
            one(".until input").value = String(Number(until.toPrecision(3)));
        }
        const times = Float64Array.from({ length: INSTANTS + 1 }, (_, k) => until * Math.max(k / INSTANTS, 1e-9));
        const curves = known.map(([given, state, ghost]) => [stepOf(f, given, state.poles, times), colour(focus) + ghost]);
        const most = 20 * Math.max(0, ...(curves[0]?.[0] ?? []).map(Math.abs).filter(Number.isFinite)) || Infinity;
        axes.step = ends([0, ...curves.flatMap(([y]) => [...y].map((v) => Math.max(-most, Math.min(most, v))).filter(Number.isFinite))], axes.step);
        plot.axes({ ends: [0, until], label: "time [s]" }, { ends: axes.step, label: `response${unitOf(f)}` });
        const [y] = curves.at(-1) ?? [], told = (k) => `${short(y[k])} at ${short(times[k])} s`;
        const last = (v) => v.findIndex((z) => Math.abs(z) > 2 * most) + 1 || v.length;  // what grows ends at the edge
        plot.show(curves.map(([v, kind]) => plot.curve(times.slice(0, last(v)), v, kind)), y ? `${f.name}: ${told(INSTANTS >> 1)}, ${told(INSTANTS)}.` : "not known");
    };

    // The loop gain from 0 on, and its mirror image, about -1 and the unit circle: resonances that leave the view are cut.
    const nyquist = (sets) => {
        const f = functions[focus], chooser = one(".gain select"), gain = parameters[chooser.value]?.id;
        const made = (!gain ? [] : sets).map(([given, state, ghost]) => {
            const found = given[gain] ? loopCurve(f, given, gain, lines(state)) : null;
            const once = (x) => {
                const { re, im } = loopGain(f, given, gain, Float64Array.of(x)) ?? { re: [NaN], im: [NaN] };
                return [re[0], im[0]];
            };
            return found && { ...found, at: once, kind: colour(focus) + ghost };
        });
        const now = made.at(-1);
        one(".loop").hidden = !now;
        if (!now) return;
        const plot = plots.nyquist, seen = now.re.flatMap((x, k) => (Math.hypot(x, now.im[k]) < VIEW ? [[x, now.im[k]]] : []));
        if (!axes.loop) {  // a unit is as long on both axes
            const [lo, hi] = ends([-1.6, 0.6, ...seen.map(([x]) => x)]), tall = Math.max(1.3, ...seen.map(([, y]) => 1.1 * Math.abs(y)));
            const wide = Math.max(plot.svg.clientWidth - 76, 1) / Math.max(plot.svg.clientHeight - 48, 1), half = Math.max((hi - lo) / 2, tall * wide);
            axes.loop = [[(lo + hi) / 2 - half, (lo + hi) / 2 + half], half / wide];
        }
        plot.axes({ ends: axes.loop[0], label: "Re L" }, { ends: [-axes.loop[1], axes.loop[1]], label: "Im L" });
        const turns = Array.from({ length: 121 }, (_, k) => TAU * k / 120), parts = [drawn("path", { class: "axis", d: `M${plot.px(0)} ${plot.top}V${plot.bottom}M${plot.left} ${plot.py(0)}H${plot.right}` }),
            plot.curve(turns.map(Math.cos), turns.map(Math.sin), "axis")];
        for (const { re, im, kind } of made.filter(Boolean)) parts.push(plot.curve(re, im, kind), plot.curve(re, im.map((y) => -y), `${kind} mirror`));
        parts.push(drawn("path", { class: "pole s2", d: `M${plot.px(-1) - 5} ${plot.py(0) - 5}l10 10m0-10l-10 10` }));
        const { phase, factor, nearest } = marginsOf(now, now.at), at = (w) => `at ${short(isHertz() ? w / TAU : w)} ${isHertz() ? "Hz" : "rad/s"}`;
        const told = [factor ? `gain margin × ${short(factor[0])} ${at(factor[1])}` : "no gain margin in the band",
            phase ? `phase margin ${short(phase[0], 3)}° ${at(phase[1])}` : "no phase margin in the band",
            `closest to −1: ${short(nearest[0], 3)} ${at(nearest[1])}`].join(", ");
        one(".margins").textContent = `${told[0].toUpperCase()}${told.slice(1)}.`;
        plot.show(parts, one(".margins").textContent);
    };

    const words = (state, f) => {
        const isSure = state.certified.poles && state.certified.zeros, count = state.poles.reduce((n, p) => n + p.multiplicity, 0);
        const isKnown = state.isKnown !== false;
        one(".roots-label").textContent = isSure ? "certified" : isKnown ? "traced" : "not known";
        one(".roots-label").classList.toggle("good", isSure);
        one(".step-label").textContent = !isKnown ? "not known" : f.infinite ? `${count} modes, estimated` : `all ${count} modes, in double precision`;
        one(".why").textContent = [
            f.fixed ? `${f.name} holds the numbers of the specification, so no slider moves it.` : "",
            !isKnown ? `No poles and zeros are known at these values: ${state.why}.`
                : isSure ? "Every root shown is certified, and none is missing from the window."
                : `Roots are traced, and not all of them are certified: ${state.why}.`,
            f.infinite && isKnown ? "The step response is the static part and the modes shown, without those beyond." : "",
        ].filter(Boolean).join(" ");
        stability(state, f);
        one(".unit").textContent = `Frequency [${isHertz() ? "Hz" : "rad/s"}]`;
        one(".accuracy").textContent = `${f.name}: ${f.accuracy}.`;
        one(".modes tbody").replaceChildren(...[...state.poles].sort((a, b) => length(a) - length(b)).map((p, i) => {
            const size = length(p), row = document.createElement("tr"), times = p.multiplicity > 1 ? ` (${p.multiplicity} times)` : "";
            const how = p.proved ? `certified${p.radius ? `, ± ${short(p.radius, 2)} rad/s` : ""}` : "traced";
            row.append(...[`${i + 1}`, short(isHertz() ? size / TAU : size, 6), size ? short(-p.re / size || 0) : "–", p.re > 0 ? "grows" : p.re ? `${short(-1 / p.re)} s` : "∞",
                how + times].map((textContent) => Object.assign(document.createElement("td"), { textContent })));
            return row;
        }));
    };
    const stability = (state, f) => {
        const line = one(".stability"), known = isSame(values, declared) || f.fixed ? f.verdict : null;
        const isMarginal = !f.infinite && state.certified.poles && state.poles.every((p) => (isOrigin(p) && !p.radius) || -p.re > p.radius);
        const isShown = f.hides && !state.isPassive && state.stability === "stable", own = isShown ? "unknown" : state.stability;
        const word = own !== "unknown" ? own : known?.word ?? (isMarginal && !f.hides ? "marginal" : "unknown");
        const right = Math.max(...state.poles.map((p) => p.re)), sentence = known && own === "unknown" ? `${known.sentence}, certified at the declared values`
            : word === "marginal" ? "marginal, certified at these values: poles at s = 0, all others in the left half-plane"
            : word !== "unknown" ? `${word}, certified at these values`
            : isShown ? "all poles shown lie in the left half-plane, certified; hidden poles, which cancel, may not"
            : state.isPassive ? "no pole lies in the right half-plane: nothing supplies energy, whatever the positive values"
            : `neither stability nor instability is certified here${state.poles.length ? `: the rightmost poles shown have Re s = ${short(right, 3)} rad/s` : ""}`;
        for (const kind of ["stable", "unstable"]) line.classList.toggle(kind, word === kind);
        const text = `${sentence[0].toUpperCase()}${sentence.slice(1)}.`;
        if (line.textContent !== text) line.textContent = text;
    };

    choose(0);
    recall();
    addEventListener("hashchange", () => { if (!main.hidden) recall(); });
    const number = (tf) => {
        const i = functions.findIndex((f) => f.name === tf);
        if (i < 0) throw new RangeError(`there is no transfer function ${tf}`);
        return i;
    };
    const asked = (tf, given) => provers[number(tf)].moved({ ...declared, ...given }, "asked");
    return {
        get parameters() {
            return Object.fromEntries(parameters.map((p) => [p.id, {
                value: values[p.id], declared: p.value, unit: PARAMETERS[p.id].unit, low: p.low * p.scale, high: p.high * p.scale,
            }]));
        },
        evaluate: (tf, given, omega) => functions[number(tf)].at([0, omega], { ...declared, ...given }),
        roots(tf, given) {
            const { poles, zeros } = asked(tf, given);
            return [["pole", poles], ["zero", zeros]].flatMap(([kind, list]) => list.map((r) => ({ ...r, kind })));
        },
        certified: (tf, given) => Object.values(asked(tf, given).certified).every(Boolean),
        ready: new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }),
        specification,
        ask,
    };
}

function live(parts) {
    const mains = [...document.querySelectorAll("main")], made = [], chooser = document.getElementById("model");
    const choose = (i) => {
        mains.forEach((main, k) => { main.hidden = k !== i; });
        made[i] ??= model(mains[i], parts[i]);
        made[i].ask();
        window.symflex = made[i];
    };
    const first = Number(new URLSearchParams(location.hash.slice(1)).get("@model"));
    chooser?.addEventListener("change", () => choose(chooser.selectedIndex));
    if (chooser) chooser.selectedIndex = first in parts ? first : 0;
    choose(first in parts ? first : 0);
}
