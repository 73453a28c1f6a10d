// What generated C code calls: parts, each under a line that says what it defines.

//: cx
typedef struct { double re, im; } cx;

//: cx_of
static inline cx cx_of(double re, double im)
{
    cx z;
    z.re = re;
    z.im = im;
    return z;
}

//: cx_neg
static inline cx cx_neg(cx z)
{
    return cx_of(-z.re, -z.im);
}

//: cx_add
static inline cx cx_add(cx z, cx w)
{
    return cx_of(z.re + w.re, z.im + w.im);
}

//: cx_addr
static inline cx cx_addr(cx z, double a)    /* z + a */
{
    return cx_of(z.re + a, z.im);
}

//: cx_addi
static inline cx cx_addi(cx z, double a)    /* z + j a */
{
    return cx_of(z.re, z.im + a);
}

//: cx_sub
static inline cx cx_sub(cx z, cx w)
{
    return cx_of(z.re - w.re, z.im - w.im);
}

//: cx_rsub
static inline cx cx_rsub(double a, cx z)    /* a - z */
{
    return cx_of(a - z.re, -z.im);
}

//: cx_isub
static inline cx cx_isub(double a, cx z)    /* j a - z */
{
    return cx_of(-z.re, a - z.im);
}

//: cx_scale
static inline cx cx_scale(double a, cx z)    /* a z */
{
    return cx_of(a * z.re, a * z.im);
}

//: cx_turn
static inline cx cx_turn(double a, cx z)    /* j a z */
{
    return cx_of(-(a * z.im), a * z.re);
}

//: cx_mul
static inline cx cx_mul(cx z, cx w)
{
    return cx_of(z.re * w.re - z.im * w.im, z.re * w.im + z.im * w.re);
}

//: cx_over
static inline cx cx_over(cx z, double a)    /* z/a */
{
    return cx_of(z.re / a, z.im / a);
}

//: cx_under
static inline cx cx_under(cx z, double a)    /* z/(j a) */
{
    return cx_of(z.im / a, -z.re / a);
}

//: cx_div
/* Smith's method: squares of numbers that can be represented could not be. */
static inline cx cx_div(cx z, cx w)
{
    double r, d;
    if (fabs(w.re) >= fabs(w.im)) {
        r = w.re == 0.0 ? 0.0 : w.im / w.re;
        d = w.re + w.im * r;
        return cx_of((z.re + z.im * r) / d, (z.im - z.re * r) / d);
    }
    r = w.re / w.im;
    d = w.im + w.re * r;
    return cx_of((z.re * r + z.im) / d, (z.im * r - z.re) / d);
}

//: lane_div
/* As accurate as Smith's method, and without branches. */
static inline cx lane_div(cx z, cx w)
{
    const double r = 1.0 / (fabs(w.re) + fabs(w.im));
    const double a = w.re * r, b = w.im * r;
    const double q = r / (a * a + b * b);
    return cx_of((z.re * a + z.im * b) * q, (z.im * a - z.re * b) * q);
}

//: cx_abs
static inline double cx_abs(cx z)
{
    return hypot(z.re, z.im);
}

//: cx_sqrt
/* The root whose real part is not negative. */
static inline cx cx_sqrt(cx z)
{
    const double t = sqrt(0.5 * fabs(z.re) + 0.5 * hypot(z.re, z.im));
    if (t == 0.0) {
        return cx_of(0.0, z.im);
    }
    if (z.re >= 0.0) {
        return cx_of(t, 0.5 * z.im / t);
    }
    return cx_of(0.5 * fabs(z.im) / t, copysign(t, z.im));
}

//: cx_cis
static inline cx cx_cis(double a)    /* exp(j a) */
{
    return cx_of(cos(a), sin(a));
}

//: cx_exp
static inline cx cx_exp(cx z)
{
    return cx_scale(exp(z.re), cx_cis(z.im));
}

//: cx_series
/* Solutions y[0], ..., y[n - 1] at 1 of the differential equation
 * y^(n) + c[n - 1] y^(n - 1) + ... + c[0] y = 0 by Taylor series; solution k starts
 * from y^(k)(0) = 1 and zeros for the other derivatives below n.
 */
static void cx_series(const cx *c, int n, int terms, cx *y)
{
    cx d[CX_ORDER];    /* the last n derivatives at 0, the oldest of them at d[m % n] */
    double first = 1.0;
    for (int k = 0; k < n; k++) {
        double factorial = 1.0;
        for (int i = 0; i < n; i++) {
            d[i] = cx_of(i == k ? 1.0 : 0.0, 0.0);
        }
        first *= k > 1 ? k : 1;
        y[k] = cx_of(1.0 / first, 0.0);
        for (int m = 1; m < terms; m++) {
            cx next = cx_of(0.0, 0.0);
            factorial *= m;
            if (m < n) {
                continue;
            }
            for (int i = 0; i < n; i++) {
                if (c[i].re != 0.0 || c[i].im != 0.0) {
                    next = cx_sub(next, cx_mul(c[i], d[(m + i) % n]));
                }
            }
            d[m % n] = next;
            y[k] = cx_add(y[k], cx_over(next, factorial));
        }
    }
}

//: cx_size
/* About the size of the largest root of x^n + c[n - 1] x^(n - 1) + ... + c[0]. */
static double cx_size(const cx *c, int n)
{
    double size = 1e-30;
    for (int i = 0; i < n; i++) {
        const double own = pow(cx_abs(c[i]), 1.0 / (n - i));
        if (!(own < HUGE_VAL)) {
            return NAN;
        }
        size = fmax(size, own);
    }
    return size;
}

//: cx_matrix
/* The product of two matrices of n rows, plus that of a number and the unit matrix. */
static void cx_matrix(const cx *a, const cx *b, int n, double scale, double plus, cx *y)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            cx sum = cx_of(0.0, 0.0);
            for (int k = 0; k < n; k++) {
                sum = cx_add(sum, cx_mul(a[n * i + k], b[n * k + j]));
            }
            y[n * i + j] = cx_addr(cx_over(sum, scale), i == j ? plus : 0.0);
        }
    }
}

//: cx_propagated
/* y = h, h', ..., h^(n - 1) at 1 for coefficients of any size; h solves
 * h^(n) + c[n - 1] h^(n - 1) + ... + c[0] h = 0 and starts from h^(n - 1)(0) = 1 and zeros.
 * The exponential of the companion matrix, by scaling and squaring.
 */
static void cx_propagated(const cx *c, int n, cx *y)
{
    cx small[CX_ORDER * CX_ORDER], grown[CX_ORDER * CX_ORDER], next[CX_ORDER * CX_ORDER];
    const double size = cx_size(c, n);
    const double above_one = size > 1.0 && size < HUGE_VAL ? size : 1.0;
    const int halvings = (int)ceil(log2(above_one)) + 3;
    const double share = ldexp(1.0, -halvings);
    for (int i = 0; i < n * n; i++) {
        small[i] = cx_of(i % n == i / n + 1 ? size * share : 0.0, 0.0);
        grown[i] = cx_of(i % n == i / n ? 1.0 : 0.0, 0.0);
    }
    for (int i = 0; i < n; i++) {
        small[n * (n - 1) + i] = cx_scale(-share / pow(size, n - 1 - i), c[i]);
    }
    for (int m = 18; m > 0; m--) {
        cx_matrix(small, grown, n, m, 1.0, next);
        memcpy(grown, next, sizeof grown);
    }
    for (int k = 0; k < halvings; k++) {
        cx_matrix(grown, grown, n, 1.0, 0.0, next);
        memcpy(grown, next, sizeof grown);
    }
    for (int k = 0; k < n; k++) {
        y[k] = cx_scale(pow(size, k - n + 1), grown[n * k + n - 1]);
    }
}

//: cx_step
/* How far x[i] is off a root, by the method of Aberth and Ehrlich; zero if that is unknown. */
static cx cx_step(const cx *c, int n, const cx *x, int i)
{
    cx value = cx_of(1.0, 0.0), slope = cx_of(0.0, 0.0), away = slope;
    for (int k = n - 1; k >= 0; k--) {
        slope = cx_add(cx_mul(slope, x[i]), value);
        value = cx_add(cx_mul(value, x[i]), c[k]);
    }
    for (int k = 0; k < n; k++) {
        if (x[k].re != x[i].re || x[k].im != x[i].im) {
            away = cx_add(away, cx_div(cx_of(1.0, 0.0), cx_sub(x[i], x[k])));
        }
    }
    const cx step = cx_div(value, cx_sub(slope, cx_mul(value, away)));
    return cx_abs(step) < HUGE_VAL ? step : cx_of(0.0, 0.0);
}

//: cx_roots
/* Roots x[0], ..., x[n - 1] of x^n + c[n - 1] x^(n - 1) + ... + c[0], and in x[n] the least
 * distance of two. Steps of Aberth and Ehrlich from where the sizes of the coefficients say
 * that roots are (Bini 1996).
 */
