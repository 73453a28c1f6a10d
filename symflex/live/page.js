// The page: values of parameters, roots that follow them, and what is drawn of both.

const SVG = "http://www.w3.org/2000/svg", TAU = 2 * Math.PI, COLOURS = 6;
const STEPS_OF_SLIDER = 400, LINES = 400, INSTANTS = 400, NODES = 64;

// ------------------------------------------------------------------------------------------ roots in doubles

// Newton's iteration for all roots at once, each repelled by the others (Aberth 1973): roots that meet and part
// again keep their number. They start beside the last ones, off the axes, which no step of theirs would leave.
// Of infinitely many roots only close ones repel each other, or the last ones would be driven away.
function followed(value, slope, roots, values, reach) {
    const pinned = roots.filter((r) => r.re === 0 && r.im === 0), re = [], im = [];
    const order = pinned.reduce((n, r) => n + r.multiplicity, 0);
    for (const r of roots) {
        if (pinned.includes(r)) continue;
        const away = 1e-5 * Math.hypot(r.re, r.im);
        for (let k = 0; k < r.multiplicity; k++) {
            for (const sign of r.im > 0 ? [1, -1] : [1]) {
                re.push(r.re + away * Math.cos(2.4 * re.length));
                im.push(sign * r.im + away * Math.sin(2.4 * im.length));
            }
        }
    }
    const left = new Float64Array(re.length), first = re.map((x, i) => [x, im[i]]);
    const others = first.map(([x, y], i) => first.flatMap(([u, v], j) =>
        (j !== i && Math.hypot(u - x, v - y) < reach * Math.hypot(x, y) ? [j] : [])));
    let best = Infinity;
    for (let round = 0, idle = 0; round < 80 && idle < 4; round++) {
        const s = [Float64Array.from(re), Float64Array.from(im)];
        const [a, b] = value(s, values), [c, d] = slope(s, values);
        let worst = 0;
        for (let i = 0; i < re.length; i++) {
            const [p, q] = over(a[i], b[i], c[i], d[i]);
            let [u, v] = order ? over(order, 0, re[i], im[i]) : [0, 0];
            for (const j of others[i]) {
                const [x, y] = over(1, 0, re[i] - re[j], im[i] - im[j]);
                u += x;
                v += y;
            }
            const [x, y] = over(p, q, 1 - p * u + q * v, -p * v - q * u);
            left[i] = Math.hypot(x, y) / Math.hypot(re[i], im[i]);
            if (!Number.isFinite(left[i])) continue;
            const part = Math.min(1, 0.1 / left[i]);
            re[i] -= part * x;
            im[i] -= part * y;
            worst = Math.max(worst, left[i]);
        }
        idle = worst < 1e-9 && worst > best / 4 ? idle + 1 : 0;
        best = Math.min(best, worst);
        if (worst < 1e-15) break;
    }
    const found = [...pinned];
    for (let i = 0; i < re.length; i++) {
        const size = Math.hypot(re[i], im[i]);
        const x = Math.abs(re[i]) < 1e-14 * size ? 0 : re[i], y = Math.abs(im[i]) < 1e-11 * size ? 0 : im[i];
        if (y < 0) continue;
        const twin = found.find((r) => Math.hypot(r.re - x, r.im - y) < 1e-6 * size);
        if (twin) twin.multiplicity++;
        else found.push(tracked(x, y, 1, !(left[i] < 1e-8 && Math.hypot(re[i] - first[i][0], im[i] - first[i][1]) < size)));
    }
    return found;
}

function tracked(re, im, multiplicity, isLost = false) {
    return { re, im, radius: NaN, proved: false, multiplicity, isLost };
}

function over(a, b, c, d) {
    const n = c * c + d * d;
    return [(a * c + b * d) / n, (b * c - a * d) / n];
}

// What a prover offers, where nothing is proved: roots are only carried along.
function tracerOf(f, data, why) {
    const state = (values, poles, zeros) => ({
        values, poles, zeros, certified: { poles: false, zeros: false }, why, stability: "unknown",
    });
    const given = (list) => list.map((r) => tracked(...r));
    return {
        begin: (values) => state(values, given(data.poles), given(data.zeros)),
        moved(last, values) {
            let { poles, zeros } = last;
            const [reach, stride] = data.infinite ? [0.08, 0.04] : [Infinity, 0.15];
            for (const step of data.fixed ? [] : path(last.values, values, stride)) {
                poles = followed(f.denominator, f.denominatorDerivative, poles, step, reach);
                zeros = followed(f.numerator, f.numeratorDerivative, zeros, step, reach);
            }
            return state(values, poles, zeros);
        },
    };
}

