// Drawings in SVG: a Bode plot, a step response, a map of poles and zeros, and the drawing of a model.

const SVG = "http://www.w3.org/2000/svg";

export function element(name, attributes = {}, ...children) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
}

const tidy = (x) => (Object.is(x, -0) ? "0" : String(+x.toPrecision(4))).replace("-", "\u2212");

/** Values at which a scale is marked: about so many round ones. */
function marks(low, high, about) {
    const raw = (high - low) / about, power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((m) => m * power >= raw);
    const found = [];
    for (let x = Math.ceil(low / step - 1e-9) * step; x <= high + step * 1e-9; x += step) found.push(x);
    return found;
}

function frame(width, height, label) {
    return element("svg", { viewBox: `0 0 ${width} ${height}`, class: "plot", role: "img", "aria-label": label });
}

function text(x, y, what, attributes = {}) {
    return element("text", { x, y, ...attributes }, what);
}

/** The curve through points, broken where a value is missing or jumps. */
function path(points, jump) {
    let said = "", last = null;
    for (const point of points) {
        const isOn = point && last && !(Math.abs(point[2] - last[2]) > jump);
        if (point) said += `${isOn ? "L" : "M"}${point[0].toFixed(2)} ${point[1].toFixed(2)}`;
        last = point;
    }
    return said;
}

/** Angles without jumps of a turn; as they are where they jump by half a turn, up at zeros and down at poles. */
function continuous(angles) {
    const found = [angles[0]];
    for (const angle of angles.slice(1)) {
        const away = angle - found.at(-1);
        const next = away - 360 * Math.round(away / 360);
        if (Math.abs(next) > 150) return angles;
        found.push(found.at(-1) + next);
    }
    return found;
}

export function bode(hertz, values, unit) {
    const left = 52, right = 20, width = 440, each = 135, between = 18, top = 12;
    const plot = frame(width, top + 2 * each + between + 40, "Bode plot: magnitude and phase over frequency");
    const [low, high] = [Math.log10(hertz[0]), Math.log10(hertz.at(-1))];
    const across = (f) => left + ((Math.log10(f) - low) / (high - low)) * (width - left - right);
    const size = values.map(([re, im]) => Math.log10(Math.hypot(re, im)));
    const angle = continuous(values.map(([re, im]) => (Math.atan2(im, re) * 180) / Math.PI));
    const seen = angle.filter((v, i) => Number.isFinite(size[i]));
    const turns = [90, 180, 360, 720, 1800, 3600].find((turn) => (Math.max(...seen) - Math.min(...seen)) / turn <= 5) ?? 36000;
    const [lowest, highest] = [Math.floor(Math.min(...seen) / turns) * turns, Math.ceil(Math.max(...seen) / turns) * turns];
    const angles = [];
    for (let v = lowest; v <= Math.max(highest, lowest + turns); v += turns) angles.push(v);
    const finite = size.filter(Number.isFinite);
    if (!finite.length) return null;
    const bottomDecade = Math.floor(Math.min(...finite)), topDecade = Math.max(Math.ceil(Math.max(...finite)), bottomDecade + 1);
    const step = Math.ceil((topDecade - bottomDecade) / 6);
    const decades = [];
    for (let d = bottomDecade; d <= topDecade; d += step) decades.push(d);
    const rows = [
        [top, bottomDecade, topDecade, decades, size, Infinity, (d) => `1e${d}`, unit ? `|G| [${unit}]` : "|G|"],
        [top + each + between, lowest, angles.at(-1), angles, angle, 180, (d) => `${tidy(d)}°`, "phase"],
    ];
    for (const [y0, from, to, marked, data, jump, say, name] of rows) {
        const up = (v) => y0 + each * (1 - (v - from) / (to - from));
        for (let d = Math.ceil(low); d <= high; d++)
            plot.append(element("path", { class: "grid-line", d: `M${across(10 ** d)} ${y0}v${each}` }));
        for (const mark of marked) {
            plot.append(element("path", { class: "grid-line", d: `M${left} ${up(mark)}H${width - right}` }));
            const shown = text(left - 6, up(mark) + 4, say(mark), { "text-anchor": "end" });
            if (say(mark).startsWith("1e"))
                shown.replaceChildren("10", element("tspan", { dy: -4, class: "raised" }, tidy(mark)));
            plot.append(shown);
        }
        plot.append(element("rect", { class: "frame", x: left, y: y0, width: width - left - right, height: each }));
        const points = data.map((v, i) => (Number.isFinite(v) ? [across(hertz[i]), up(v), v] : null));
        plot.append(element("path", { class: "curve", d: path(points, jump) }));
        plot.append(text(left + 8, y0 + 15, name, { class: "quiet" }));
    }
    const foot = top + 2 * each + between;
    for (let d = Math.ceil(low); d <= high; d++)
        plot.append(text(across(10 ** d), foot + 16, tidy(10 ** d), { "text-anchor": "middle" }));
    plot.append(text((left + width - right) / 2, foot + 34, "frequency [Hz]", { "text-anchor": "middle", class: "quiet" }));
    return plot;
}