static void cx_roots(const cx *c, int n, cx *x)
{
    cx scaled[CX_ORDER], step[CX_ORDER];
    double height[CX_ORDER + 1], least = HUGE_VAL;
    const double size = cx_size(c, n);
    int moves = 1;
    if (n == 1) {
        x[0] = cx_neg(c[0]);
        x[1] = cx_of(least, 0.0);
        return;
    }
    height[n] = 0.0;
    for (int i = 0; i < n; i++) {
        scaled[i] = cx_over(c[i], pow(size, n - i));
        height[i] = log(cx_abs(scaled[i]) + 1e-300);
    }
    for (int j = 1; j <= n; j++) {
        /* The slope of the least concave curve above the points (i, height[i]). */
        double slope = HUGE_VAL;
        for (int a = 0; a < j; a++) {
            double most = -HUGE_VAL;
            for (int b = j; b <= n; b++) {
                most = fmax(most, (height[b] - height[a]) / (b - a));
            }
            slope = fmin(slope, most);
        }
        /* By the golden angle points of a circle lie apart however many they are. */
        x[j - 1] = cx_scale(exp(-slope) + 1e-30, cx_cis(2.399963229728653 * j + 0.7));
    }
    for (int count = 0; count < 60 && moves; count++) {
        moves = 0;
        for (int i = 0; i < n; i++) {
            step[i] = cx_step(scaled, n, x, i);
            moves |= cx_abs(step[i]) > 1e-9 * cx_abs(x[i]);
        }
        for (int i = 0; i < n; i++) {
            const double length = cx_abs(step[i]);
            x[i] = cx_sub(x[i], length > 1.0 ? cx_over(step[i], length) : step[i]);
        }
    }
    for (int i = 0; i < n; i++) {
        step[i] = cx_step(scaled, n, x, i);
    }
    for (int i = 0; i < n; i++) {
        x[i] = cx_scale(size, cx_abs(step[i]) < 0.01 ? cx_sub(x[i], step[i]) : x[i]);
        for (int k = 0; k < i; k++) {
            least = fmin(least, cx_abs(cx_sub(x[i], x[k])));
        }
    }
    x[n] = cx_of(least, 0.0);
}

//: cx_modes cx_mode
/* Exponents of n roots at a length, and per root x^k/chi'(x) for k = 0, ..., n - 1. */
typedef struct { cx exponent[CX_ORDER], power[CX_ORDER][CX_ORDER]; } cx_mode;

static void cx_modes(const cx *x, int n, cx length, cx_mode *mode)
{
    for (int i = 0; i < n; i++) {
        cx slope = cx_of(1.0, 0.0);
        for (int k = 0; k < n; k++) {
            slope = k == i ? slope : cx_mul(slope, cx_sub(x[i], x[k]));
        }
        mode->exponent[i] = cx_mul(x[i], length);
        mode->power[i][0] = cx_div(cx_of(1.0, 0.0), slope);
        for (int k = 1; k < n; k++) {
            mode->power[i][k] = cx_mul(mode->power[i][k - 1], x[i]);
        }
    }
}

//: cx_exponent
/* The sum of the exponents of some roots, one of each mode. */
static cx cx_exponent(const cx_mode *const *modes, const int *slots, int count, const int *roots)
{
    cx sum = cx_of(0.0, 0.0);
    for (int i = 0; i < count; i++) {
        sum = cx_add(sum, modes[slots[i]]->exponent[roots[i]]);
    }
    return sum;
}

//: cx_modal
/* A sum of exponentials over the largest one, and the logarithm of that. The plan has for
 * every frame: the number of slots and their modes; per slot the number of terms, with the
 * order of the derivative of each and the sum that it becomes part of; the number of
 * coefficients, which are the first sums, and their places; the number of products of
 * exponentials, with the root that every slot takes and a divisor each.
 */
static void cx_modal(const cx_mode *const *modes, const cx *c, const int *plan, cx *sums,
                     cx *value)
{
    double growth = -HUGE_VAL;
    for (int turn = 0; turn < 2; turn++) {
        const int *at = plan + 1;
        value[0] = cx_of(0.0, 0.0);
        for (int frame = 0; frame < plan[0]; frame++) {
            const int slots = *at++;
            const int *const mode = at, *const steps = at + slots;
            at = steps;
            for (int slot = 0; slot < slots; slot++) {
                at += 2 + 2 * at[0];
            }
            const int first = *at++;
            for (int k = 0; k < first; k++) {
                sums[k] = c[*at++];
            }
            const int keys = *at++;
            for (int key = 0; key < keys; key++, at += slots + 1) {
                const cx exponent = cx_exponent(modes, mode, slots, at);
                const int *step = steps;
                cx *own = sums;
                int is_known = key > 0;
                if (turn == 0) {
                    growth = exponent.re > growth ? exponent.re : growth;
                    continue;
                }
                for (int slot = 0; slot < slots; slot++) {
                    const int terms = step[0], found = step[1];
                    cx *const next = own + terms;
                    is_known = is_known && at[slot] == at[slot - slots - 1];
                    for (int k = 0; k < found && !is_known; k++) {
                        next[k] = cx_of(0.0, 0.0);
                    }
                    for (int k = 0; k < terms && !is_known; k++) {
                        const cx power = modes[mode[slot]]->power[at[slot]][step[2 + 2 * k]];
                        cx *const sum = next + step[3 + 2 * k];
                        *sum = cx_add(*sum, cx_mul(own[k], power));
                    }
                    own = next;
                    step += 2 + 2 * terms;
                }
                const cx scale = cx_exp(cx_of(exponent.re - growth, exponent.im));
                value[0] = cx_add(value[0], cx_mul(cx_over(*own, at[slots]), scale));
            }
        }
    }
    value[1] = cx_of(growth, 0.0);
}

//: cx_sum
/* About the size of a number, without a root. */
static inline double cx_sum(cx z)
{
    return fabs(z.re) + fabs(z.im);
}

//: cx_shift
static inline cx cx_shift(cx z, int power)    /* z times a power of two */
{
    return cx_of(ldexp(z.re, power), ldexp(z.im, power));
}

//: cx_balance
/* Powers of two by which states are scaled so that rows and columns of a are alike. */
static void cx_balance(const cx *a, int n, int *power)
{
    double scale[CX_ORDER] = {0.0};
    for (int turn = 0; turn < 4; turn++) {
        for (int k = 0; k < n; k++) {
            double above = -40.0, below = -40.0;
            for (int j = 0; j < n; j++) {
                if (j != k) {
                    const double row = cx_sum(a[n * k + j]), column = cx_sum(a[n * j + k]);
                    above = row > 0.0 ? fmax(above, log2(row) + scale[j] - scale[k]) : above;
                    below = column > 0.0 ? fmax(below, log2(column) + scale[k] - scale[j]) : below;
                }
            }
            scale[k] += 0.5 * (above - below);
        }
    }
    for (int k = 0; k < n; k++) {
        power[k] = fabs(scale[k]) < 1000.0 ? (int)rint(scale[k]) : 0;
    }
}

//: cx_doubled
/* The relation between the ends of two elements in a row, its largest coefficients about one. */
static void cx_doubled(cx *relation, int n)
{
    cx row[6 * CX_ORDER * CX_ORDER];
    const int w = 3 * n;
    for (int i = 0; i < 2 * n * w; i++) {
        row[i] = cx_of(0.0, 0.0);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            row[w * i + n + j] = row[w * (n + i) + j] = relation[2 * n * i + j];
            row[w * i + j] = row[w * (n + i) + 2 * n + j] = relation[2 * n * i + n + j];
        }
    }
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < 2 * n; i++) {
            pivot = cx_sum(row[w * i + k]) > cx_sum(row[w * pivot + k]) ? i : pivot;
        }
        for (int j = k; j < w; j++) {
            const cx held = row[w * k + j];
            row[w * k + j] = row[w * pivot + j];
            row[w * pivot + j] = held;
        }
        const cx inverse = cx_div(cx_of(1.0, 0.0), row[w * k + k]);
        for (int i = k + 1; i < 2 * n; i++) {
            const cx factor = cx_mul(row[w * i + k], inverse);
            for (int j = k + 1; j < w; j++) {
                row[w * i + j] = cx_sub(row[w * i + j], cx_mul(factor, row[w * k + j]));
            }
        }
    }
    for (int i = 0; i < n; i++) {
        double most = 0.0;
        for (int j = 0; j < 2 * n; j++) {
            most = fmax(most, cx_sum(row[w * (n + i) + n + j]));
        }
        const int power = most > 0.0 && most < HUGE_VAL ? -(int)rint(log2(most)) : 0;
        for (int j = 0; j < 2 * n; j++) {
            relation[2 * n * i + j] = cx_shift(row[w * (n + i) + n + j], power);
        }
    }
}

//: cx_relation
/* The relation p z(0) + q z(1) = 0 of the ends of a line element dz/dx = a z, as rows (p, q);
 * a is overwritten.
 */