// Values between two sets of values, so close to each other that roots can be followed.
function path(from, to, stride) {
    const names = Object.keys(to).filter((name) => from[name] !== to[name]);
    const far = Math.max(0, ...names.map((n) => (from[n] * to[n] > 0 ? Math.abs(Math.log(to[n] / from[n])) / stride : 12)));
    const count = Math.min(100, Math.ceil(far)), steps = [];
    for (let k = 1; k <= count; k++) {
        const step = { ...to }, t = k / count;
        for (const n of names) {
            if (k === count) break;
            step[n] = from[n] * to[n] > 0 ? from[n] * (to[n] / from[n]) ** t : from[n] + (to[n] - from[n]) * t;
        }
        steps.push(step);
    }
    return steps;
}

// The response to a unit step as the sum of residues of G(s)/s: at 0 and at multiple poles by means over a circle.
function stepOf(f, values, listed, times) {
    const poles = [];
    for (const p of listed) {
        const same = poles.find((r) => Math.hypot(r.re - p.re, r.im - p.im) <= 1e-7 * Math.hypot(p.re, p.im));
        if (same) same.multiplicity += p.multiplicity;
        else poles.push({ ...p });
    }
    const y = new Float64Array(times.length);
    const distance = (p) => Math.min(...poles.filter((r) => r !== p).map((r) => Math.hypot(r.re - p.re, r.im - p.im)),
        p.im ? 2 * p.im : Infinity, Math.hypot(p.re, p.im) || Infinity);
    const circle = (p, radius) => {
        const angles = Array.from({ length: NODES }, (_, k) => TAU * (k + 0.5) / NODES);
        const x = angles.map((a) => radius * Math.cos(a)), z = angles.map((a) => radius * Math.sin(a));
        const s = [Float64Array.from(x, (v) => v + p.re), Float64Array.from(z, (v) => v + p.im)];
        return [s, x, z, f(s, values)];
    };
    const origin = poles.find((r) => r.re === 0 && r.im === 0) ?? tracked(0, 0, 0);
    const radius = 0.5 * distance(origin), [, x0, z0, [g, h]] = circle(origin, Number.isFinite(radius) ? radius : 1);
    let factorial = 1;
    for (let k = 0, u = x0.map(() => 1), v = x0.map(() => 0); k <= origin.multiplicity; k++) {
        let mean = 0;
        for (let i = 0; i < NODES; i++) {
            mean += (g[i] * u[i] - h[i] * v[i]) / NODES;
            [u[i], v[i]] = [u[i] * x0[i] - v[i] * z0[i], u[i] * z0[i] + v[i] * x0[i]];
        }
        factorial *= Math.max(k, 1);
        for (let i = 0; i < times.length; i++) y[i] += mean * times[i] ** k / factorial;
    }
    const add = (a, b, re, im, weight) => {
        for (let i = 0; i < times.length; i++) {
            y[i] += weight * Math.exp(re * times[i]) * (a * Math.cos(im * times[i]) - b * Math.sin(im * times[i]));
        }
    };
    for (const p of poles) {
        const weight = p.im ? 2 : 1;
        if (p === origin) continue;
        if (p.multiplicity === 1) {
            const at = [p.re, p.im], [a, b] = f.numerator(at, values), [c, d] = f.denominatorDerivative(at, values);
            const [u, v] = over(a, b, c, d);
            add(...over(u, v, p.re, p.im), p.re, p.im, weight);
            continue;
        }
        const [s, x, z, [c, d]] = circle(p, 0.5 * distance(p));
        for (let i = 0; i < NODES; i++) {
            const [u, v] = over(c[i], d[i], s[0][i], s[1][i]);
            add((u * x[i] - v * z[i]) / NODES, (u * z[i] + v * x[i]) / NODES, s[0][i], s[1][i], weight);
        }
    }
    return y;
}

// ------------------------------------------------------------------------------------------------- plots

function drawn(name, attributes = {}, text = "") {
    const e = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) e.setAttribute(key, value);
    if (text) e.textContent = text;
    return e;
}

function short(x, digits = 4) {
    return String(Number(x.toPrecision(digits))).replace("-", "−").replace("e-", "e−").replace("e+", "e");
}

function decade(n) {
    return n >= -2 && n <= 4 ? String(Number(`1e${n}`)) : `10${String(n).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻")}`;
}

