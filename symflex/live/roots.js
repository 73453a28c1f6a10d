// Poles and zeros under a slider: carried along by Newton steps, then proved at every position.
//
// Input: what symflex/live/tape.py made of a transfer function, and values of its parameters.
// What is proved (interval Newton, the argument principle) is proved on discs, as tape.py says; how roots are
// guessed proves nothing, so there any function serves.

const CODES = { "+": 1, "-": 2, "*": 3, "/": 4, sqrt: 5, exp: 6 };
const SHORTEST = 1.0 / 60.0, STEPS = 40;  // of the way from one position to the next
const PIECES = 16, DEEPEST = 9, INSIDE = 0.995;  // cos(pi/32) > INSIDE: no chord of the window is nearer to 0

// One factor of a numerator or denominator as a function of s, on discs in registers `m`.
function factorOf(part) {
    const { tape } = part, [kinds, a, b] = [0, 1, 2].map((i) => tape.map((row) => row[i]));
    const code = kinds.map((kind) => CODES[kind] || 0), s = kinds.indexOf("s"), moves = [];
    const m = discs(tape.length), branches = discs(tape.length);
    let follows = false;
    tape.forEach(([kind, x, y, r], i) => {
        moves[i] = i === s || (code[i] > 0 && (moves[x] || (code[i] < 4 && moves[y])));
        if (kind === "#") put(m, i, x, y, r);
    });
    const needed = (ends, isMoving) => {
        const used = new Set(ends);
        for (let i = tape.length - 1; i >= 0; i--) {
            if (used.has(i) && code[i]) used.add(a[i]).add(code[i] < 4 ? b[i] : a[i]);
        }
        return Int32Array.from([...used].filter((i) => code[i] && moves[i] === isMoving)).sort();
    };
    const run = (list) => {
        for (const k of list) {
            switch (code[k]) {
            case 1: sum(m, k, a[k], b[k], 1.0); break;
            case 2: sum(m, k, a[k], b[k], -1.0); break;
            case 3: product(m, k, a[k], b[k]); break;
            case 4: inverse(m, k, a[k]); break;
            case 5: root(m, k, a[k]); branch(k); break;
            default: exponent(m, k, a[k]);
            }
        }
    };
    // Members of a disc have roots on the same side as its centre has, on the branch that is continuous there.
    const branch = (k) => {
        if (!follows) put(branches, k, m.x[k], m.y[k], 0.0);
        else if (m.x[k] * branches.x[k] + m.y[k] * branches.y[k] < 0.0) put(m, k, -m.x[k], -m.y[k], m.r[k]);
    };
    const fixed = needed(tape.keys(), false);
    return {
        ...part, m,
        values: needed([part.value, ...part.growth], true),
        slopes: needed([part.value, part.slope], true),
        laws: needed(part.divisors, true),
        // Evaluate what is listed on a disc; at a member of the last disc, if it `follows` that.
        at(list, x, y, r, isMember = false) {
            put(m, s, x, y, r);
            follows = isMember;
            run(list);
        },
        bind(values) {
            follows = false;
            kinds.forEach((kind, i) => kind === "p" && put(m, i, values[a[i]], 0.0, 0.0));
            run(fixed);
        },
    };
}

// ------------------------------------------------------------------------------------------- guesses

const size = ([x, y]) => modulus(x, y), apart = (p, q) => modulus(p[0] - q[0], p[1] - q[1]);
const bySize = (roots) => roots.sort((p, q) => size(p) - size(q));
const weight = (z) => (z[1] ? 2 : 1), total = (roots) => roots.reduce((n, z) => n + weight(z), 0);
const isNew = (z, roots) => roots.every((p) => apart(z, p) > 1e-8 * size(z));

// What Newton subtracts at a point; away from roots that are `known` so often, and from their conjugates.
function newton(f, x, y, known = []) {
    f.at(f.slopes, x, y, 0.0);
    const { x: X, y: Y } = f.m, vx = X[f.value], vy = Y[f.value], dx = X[f.slope], dy = Y[f.slope];
    const n = vx * vx + vy * vy;
    if (!(n > 0.0)) return [0.0, 0.0];
    let u = (dx * vx + dy * vy) / n, w = (dy * vx - dx * vy) / n;
    for (const [p, q, times = 1] of known) {
        for (const h of q ? [y - q, y + q] : [y]) {
            const g = x - p, k = times / (g * g + h * h);
            u -= g * k;
            w += h * k;
        }
    }
    const k = u * u + w * w;
    return [u / k, -w / k];
}

