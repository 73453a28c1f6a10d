// Poles and zeros under a slider: carried along by Newton steps, then proved at every position.
//
// Input: what symflex/live/tape.py made of a transfer function. What is proved there (interval Newton, the
// argument principle) is proved of these tapes on discs; how roots are guessed proves nothing.

const CODES = { "+": 1, "-": 2, "*": 3, "/": 4, sqrt: 5, exp: 6 };
const MINIMAL = 1.0 / 100.0, PIECES = 16, DEEPEST = 9, INSIDE = 0.995;  // cos(pi/32) > INSIDE: chords of the first pieces lie beyond it

// One factor of a numerator or denominator, as a function of s on discs.
function factorOf(part) {
    const tape = part.tape, m = discs(tape.length), code = tape.map(([op]) => CODES[op] || 0);
    const a = tape.map((row) => row[1]), b = tape.map((row) => row[2]), moves = [];
    const given = [], sign = new Float64Array(2 * tape.length);
    let s = -1, following = false;
    tape.forEach(([op, x, y, r], i) => {
        moves[i] = op === "s" || (code[i] > 0 && (moves[x] || (code[i] < 4 && moves[y])));
        if (op === "#") put(m, i, x, y, r);
        if (op === "s") s = i;
        if (op === "p") given.push([i, x]);
    });
    const needed = (ends, kind) => {
        const used = new Set(ends);
        for (let i = tape.length - 1; i >= 0; i--) {
            if (used.has(i) && code[i]) [a[i], ...(code[i] < 4 ? [b[i]] : [])].forEach((x) => used.add(x));
        }
        return Int32Array.from([...used].filter((i) => code[i] && moves[i] === kind).sort((x, y) => x - y));
    };
    const everything = tape.map((_, i) => i);
    const run = (list) => {
        for (const k of list) {
            switch (code[k]) {
            case 1: sum(m, k, a[k], b[k], 1.0); break;
            case 2: sum(m, k, a[k], b[k], -1.0); break;
            case 3: product(m, k, a[k], b[k]); break;
            case 4: inverse(m, k, a[k]); break;
            case 6: exponent(m, k, a[k]); break;
            default:
                root(m, k, a[k]);
                if (!following) {
                    sign[2 * k] = m.x[k];
                    sign[2 * k + 1] = m.y[k];
                } else if (m.x[k] * sign[2 * k] + m.y[k] * sign[2 * k + 1] < 0.0) {
                    m.x[k] = -m.x[k];
                    m.y[k] = -m.y[k];
                }
            }
        }
    };
    const fixed = needed(everything, false), value = needed([part.value, ...part.growth], true);
    const slope = needed([part.value, part.slope], true), divisors = needed(part.divisors, true);
    const at = (list, x, y, r, follow = false) => {
        put(m, s, x, y, r);
        following = follow;
        run(list);
    };
    return {
        ...part, m, at, lists: { value, slope, divisors },
        bind(values) {
            for (const [i, place] of given) put(m, i, values[place], 0.0, 0.0);
            following = false;
            run(fixed);
        },
    };
}

// ------------------------------------------------------------------------------------------- guesses

const apart = (p, q) => modulus(p[0] - q[0], p[1] - q[1]);
const size = (p) => modulus(p[0], p[1]);

// The step that Newton takes from a point: what is subtracted. Away from roots that are `known`, their conjugates
// included; a root at 0 is one that is known so often.
function newton(f, x, y, known = []) {
    f.at(f.lists.slope, x, y, 0.0);
    const vx = f.m.x[f.value], vy = f.m.y[f.value], dx = f.m.x[f.slope], dy = f.m.y[f.slope];
    const n = vx * vx + vy * vy;
    if (!(n > 0.0)) return [0.0, 0.0];
    let u = (dx * vx + dy * vy) / n, w = (dy * vx - dx * vy) / n;
    for (const [p, q, times = 1] of known) {
        for (const sign of q ? [1.0, -1.0] : [1.0]) {
            const g = x - p, h = y - sign * q, k = times / (g * g + h * h);
            u -= g * k;
            w += h * k;
        }
    }
    const k = 1.0 / (u * u + w * w);
    return [u * k, -w * k];
}