// Ticks [place, label] between two ends, and lines between them; on a logarithmic axis places are exponents.
function ticks(lo, hi, room, isLog) {
    const many = Math.max(2, Math.floor(room));
    if (isLog && hi - lo >= 1.5) {
        const every = Math.ceil((hi - lo) / many), found = [];
        for (let n = Math.ceil(lo - 1e-9); n <= hi + 1e-9; n++) {
            if (n % every === 0) found.push([n, decade(n)]);
        }
        return found;
    }
    if (isLog) {
        const found = [];
        for (let n = Math.floor(lo); n <= hi; n++) {
            for (const m of [1, 2, 5]) {
                const at = n + Math.log10(m);
                if (at >= lo && at <= hi) found.push([at, short(m * 10 ** n)]);
            }
        }
        return found;
    }
    const raw = (hi - lo) / many, unit = 10 ** Math.floor(Math.log10(raw));
    const step = unit * [1, 2, 5, 10].find((m) => m * unit >= raw), found = [];
    for (let k = Math.ceil(lo / step - 1e-9); k * step <= hi + 1e-9 * step; k++) found.push([k * step, short(k * step, 6)]);
    return found;
}

// Ends of an axis around values: the last ones where they still serve, so that curves move and not the axis.
function ends(values, last, isWhole = false) {
    let lo = Infinity, hi = -Infinity;
    for (const x of values) {
        if (x < lo) lo = x;
        if (x > hi) hi = x;
    }
    if (!(hi >= lo)) return last ?? [0, 1];
    if (last && lo >= last[0] && hi <= last[1] && hi - lo > 0.4 * (last[1] - last[0])) return last;
    if (isWhole) return [Math.floor(lo - 0.1), Math.ceil(hi + 0.1)];
    const room = 0.12 * (hi - lo) || 0.5 * Math.abs(hi) || 1;
    return [lo - room, hi + room];
}

class Plot {
    constructor(svg, name) {
        Object.assign(this, { svg, name, key: "", x: null, y: null });
        svg.setAttribute("role", "img");
        const id = `${svg.closest("main").id}-${svg.classList[1]}`;
        svg.setAttribute("aria-labelledby", `${id}-title ${id}-desc`);
        this.title = drawn("title", { id: `${id}-title` }, name);
        this.desc = drawn("desc", { id: `${id}-desc` });
        this.grid = drawn("g");
        this.clip = drawn("rect");
        const clip = drawn("clipPath", { id: `${id}-clip` });
        clip.append(this.clip);
        this.inner = drawn("g", { "clip-path": `url(#${id}-clip)` });
        svg.append(this.title, this.desc, clip, this.grid, this.inner);
    }

    // Draw axes between ends, when they or the size changed.
    axes(x, y) {
        const width = this.svg.clientWidth || 400, height = this.svg.clientHeight || 240;
        const key = JSON.stringify([x, y, width, height]);
        if (key === this.key) return;
        const left = 58, right = width - 18, top = 8, bottom = height - 40;
        Object.assign(this, { key, left, right, top, bottom, x, y });
        this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
        for (const [k, v] of Object.entries({ x: left, y: top, width: right - left, height: bottom - top })) {
            this.clip.setAttribute(k, Math.max(v, 0));
        }
        const lines = [], texts = [];
        const across = ticks(...x.ends, (right - left) / 70, x.isLog), up = y.ticks ?? ticks(...y.ends, (bottom - top) / 40, y.isLog);
        for (const [at, label] of across) {
            lines.push(drawn("path", { class: "grid-line", d: `M${this.px(at)} ${top}V${bottom}` }));
            texts.push(drawn("text", { x: this.px(at), y: bottom + 16, "text-anchor": "middle" }, label));
        }
        for (const [at, label] of up) {
            if (at < y.ends[0] || at > y.ends[1]) continue;
            lines.push(drawn("path", { class: "grid-line", d: `M${left} ${this.py(at)}H${right}` }));
            texts.push(drawn("text", { x: left - 6, y: this.py(at) + 4, "text-anchor": "end" }, label));
        }
        texts.push(drawn("text", { x: (left + right) / 2, y: height - 6, "text-anchor": "middle" }, x.label));
        const middle = (top + bottom) / 2;
        texts.push(drawn("text", { x: 0, y: 0, transform: `translate(12 ${middle}) rotate(-90)`, "text-anchor": "middle" }, y.label));
        const frame = drawn("rect", { class: "frame", x: left, y: top, width: Math.max(right - left, 0), height: Math.max(bottom - top, 0) });
        this.grid.replaceChildren(...lines, ...texts, frame);
    }

    px(x) {
        const [lo, hi] = this.x.ends;
        return Math.round(10 * (this.left + (x - lo) / (hi - lo) * (this.right - this.left))) / 10;
    }

    py(y) {
        const [lo, hi] = this.y.ends;
        const at = this.bottom - (y - lo) / (hi - lo) * (this.bottom - this.top);
        return Math.round(10 * Math.max(-1e5, Math.min(1e5, at))) / 10;
    }