// Where Newton's steps from z settle, null where they do not.
function approached(f, z, known) {
    let [x, y] = z, last = Infinity;
    for (let i = 0; i < 40; i++) {
        const [p, q] = newton(f, x, y, known), noise = f.m.r[f.value] / modulus(f.m.x[f.slope], f.m.y[f.slope]);
        [x, y] = [x - p, y - q];
        const step = modulus(p, q), here = modulus(x, y);
        if (!(here < 30.0 * size(z) && size(z) < 30.0 * here)) return null;
        const isSettled = step < 1e-9 * here && step > 0.5 * last;
        if (isSettled || step <= Math.max(4e-16 * here, 2.0 * noise)) return [x, y];
        last = step;
    }
    return null;
}

// Roots in the upper half-plane or on the real axis, each once, of points that may be null.
function distinct(f, points) {
    const roots = [];
    for (const z of points.filter(Boolean)) {
        const real = Math.abs(z[1]) < 1e-7 * size(z) && approached(f, [z[0], 0.0]);
        const own = real && apart(real, z) < 1e-5 * size(z) ? [real[0], 0.0] : [z[0], Math.abs(z[1])];
        if (isNew(own, roots)) roots.push(own);
    }
    return roots;
}

// Roots at new values from those at old ones: along the logarithms of values guesses follow the tangents, and
// steps are shortened where roots might be mixed up.
function carried(f, roots, from, to) {
    const between = (t) => (t >= 1.0 ? to
        : to.map((v, i) => (from[i] * v > 0.0 ? from[i] * (v / from[i]) ** t : from[i] + t * (v - from[i]))));
    for (let t = 0.0, h = 1.0, work = 0; t < 1.0; work++) {
        const end = work < STEPS ? Math.min(1.0, t + h) : 1.0, e = 1e-5;
        f.bind(between(t + e));
        const guesses = roots.map(([x, y]) => {
            const [p, q] = newton(f, x, y), n = (x * x + y * y) * e / (t - end), turn = (q * x - p * y) / n;
            const grown = Math.exp(Math.max(-20.0, Math.min(20.0, (p * x + q * y) / n)));
            const c = grown * Math.cos(turn), d = grown * Math.sin(turn);
            return [x * c - y * d, x * d + y * c];
        });
        f.bind(between(end));
        const found = guesses.map((z) => approached(f, z));
        const room = (z, i) => Math.min(...guesses.map((g, j) => (
            j === i ? 2.0 * Math.abs(g[1]) || Infinity : apart(g, z))));
        const isSafe = found.every((z, i) => z && apart(z, guesses[i]) < 0.2 * room(guesses[i], i));
        if (isSafe || h < SHORTEST || work >= STEPS) [roots, t, h] = [distinct(f, found), end, 3.0 * h];
        else h /= 3.0;
    }
    return roots;
}

// Roots that are missing between two radii besides, by Newton steps that avoid those that are known.
function sought(f, roots, low, high, missing) {
    const all = [...roots], zero = f.order ? [[0.0, 0.0, f.order]] : [];
    for (let i = 0; i < 40 && missing > 0; i++) {
        const r = low + (high - low) * ((0.5 + i * 0.6180339887) % 1.0);
        const turn = Math.PI * ((i * 0.3774388331) % 0.5), x = r * Math.cos(turn), y = r * Math.sin(turn);
        const starts = [[0.0, r], [r, 0.0], [-r, 0.0], [x, y], [-x, y]];
        for (const start of i ? starts : [...roots.map((z) => [-z[0], z[1]]), ...starts]) {
            const guess = missing > 0 && approached(f, start, [...zero, ...all]);
            const [z] = distinct(f, [guess && approached(f, guess)]);
            if (!z || !isNew(z, all) || size(z) < 1e-9 * high || size(z) > 2.0 * high) continue;
            all.push(z);
            if (size(z) < high) missing -= weight(z);
        }
    }
    return bySize(all);
}

// The same for functions with kernels: counts tell between which two known roots some are missing.
function soughtByCounts(f, roots, reach, missing) {
    const ends = [[0.0, f.order]], inside = roots.filter((z) => size(z) < reach);
    inside.forEach((z, i) => {
        const end = Math.sqrt(size(z) * (i + 1 < inside.length ? size(inside[i + 1]) : reach));
        if (end > 1.01 * size(z)) ends.push([end, f.order + total(inside.slice(0, i + 1))]);
    });
    let low = 0, high = ends.push([reach, f.order + total(inside)]) - 1, most = missing;
    while (high - low > 1) {
        const middle = (low + high) >> 1, more = counted(f, ends[middle][0]) - ends[middle][1];
        if (more > 0) [high, most] = [middle, more];
        else low = middle;
    }
    return sought(f, roots, ends[low][0], ends[high][0], most);
}