// Where Newton's steps from z settle, null where they do not.
function approached(f, z, known) {
    let [x, y] = z, last = Infinity;
    for (let i = 0; i < 40; i++) {
        const [p, q] = newton(f, x, y, known), { x: X, y: Y, r: R } = f.m;
        x -= p;
        y -= q;
        const step = modulus(p, q), here = modulus(x, y), noise = R[f.value] / modulus(X[f.slope], Y[f.slope]);
        if (!(step < 1e6 * here)) return null;
        if (step <= 4e-16 * here || step <= 2.0 * noise || (step < 1e-9 * here && step > 0.5 * last)) return [x, y];
        last = step;
    }
    return null;
}

// A root in the upper half plane or on the real axis.
function upper(f, z) {
    if (Math.abs(z[1]) > 1e-7 * size(z)) return [z[0], Math.abs(z[1])];
    const real = approached(f, [z[0], 0.0]);
    return real && apart(real, z) < 1e-5 * size(z) ? [real[0], 0.0] : [z[0], Math.abs(z[1])];
}

const isNew = (z, roots) => roots.every((p) => apart(z, p) > 1e-8 * size(z));
const weight = (z) => (z[1] ? 2 : 1);
const total = (roots) => roots.reduce((n, z) => n + weight(z), 0);

// Roots at new values, from those at old ones, along the logarithms of values: guesses follow the tangent, and
// steps are shortened where two roots might be mixed up.
function carried(f, roots, from, to) {
    const between = (t) => (t >= 1.0 ? to : to.map((v, i) => (from[i] * v > 0.0 ? from[i] * (v / from[i]) ** t
        : from[i] + t * (v - from[i]))));
    let t = 0.0, h = 1.0, now = roots;
    for (let work = 0; t < 1.0 && work < 80; work++) {
        const e = 1e-5, end = Math.min(1.0, t + h);
        f.bind(between(t + e));
        const guesses = now.map(([x, y]) => {
            const [p, q] = newton(f, x, y), n = (x * x + y * y) * e / (t - end);
            const grown = Math.exp(Math.max(-20.0, Math.min(20.0, (p * x + q * y) / n))), turn = (q * x - p * y) / n;
            const c = grown * Math.cos(turn), s = grown * Math.sin(turn);
            return [x * c - y * s, x * s + y * c];
        });
        f.bind(between(end));
        const found = guesses.map((z) => approached(f, z));
        const isSafe = h < MINIMAL || found.every((z, i) => z && apart(z, guesses[i]) < 0.2 * Math.min(
            ...guesses.map((g, j) => (j === i ? 2.0 * Math.abs(g[1]) || Infinity : apart(g, guesses[i])))));
        if (!isSafe) {
            h /= 3.0;
            continue;
        }
        now = [];
        for (const z of found) {
            const own = z && upper(f, z);
            if (own && isNew(own, now)) now.push(own);
        }
        [t, h] = [end, 2.0 * h];
    }
    f.bind(to);
    return now;
}

// Roots that are missing within a radius, by Newton steps that avoid those that are known.
function sought(f, roots, radius, missing, hints) {
    const all = [...roots], starts = [...hints];
    for (let i = 0; i < 40; i++) {
        const r = radius * (1.0 - ((i * 0.6180339887) % 1.0)) ** 2, angle = Math.PI * (0.5 + 0.5 * ((i * 0.7548776662) % 1.0));
        const x = -r * Math.cos(angle), y = r * Math.sin(angle);
        starts.push([r, 0.0], [-r, 0.0], [0.0, r], [x, y], [-x, y]);
    }
    const zero = f.order ? [[0.0, 0.0, f.order]] : [];
    for (const start of starts) {
        if (missing <= 0) break;
        const guess = approached(f, start, [...zero, ...all]), z = guess && approached(f, guess);
        if (!z || !isNew(upper(f, z), all) || !(size(z) > 1e-9 * radius)) continue;
        all.push(upper(f, z));
        if (size(z) < radius) missing -= weight(all[all.length - 1]);
    }
    return all;
}

// -------------------------------------------------------------------------------------------- proofs