static void cx_relation(cx *a, int n, cx *relation)
{
    cx term[CX_ORDER * CX_ORDER], next[CX_ORDER * CX_ORDER];
    int power[CX_ORDER];
    double norm = 1.0;
    cx_balance(a, n, power);
    for (int i = 0; i < n; i++) {
        double sum = 0.0;
        for (int j = 0; j < n; j++) {
            a[n * i + j] = cx_shift(a[n * i + j], power[j] - power[i]);
            sum += cx_abs(a[n * i + j]);
        }
        norm = fmax(norm, sum);
    }
    const int halvings = norm < HUGE_VAL ? (int)fmin(fmax(ceil(log2(norm)) - 1.0, 0.0), 60.0) : 0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            a[n * i + j] = cx_shift(a[n * i + j], -halvings);
            term[n * i + j] = cx_of(i == j ? 1.0 : 0.0, 0.0);
            relation[2 * n * i + j] = term[n * i + j];
            relation[2 * n * i + n + j] = cx_of(i == j ? -1.0 : 0.0, 0.0);
        }
    }
    for (int m = 1; m < 29; m++) {
        for (int i = 0; i < n * n; i++) {
            next[i] = cx_of(0.0, 0.0);
        }
        for (int i = 0; i < n * n; i++) {
            for (int j = 0; j < n && cx_sum(a[i]) != 0.0; j++) {
                const int at = n * (i / n) + j;
                next[at] = cx_add(next[at], cx_mul(a[i], term[n * (i % n) + j]));
            }
        }
        for (int i = 0; i < n * n; i++) {
            const int at = 2 * n * (i / n) + i % n;
            term[i] = cx_scale(1.0 / m, next[i]);
            relation[at] = cx_add(relation[at], term[i]);
        }
    }
    for (int k = 0; k < halvings; k++) {
        cx_doubled(relation, n);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < 2 * n; j++) {
            relation[2 * n * i + j] = cx_shift(relation[2 * n * i + j], -power[j % n]);
        }
    }
}

//: cx_coefficients cx_place
/* A coefficient and where it stands. */
typedef struct { cx value; int row, column; } cx_place;

/* The coefficients of a network, as the plan says after its first four numbers: the number of
 * lumped ones, with row, column and entry of each; the number of groups of line elements, and
 * for each the number n of states, that of coefficients, row and column of these, the signs of
 * the n states at the end, and the number of elements; for each of these its first row, the
 * entries of the coefficients and of the length, and the unknowns at both ends, -1 for none.
 */
static void cx_coefficients(const cx *entry, const int *plan, cx_place *place)
{
    const int *at = plan + 4;
    cx a[CX_ORDER * CX_ORDER], relation[2 * CX_ORDER * CX_ORDER];
    for (int left = *at++; left > 0; left--, at += 3, place++) {
        place->value = entry[at[2]];
        place->row = at[0];
        place->column = at[1];
    }
    for (int groups = *at++; groups > 0; groups--) {
        const int n = at[0], count = at[1], *const where = at + 2, *const sign = where + 2 * count;
        int elements = sign[n];
        for (at = sign + n + 1; elements > 0; elements--, at += 2 + count + 2 * n) {
            const cx length = entry[at[1 + count]];
            for (int i = 0; i < n * n; i++) {
                a[i] = cx_of(0.0, 0.0);
            }
            for (int i = 0; i < count; i++) {
                a[n * where[2 * i] + where[2 * i + 1]] = cx_mul(entry[at[1 + i]], length);
            }
            cx_relation(a, n, relation);
            for (int i = 0; i < 2 * n * n; i++, place++) {
                const int j = i % (2 * n), turned = j >= n && sign[j - n] < 0;
                place->value = turned ? cx_neg(relation[i]) : relation[i];
                place->row = at[0] + i / (2 * n);
                place->column = at[2 + count + j];
            }
        }
    }
}

//: cx_equilibrated
/* Scale rows and columns by powers of two so that their largest coefficients are about one. */
static void cx_equilibrated(cx_place *place, int count, int size, double *scale)
{
    double *const most = scale + 2 * (size + 1);
    for (int i = 0; i < 2 * (size + 1); i++) {
        scale[i] = 0.0;
    }
    for (int turn = 0; turn < 2; turn++) {
        for (int i = 0; i < 2 * (size + 1); i++) {
            most[i] = -HUGE_VAL;
        }
        for (int i = 0; i < count; i++) {
            const int row = place[i].row, column = size + 1 + place[i].column;
            if (row < size && column < 2 * size + 1) {
                const double left = log2(cx_sum(place[i].value) + 1e-300) + scale[row] + scale[column];
                most[row] = fmax(most[row], left);
                most[column] = fmax(most[column], left);
            }
        }
        for (int i = 0; i < 2 * (size + 1); i++) {
            scale[i] -= fabs(most[i]) < HUGE_VAL ? 0.5 * most[i] : 0.0;
        }
    }
    for (int i = 0; i < count; i++) {
        const double power = rint(scale[place[i].row]) + rint(scale[size + 1 + place[i].column]);
        place[i].value = cx_shift(place[i].value, (int)power);
    }
}

//: cx_eliminated cx_pivot
/* A step of an elimination: how many rows begin to be used, the place of the last one in use,
 * the pivot's, with which it changes place, and how much of the pivot's row follows.
 */
typedef struct { int entering, high, pivot, length; cx inverse; } cx_pivot;

/* The steps of Gauss's elimination with partial pivoting, the factors of the other rows, height
 * for each step, and the rest of the pivot's rows, width for each. Rows stand in the order of
 * their first columns; so many of them, and so many columns, are in use at a time. first has for
 * each row where its coefficients begin.
 */
static void cx_eliminated(const cx_place *place, const int *first, int size, int height, int width,
                          cx *window, cx_pivot *step, cx *factor, cx *top)
{
    int high = 0, entered = 0, end = 0;
    for (int k = 0; k < size; k++, step++, factor += height, top += width) {
        step->entering = 0;
        while (entered < size && high < height) {
            int left = size;
            for (int i = first[entered]; i < first[entered + 1]; i++) {
                left = place[i].column < left ? place[i].column : left;
            }
            if (left > k) {
                break;
            }
            cx *const row = window + width * high;
            for (int j = 0; j < width; j++) {
                row[j] = cx_of(0.0, 0.0);
            }
            for (int i = first[entered]; i < first[entered + 1]; i++) {
                const int column = place[i].column;
                if (column < size) {
                    row[column % width] = cx_add(row[column % width], place[i].value);
                    end = column >= end ? column + 1 : end;
                }
            }
            high++;
            entered++;
            step->entering++;
        }
        step->pivot = 0;
        for (int i = 1; i < high; i++) {
            const cx *const own = window + k % width;
            step->pivot = cx_sum(own[width * i]) > cx_sum(own[width * step->pivot]) ? i : step->pivot;
        }
        step->high = --high;
        step->length = end - k - 1;
        cx *const chosen = window + width * step->pivot, *const other = window + width * high;
        step->inverse = cx_div(cx_of(1.0, 0.0), chosen[k % width]);
        for (int j = 0; j < step->length; j++) {
            top[j] = chosen[(k + 1 + j) % width];
        }
        for (int j = 0; j < width; j++) {
            chosen[j] = other[j];
        }
        for (int i = 0; i < high; i++) {
            cx *const row = window + width * i;
            factor[i] = cx_mul(row[k % width], step->inverse);
            row[k % width] = cx_of(0.0, 0.0);
            for (int j = 0; j < step->length && cx_sum(factor[i]) != 0.0; j++) {
                cx *const own = row + (k + 1 + j) % width;
                *own = cx_sub(*own, cx_mul(factor[i], top[j]));
            }
        }
    }
}

//: cx_improved
/* Subtract the solution for a right side, from the steps of an elimination. */
static void cx_improved(const cx *right, int size, int height, int width, const cx_pivot *step,
                        const cx *factor, const cx *top, cx *window, cx *driven, cx *found)
{
    for (int k = 0; k < size; k++) {
        const cx_pivot own = step[k];
        for (int i = own.high + 1 - own.entering; i <= own.high; i++) {
            window[i] = *right++;
        }
        driven[k] = window[own.pivot];
        window[own.pivot] = window[own.high];
        for (int i = 0; i < own.high; i++) {
            window[i] = cx_sub(window[i], cx_mul(factor[height * k + i], driven[k]));
        }
    }
    for (int k = size - 1; k >= 0; k--) {
        cx sum = cx_of(0.0, 0.0);
        for (int j = 0; j < step[k].length; j++) {
            sum = cx_add(sum, cx_mul(top[width * k + j], driven[k + 1 + j]));
        }
        driven[k] = cx_mul(cx_sub(driven[k], sum), step[k].inverse);
    }
    for (int k = 0; k < size; k++) {
        found[k] = cx_sub(found[k], driven[k]);
    }
}

//: cx_solved
/* c x + d, where a x + b = 0, of the matrix ((a, b), (c, d)). A step of refinement makes small
 * unknowns beside large ones as accurate as these (Skeel 1980).
 */
static cx cx_solved(const cx_place *place, const int *first, int size, int height, int width,
                    cx_pivot *step, cx *work)
{
    cx *const window = work, *const factor = window + height * width;
    cx *const top = factor + height * size, *const left = top + width * size;
    cx *const driven = left + size + 1, *const found = driven + size + 1;
    cx_eliminated(place, first, size, height, width, window, step, factor, top);
    for (int i = 0; i <= size; i++) {
        found[i] = cx_of(i == size ? 1.0 : 0.0, 0.0);
    }
    for (int turn = 0; turn < 3; turn++) {
        for (int row = 0; row <= size; row++) {
            left[row] = cx_of(0.0, 0.0);
            for (int i = first[row]; i < first[row + 1]; i++) {
                left[row] = cx_add(left[row], cx_mul(place[i].value, found[place[i].column]));
            }
        }
        if (turn < 2) {
            cx_improved(left, size, height, width, step, factor, top, window, driven, found);
        }
    }
    return left[size];
}

//: cx_network
/* What an output of a network of line elements is per unit of an input. The plan begins with
 * the numbers of unknowns and of coefficients, and height and width of the window in which
 * unknowns are eliminated. NAN where there is no memory.
 */