// -------------------------------------------------------------------------------------------- proofs

// The radius of a disc about a double that holds one root, and that is simple; Infinity where none is proved.
function enclosed(f, [x, y]) {
    const { x: X, y: Y, r: R } = f.m, { value: v, slope: d } = f;
    f.at(f.slopes, x, y, 0.0);
    const error = (modulus(X[v], Y[v]) * UP + R[v]) * UP;
    let radius = 4.0 * error / modulus(X[d], Y[d]) + 1e-15 * modulus(x, y);
    for (let i = 0; i < 3; i++, radius *= 16.0) {
        f.at(f.slopes, x, y, radius);
        const least = distance(X[d], Y[d], R[d]), step = error / least * UP + TINY;
        if (least > 0.0 && step < radius) return step;
    }
    return Infinity;
}

// How many roots lie within a polygon whose corners are at this radius; -1 where that is not decided.
// Where a disc without 0 holds the values on a chord, and what is computed at both ends, it tells the turn.
function counted(f, radius) {
    const { x: X, y: Y, r: R } = f.m, v = f.value, [g] = f.growth;
    f.at(f.laws, 0.0, 0.0, radius * UP);
    if (!f.divisors.every((k) => distance(X[k], Y[k], R[k]) > 0.0)) return -1;
    const corner = (i, of) => (i % of === 0 ? [i ? -radius : radius, 0.0]
        : [radius * Math.cos(Math.PI * i / of), radius * Math.sin(Math.PI * i / of)]);
    const pending = Array.from({ length: PIECES }, (_, i) => [i, PIECES]);
    let turned = 0.0, error = 0.0;
    for (let work = 0; pending.length; work++) {
        const [i, of] = pending.pop(), [px, py] = corner(i, of), [qx, qy] = corner(i + 1, of);
        const half = 0.5 * modulus(qx - px, qy - py) * UP + 1e-15 * radius;
        f.at(f.values, 0.5 * (px + qx), 0.5 * (py + qy), half);
        const x = X[v], y = Y[v], r = R[v];
        let isClear = distance(x, y, r) > 0.0;
        if (isClear) {
            f.at(f.values, px, py, 0.0, true);
            const n = modulus(X[v], Y[v]), ux = X[v] / n, uy = Y[v] / n, ur = R[v], grown = Y[g], unsure = R[g];
            f.at(f.values, qx, qy, 0.0, true);
            isClear = distance(x, y, (r + Math.max(ur, R[v])) * UP) > 0.0;
            if (isClear) turned += angle(X[v] * ux + Y[v] * uy, Y[v] * ux - X[v] * uy) + (Y[g] - grown);
            if (isClear) error += 4e-5 + unsure + R[g];
        }
        if (!isClear && (of > PIECES << DEEPEST || work > 2000)) return -1;
        if (!isClear) pending.push([2 * i, 2 * of], [2 * i + 1, 2 * of]);
    }
    const count = Math.round(turned / Math.PI);
    return error < 0.5 && Math.abs(turned / Math.PI - count) < 0.2 ? count : -1;
}

// ------------------------------------------------------------------------------------------ positions

// Radii between roots in order of size: the widest gaps where about so many lie within, then ever smaller ones.
function radiiOf(roots, modes, nominal) {
    const sizes = roots.map(size), wide = [], small = [];
    for (let k = Math.min(modes, sizes.length) + 2; k > 0 && sizes.length; k--) {
        const low = sizes[Math.min(k, sizes.length) - 1], more = k - sizes.length + 1;
        const ratio = more > 0 ? 1.0 + 0.06 * more : sizes[k] / low;
        if (ratio > 1.012) (k >= modes - 1 ? wide : small).push([ratio, Math.sqrt(ratio) * low]);
    }
    const least = sizes.length ? 0.7 * sizes[0] : nominal;
    return [...wide.sort((p, q) => q[0] - p[0]), ...small, [1.0, least]].map(([, radius]) => radius);
}

