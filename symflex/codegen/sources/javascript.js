// What generated JavaScript calls: parts, each under a line that says what it defines.
// A function of a complex number takes two arguments and returns the real part; the imaginary part is left in
// `imaginary`, because a pair for every value would have to be collected again.

//: imaginary
let imaginary = 0.0;

//: quotient
// Smith's method: squares of numbers that can be represented could not be.
function quotient(a, b, c, d) {
    if (Math.abs(c) >= Math.abs(d)) {
        const r = c === 0.0 ? 0.0 : d / c, n = c + d * r;
        imaginary = (b - a * r) / n;
        return (a + b * r) / n;
    }
    const r = c / d, n = d + c * r;
    imaginary = (b * r - a) / n;
    return (a * r + b) / n;
}

//: size
function size(a, b) {
    const m = Math.max(Math.abs(a), Math.abs(b));
    return m < 1e150 && m > 1e-150 ? Math.sqrt(a * a + b * b) : Math.hypot(a, b);
}

//: root
// The square root whose real part is not negative.
function root(a, b) {
    const t = Math.sqrt(0.5 * Math.abs(a) + 0.5 * size(a, b));
    if (t === 0.0) {
        imaginary = b;
        return 0.0;
    }
    if (a >= 0.0) {
        imaginary = 0.5 * b / t;
        return t;
    }
    imaginary = b < 0.0 || Object.is(b, -0.0) ? -t : t;
    return 0.5 * Math.abs(b) / t;
}

//: solutions
// Solutions at 1 of y^(n) + c[n-1] y^(n-1) + ... + c[0] y = 0 by Taylor series, and their derivatives in s
// where those of the coefficients are given; solution k starts from y^(k)(0) = 1 and zeros. Complex numbers
// are pairs in one array: [re, im, re, im, ...].
function solutions(c, terms, dc = null) {
    const n = c.length / 2, found = new Float64Array(2 * n), slopes = new Float64Array(2 * n);
    let first = 1.0;
    for (let k = 0; k < n; k++) {
        const y = new Float64Array(2 * n), dy = new Float64Array(2 * n);
        y[2 * k] = 1.0;
        first *= Math.max(k, 1);
        let total = 1.0 / first, turn = 0.0, rise = 0.0, twist = 0.0, factorial = 1.0;
        for (let m = 1; m < terms; m++) {
            factorial *= m;
            if (m < n) continue;
            let a = 0.0, b = 0.0, da = 0.0, db = 0.0;
            for (let i = 0; i < n; i++) {
                const u = c[2 * i], v = c[2 * i + 1], at = 2 * ((m + i) % n), p = y[at], q = y[at + 1];
                a -= u * p - v * q;
                b -= u * q + v * p;
                if (dc === null) continue;
                const du = dc[2 * i], dv = dc[2 * i + 1];
                da -= du * p - dv * q + u * dy[at] - v * dy[at + 1];
                db -= du * q + dv * p + u * dy[at + 1] + v * dy[at];
            }
            const at = 2 * (m % n);
            y[at] = a;
            y[at + 1] = b;
            dy[at] = da;
            dy[at + 1] = db;
            total += a / factorial;
            turn += b / factorial;
            rise += da / factorial;
            twist += db / factorial;
        }
        found[2 * k] = total;
        found[2 * k + 1] = turn;
        slopes[2 * k] = rise;
        slopes[2 * k + 1] = twist;
    }
    return dc === null ? found : slopes;
}

//: circle
// The mean over a circle around s of what `parts` writes, because the formula itself is singular near s though
// numerator and denominator are not. `parts` leaves numerator, denominator, the logarithm of what both were
// divided by, and the radius; each is followed by its derivative where `step` is two.
function circle(parts, x, y, points, step) {
    const value = new Float64Array(8 * step), mean = new Float64Array(4 * step);
    parts(x, y, value);
    const a = value[4 * step], b = value[4 * step + 1], radius = value[6 * step];
    for (let k = 0; k < points; k++) {
        const angle = 6.283185307179586 * (k + 0.5) / points;
        parts(x + radius * Math.cos(angle), y + radius * Math.sin(angle), value);
        const p = value[4 * step] - a, q = value[4 * step + 1] - b, e = Math.exp(p) / points;
        const c = e * Math.cos(q), d = e * Math.sin(q);
        for (let i = 0; i < 4 * step; i += 2) {
            let u = value[i], v = value[i + 1];
            if (i % 4 === 2 && step === 2) {
                const g = value[10], h = value[11];
                u += value[i - 2] * g - value[i - 1] * h;
                v += value[i - 2] * h + value[i - 1] * g;
            }
            mean[i] += u * c - v * d;
            mean[i + 1] += u * d + v * c;
        }
    }
    return mean;
}

//: over
function over(mean) {
    return quotient(mean[0], mean[1], mean[2], mean[3]);
}

//: given
// The values of parameters: those that are given, and the model's for the others.
function given(values) {
    for (const name of Object.keys(values)) {
        if (!Object.hasOwn(PARAMETERS, name)) throw new RangeError(`there is no parameter ${name}`);
    }
    const all = {};
    for (const [name, { value }] of Object.entries(PARAMETERS)) {
        all[name] = Object.hasOwn(values, name) ? values[name] : value;
    }
    return all;
}

//: checked
function checked(values, used) {
    for (const name of used) {
        if (typeof values[name] !== "number") throw new TypeError(`${name} needs a number as its value`);
    }
    return values;
}

//: evaluated
// Values at s: a real number, [re, im], or two arrays of doubles.
function evaluated(at, s) {
    const [x, y] = typeof s === "number" ? [s, 0.0] : s;
    if (typeof x === "number") {
        const re = at(x, y);
        return [re, imaginary];
    }
    const re = new Float64Array(x.length), im = new Float64Array(x.length);
    for (let i = 0; i < x.length; i++) {
        re[i] = at(x[i], y[i]);
        im[i] = imaginary;
    }
    return [re, im];
}

//: entries
// Rows of the values of a matrix at s, all of which one function writes.
function entries(s, values, of, used, rows, columns) {
    const at = of(checked(given(values), used)), count = rows * columns, into = new Float64Array(2 * count);
    const [x, y] = typeof s === "number" ? [s, 0.0] : s, isOne = typeof x === "number";
    const size = isOne ? 1 : x.length, all = Array.from(into, () => new Float64Array(size));
    for (let i = 0; i < size; i++) {
        if (isOne) at(x, y, into);
        else at(x[i], y[i], into);
        for (let k = 0; k < 2 * count; k++) all[k][i] = into[k];
    }
    const pair = (k) => (isOne ? [all[2 * k][0], all[2 * k + 1][0]] : [all[2 * k], all[2 * k + 1]]);
    return Array.from({ length: rows }, (_, i) =>
        Array.from({ length: columns }, (_, j) => pair(i * columns + j)));
}

//: offered
// A function of s and of parameters, with those of its numerator and denominator.
function offered(value, parts, used) {
    const of = (s, values = {}) => evaluated(value(checked(given(values), used)), s);
    ["numerator", "numeratorDerivative", "denominator", "denominatorDerivative"].forEach((name, i) => {
        of[name] = (s, values = {}) => {
            const into = new Float64Array(8), at = parts(checked(given(values), used));
            return evaluated((x, y) => {
                at(x, y, into);
                imaginary = into[2 * i + 1];
                return into[2 * i];
            }, s);
        };
    });
    return Object.freeze(of);
}