static cx cx_network(const cx *entry, const int *plan, int output, int source)
{
    const int size = plan[0], total = plan[1], height = plan[2], width = plan[3];
    const size_t one = (size_t)size + 1, values = ((size_t)height + width) * one + 3 * one;
    cx_place *const all = malloc(2 * (size_t)total * sizeof *all);
    cx *const work = malloc((values + (size_t)height * width) * sizeof *work);
    cx_pivot *const step = malloc(one * sizeof *step);
    double *const scale = malloc(4 * one * sizeof *scale);
    int *const first = malloc((one + 1) * sizeof *first);
    cx found = cx_of(NAN, NAN);
    if (all && work && step && scale && first) {
        cx_place *const sorted = all + total;
        int count = 0;
        cx_coefficients(entry, plan, all);
        for (int i = 0; i < total; i++) {
            const int row = all[i].row, column = all[i].column;
            const int is_kept = (row < size || row == size + output) && column >= 0;
            if (is_kept && (column < size || column == size + source)) {
                all[count] = all[i];
                all[count].row = row < size ? row : size;
                all[count].column = column < size ? column : size;
                count++;
            }
        }
        cx_equilibrated(all, count, size, scale);
        for (int i = 0; i <= size + 1; i++) {
            first[i] = 0;
        }
        for (int i = 0; i < count; i++) {
            first[all[i].row + 1]++;
        }
        for (int i = 0; i <= size; i++) {
            first[i + 1] += first[i];
        }
        for (int i = count - 1; i >= 0; i--) {
            sorted[--first[all[i].row + 1]] = all[i];
        }
        for (int i = 0; i <= size; i++) {
            first[i] = first[i + 1];
        }
        first[size + 1] = count;
        found = cx_solved(sorted, first, size, height, width, step, work);
    }
    free(all);
    free(work);
    free(step);
    free(scale);
    free(first);
    return found;
}

//: cx_pieces cx_begin cx_end
/* So many frequencies are computed at a time, in loops that compilers turn into vector instructions. */
enum { cx_lanes = 32 };

typedef struct cx_law cx_law;
typedef struct cx_table cx_table;

/* A matrix whose law varies along x: the parts of the law at x, and at s the start, the length and the
 * bases; the plan is told at cx_law. begun calls cx_begun where a stiffness vanishes at the start, and is
 * NULL elsewhere.
 */
typedef struct {
    void (*along)(double x, const PARAMETERS *p, double *part);
    void (*at)(cx s, const PARAMETERS *p, cx *given);
    int (*begun)(const cx_law *law, const cx_table *table, double to, int halvings, double *sum);
    const int *plan;
} cx_member;

/* What the fundamental matrix of a member is on pieces of its length: polynomials in the bases over
 * their limits, which frequencies within a factor of four share. Of every piece there are so many
 * coefficients, in order of the entries: place has where those of each begin, then of each coefficient
 * the product of bases, and then where the lanes of that begin. now points to the minors at the frequency
 * whose value is wanted.
 */
typedef struct {
    const cx_member *member;
    int octave[CX_ORDER];    /* of the bases, in powers of 16 */
    int pieces, count, *place;
    size_t room;
    double *coefficient, *work;
    cx *minor, *now;
} cx_pieces;

static void cx_begin(cx_pieces *kept, const cx_member *member, int count)
{
    for (int k = 0; k < count; k++) {
        const cx_pieces none = {.member = member + k, .pieces = -1};
        kept[k] = none;
    }
}

static void cx_end(cx_pieces *kept, int count)
{
    for (int k = 0; k < count; k++) {
        free(kept[k].place);
        free(kept[k].coefficient);
        free(kept[k].work);
        free(kept[k].minor);
    }
}

//: cx_chebyshev
/* The number of Chebyshev points on a piece, less one, and of lanes for them. */
enum { cx_points = 20, cx_room = 24 };

/* Points from 0 to 1, what makes Chebyshev's terms of values there, and by value its integrals from 0. */
struct cx_table {
    double point[cx_points + 1];
    double term[cx_points + 1][cx_points + 1], integral[cx_points + 1][cx_room];
    int at[cx_points + 1];    /* where the integrals of a value begin */
};

static void cx_chebyshev(cx_table *table)
{
    enum { N = cx_points };
    double cosine[2 * N];
    memset(table, 0, sizeof *table);
    for (int m = 0; m < 2 * N; m++) {
        cosine[m] = cos(3.141592653589793 * m / N);
    }
    for (int j = 0; j <= N; j++) {
        table->point[j] = 0.5 + 0.5 * cosine[N - j];
        table->at[j] = cx_room * j;
        for (int k = 0; k <= N; k++) {
            const double ends = (j % N ? 1.0 : 0.5) * (k % N ? 1.0 : 0.5);
            table->term[k][j] = 2.0 / N * ends * cosine[k * (N - j) % (2 * N)];
        }
    }
    for (int i = 0; i <= N; i++) {
        double grown[N + 1];
        for (int m = 0; m <= N; m++) {
            /* The integral of the term m, at the point i less that at the first one. */
            const double above = cosine[(m + 1) * (N - i) % (2 * N)] - cosine[(m + 1) * N % (2 * N)];
            grown[m] = m == 0 ? above : above / (2 * m + 2);
            if (m > 1) {
                const double below = cosine[(m - 1) * (N - i) % (2 * N)] - cosine[(m - 1) * N % (2 * N)];
                grown[m] -= below / (2 * m - 2);
            }
        }
        for (int j = 0; j <= N; j++) {
            double sum = 0.0;
            for (int m = 0; m <= N; m++) {
                sum += 0.5 * grown[m] * table->term[m][j];
            }
            table->integral[j][i] = sum;
        }
    }
}

//: cx_parts cx_scales cx_growth
/* A law along x, the parts of whose coefficients are functions of x times powers of the bases; scale has
 * what these are at the limits, which octave tells, times the length. The plan begins with the numbers of
 * states, parts, bases and products of their powers, how many complex numbers cx_through needs, and where
 * choices and starts stand. Then follow per part its row, its column, its powers, and what it makes of
 * each product, -1 for none; the powers in each product; the choices: the largest number of rows, and for
 * each above one how many choices of so many rows there are, and of each choice these, and the choices
 * that are left without one of them; the starts: how many, of each how many columns and which choice of
 * these; and how many minors, of each its start and its choice of rows.
 */
struct cx_law {
    void (*along)(double x, const PARAMETERS *p, double *part);
    int (*begun)(const cx_law *law, const cx_table *table, double to, int halvings, double *sum);
    const PARAMETERS *p;
    const int *plan, *octave;
    double start, length, *scale;
    int *sum;    /* of the powers in two products, which product has them; -1 for none */
};

static void cx_parts(const cx_law *law, double share, double *part)
{
    law->along(law->start + law->length * share, law->p, part);
    for (int k = 0; k < law->plan[1]; k++) {
        part[k] *= law->scale[k];
    }
}

/* Make the scales, times a factor. */
static void cx_scales(const cx_law *law, double factor)
{
    const int bases = law->plan[2], stride = 2 + bases + law->plan[3];
    for (int k = 0; k < law->plan[1]; k++) {
        law->scale[k] = factor;
        for (int b = 0; b < bases; b++) {
            law->scale[k] *= ldexp(1.0, 4 * law->octave[b] * law->plan[9 + k * stride + b]);
        }
    }
}

/* The largest eigenvalue of a matrix without negative entries, which is its norm if states are
 * scaled well: the growth of its powers, found by squaring.
 */
static double cx_growth(const cx_law *law, const double *part)
{
    enum { TURNS = 7 };    /* to a hundredth, for matrices of four rows */
    const int n = law->plan[0], stride = 2 + law->plan[2] + law->plan[3];
    double a[CX_ORDER * CX_ORDER] = {0.0}, b[CX_ORDER * CX_ORDER], grown = 0.0;
    for (int k = 0; k < law->plan[1]; k++) {
        const int *const own = law->plan + 7 + stride * k;
        a[n * own[0] + own[1]] += fabs(part[k]);
    }
    for (int turn = 0; turn <= TURNS; turn++) {
        double most = 0.0;
        for (int i = 0; i < n * n; i++) {
            if (!(a[i] < HUGE_VAL)) {
                return NAN;
            }
            most = a[i] > most ? a[i] : most;
        }
        if (most == 0.0) {
            return 0.0;
        }
        grown = 2.0 * grown + log(most);
        for (int i = 0; i < n * n; i++) {
            a[i] /= most;
            b[i] = 0.0;
        }
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < n; k++) {
                for (int j = 0; j < n && a[n * i + k] > 0.0; j++) {
                    b[n * i + j] += a[n * i + k] * a[n * k + j];
                }
            }
        }
        memcpy(a, b, sizeof a);
    }
    return exp(ldexp(grown, -TURNS));
}

//: cx_combined
/* Lanes of a sum of numbers times the lanes that begin at some places. */
static void cx_combined(int count, const double *factor, const double *lanes, const int *at, int width,
                        double *c)
{
    for (int j = 0; j < width; j += 8) {
        double s_0 = 0.0, s_1 = 0.0, s_2 = 0.0, s_3 = 0.0, s_4 = 0.0, s_5 = 0.0, s_6 = 0.0, s_7 = 0.0;
        for (int k = 0; k < count; k++) {
            const double *const p = lanes + at[k] + j, f = factor[k];
            s_0 += f * p[0];
            s_1 += f * p[1];
            s_2 += f * p[2];
            s_3 += f * p[3];
            s_4 += f * p[4];
            s_5 += f * p[5];
            s_6 += f * p[6];
            s_7 += f * p[7];
        }
        c[j] = s_0;
        c[j + 1] = s_1;
        c[j + 2] = s_2;
        c[j + 3] = s_3;
        c[j + 4] = s_4;
        c[j + 5] = s_5;
        c[j + 6] = s_6;
        c[j + 7] = s_7;
    }
}

