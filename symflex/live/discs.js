// Arithmetic of discs in the complex plane, in doubles: a disc {s : |s - (x + j y)| <= r} is three numbers in
// registers of `m`, and the disc computed from others holds every value that members of these can have.
//
// Basic operations and Math.sqrt err by at most u = 2^-53, relatively (ECMA-262, IEEE 754); nothing else is
// assumed. A radius is a sum of products of numbers that are not negative, computed with fewer than 14
// roundings: times UP it is not too small, and TINY covers what underflows.

const UP = 1.0 + 1.8e-15, DOWN = 1.0 - 9e-16, U4 = 4.5e-16, TINY = 1e-301;

const discs = (n) => ({ x: new Float64Array(n), y: new Float64Array(n), r: new Float64Array(n) });

// |x + j y|, too small by less than 2^-51 of it; where squares underflow, too large.
function modulus(x, y) {
    const n = x * x + y * y;
    return n > 1e-280 ? Math.sqrt(n) : Math.abs(x) + Math.abs(y);
}

// A lower bound of |x + j y| - r; negative where there is none.
function distance(x, y, r) {
    const n = x * x + y * y;
    return n > 1e-280 && n < 1e300 ? (Math.sqrt(n) * DOWN - r) * DOWN : -1.0;
}

function put(m, k, x, y, r) {
    [m.x[k], m.y[k], m.r[k]] = [x, y, r];
}

function sum(m, k, a, b, sign) {
    const x = m.x[a] + sign * m.x[b], y = m.y[a] + sign * m.y[b];
    put(m, k, x, y, (m.r[a] + m.r[b] + U4 * (Math.abs(x) + Math.abs(y))) * UP + TINY);
}

// The centre of a product errs by less than 4 u |a| |b|.
function product(m, k, a, b) {
    const ax = m.x[a], ay = m.y[a], bx = m.x[b], by = m.y[b], ra = m.r[a], rb = m.r[b];
    const p = modulus(ax, ay), q = modulus(bx, by);
    put(m, k, ax * bx - ay * by, ax * by + ay * bx, (p * rb + q * ra + ra * rb + U4 * p * q) * UP + TINY);
}

// |1/(a + d) - 1/a| <= r/(|a| (|a| - r)) for |d| <= r.
function inverse(m, k, a) {
    const x = m.x[a], y = m.y[a], r = m.r[a], n = x * x + y * y, gap = distance(x, y, r);
    if (!(gap > 0.0)) return put(m, k, NaN, NaN, Infinity);
    const least = Math.sqrt(n) * DOWN;
    put(m, k, x / n, -y / n, (r / (least * gap) + 2.0 * U4 / least) * UP + TINY);
}

// The branch that continues the principal root at the centre: sqrt(1 + t) - 1 has a series whose coefficients
// are in size those of 1 - sqrt(1 - t), so that bounds it for |t| < 1.
function root(m, k, a) {
    const x = m.x[a], y = m.y[a], r = m.r[a];
    if (x === 0.0 && y === 0.0 && r === 0.0) return put(m, k, 0.0, 0.0, 0.0);
    const size = modulus(x, y), gap = distance(x, y, r);
    if (!(gap > 0.0)) return put(m, k, NaN, NaN, Infinity);
    const t = Math.sqrt(0.5 * (Math.abs(x) + size)), half = 0.5 * y / t, least = size * DOWN;
    const q = r / least * UP, w = Math.sqrt(size) * UP;
    const spread = q / (1.0 + Math.sqrt(Math.max(0.0, 1.0 - q)));
    const radius = (w * spread + 2.0 * U4 * w) * UP + TINY;
    if (x >= 0.0) return put(m, k, t, half, radius);
    put(m, k, Math.abs(half), y < 0.0 ? -t : t, radius);
}

const LOG2E = 1.4426950408889634, LN2_HIGH = 6.93147180369123816490e-01, LN2_LOW = 1.90821492927058770002e-10;
const POWERS = new Float64Array(2048), INVERSE = new Float64Array(20);
POWERS[1022] = 1.0;
for (let i = 1023; i < 2046; i++) POWERS[i] = 2.0 * POWERS[i - 1];
for (let i = 1021; i >= 0; i--) POWERS[i] = 0.5 * POWERS[i + 1];
for (let i = 1; i < 20; i++) INVERSE[i] = 1.0 / i;

