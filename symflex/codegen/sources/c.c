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

//: cx_pair
/* (z - s) (conj z - s), where z = a + da + j (b + db) is known to more digits than a double has. */
static inline cx cx_pair(cx s, double b, double db, double a, double da)
{
    const double re = a - s.re + da;
    return cx_mul(cx_of(re, b - s.im + db), cx_of(re, -b - s.im - db));
}

//: cx_axial
static inline double cx_axial(double w, double b, double db)    /* the same where a = 0 and s = j w */
{
    return (b - w + db) * (b + w + db);
}

//: cx_two
static inline double cx_two(double w, double a)    /* (a - s) (a + s) at s = j w */
{
    return a * a + w * w;
}

//: cx_four
static inline double cx_four(double w, double b, double db, double a)    /* of a + j b and its images */
{
    const double near = b - w + db, far = b + w + db;
    return (near * near + a * a) * (far * far + a * a);
}

//: cx_mirrored
static inline cx cx_mirrored(cx s, double a, double da)    /* (a - s) (a + s), with a to more digits */
{
    return cx_mul(cx_of(a - s.re + da, -s.im), cx_of(a + s.re + da, s.im));
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

//: lane_exp
/* Beyond |x| = 708 as at 708. */
static inline double lane_exp(double x)
{
    const uint64_t bits = lane_bits(x), limit = lane_bits(708.0);
    const uint64_t size = bits & ~(UINT64_C(1) << 63);
    const uint64_t is_large = UINT64_C(0) - ((limit - size) >> 63);
    const double y = lane_double((bits ^ size) | (size & ~is_large) | (limit & is_large));
    const double t = y * 1.4426950408889634 + ROUNDER;
    const double k = t - ROUNDER;
    const double r = (y - k * 0.6931471803691238) - k * 1.9082149292705877e-10;
    const double r_2 = r * r, r_4 = r_2 * r_2;
    const double scale = lane_double((lane_bits(t) + 1023) << 52);
    return scale + scale * (r + r_2 * ((0.5 + r * 0.16666666666666669)
        + r_2 * (0.04166666666662348 + r * 0.008333333333330011)
        + r_4 * ((0.0013888888917538296 + r * 0.00019841269863303223)
        + r_2 * (2.4801520792572694e-05 + r * 2.75572680728901e-06)
        + r_4 * (2.762032742826824e-07 + r * 2.5100569275813683e-08))));
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