//: cx_dot
/* Lanes of a sum of products. */
static void cx_dot(int count, const double *const *a, const double *const *b, double *c)
{
    for (int j = 0; j < cx_lanes; j += 8) {
        double s_0 = 0.0, s_1 = 0.0, s_2 = 0.0, s_3 = 0.0, s_4 = 0.0, s_5 = 0.0, s_6 = 0.0, s_7 = 0.0;
        for (int k = 0; k < count; k++) {
            const double *const p = a[k] + j, *const q = b[k] + j;
            s_0 += p[0] * q[0];
            s_1 += p[1] * q[1];
            s_2 += p[2] * q[2];
            s_3 += p[3] * q[3];
            s_4 += p[4] * q[4];
            s_5 += p[5] * q[5];
            s_6 += p[6] * q[6];
            s_7 += p[7] * q[7];
        }
        c[j] = s_0;
        c[j + 1] = s_1;
        c[j + 2] = s_2;
        c[j + 3] = s_3;
        c[j + 4] = s_4;
        c[j + 5] = s_5;
        c[j + 6] = s_6;
        c[j + 7] = s_7;
    }
}

//: cx_joined
/* Put the product of the last two pieces in their place, but for powers that are too high to matter:
 * where a section changes quickly, waves may grow little from piece to piece.
 */
static void cx_joined(const cx_law *law, double *work, cx_pieces *kept)
{
    const int n = law->plan[0], products = law->plan[3], size = n * n;
    const int *const place = kept->place, *const product = place + size + 1;
    double *const first = kept->coefficient + (size_t)kept->count * (size_t)(kept->pieces - 2);
    const double *const second = first + kept->count;
    memset(work, 0, (size_t)(products * size) * sizeof *work);
    for (int i = 0; i < size; i++) {
        for (int k = place[i]; k < place[i + 1]; k++) {
            const int *const sum = law->sum + products * product[k], column = i % n;
            for (int j = 0; j < n; j++) {
                for (int m = place[n * column + j]; m < place[n * column + j + 1]; m++) {
                    if (sum[product[m]] >= 0) {
                        work[size * sum[product[m]] + i - column + j] += second[k] * first[m];
                    }
                }
            }
        }
    }
    for (int i = 0; i < size; i++) {
        for (int k = place[i]; k < place[i + 1]; k++) {
            first[k] = work[size * product[k] + i];
        }
    }
    kept->pieces--;
}

//: cx_sampled
/* Put the parts of a law, times a factor, at Chebyshev points from one share of the length to another.
 * Nonzero where these are too few: the parts are no polynomials there to the last digits.
 */
static int cx_sampled(const cx_law *law, const cx_table *table, double from, double to, double factor,
                      double *value, double *part)
{
    enum { N = cx_points, STRIDE = cx_room };
    const int parts = law->plan[1];
    int is_rough = 0;
    memset(value, 0, (size_t)(STRIDE * parts) * sizeof *value);
    for (int i = 0; i <= N; i++) {
        cx_parts(law, from + (to - from) * table->point[i], part);
        for (int k = 0; k < parts; k++) {
            value[STRIDE * k + i] = factor * part[k];
        }
    }
    for (int k = 0; k < parts; k++) {
        double most = 0.0, last = 0.0;
        for (int m = 0; m <= N; m++) {
            double own = 0.0;
            for (int i = 0; i <= N; i++) {
                own += table->term[m][i] * value[STRIDE * k + i];
            }
            most = fmax(most, fabs(own));
            last = m > N - 3 ? fmax(last, fabs(own)) : 0.0;
        }
        is_rough |= last > 1e-13 * most;
    }
    return is_rough;
}

//: cx_slopes
/* The parts of a plan times rows of a matrix, at Chebyshev points; at last of each whether there is any. */
static void cx_slopes(const int *plan, const double *value, const double *row, double *next)
{
    enum { STRIDE = cx_room, FLAG = cx_room - 1 };
    const int n = plan[0], parts = plan[1], bases = plan[2], products = plan[3];
    for (int k = 0; k < products * n * n; k++) {
        next[STRIDE * k + FLAG] = 0.0;
    }
    for (int k = 0; k < parts; k++) {
        const int *const own = plan + 7 + k * (2 + bases + products), *const made = own + 2 + bases;
        const double *const factor = value + STRIDE * k;
        for (int m = 0; m < n * products; m++) {
            const double *const given = row + STRIDE * (n * (n * (m / n) + own[1]) + m % n);
            if (given[FLAG] == 0.0 || made[m / n] < 0) {
                continue;
            }
            double *const slope = next + STRIDE * (n * (n * made[m / n] + own[0]) + m % n);
            for (int i = 0; i < STRIDE && slope[FLAG] == 0.0; i++) {
                slope[i] = 0.0;
            }
            for (int i = 0; i < STRIDE; i++) {
                slope[i] += factor[i] * given[i];
            }
            slope[FLAG] = 1.0;
        }
    }
}

//: cx_iterated
/* The fundamental matrix at the end of a piece by so many steps of Picard's iteration, of each entry
 * with whether there is any.
 */
static void cx_iterated(const cx_law *law, const cx_table *table, int steps, const double *value, double *sum)
{
    enum { N = cx_points, STRIDE = cx_room, FLAG = cx_room - 1 };
    const int n = law->plan[0], total = law->plan[3] * n * n;
    double *const row = sum + 2 * total, *const next = row + STRIDE * total;
    for (int k = 0; k < total; k++) {
        row[STRIDE * k + FLAG] = sum[2 * k] = sum[2 * k + 1] = 0.0;
    }
    for (int i = 0; i < n; i++) {
        const int at = (n + 1) * i;
        sum[2 * at] = sum[2 * at + 1] = 1.0;
        for (int k = 0; k < STRIDE; k++) {
            row[STRIDE * at + k] = 1.0;
        }
    }
    for (int step = 0; step < steps; step++) {
        cx_slopes(law->plan, value, row, next);
        for (int k = 0; k < total; k++) {
            const double *const slope = next + STRIDE * k;
            double *const grown = row + STRIDE * k;
            grown[FLAG] = slope[FLAG];
            if (slope[FLAG] != 0.0) {
                cx_combined(N + 1, slope, table->integral[0], table->at, STRIDE, grown);
                grown[FLAG] = 1.0;
                sum[2 * k] += grown[N];
                sum[2 * k + 1] = 1.0;
            }
        }
    }
}

//: cx_weighted
/* Make, by value at Chebyshev points, the integrals over t in [0, 1] of g(t x) t^(a - 1); of g less g(0)
 * where a = 0. They are u with x u' + a u = g: of Chebyshev's terms of u that of the highest order is the
 * first to be known, since x T_k' = k (T_k + 2 T_(k-1) + ... + 2 T_1 + T_0).
 */
static void cx_weighted(const cx_table *table, int a, double *integral)
{
    enum { N = cx_points };
    double cosine[2 * N];
    for (int m = 0; m < 2 * N; m++) {
        cosine[m] = cos(3.141592653589793 * m / N);
    }
    memset(integral, 0, (N + 1) * cx_room * sizeof *integral);
    for (int j = 0; j <= N; j++) {
        double term[N + 1] = {0.0}, above = 0.0, at_start = 0.0;
        for (int k = N; k > 0; k--) {
            term[k] = (table->term[k][j] - 2.0 * above) / (k + a);
            above += k * term[k];
            at_start += k % 2 ? -term[k] : term[k];
        }
        term[0] = a > 0 ? (table->term[0][j] - above) / a : -at_start;
        for (int i = 0; i <= N; i++) {
            for (int k = 0; k <= N; k++) {
                integral[table->at[j] + i] += term[k] * cosine[k * (N - i) % (2 * N)];
            }
        }
    }
}

//: cx_begun
/* The fundamental matrix at the end of the piece that begins where a stiffness vanishes, as cx_iterated
 * gives others. There h v' = B v, with h the way from the start and z_i = h^power_i v_i. The diagonal of B
 * has a number b_i <= 0 at h = 0; beginning gives the parts of B without these, and g is that times v:
 *
 *     v_i(h) = 1 or 0 + integral over t in [0, 1] of g_i(t h) t^(-b_i - 1)
 *
 * with 1 in one free state; where b_i = 0 g_i(0) is zero, or what made a logarithm. The plan has what that
 * of a law has up to what parts make of products; then the power of h of each part, and of all states the
 * powers, the -b_i, and whether they are free. Nonzero where no matrix is made: 1 where Chebyshev points
 * are too few for the parts of B, -1 where there is no memory.
 */