// exp(x) for |x| <= 700 with a relative error below 2^-50; 0 below, where it is less than TINY.
// x = k ln 2 + r: LN2_HIGH ends with 20 zero bits, so k LN2_HIGH is exact for these k; two differences round
// by 0.36 u each, and |r| < 0.35. Taylor's remainder r^14/14! is below u/20. Horner's steps are 1 + r (.)/n:
// the last adds u exp(r) and 2 u |r (.)|, those before it less than |r|/2 of as much: below 4 u in all, and 6 u
// of exp(r).
function exponential(x) {
    if (x < -700.0) return 0.0;
    if (!(x <= 700.0)) return Infinity;
    const k = Math.floor(x * LOG2E + 0.5), r = x - k * LN2_HIGH - k * LN2_LOW;
    let e = 1.0;
    for (let n = 13; n > 0; n--) e = 1.0 + r * e * INVERSE[n];
    return e * POWERS[k + 1022];
}

const TURN = 0.6366197723675814, QUARTER = [1.57079632673412561417, 6.07710050630396597660e-11,
    2.02226624871116645580e-21];
const SINES = new Float64Array(10), COSINES = new Float64Array(10);
for (let n = 1; n < 10; n++) {
    SINES[n] = -1.0 / (2 * n * (2 * n + 1));
    COSINES[n] = -1.0 / (2 * n * (2 * n - 1));
}
let sine = 0.0;

// cos(x), and sin(x) in `sine`, for |x| <= 10^6 with errors below 2^-50; else NaN.
// x = k pi/2 + r: each of three parts of pi/2 has 33 bits, so their products with k are exact; three
// differences round by 0.8 u each, what the parts leave is below 10^-31 k, and |r| < 0.8. Taylor's remainders
// r^20/20! and r^21/21! are below u/100. The last steps round cos by u and by 3 u r^2/2, sin by u |r| and by
// 4 u |r|^3/6; those before them by less than a tenth of that: below 5 u in all.
function cosine(x) {
    if (!(Math.abs(x) <= 1e6)) {
        sine = NaN;
        return NaN;
    }
    const k = Math.floor(x * TURN + 0.5), r = x - k * QUARTER[0] - k * QUARTER[1] - k * QUARTER[2], z = r * r;
    let c = 1.0, s = 1.0;
    for (let n = 9; n > 0; n--) {
        c = 1.0 + z * c * COSINES[n];
        s = 1.0 + z * s * SINES[n];
    }
    s *= r;
    const turns = k & 3;
    sine = turns === 0 ? s : turns === 1 ? c : turns === 2 ? -s : -c;
    return turns === 0 ? c : turns === 1 ? -s : turns === 2 ? -c : s;
}

// exp(r) - 1 <= r + (e - 2) r^2 for r <= 1. exp, cos and sin of the centre err by 2^-50 of exp(x) each.
function exponent(m, k, a) {
    const size = exponential(m.x[a]), c = cosine(m.y[a]), s = sine, r = m.r[a];
    if (m.x[a] < -700.0) return put(m, k, 0.0, 0.0, exponential(m.x[a] + r) * UP + TINY);
    const over = r <= 1.0 ? r + 0.7182818284590453 * r * r : exponential(r) * UP;
    const radius = size * (over + 7.2e-15) * UP + TINY;
    put(m, k, size * c, size * s, radius === radius && c === c ? radius : Infinity);
}

// The angle of x + j y, within 3e-5: a sixteenth of it has a tangent t below 0.2, and t^7/7 is left out.
function angle(x, y) {
    const n = Math.sqrt(x * x + y * y);
    let c = x / n, s = y / n;
    for (let i = 0; i < 4; i++) {
        const d = Math.sqrt(0.5 + 0.5 * Math.abs(c));
        [c, s] = c >= 0.0 ? [d, 0.5 * s / d] : [0.5 * Math.abs(s) / d, s < 0.0 ? -d : d];
    }
    const t = s / c;
    return 16.0 * (t - t * t * t * (1.0 / 3.0 - t * t / 5.0));
}