    // A curve; it is interrupted where it is not finite, and where it jumps by more than `jump`.
    curve(xs, ys, jump = Infinity) {
        const d = [];
        let last = NaN;
        for (let i = 0; i < xs.length; i++) {
            if (!Number.isFinite(ys[i])) {
                if (ys[i] !== Infinity) last = NaN;
                continue;
            }
            d.push(Math.abs(ys[i] - last) <= jump ? "L" : "M", this.px(xs[i]), " ", this.py(ys[i]));
            last = ys[i];
        }
        return d.join("");
    }

    show(children, desc) {
        this.inner.replaceChildren(...children);
        if (this.desc.textContent !== desc) this.desc.textContent = desc;
    }
}

function crosses(plot, roots, isPole, isGhost, colour) {
    const parts = [];
    for (const r of roots) {
        for (const im of r.im ? [r.im, -r.im] : [0]) {
            const x = plot.px(r.re), y = plot.py(im);
            parts.push(isPole ? `M${x - 5} ${y - 5}l10 10m0-10l-10 10` : `M${x - 5} ${y}a5 5 0 1 0 10 0a5 5 0 1 0-10 0`);
        }
    }
    return drawn("path", { class: `${isPole ? "pole" : "zero"} ${colour}${isGhost ? " ghost" : ""}`, d: parts.join("") });
}

// ------------------------------------------------------------------------------------------------- a model