// The radius of a disc about a double that holds one root, and that is simple; Infinity where none is proved.
function enclosed(f, [x, y]) {
    const { x: X, y: Y, r: R } = f.m, v = f.value, d = f.slope;
    f.at(f.lists.slope, x, y, 0.0);
    const error = (modulus(X[v], Y[v]) * UP + R[v]) * UP;
    let radius = 4.0 * error / modulus(X[d], Y[d]) + 1e-15 * modulus(x, y);
    for (let i = 0; i < 3; i++, radius *= 16.0) {
        f.at(f.lists.slope, x, y, radius);
        const least = distance(X[d], Y[d], R[d]), newton = error / least * UP + TINY;
        if (least > 0.0 && newton < radius) return newton;
    }
    return Infinity;
}

// How many roots lie within the polygon that `counted` walks, whose corners have this radius; -1 where that is
// not decided. The upper half of a polygon that is its own mirror image turns half as often.
function counted(f, radius) {
    const { x: X, y: Y, r: R } = f.m, v = f.value, [g] = f.growth;
    f.at(f.lists.divisors, 0.0, 0.0, radius * UP);
    if (!f.divisors.every((k) => distance(X[k], Y[k], R[k]) > 0.0)) return -1;
    const corner = (i, of) => (i === 0 ? [radius, 0.0] : i === of ? [-radius, 0.0]
        : [radius * Math.cos(Math.PI * i / of), radius * Math.sin(Math.PI * i / of)]);
    const pending = [];
    for (let i = PIECES - 1; i >= 0; i--) pending.push([i, PIECES]);
    let turned = 0.0, error = 0.0, work = 0;
    while (pending.length) {
        const [i, of] = pending.pop(), [px, py] = corner(i, of), [qx, qy] = corner(i + 1, of);
        const cx = 0.5 * (px + qx), cy = 0.5 * (py + qy), reach = 0.5 * modulus(qx - px, qy - py) * UP + 1e-15 * radius;
        f.at(f.lists.value, cx, cy, reach);
        const mx = X[v], my = Y[v], mr = R[v];
        let isClear = distance(mx, my, mr) > 0.0;
        if (isClear) {
            f.at(f.lists.value, px, py, 0.0, true);
            const n = 1.0 / modulus(X[v], Y[v]), ux = X[v] * n, uy = Y[v] * n, pr = R[v], pg = Y[g] || 0.0;
            error += R[g] || 0.0;
            f.at(f.lists.value, qx, qy, 0.0, true);
            isClear = distance(mx, my, (mr + Math.max(pr, R[v])) * UP) > 0.0;
            if (isClear) turned += angle(X[v] * ux + Y[v] * uy, Y[v] * ux - X[v] * uy) + ((Y[g] || 0.0) - pg);
            error += 4e-5 + (R[g] || 0.0);
        }
        if (!isClear) {
            if (of > PIECES << DEEPEST || ++work > 1500) return -1;
            pending.push([2 * i + 1, 2 * of], [2 * i, 2 * of]);
        }
    }
    const count = Math.round(turned / Math.PI);
    return error < 0.5 && Math.abs(turned / Math.PI - count) < 0.2 ? count : -1;
}

// ------------------------------------------------------------------------------------------ positions

// Radii between roots in order of size: the widest gaps where about so many lie within, then ever smaller ones.
function radiiOf(roots, modes, fallback) {
    const sizes = roots.map(size), wide = [], small = [];
    for (let k = Math.min(modes + 2, sizes.length + 2); k > 0; k--) {
        const low = sizes[Math.min(k, sizes.length) - 1], more = k - sizes.length + 1;
        const ratio = (more > 0 ? low * (1.0 + 0.06 * more) : sizes[k]) / low;
        if (ratio > 1.012) (k >= modes - 1 ? wide : small).push([ratio, Math.sqrt(ratio) * low]);
    }
    return [...wide.sort((p, q) => q[0] - p[0]), ...small, [0.0, sizes.length ? 0.7 * sizes[0] : fallback]].map(([, r]) => r);
}

const bySize = (roots) => roots.sort((p, q) => size(p) - size(q));