static int cx_begun(const cx_law *law, const cx_table *table,
                    void (*beginning)(double x, const PARAMETERS *p, double *part), const int *plan,
                    double to, int halvings, double *sum)
{
    enum { N = cx_points, STRIDE = cx_room, FLAG = cx_room - 1, MOST = 200 };
    const int n = plan[0], parts = plan[1], total = plan[3] * n * n;
    const int *const order = plan + 7 + parts * (2 + plan[2] + plan[3]), *const power = order + parts;
    const int *const decay = power + n, *const is_free = decay + n;
    const double way = law->length * to;
    double integral[CX_ORDER][(N + 1) * STRIDE], largest[CX_ORDER * CX_ORDER] = {0.0};
    double *const row = sum + 2 * total, *const next = row + STRIDE * total;
    double *const value = malloc((STRIDE + 2) * (size_t)parts * sizeof *value);
    cx_law own = *law;
    if (value == NULL) {
        return -1;
    }
    own.along = beginning;
    own.plan = plan;
    own.scale = value + STRIDE * parts;
    cx_scales(&own, 1.0);
    if (cx_sampled(&own, table, 0.0, to, 1.0, value, own.scale + parts) && halvings < 12) {
        free(value);
        return 1;
    }
    for (int k = 0; k < parts; k++) {
        for (int i = 0; i <= N; i++) {
            value[STRIDE * k + i] *= pow(way * table->point[i], order[k]);
        }
    }
    for (int k = 0; k < total; k++) {
        row[STRIDE * k + FLAG] = sum[2 * k] = 0.0;
        /* Pieces that follow may have any entry. */
        sum[2 * k + 1] = 1.0;
    }
    for (int i = 0; i < n; i++) {
        const int at = (n + 1) * i;
        cx_weighted(table, decay[i], integral[i]);
        sum[2 * at] = is_free[i];
        for (int k = 0; k < STRIDE && is_free[i]; k++) {
            row[STRIDE * at + k] = 1.0;
        }
    }
    /* Terms of one state may vanish while others grow, but not for as many steps as there are states. */
    for (int step = 0, quiet = 0; step < MOST && quiet < n; step++) {
        double size[CX_ORDER * CX_ORDER] = {0.0};
        cx_slopes(plan, value, row, next);
        for (int k = 0; k < total; k++) {
            const double *const slope = next + STRIDE * k;
            double *const grown = row + STRIDE * k, *const most = size + k % (n * n);
            grown[FLAG] = slope[FLAG];
            if (slope[FLAG] != 0.0) {
                cx_combined(N + 1, slope, integral[k % (n * n) / n], table->at, STRIDE, grown);
                grown[FLAG] = 1.0;
                sum[2 * k] += grown[N];
                for (int i = 0; i <= N; i++) {
                    *most = fmax(*most, fabs(grown[i]));
                }
            }
        }
        quiet++;
        for (int k = 0; k < n * n; k++) {
            largest[k] = fmax(largest[k], size[k]);
            quiet = size[k] <= 1e-18 * largest[k] ? quiet : 0;
        }
    }
    for (int k = 0; k < total; k++) {
        sum[2 * k] *= pow(way, power[k % (n * n) / n]);
    }
    free(value);
    return 0;
}

//: cx_followed
/* Append the fundamental matrix of a piece, from one share of the length to another, by so many
 * steps of Picard's iteration; it is made of halves until the parts are polynomials there to the
 * last digits. work holds values of the parts, and rows of the matrix at Chebyshev points, by
 * product of powers, row and column, of each at last whether there is any. 0 without memory.
 */
static int cx_followed(const cx_law *law, const cx_table *table, double from, double to, int halvings,
                       int steps, double *work, cx_pieces *kept)
{
    enum { STRIDE = cx_room };
    const int n = law->plan[0], parts = law->plan[1], products = law->plan[3];
    const int total = products * n * n, is_first = law->begun && from == 0.0;
    double *const value = work, *const sum = value + STRIDE * parts;
    double *const part = sum + 2 * (STRIDE + 1) * total;
    int is_rough;
    if (is_first) {
        is_rough = law->begun(law, table, to, halvings, sum);
    } else {
        is_rough = cx_sampled(law, table, from, to, to - from, value, part) && halvings < 12;
    }
    if (is_rough < 0) {
        return 0;
    }
    if (is_rough) {
        const double middle = 0.5 * (from + to);
        if (!cx_followed(law, table, from, middle, halvings + 1, steps, work, kept)
            || !cx_followed(law, table, middle, to, halvings + 1, steps, work, kept)) {
            return 0;
        }
        cx_joined(law, work, kept);
        return 1;
    }
    if (!is_first) {
        cx_iterated(law, table, steps, value, sum);
    }
    if (kept->place == NULL) {
        /* The same for all pieces of one cut. */
        kept->place = malloc((size_t)(n * n + 1 + 2 * total) * sizeof *kept->place);
        for (int k = 0; k < total && kept->place; k++) {
            if (k % products == 0) {
                kept->place[k / products] = kept->count;
            }
            if (sum[2 * (n * n * (k % products) + k / products) + 1] != 0.0) {
                kept->place[n * n + 1 + kept->count++] = k % products;
                kept->place[n * n] = kept->count;
            }
        }
        for (int k = 0; k < kept->count && kept->place; k++) {
            kept->place[n * n + 1 + kept->count + k] = 3 * cx_lanes * kept->place[n * n + 1 + k];
        }
    }
    const size_t used = (size_t)kept->count * (size_t)kept->pieces, more = used + (size_t)kept->count;
    if (more > kept->room) {
        double *const larger = realloc(kept->coefficient, 2 * more * sizeof *larger);
        kept->room = larger ? 2 * more : kept->room;
        kept->coefficient = larger ? larger : kept->coefficient;
    }
    if (kept->place == NULL || more > kept->room) {
        return 0;
    }
    for (int i = 0; i < n * n; i++) {
        for (int k = kept->place[i]; k < kept->place[i + 1]; k++) {
            kept->coefficient[used + (size_t)k] = sum[2 * (n * n * kept->place[n * n + 1 + k] + i)];
        }
    }
    kept->pieces++;
    return 1;
}

//: cx_cut
/* Make the pieces of a law for bases up to limits; there are none where waves are too many to be
 * followed, or where there is no memory.
 */
static void cx_cut(const cx_law *law, double *work, cx_pieces *kept)
{
    enum { COUNT = 64, MOST = 4000 };
    double share[COUNT + 1] = {0.0}, growth = 0.0, size = 1.0, from = 0.0;
    cx_table table;
    int steps = 0, at = 0, is_made = 1;
    /* Where a stiffness vanishes waves grow ever faster, in measure of the length, but not of its root. */
    const int degree = law->begun ? 4 : 1;
    free(kept->place);
    kept->place = NULL;
    kept->count = kept->pieces = 0;
    for (int i = 0; i < COUNT; i++) {
        const double root = (i + 0.5) / COUNT;
        cx_parts(law, pow(root, degree), work);
        growth += degree * pow(root, degree - 1) * cx_growth(law, work) / COUNT;
        share[i + 1] = growth + 1e-9 * (i + 1);
    }
    /* Where waves grow by e^3, sums of terms of both signs lose a digit. */
    if (!(growth < 3.0 * MOST)) {
        return;
    }
    const int number = (int)(growth / 3.0) + 1;
    while (size > 1e-18 || steps < 2 * law->plan[0]) {
        steps++;
        size *= growth / number / steps;
    }
    cx_chebyshev(&table);
    for (int k = 1; k <= number && is_made; k++) {
        const double wanted = share[COUNT] * k / number;
        while (at < COUNT - 1 && share[at + 1] < wanted) {
            at++;
        }
        const double rest = (wanted - share[at]) / (share[at + 1] - share[at]);
        const double to = k == number ? 1.0 : pow((at + rest) / COUNT, degree);
        is_made = cx_followed(law, &table, from, to, 0, steps, work, kept);
        from = to;
    }
    kept->pieces = is_made ? kept->pieces : 0;
}

//: cx_negated
static void cx_negated(const double *restrict a, double *restrict c)
{
    for (int j = 0; j < cx_lanes; j++) {
        c[j] = -a[j];
    }
}

//: cx_product
/* A sum of products of numbers in lanes: of each there are the real parts, the imaginary parts, and
 * these with the other sign.
 */
static void cx_product(int count, const double *const *a, const double *const *b, int is_complex, double *c)
{
    enum { L = cx_lanes, MOST = 2 * CX_CHOICES };
    if (!is_complex) {
        cx_dot(count, a, b, c);
        return;
    }
    const double *p[MOST] = {NULL}, *q[MOST] = {NULL};
    for (int part = 0; part < 2; part++) {
        for (int k = 0; k < count; k++) {
            p[2 * k] = a[k];
            q[2 * k] = b[k] + L * part;
            p[2 * k + 1] = a[k] + L * (2 - part);
            q[2 * k + 1] = b[k] + L * (1 - part);
        }
        cx_dot(2 * count, p, q, c + L * part);
    }
    cx_negated(c + L, c + 2 * L);
}

//: cx_rescale
/* Divide numbers by their largest part in each lane, and add its logarithm to growth. */
static void cx_rescale(double *number, int count, int is_complex, double *growth)
{
    enum { L = cx_lanes };
    double most[L] = {0.0};
    for (int i = 0; i < 3 * count; i += is_complex ? 1 : 3) {
        for (int j = 0; j < L; j++) {
            const double size = fabs(number[L * i + j]);
            most[j] = size > most[j] ? size : most[j];
        }
    }
    for (int j = 0; j < L; j++) {
        most[j] = most[j] > 0.0 ? most[j] : 1.0;
        growth[j] += log(most[j]);
    }
    for (int i = 0; i < 3 * count; i += is_complex ? 1 : 3) {
        for (int j = 0; j < L; j++) {
            number[L * i + j] /= most[j];
        }
    }
}