function model(main, { PARAMETERS, TRANSFER_FUNCTIONS, data }) {
    const one = (selector) => main.querySelector(selector), all = (selector) => [...main.querySelectorAll(selector)];
    const parameters = data.parameters, functions = data.functions.map((f) => ({ ...f, at: TRANSFER_FUNCTIONS[f.name] }));
    const declared = Object.fromEntries(parameters.map((p) => [p.id, p.value]));
    const plots = Object.fromEntries(["magnitude", "phase", "map", "step"].map((n) => [n, new Plot(one(`svg.${n}`), n)]));
    let values = { ...declared }, earlier = [], committed = { ...declared }, focus = 0, until = 0, wanted = false;
    let span = null, map = {}, last = null;
    const shown = new Set([0]);
    const [sliders, fields, rows] = [all(".parameter input[type=range]"), all(".parameter input[type=number]"), all(".parameter")];
    const said = (text) => { one(".said").textContent = text; };
    const missing = (at) => parameters.filter((p) => p.moves && at[p.id] === null);
    const isDeclared = () => parameters.every((p) => values[p.id] === declared[p.id]);

    const provers = functions.map((f) => {
        const make = () => {
            const prover = proverOf(f.tape);
            return prover.refused ? tracerOf(f.at, f, prover.refused) : prover;
        };
        let made = null;
        return () => (made ??= make());
    });
    const states = functions.map(() => null);
    const rootsAt = (i, at) => {
        const before = states[i];
        states[i] = provers[i]().moved(before ?? provers[i]().begin(declared), at);
        return states[i];
    };

    // ------------------------------------------------------------------------------------------ sliders

    const log = (p) => p.low > 0 || p.high < 0;
    const place = (p, x) => {
        const [a, b, y] = log(p) ? [p.low, p.high, x].map((v) => Math.log(Math.abs(v))) : [p.low, p.high, x];
        return STEPS_OF_SLIDER * (y - a) / (b - a);
    };
    const atPlace = (p, k) => {
        const t = k / STEPS_OF_SLIDER;
        return Number((log(p) ? p.low * (p.high / p.low) ** t : p.low + (p.high - p.low) * t).toPrecision(4));
    };
    const written = (p) => (values[p.id] === null ? NaN : Number((values[p.id] / p.scale).toPrecision(12)));
    const sync = () => {
        parameters.forEach((p, i) => {
            const x = written(p);
            if (document.activeElement !== fields[i]) fields[i].value = Number.isNaN(x) ? "" : String(Number(x.toPrecision(6)));
            sliders[i].value = Number.isNaN(x) ? STEPS_OF_SLIDER / 2 : place(p, x);
            sliders[i].setAttribute("aria-valuetext", Number.isNaN(x) ? "no value" : `${short(x, 6)} ${p.unit}`);
        });
        one(".undo").disabled = !earlier.length;
        one(".reset").disabled = isDeclared();
    };
    const commit = () => {
        if (parameters.every((p) => values[p.id] === committed[p.id])) return;
        earlier.push(committed);
        committed = { ...values };
        keep();
        sync();
    };
    const put = (next) => {
        values = { ...values, ...next };
        sync();
        ask();
    };
    parameters.forEach((p, i) => {
        sliders[i].disabled = fields[i].disabled = !p.moves;
        if (!p.moves) {
            rows[i].classList.add("fixed");
            rows[i].title = "fixed: the functions hold its number";
        }
        sliders[i].addEventListener("input", () => put({ [p.id]: atPlace(p, Number(sliders[i].value)) * p.scale }));
        fields[i].addEventListener("input", () => {
            const x = Number(fields[i].value);
            const isGood = fields[i].value !== "" && Number.isFinite(x) && (p.assume === "real" || x > 0 || (p.assume === "nonnegative" && x === 0));
            fields[i].setCustomValidity(isGood ? "" : `${p.name} is ${p.assume}`);
            if (isGood) put({ [p.id]: x * p.scale });
        });
        for (const input of [sliders[i], fields[i]]) input.addEventListener("change", commit);
    });

    // ------------------------------------------------------------------------------------------ buttons

    const back = () => {
        if (!earlier.length) return;
        committed = earlier.pop();
        values = { ...committed };
        keep();
        put({});
    };
    one(".reset").addEventListener("click", () => { put(declared); commit(); });
    one(".undo").addEventListener("click", back);
    main.addEventListener("keydown", (e) => {
        if ((e.ctrlKey || e.metaKey) && e.key === "z" && e.target.type !== "number") {
            e.preventDefault();
            back();
        }
    });
    const copy = async (text, what) => {
        try {
            await navigator.clipboard.writeText(text);
        } catch {
            const area = document.createElement("textarea");
            area.value = text;
            main.append(area);
            area.select();
            document.execCommand("copy");
            area.remove();
        }
        said(`${what} is on the clipboard.`);
    };
    const specification = () => data.specification.map((piece) => {
        if (typeof piece === "string") return piece;
        const [i, unit] = piece, x = String(Number(written(parameters[i]).toPrecision(6)));
        return unit ? `"${x} ${unit}"` : x;
    }).join("");
    one(".copy").addEventListener("click", () => copy(specification(), "The specification"));
    one(".link").addEventListener("click", () => { keep(); copy(location.href, "The link"); });
    one(".save").addEventListener("click", () => {
        const link = document.createElement("a");
        link.href = URL.createObjectURL(new Blob([picture(Object.values(plots).map((p) => p.svg))], { type: "image/svg+xml" }));
        link.download = "symflex.svg";
        link.click();
        URL.revokeObjectURL(link.href);
        said("symflex.svg is saved.");
    });

    // The state as the link holds it.
    const keep = () => {
        const changed = parameters.filter((p) => values[p.id] !== declared[p.id]).map((p) => [p.name, String(written(p))]);
        const words = new URLSearchParams(changed);
        if (main.id !== "model-0") words.set("@model", main.id.slice(6));
        if (focus) words.set("@tf", functions[focus].name);
        const hash = words.toString();
        if (location.hash.slice(1) !== hash) location.replace(`#${hash}`);
    };
    const recall = () => {
        const words = new URLSearchParams(location.hash.slice(1)), next = {};
        for (const p of parameters) {
            const x = Number(words.get(p.name) ?? NaN);
            if (p.moves && Number.isFinite(x)) next[p.id] = x * p.scale;
        }
        const named = functions.findIndex((f) => f.name === words.get("@tf"));
        if (named > 0) choose(named);
        put({ ...declared, ...next });
        committed = { ...values };
    };

    // ------------------------------------------------------------------------------------------ what is shown

    const checks = all(".checks input"), hertz = one(".hertz"), decibels = one(".decibels");
    const choose = (i) => {
        focus = i;
        one(".focus").selectedIndex = i;
        shown.add(i);
        checks.forEach((c, k) => { c.checked = shown.has(k); });
        all(".formulas > *").forEach((e, k) => { e.hidden = k !== i; });
        map = {};
        until = 0;
        plots.step.y = null;
        ask();
    };
    checks.forEach((c, k) => {
        c.parentElement.classList.add(`k${k % COLOURS + 1}`);
        c.addEventListener("change", () => { shown[c.checked ? "add" : "delete"](k); ask(); });
    });
    one(".focus").addEventListener("change", () => { choose(one(".focus").selectedIndex); keep(); });
    for (const s of [hertz, decibels]) s.addEventListener("change", () => { span = null; ask(); });
    one(".until input").addEventListener("input", (e) => {
        if (Number(e.target.value) > 0) until = Number(e.target.value);
        ask();
    });
    one(".chooser").hidden = one(".checks").hidden = functions.length < 2;
    new ResizeObserver(() => ask()).observe(one(".grid"));

    const ask = () => {
        if (wanted) return;
        wanted = true;
        requestAnimationFrame(() => { wanted = false; draw(); });
    };

    const draw = () => {
        const lacking = missing(values);
        one(".missing").hidden = !lacking.length;
        one(".missing").textContent = `Curves need values for ${lacking.map((p) => p.name).join(", ")}.`;
        if (lacking.length) return;
        const hasGhost = !missing(declared).length && !isDeclared();
        const state = rootsAt(focus, values);
        last = state;
        bode(hasGhost, state);
        plane(hasGhost, state);
        response(hasGhost, state);
        words(state);
    };

    const colour = (i) => `s${i % COLOURS + 1}`;

    // Angular frequencies: evenly on a logarithmic axis, and around every root.
    const grid = (state) => {
        const [lo, hi] = data.band.map((f) => Math.log(TAU * f)), list = [];
        for (let k = 0; k <= LINES; k++) list.push(Math.exp(lo + (hi - lo) * k / LINES));
        for (const r of [...state.poles, ...state.zeros]) {
            const width = Math.max(Math.abs(r.re), 1e-5 * r.im);
            for (const k of [-30, -10, -4, -2, -1, -0.5, 0, 0.5, 1, 2, 4, 10, 30]) list.push(r.im + k * width);
        }
        return Float64Array.from(list.filter((w) => w >= Math.exp(lo) * 0.999999 && w <= Math.exp(hi) * 1.000001)).sort();
    };

    const sampled = (i, w, at) => {
        const [re, im] = functions[i].at([new Float64Array(w.length), w], at);
        const size = new Float64Array(w.length), angle = new Float64Array(w.length);
        for (let k = 0; k < w.length; k++) {
            size[k] = Math.log10(Math.hypot(re[k], im[k]));
            const a = Math.atan2(im[k], re[k]) * 180 / Math.PI;
            angle[k] = a > 179.9 ? a - 360 : a;
        }
        return { size, angle };
    };

    const bode = (hasGhost, state) => {
        const isHertz = hertz.selectedIndex === 0, isDecibels = decibels.selectedIndex === 1;
        const sets = [[values, grid(state), ""]];
        if (hasGhost) sets.unshift([declared, grid(provers[focus]().begin(declared)), " ghost"]);
        const curves = [], sizes = [];
        for (const [at, w, ghost] of sets) {
            const x = Float64Array.from(w, (v) => Math.log10(isHertz ? v / TAU : v));
            for (const i of shown) {
                const { size, angle } = sampled(i, w, at), y = isDecibels ? size.map((v) => 20 * v) : size;
                curves.push([i, ghost, x, y, angle]);
                // Peaks of undamped resonances do not set the axis.
                const sorted = y.filter(Number.isFinite).sort(), cut = Math.floor(0.04 * sorted.length);
                sizes.push(...sorted.slice(cut, sorted.length - cut));
                if (sorted.length) sizes.push(Math.max(sorted[0], sorted[cut] - (isDecibels ? 40 : 2)), Math.min(sorted.at(-1), sorted.at(-1 - cut) + (isDecibels ? 40 : 2)));
            }
        }
        span = ends(sizes, span, !isDecibels);
        const units = new Set([...shown].map((i) => functions[i].unit)), unit = units.size === 1 ? [...units][0] : "";
        const x = { ends: data.band.map((f) => Math.log10(isHertz ? f : TAU * f)), isLog: true, label: isHertz ? "frequency [Hz]" : "frequency [rad/s]" };
        plots.magnitude.axes(x, { ends: span, isLog: !isDecibels, label: isDecibels ? "magnitude [dB]" : unit && unit !== "1" ? `magnitude [${unit}]` : "magnitude" });
        plots.phase.axes(x, { ends: [-190, 190], label: "phase [°]", ticks: [-180, -90, 0, 90, 180].map((v) => [v, short(v)]) });
        const paths = (plot, pick, jump) => curves.map((c) => drawn("path", { class: `curve ${colour(c[0])}${c[1]}`, d: plot.curve(c[2], pick(c), jump) }));
        const ofFocus = curves.filter((c) => !c[1]).map(([i, , cx, y]) => {
            let peak = 0;
            for (let k = 0; k < y.length; k++) if (y[k] > y[peak]) peak = k;
            const say = (k) => `${isDecibels ? `${short(y[k])} dB` : short(10 ** y[k])} at ${short(10 ** cx[k])} ${isHertz ? "Hz" : "rad/s"}`;
            return y.length ? `${functions[i].name}: ${say(0)}, largest ${say(peak)}, ${say(y.length - 1)}.` : "";
        }).join(" ");
        plots.magnitude.show(paths(plots.magnitude, (c) => c[3]), ofFocus);
        plots.phase.show(paths(plots.phase, (c) => c[4], 185), `Phase between −180° and 180° over the same frequencies.`);
    };

    const plane = (hasGhost, state) => {
        const before = provers[focus]().begin(declared), plot = plots.map;
        const roots = [...state.poles, ...state.zeros, ...(hasGhost ? [...before.poles, ...before.zeros] : [])];
        const tall = Math.max(1e-9, ...roots.map((r) => Math.hypot(r.re, r.im)));
        map.x = ends([...roots.map((r) => r.re), -0.02 * tall, 0.02 * tall], map.x);
        map.y = ends([-1.02, 1.02].map((k) => k * Math.max(...roots.map((r) => r.im), 0.2 * tall)), map.y);
        plot.axes({ ends: map.x, label: "Re s [rad/s]" }, { ends: map.y, label: "Im s [rad/s]" });
        const zero = plot.px(0), width = Math.max(plot.right - zero, 0);
        const parts = [drawn("rect", { class: "right", x: zero, y: plot.top, width, height: Math.max(plot.bottom - plot.top, 0) }),
            drawn("path", { class: "axis", d: `M${zero} ${plot.top}V${plot.bottom}M${plot.left} ${plot.py(0)}H${plot.right}` })];
        if (hasGhost) parts.push(crosses(plot, before.zeros, false, true, colour(focus)), crosses(plot, before.poles, true, true, colour(focus)));
        parts.push(crosses(plot, state.zeros, false, false, colour(focus)), crosses(plot, state.poles, true, false, colour(focus)));
        plot.show(parts, `${state.poles.length} poles and ${state.zeros.length} zeros in the upper half plane and on the real axis; the table lists the poles.`);
    };

    // A time in which the slowest motion shows: ten periods, or until it has decayed.
    const usual = (poles) => {
        const moving = poles.filter((p) => p.re || p.im), sizes = moving.map((p) => Math.hypot(p.re, p.im));
        if (!moving.length) return 1;
        const slow = Math.min(...moving.map((p) => Math.abs(p.re)));
        const long = Math.min(10 * TAU / Math.min(...sizes), 7 / slow), unit = 10 ** Math.floor(Math.log10(long));
        return unit * [1, 2, 5, 10].find((m) => m * unit >= long * 0.999);
    };

    const response = (hasGhost, state) => {
        const before = provers[focus]().begin(declared), f = functions[focus], plot = plots.step;
        if (!until) {
            until = usual(before.poles.length ? before.poles : state.poles);
            one(".until input").value = String(Number(until.toPrecision(3)));
        }
        const times = Float64Array.from({ length: INSTANTS + 1 }, (_, k) => until * k / INSTANTS);
        times[0] = until * 1e-9;
        const sets = [];
        if (hasGhost) sets.push([stepOf(f.at, declared, before.poles, times), " ghost"]);
        sets.push([stepOf(f.at, values, state.poles, times), ""]);
        const all = sets.flatMap(([y]) => [...y].filter(Number.isFinite));
        const first = [...sets[0][0]].filter(Number.isFinite).map(Math.abs), most = 20 * Math.max(...first, 0);
        span = span ?? null;
        map.step = ends([0, ...all.map((v) => (most ? Math.max(-most, Math.min(most, v)) : v))], map.step);
        plot.axes({ ends: [0, until], label: "time [s]" }, { ends: map.step, label: f.unit && f.unit !== "1" ? `response [${f.unit}]` : "response" });
        const y = sets.at(-1)[0];
        plot.show(sets.map(([v, ghost]) => drawn("path", { class: `curve ${colour(focus)}${ghost}`, d: plot.curve(times, v) })),
            `${f.name}: ${short(y[INSTANTS >> 1])} at ${short(until / 2)} s, ${short(y[INSTANTS])} at ${short(until)} s.`);
    };

    const words = (state) => {
        const f = functions[focus], isHertz = hertz.selectedIndex === 0;
        const sure = state.certified.poles && state.certified.zeros;
        const count = state.poles.reduce((n, p) => n + p.multiplicity, 0);
        const label = (selector, text, isGood) => {
            one(selector).textContent = text;
            one(selector).classList.toggle("good", isGood);
        };
        label(".roots-label", sure ? "proved" : "traced", sure);
        label(".step-label", f.infinite ? `${count} modes, estimated` : `all ${count} modes, in doubles`, false);
        const lost = [...state.poles, ...state.zeros].filter((r) => r.isLost).length;
        const parts = [sure ? "Every root shown is proved, and none is missing from the window." : `Roots are traced, not proved: ${state.why}.`];
        if (lost) parts.push(`${lost} of them did not converge.`);
        if (f.why) parts.push(`There are no roots: ${f.why}.`);
        if (f.fixed) parts.push(`${f.name} is in band form: its numbers are those of the model, and no slider moves it.`);
        parts.push(f.infinite ? "The step response is the static part and the modes shown; modes beyond are left out." : "");
        one(".why").textContent = parts.filter(Boolean).join(" ");
        stability(state, f);
        one(".unit").textContent = isHertz ? "Frequency [Hz]" : "Frequency [rad/s]";
        const modes = [...state.poles].sort((a, b) => Math.hypot(a.re, a.im) - Math.hypot(b.re, b.im));
        one(".modes tbody").replaceChildren(...modes.map((p, i) => {
            const size = Math.hypot(p.re, p.im), row = document.createElement("tr");
            const times = p.multiplicity > 1 ? ` (${p.multiplicity} times)` : "";
            const how = p.isLost ? "lost" : p.proved ? `proved${p.radius ? `, ± ${short(p.radius, 2)} rad/s` : ""}` : "traced";
            const cells = [`${i + 1}`, short(isHertz ? size / TAU : size, 6), size ? short(-p.re / size || 0) : "–",
                p.re ? `${short(-1 / p.re)} s` : "∞", `${how}${times}`];
            for (const text of cells) row.append(Object.assign(document.createElement("td"), { textContent: text }));
            return row;
        }));
        one(".accuracy").textContent = `${f.name}: ${f.accuracy}.`;
    };

    const stability = (state, f) => {
        const line = one(".stability"), known = f.verdict && (isDeclared() || f.fixed) && f.verdict.proved ? f.verdict : null;
        const word = state.stability !== "unknown" ? state.stability : known?.word ?? "unknown";
        line.classList.toggle("stable", word === "stable");
        line.classList.toggle("unstable", word === "unstable");
        const right = Math.max(...state.poles.map((p) => p.re));
        const traced = state.poles.length ? `the rightmost poles shown have Re s = ${short(right, 3)} rad/s` : "no pole is known";
        const text = word === state.stability && word !== "unknown" ? `${word === "stable" ? "Stable" : "Unstable"}, proved at these values`
            : known ? `${known.sentence[0].toUpperCase()}${known.sentence.slice(1)}, proved at the declared values`
            : `Neither stability nor instability is proved here: ${traced}`;
        if (line.textContent !== `${text}.`) line.textContent = `${text}.`;
    };

    choose(0);
    recall();
    addEventListener("hashchange", recall);
    const named = (tf) => {
        const i = functions.findIndex((f) => f.name === tf);
        if (i < 0) throw new RangeError(`there is no transfer function ${tf}`);
        return i;
    };
    const spoken = functions.map(() => null);
    const stateOf = (tf, at = {}) => {
        const i = named(tf), p = provers[i]();
        return (spoken[i] = p.moved(spoken[i] ?? p.begin(declared), { ...declared, ...at }));
    };
    return {
        get parameters() {
            return Object.fromEntries(parameters.map((p) => [p.id, {
                value: values[p.id], declared: p.value, unit: PARAMETERS[p.id].unit, low: p.low * p.scale, high: p.high * p.scale,
            }]));
        },
        evaluate: (tf, at, omega) => functions[named(tf)].at([0, omega], { ...declared, ...at }),
        roots(tf, at) {
            const { poles, zeros } = stateOf(tf, at);
            return [...poles.map((r) => ({ ...r, kind: "pole" })), ...zeros.map((r) => ({ ...r, kind: "zero" }))];
        },
        certified: (tf, at) => Object.values(stateOf(tf, at).certified).every(Boolean),
        ready: new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }),
        show() { ask(); },
        specification,
    };
}