// Roots of one factor at the values it is bound to, all proved that can be.
function settled(f, guesses, modes, fallback) {
    let roots = bySize([...guesses]), reach = Infinity, isComplete = false, why = "";
    const expected = f.degree - f.order;
    if (f.degree) {
        const far = roots.length ? 2.0 * size(roots[roots.length - 1]) : fallback;
        for (let i = 0, r = far; i < 6 && total(roots) < expected; i++, r *= i % 2 ? 0.01 : 1000.0) {
            roots = bySize(sought(f, roots, r, expected - total(roots), []));
        }
        isComplete = total(roots) === expected;
        why = isComplete ? "" : "not all roots were found";
    } else {
        for (let round = 0; round < 4 && !isComplete; round++) {
            let count = -1;
            for (const r of radiiOf(roots, modes, fallback)) {
                count = counted(f, r);
                reach = r;
                if (count >= 0) break;
            }
            const inside = roots.filter((z) => size(z) < reach), missing = count - f.order - total(inside);
            why = count < 0 ? "the number of roots was not decided in doubles" : "more roots are there than were found";
            isComplete = count >= 0 && missing === 0;
            if (isComplete || missing < 0 || count < 0) break;
            roots = bySize(sought(f, roots, reach, missing, guesses));
        }
    }
    const listed = roots.filter((z) => size(z) < reach).map((z) => {
        const radius = enclosed(f, z);
        return { re: z[0], im: z[1], radius, proved: radius < Infinity, multiplicity: f.multiplicity };
    });
    if (!listed.every(isApart)) [isComplete, why] = [false, "some roots are too close to each other"];
    if (f.order) listed.unshift({ re: 0, im: 0, radius: 0, proved: isComplete, multiplicity: f.order * f.multiplicity });
    return { roots: roots.slice(0, f.degree || modes + 4), listed, reach, isComplete, why };

    // Proved, off the edge of the window, and apart from all others, conjugates too.
    function isApart({ re, im, radius, proved }, i) {
        const end = modulus(re, im);
        return proved && (end + radius) * UP < reach * INSIDE && (!im || im > radius * UP) && end > radius * UP
            && listed.every((other, j) => j >= i || apart([re, im], [other.re, other.im]) > (radius + other.radius) * UP);
    }
}

/** What proves the roots of a transfer function, from its tape; or why there is none: {refused}. */
function proverOf(tape) {
    if (tape.refused) return tape;
    const kinds = ["poles", "zeros"], factors = { poles: tape.poles.map(factorOf), zeros: tape.zeros.map(factorOf) };
    const start = tape.start, isLumped = tape.poles.every((part) => part.degree);
    const listed = (values) => tape.parameters.map((name) => values[name]);
    const widest = Math.max(1.0, ...kinds.flatMap((kind) => start[kind].slice(0, tape.modes).map(size)));

    function state(values, guess) {
        const next = { values, parts: {}, certified: {}, reach: {}, why: "" };
        for (const kind of kinds) {
            next.parts[kind] = factors[kind].map((f, i) => settled(f, guess(f, kind, i), tape.modes, widest));
            next[kind] = next.parts[kind].flatMap((part) => part.listed);
            next.certified[kind] = next.parts[kind].every((part) => part.isComplete);
            next.reach[kind] = Math.min(Infinity, ...next.parts[kind].map((part) => part.reach));
            const failed = next.parts[kind].find((part) => !part.isComplete);
            if (failed) next.why = `${kind}: ${failed.why}`;
        }
        next.stability = next.poles.some((z) => z.proved && z.re > z.radius * UP) ? "unstable"
            : isLumped && next.certified.poles && next.poles.every((z) => -z.re > z.radius * UP) ? "stable" : "unknown";
        return next;
    }

    return {
        start,
        window: { re: [-1.1 * widest, 1.1 * widest], im: [0.0, 1.1 * widest] },
        begin(given) {
            const values = listed(given);
            return state(values, (f, kind) => {
                f.bind(values);
                return start[kind].map((z) => approached(f, z)).filter((z, i) => z && apart(z, start[kind][i])
                    < 1e-3 * size(z)).map((z) => upper(f, z)).filter((z, i, all) => isNew(z, all.slice(0, i)));
            });
        },
        moved(before, given) {
            const values = listed(given);
            return state(values, (f, kind, i) => carried(f, before.parts[kind][i].roots, before.values, values));
        },
    };
}