//: cx_bordered
/* Minors of two rows of z y, from those of y: the upper half of z p z', where p holds these and is
 * antisymmetric. work has room for the n^2 of z p, turned for the minors with the other sign.
 */
static void cx_bordered(int n, const int *choice, const double *z, const double *minor, int is_complex,
                        double *work, double *turned, double *grown)
{
    enum { W = 3 * cx_lanes };
    const double *a[CX_ORDER], *b[CX_ORDER];
    for (int c = 0; c < n * (n - 1) / 2; c++) {
        for (int part = 0; part <= 2 * is_complex; part++) {
            cx_negated(minor + W * c + cx_lanes * part, turned + W * c + cx_lanes * part);
        }
    }
    for (int j = 0; j < n; j++) {
        int count = 0;
        for (int c = 0; c < n * (n - 1) / 2; c++) {
            const int *const rows = choice + 4 * c;
            if (rows[0] == j || rows[1] == j) {
                a[count] = z + W * rows[rows[0] == j];
                b[count++] = (rows[0] == j ? turned : minor) + W * c;
            }
        }
        for (int i = 0; i < n; i++) {
            cx_product(count, a, b, is_complex, work + W * (n * i + j));
            for (int k = 0; k < count; k++) {
                a[k] += W * n;
            }
        }
    }
    for (int c = 0; c < n * (n - 1) / 2; c++) {
        for (int k = 0; k < n; k++) {
            a[k] = work + W * (n * choice[4 * c] + k);
            b[k] = z + W * (n * choice[4 * c + 1] + k);
        }
        cx_product(n, a, b, is_complex, grown + W * c);
    }
}

//: cx_through
/* Minors of the product of all pieces, and the logarithms of the scales of their sizes, in some lanes. */
static void cx_through(cx_pieces *kept, const double *base, int is_complex, const int *is_wanted)
{
    enum { L = cx_lanes, W = 3 * cx_lanes };
    const int *const plan = kept->member->plan;
    const int n = plan[0], bases = plan[2], products = plan[3], largest = plan[plan[5]];
    const int *const starts = plan + plan[6], *const wanted = starts + 1 + 2 * starts[0];
    const int *exponent = plan + 7 + plan[1] * (2 + bases + products), *choice[CX_ORDER + 1];
    int count[CX_ORDER + 1] = {0, n}, chosen[CX_ORDER + 1] = {0};
    double growth[CX_ORDER + 1][L] = {{0.0}};
    double *const power = kept->work, *level[CX_ORDER + 1] = {NULL, power + W * products};
    /* Of the matrix there is one with the other sign, too. */
    double *const negative = level[1] + W * n * n;
    const double *a[CX_CHOICES], *b[CX_CHOICES];
    double *state[CX_ORDER + 1], *spare[CX_ORDER + 1], *end;
    choice[1] = plan + plan[5] + 1;
    for (int q = 2, before = 0; q <= largest; q++) {
        choice[q] = choice[q - 1] + 2 * (q - 1) * before;
        before = count[q] = *choice[q]++;
        level[q] = q == 2 ? negative + W * n * n : level[q - 1] + W * count[q - 1] * count[q - 1];
    }
    /* Starts come in order of their sizes; after those of one size there is room for what they become. */
    end = largest > 1 ? level[largest] + W * count[largest] * count[largest] : negative + W * n * n;
    for (int q = 1; q <= largest; q++) {
        state[q] = end;
        for (int k = 0; k < starts[0]; k++) {
            for (int i = 0; i < count[q] && starts[1 + 2 * k] == q; i++, end += W) {
                for (int j = 0; j < W; j++) {
                    end[j] = i == starts[2 + 2 * k] && j < L ? 1.0 : 0.0;
                }
                chosen[q]++;
            }
        }
        spare[q] = end;
        end += W * chosen[q];
    }
    /* Two sets of minors are sooner multiplied by the matrix twice than by its minors. */
    const int is_bordered = largest == 2 && n > 2 && chosen[2] <= 2 * count[2];
    for (int m = 0; m < products; m++) {
        /* A product before it, times bases. */
        const int *const power_of = exponent + bases * m;
        int from = 0, left = 0;
        for (int i = 0; i < bases; i++) {
            left += power_of[i];
        }
        for (int before = 1; before < m; before++) {
            int more = 0, divides = 1;
            for (int i = 0; i < bases; i++) {
                const int own = power_of[i] - exponent[bases * before + i];
                divides &= own >= 0;
                more += own;
            }
            from = divides && more < left ? before : from;
            left = divides && more < left ? more : left;
        }
        b[0] = power + W * from;
        for (int j = 0; j < W && m == 0; j++) {
            power[j] = j < L ? 1.0 : 0.0;
        }
        for (int i = 0; i < bases; i++) {
            for (int k = exponent[bases * from + i]; k < power_of[i]; k++, left--) {
                /* What comes behind the powers is not in use yet. */
                double *const made = left % 2 ? power + W * m : level[1];
                a[0] = base + W * i;
                cx_product(1, a, b, is_complex, made);
                b[0] = made;
            }
        }
    }
    for (int piece = 0; piece < kept->pieces; piece++) {
        const double *const coefficient = kept->coefficient + (size_t)kept->count * (size_t)piece;
        const int *const at = kept->place + n * n + 1 + kept->count;
        for (int i = 0; i < n * n; i++) {
            const int begin = kept->place[i], number = kept->place[i + 1] - begin;
            double *const entry = level[1] + W * i;
            for (int part = 0; part <= 2 * is_complex; part++) {
                cx_combined(number, coefficient + begin, power + L * part, at + begin, L, entry + L * part);
                if (largest > 1 && !is_bordered) {
                    cx_negated(entry + L * part, negative + W * i + L * part);
                }
            }
        }
        for (int q = 2; q <= largest && !is_bordered; q++) {
            /* Expanded along the first rows. */
            for (int i = 0; i < count[q]; i++) {
                const int *const rows = choice[q] + 2 * q * i;
                for (int j = 0; j < count[q]; j++) {
                    const int *const columns = choice[q] + 2 * q * j;
                    for (int k = 0; k < q; k++) {
                        a[k] = (k % 2 ? negative : level[1]) + W * (n * rows[0] + columns[k]);
                        b[k] = level[q - 1] + W * (count[q - 1] * rows[q] + columns[q + k]);
                    }
                    cx_product(q, a, b, is_complex, level[q] + W * (count[q] * i + j));
                }
            }
        }
        for (int q = 1; q <= largest; q++) {
            double *const grown = spare[q];
            for (int i = 0; i < chosen[q]; i++) {
                if (q == 2 && is_bordered) {
                    if (i % count[q] == 0) {
                        cx_bordered(n, choice[q], level[1], state[q] + W * i, is_complex, negative,
                                    level[2], grown + W * i);
                    }
                    continue;
                }
                for (int k = 0; k < count[q]; k++) {
                    a[k] = level[q] + W * (count[q] * (i % count[q]) + k);
                    b[k] = state[q] + W * (i - i % count[q] + k);
                }
                cx_product(count[q], a, b, is_complex, grown + W * i);
            }
            spare[q] = state[q];
            state[q] = grown;
            /* Waves grow by e^3 on a piece. */
            if (piece % 8 == 7 || piece == kept->pieces - 1) {
                cx_rescale(grown, chosen[q], is_complex, growth[q]);
            }
        }
    }
    for (int j = 0; j < L; j++) {
        cx *const minor = kept->minor + j * (wanted[0] + n);
        for (int w = 0; w < wanted[0] && is_wanted[j]; w++) {
            const int q = starts[1 + 2 * wanted[1 + 2 * w]];
            const double *own = state[q] + W * wanted[2 + 2 * w] + j;
            for (int k = 0; k < wanted[1 + 2 * w]; k++) {
                own += starts[1 + 2 * k] == q ? W * count[q] : 0;
            }
            minor[w] = cx_of(own[0], is_complex ? own[L] : 0.0);
        }
        for (int q = 1; q <= n && is_wanted[j]; q++) {
            minor[wanted[0] + q - 1] = cx_of(q <= largest ? growth[q][j] : 0.0, 0.0);
        }
    }
}