// Plots as one picture: what the style sheet says becomes attributes, which every program reads.
function picture(plots) {
    const whole = drawn("svg", { xmlns: SVG }), gap = 16;
    let top = 0, widest = 0;
    for (const svg of plots) {
        const copy = svg.cloneNode(true), { width, height } = svg.getBoundingClientRect();
        const [own, copied] = [svg, copy].map((e) => [...e.querySelectorAll("*")]);
        own.forEach((e, i) => {
            const style = getComputedStyle(e);
            for (const key of ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "font-family", "font-size"]) {
                copied[i].setAttribute(key, style.getPropertyValue(key));
            }
        });
        for (const [k, v] of Object.entries({ x: 0, y: top, width, height })) copy.setAttribute(k, v);
        whole.append(copy);
        top += height + gap;
        widest = Math.max(widest, width);
    }
    whole.prepend(drawn("rect", { width: widest, height: top, fill: getComputedStyle(document.body).backgroundColor }));
    whole.setAttribute("viewBox", `0 0 ${widest} ${top}`);
    return new XMLSerializer().serializeToString(whole);
}

function live(parts) {
    const mains = [...document.querySelectorAll("main")], made = [], chooser = document.getElementById("model");
    const choose = (i) => {
        mains.forEach((main, k) => { main.hidden = k !== i; });
        made[i] ??= model(mains[i], parts[i]);
        made[i].show();
        window.symflex = made[i];
    };
    chooser?.addEventListener("change", () => choose(chooser.selectedIndex));
    const first = Number(new URLSearchParams(location.hash.slice(1)).get("@model")) || 0;
    if (chooser) chooser.selectedIndex = first;
    choose(first < parts.length ? first : 0);
}