export function step(times, values, unit) {
    const width = 440, height = 220, left = 64, right = 20, top = 12, bottom = 40;
    const plot = frame(width, height, "Step response over time");
    const finite = values.filter(Number.isFinite);
    const [least, most] = [Math.min(0, ...finite), Math.max(0, ...finite)];
    const air = (most - least) * 0.06 || 1;
    const [from, to, end] = [least && least - air, most + air, times.at(-1)];
    const x = (t) => left + (t / end) * (width - left - right);
    const y = (v) => top + ((to - v) / (to - from)) * (height - top - bottom);
    for (const mark of marks(from, to, 5)) {
        plot.append(element("path", { class: "grid-line", d: `M${left} ${y(mark)}H${width - right}` }));
        plot.append(text(left - 6, y(mark) + 4, tidy(mark), { "text-anchor": "end" }));
    }
    for (const mark of marks(0, end, 6)) {
        plot.append(element("path", { class: "grid-line", d: `M${x(mark)} ${top}V${height - bottom}` }));
        plot.append(text(x(mark), height - bottom + 16, tidy(mark), { "text-anchor": "middle" }));
    }
    plot.append(element("path", { class: "axis", d: `M${left} ${y(0)}H${width - right}` }));
    plot.append(element("rect", { class: "frame", x: left, y: top, width: width - left - right, height: height - top - bottom }));
    const points = values.map((v, i) => (Number.isFinite(v) ? [x(times[i]), y(v), v] : null));
    plot.append(element("path", { class: "curve", d: path(points, Infinity) }));
    plot.append(text((left + width - right) / 2, height - 6, "time [s]", { "text-anchor": "middle", class: "quiet" }));
    if (unit) plot.append(text(left + 8, top + 15, `[${unit}]`, { class: "quiet" }));
    return plot;
}

export function rootMap(poles, zeros) {
    const width = 440, height = 300, left = 52, right = 14, top = 12, bottom = 40;
    const plot = frame(width, height, `Poles and zeros in the s plane: ${poles.length} poles, ${zeros.length} zeros`);
    const all = [...poles, ...zeros].map((r) => [Number(r.re), Number(r.im)]);
    const most = (i) => Math.max(...all.map((z) => Math.abs(z[i])), 0);
    const tall = most(1) * 1.15 || most(0) * 0.6 || 1;
    const reach = Math.max(most(0) * 1.2, tall * 0.05) || 1;
    const from = -reach, to = all.some((z) => z[0] > 0) ? reach : reach * 0.25;
    const x = (v) => left + ((v - from) / (to - from)) * (width - left - right);
    const y = (v) => top + ((tall - v) / (2 * tall)) * (height - top - bottom);
    plot.append(element("rect", { class: "right", x: x(0), y: top, width: width - right - x(0), height: height - top - bottom }));
    for (const mark of marks(-tall, tall, 5)) {
        plot.append(element("path", { class: "grid-line", d: `M${left} ${y(mark)}H${width - right}` }));
        plot.append(text(left - 6, y(mark) + 4, tidy(mark), { "text-anchor": "end" }));
    }
    for (const mark of marks(from, to, 5)) {
        plot.append(element("path", { class: "grid-line", d: `M${x(mark)} ${top}V${height - bottom}` }));
        plot.append(text(x(mark), height - bottom + 16, tidy(mark), { "text-anchor": "middle" }));
    }
    plot.append(element("path", { class: "axis", d: `M${x(0)} ${top}V${height - bottom}M${left} ${y(0)}H${width - right}` }));
    plot.append(element("rect", { class: "frame", x: left, y: top, width: width - left - right, height: height - top - bottom }));
    for (const [roots, kind] of [[zeros, "zero"], [poles, "pole"]])
        for (const root of roots) {
            const [u, v] = [x(Number(root.re)), y(Number(root.im))];
            const title = `${kind}: ${root.re} ${root.im} j rad/s, within ${root.radius}`;
            const mark = kind === "zero"
                ? element("circle", { class: "zero", cx: u, cy: v, r: 5 })
                : element("path", { class: "pole", d: `M${u - 5} ${v - 5}l10 10m0 -10l-10 10` });
            mark.append(element("title", {}, title));
            plot.append(mark);
            if (root.multiplicity > 1) plot.append(text(u + 8, v - 6, root.multiplicity));
        }
    plot.append(text((left + width - right) / 2, height - 6, "Re s [rad/s]", { "text-anchor": "middle", class: "quiet" }));
    plot.append(text(left + 8, top + 15, "Im s [rad/s]", { class: "quiet" }));
    return plot;
}

const ROLES = new Set(["element", "input", "output", "block", "field"]);

/** The drawing of a model: strokes, and runs of letters as wide as they were measured. */
export function drawn({ width, height, parts }) {
    const picture = element("svg", {
        viewBox: `0 0 ${width.toFixed(2)} ${height.toFixed(2)}`, class: "drawn", role: "img", "aria-label": "The model, drawn",
        width: `${(2.1 * width).toFixed(0)}`,
    });
    for (const { kind, name, strokes, texts } of parts) {
        const group = element("g");
        if (ROLES.has(kind)) group.append(element("title", {}, `${kind} ${name}`));
        for (const [points, wide, fill, isDashed] of strokes) {
            const isClosed = points.length > 2 && points[0].every((x, i) => x === points.at(-1)[i]);
            const d = points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(2)} ${(height - y).toFixed(2)}`).join("");
            const shade = { "": "none", "#E3E3E3": "grey", "#FFFFFF": "paper" }[fill] ?? "ink";
            group.append(element("path", { d: isClosed ? `${d}Z` : d, "stroke-width": wide, class: `${shade}${isDashed ? " dashed" : ""}` }));
        }
        for (const [letters, x, y, wide, size, face] of texts.flat()) {
            if (!letters) {
                group.append(element("path", { d: `M${x.toFixed(2)} ${(height - y).toFixed(2)}h${wide.toFixed(2)}`, "stroke-width": 0.5, class: "none" }));
                continue;
            }
            group.append(element("text", {
                x: x.toFixed(2), y: (height - y).toFixed(2), "font-size": size.toFixed(2), textLength: wide.toFixed(2),
                lengthAdjust: "spacingAndGlyphs", class: face,
            }, letters));
        }
        picture.append(group);
    }
    return picture;
}