//: cx_minors
/* Make the minors of a member over the scales of their sizes, then the logarithms of these, at some s. */
static void cx_minors(cx_pieces *kept, const PARAMETERS *p, const cx *s, int count)
{
    enum { L = cx_lanes };
    const int *const plan = kept->member->plan;
    const int n = plan[0], parts = plan[1], bases = plan[2], products = plan[3];
    const int width = plan[plan[6] + 1 + 2 * plan[plan[6]]] + n;
    const size_t total = (size_t)(products * n * n);
    int octave[L][CX_ORDER];
    double base[3 * L * CX_ORDER];
    cx given[2 + CX_ORDER], reduced[L][CX_ORDER];
    int is_left[L];
    for (int j = 0; j < count; j++) {
        for (int w = 0; w < width; w++) {
            kept->minor[j * width + w] = cx_of(NAN, NAN);
        }
        kept->member->at(s[j], p, given);
        is_left[j] = 1;
        for (int b = 0; b < bases; b++) {
            const double size = cx_abs(given[2 + b]);
            is_left[j] &= size < HUGE_VAL;
            /* Frequencies within a factor of four share their pieces. */
            int exponent = 0;
            (void)frexp(is_left[j] && size > 0.0 ? size : 1e-300, &exponent);
            octave[j][b] = (exponent + 4003) / 4 - 1000;
            reduced[j][b] = cx_scale(ldexp(1.0, -4 * octave[j][b]), given[2 + b]);
        }
    }
    for (int first = 0; first < count; first++) {
        int is_wanted[L] = {0}, is_complex = 0, is_new = kept->pieces < 0;
        for (int b = 0; b < bases && is_left[first]; b++) {
            is_new = is_new || octave[first][b] != kept->octave[b];
            kept->octave[b] = octave[first][b];
        }
        if (!is_left[first]) {
            continue;
        }
        if (is_new) {
            const size_t room = 2 * (cx_room + 1) * total + (cx_room + 2) * (size_t)parts;
            const int *const exponent = plan + 7 + parts * (2 + bases + products);
            double *const scale = malloc(room * sizeof *scale);
            int *const sum = malloc((size_t)(products * products) * sizeof *sum);
            const cx_law law = {kept->member->along, kept->member->begun, p, plan, kept->octave, given[0].re,
                                given[1].re, scale, sum};
            kept->pieces = 0;
            for (int k = 0; k < products * products && sum; k++) {
                sum[k] = -1;
                for (int m = 0; m < products; m++) {
                    int is_same = 1;
                    for (int b = 0; b < bases; b++) {
                        const int other = exponent[bases * (k % products) + b];
                        is_same &= exponent[bases * m + b] == exponent[bases * (k / products) + b] + other;
                    }
                    sum[k] = is_same ? m : sum[k];
                }
            }
            if (scale && sum) {
                cx_scales(&law, law.length);
                cx_cut(&law, scale + parts, kept);
            }
            free(scale);
            free(sum);
        }
        for (int j = 0; j < L; j++) {
            is_wanted[j] = j < count && is_left[j];
            for (int b = 0; b < bases && is_wanted[j]; b++) {
                is_wanted[j] &= octave[j][b] == kept->octave[b];
            }
            for (int b = 0; b < bases; b++) {
                const cx own = reduced[is_wanted[j] ? j : first][b];
                base[3 * L * b + j] = own.re;
                base[3 * L * b + L + j] = own.im;
                base[3 * L * b + 2 * L + j] = -own.im;
                is_complex |= own.im != 0.0;
            }
        }
        if (kept->pieces > 0) {
            cx_through(kept, base, is_complex, is_wanted);
        }
        for (int j = 0; j < count; j++) {
            is_left[j] &= !is_wanted[j];
        }
    }
}

//: cx_follow
/* Put values in the place of some s, no more than there are lanes: functions of the minors of all members. */
static void cx_follow(cx_pieces *kept, int members,
                      cx (*value)(cx s, const PARAMETERS *p, const cx_pieces *kept),
                      const PARAMETERS *p, cx *s, int count)
{
    int is_made = 1;
    for (int k = 0; k < members && is_made; k++) {
        const int *const plan = kept[k].member->plan;
        const size_t width = (size_t)(plan[plan[6] + 1 + 2 * plan[plan[6]]] + plan[0]);
        if (kept[k].minor == NULL) {
            kept[k].minor = malloc(cx_lanes * width * sizeof *kept[k].minor);
            kept[k].work = malloc(3 * cx_lanes * (size_t)plan[4] * sizeof *kept[k].work);
        }
        is_made = kept[k].minor && kept[k].work;
        if (is_made) {
            cx_minors(kept + k, p, s, count);
        }
    }
    for (int j = 0; j < count; j++) {
        for (int k = 0; k < members && is_made; k++) {
            const int *const plan = kept[k].member->plan;
            kept[k].now = kept[k].minor + j * (plan[plan[6] + 1 + 2 * plan[plan[6]]] + plan[0]);
        }
        s[j] = is_made ? value(s[j], p, kept) : cx_of(NAN, NAN);
    }
}

//: cx_total
/* A sum of amplitudes times exponentials over the largest one, and the logarithm of that. */
static void cx_total(const cx *amplitude, const cx *exponent, int n, cx *value)
{
    double growth = -HUGE_VAL;
    value[0] = cx_of(0.0, 0.0);
    for (int k = 0; k < n; k++) {
        growth = !(exponent[k].re <= growth) ? exponent[k].re : growth;
    }
    for (int k = 0; k < n; k++) {
        const cx left = cx_exp(cx_of(exponent[k].re - growth, exponent[k].im));
        value[0] = cx_add(value[0], cx_mul(amplitude[k], left));
    }
    value[1] = cx_of(growth, 0.0);
}

//: cx_circle
/* Numerator over denominator at s, each the mean of its values on a circle around s,
 * because the formula itself is singular near s though they are not. At z, parts gives
 * numerator, denominator, the logarithm of the factor that both were divided by, and
 * the radius.
 */
static cx cx_circle(void (*parts)(cx z, const PARAMETERS *p, cx *value),
                    cx s, const PARAMETERS *p, int points)
{
    cx value[4], num = cx_of(0.0, 0.0), den = cx_of(0.0, 0.0);
    parts(s, p, value);
    const cx growth = value[2];
    const double radius = value[3].re;
    for (int k = 0; k < points; k++) {
        const cx turn = cx_cis(6.283185307179586 * (k + 0.5) / points);
        parts(cx_add(s, cx_scale(radius, turn)), p, value);
        const cx scale = cx_exp(cx_sub(value[2], growth));
        num = cx_add(num, cx_mul(value[0], scale));
        den = cx_add(den, cx_mul(value[1], scale));
    }
    return cx_div(num, den);
}

//: LANES
#define LANES 32

//: ROUNDER
/* Elementary functions without branches, so that compilers can compute several values at a time.
 * They need IEEE arithmetic that is not reordered, and double rounded to double.
 */
#define LANES 32
#if !defined(__FAST_MATH__) && defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 1)

/* Added to a number and subtracted again, it rounds to an integer. */
#define ROUNDER 6755399441055744.0

//: lane_bits lane_double
static inline uint64_t lane_bits(double x)
{
    uint64_t u;
    memcpy(&u, &x, sizeof u);
    return u;
}

static inline double lane_double(uint64_t u)
{
    double x;
    memcpy(&x, &u, sizeof x);
    return x;
}

//: lane_tan
/* Sine and cosine as in fdlibm (Sun Microsystems 1993), of x - k pi/2; they change places if k is odd. */
static inline double lane_tan(double x)
{
    const double t = x * 0.6366197723675814 + ROUNDER;
    const double k = t - ROUNDER;
    const uint64_t odd = UINT64_C(0) - (lane_bits(t) & 1);
    const double y = (x - k * 1.5707963267341256) - k * 6.077100506506192e-11;
    const double z = y * y, z_2 = z * z;
    const double sine = y + y * z * ((-0.16666666666666632 + z * 0.00833333333332249)
        + z_2 * ((-0.0001984126982985795 + z * 2.7557313707070068e-06)
        + z_2 * (-2.5050760253406863e-08 + z * 1.58969099521155e-10)));
    const double cosine = 1.0 - (0.5 * z - z_2 * ((0.0416666666666666
        - z * 0.001388888888887411) + z_2 * ((2.480158728947673e-05
        - z * 2.7557314351390663e-07) + z_2 * (2.087572321298175e-09
        - z * 1.1359647557788195e-11))));
    const uint64_t change = (lane_bits(sine) ^ lane_bits(-cosine)) & odd;
    const uint64_t sign = odd & (UINT64_C(1) << 63);
    return lane_double(lane_bits(sine) ^ change) / lane_double(lane_bits(cosine) ^ change ^ sign);
}

//: lane_expm1
/* exp(x) = *scale (1 + value); beyond |x| = 708 as at 708. */
static inline double lane_expm1(double x, double *scale)
{
    const uint64_t bits = lane_bits(x), limit = lane_bits(708.0);
    const uint64_t size = bits & ~(UINT64_C(1) << 63);
    const uint64_t is_large = UINT64_C(0) - ((limit - size) >> 63);
    const double y = lane_double((bits ^ size) | (size & ~is_large) | (limit & is_large));
    const double t = y * 1.4426950408889634 + ROUNDER;
    const double k = t - ROUNDER;
    const double r = (y - k * 0.6931471803691238) - k * 1.9082149292705877e-10;
    const double r_2 = r * r, r_4 = r_2 * r_2;
    *scale = lane_double((lane_bits(t) + 1023) << 52);
    return r + r_2 * ((0.5 + r * 0.16666666666666669)
        + r_2 * (0.04166666666662348 + r * 0.008333333333330011)
        + r_4 * ((0.0013888888917538296 + r * 0.00019841269863303223)
        + r_2 * (2.4801520792572694e-05 + r * 2.75572680728901e-06)
        + r_4 * (2.762032742826824e-07 + r * 2.5100569275813683e-08)));
}

//: lane_exp
static inline double lane_exp(double x)
{
    double scale;
    const double rest = lane_expm1(x, &scale);
    return scale + scale * rest;
}

//: lane_tanh
static inline double lane_tanh(double x)
{
    double scale;
    const double rest = lane_expm1(-2.0 * x, &scale);
    return ((1.0 - scale) - scale * rest) / ((1.0 + scale) + scale * rest);
}

//: OTHERWISE
#else

OTHERWISE

#endif

//: complex_of
#ifndef __STDC_NO_COMPLEX__
static double complex complex_of(cx z)
{
    union { double part[2]; double complex whole; } value;
    value.part[0] = z.re;
    value.part[1] = z.im;
    return value.whole;
}
#endif