// Roots of one factor at the values it is bound to, from guesses in order of size, all proved that can be.
function settled(f, roots, modes, nominal) {
    let reach = Infinity, missing = f.degree ? f.degree - f.order - total(roots) : 1, why = "";
    const end = roots.length ? 2.0 * size(roots[roots.length - 1]) : nominal;
    if (f.degree) {
        for (const scale of [1.0, 1e3, 1e-2, 1e6, 1e-4, 1e9]) {
            if (missing > 0) roots = sought(f, roots, 0.0, scale * end, missing);
            missing = f.degree - f.order - total(roots);
        }
    } else {
        for (let round = 0, count = -1; round < 8 && missing > 0; round++) {
            for (reach of radiiOf(roots, modes, nominal)) if ((count = counted(f, reach)) >= 0) break;
            const known = f.order + total(roots.filter((z) => size(z) < reach));
            missing = count < 0 ? -1 : count - known;
            if (missing > 0) roots = soughtByCounts(f, roots, reach, missing);
            if (count < 0) why = "the number of roots within the window was not decided in doubles";
        }
        roots = roots.filter((z) => size(z) < 2.0 * reach).slice(0, modes + 4);
    }
    if (missing) why = why || "there are more roots than were found";
    const listed = roots.filter((z) => size(z) < reach).map((z) => {
        const radius = enclosed(f, z);
        return { re: z[0], im: z[1], radius, proved: radius < Infinity, multiplicity: f.multiplicity };
    });
    // Proved, within the edge of the window, and apart from all others, conjugates too.
    const isApart = ({ re, im, radius, proved }, i) => proved && (modulus(re, im) + radius) * UP < reach * INSIDE
        && (!im || im > radius * UP) && modulus(re, im) > radius * UP && listed.slice(0, i).every((other) =>
            apart([re, im], [other.re, other.im]) * DOWN > (radius + other.radius) * UP);
    if (!missing && !listed.every(isApart)) why = "roots are too close to each other, or to the edge, for doubles";
    if (f.order) listed.unshift({ re: 0, im: 0, radius: 0, proved: !why, multiplicity: f.order * f.multiplicity });
    return { roots, listed, reach, isComplete: !why, why };
}

/** What certifies the roots of a transfer function, from its tape; or why there is none: {refused}. */
function proverOf(tape) {
    if (tape.refused) return tape;
    const kinds = ["poles", "zeros"], { start, modes } = tape, isLumped = tape.poles.every((part) => part.degree);
    const factors = { poles: tape.poles.map(factorOf), zeros: tape.zeros.map(factorOf) };
    const nominal = Math.max(1e-9, ...kinds.flatMap((kind) => start[kind].slice(0, modes).map(size)));
    const listed = (values) => tape.parameters.map((name) => values[name]);
    let first = null;

    function state(values, guess) {
        const next = { values, parts: {}, certified: {}, reach: {}, why: "" };
        for (const kind of kinds) {
            const parts = next.parts[kind] = factors[kind].map((f, i) => {
                const part = settled(f, bySize(guess(f, kind, i)), modes, nominal);
                if (part.isComplete || !first) return part;
                const again = carried(f, first.parts[kind][i].roots, first.values, values);
                const other = settled(f, bySize(again), modes, nominal);
                return other.isComplete ? other : part;
            });
            next[kind] = parts.flatMap((part) => part.listed);
            next.certified[kind] = parts.every((part) => part.isComplete);
            next.reach[kind] = Math.min(...parts.map((part) => part.reach));
            next.why = next.why || parts.filter((part) => part.why).map((part) => `${kind}: ${part.why}`)[0] || "";
        }
        // Where a numerator and a denominator may vanish together, there is perhaps neither a pole nor a zero.
        for (const [p, z] of next.poles.flatMap((one) => next.zeros.map((other) => [one, other]))) {
            const gap = apart([p.re, p.im], [z.re, z.im]) * DOWN;
            if (!p.proved || !z.proved || gap > (p.radius + z.radius) * UP) continue;
            p.proved = z.proved = next.certified.poles = next.certified.zeros = false;
            next.why = "a pole and a zero are so close that they may cancel";
        }
        const isLeft = isLumped && next.certified.poles && next.poles.every((z) => -z.re > z.radius * UP);
        const isRight = next.poles.some((z) => z.proved && z.re > z.radius * UP);
        const isPassive = tape.passive && values.every((v) => v > 0.0);  // then no pole is in the right half-plane
        return { ...next, isPassive, stability: isRight ? "unstable" : isLeft ? "stable" : "unknown" };
    }

    return {
        begin(given) {
            const values = listed(given);
            first = state(values, (f, kind) => {
                f.bind(values);
                const near = (z, i) => z && apart(z, start[kind][i]) < 1e-3 * size(z);
                return distinct(f, start[kind].map((z) => approached(f, z)).filter(near));
            });
            return first;
        },
        moved(before, given) {
            const values = listed(given);
            return state(values, (f, kind, i) => carried(f, before.parts[kind][i].roots, before.values, values));
        },
    };
}
