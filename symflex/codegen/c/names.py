"""Identifiers that a name of a model cannot have in C, because they mean something else there."""

from __future__ import annotations

from symflex.codegen.source_parts import parts_of

PARTS = parts_of("c.c")

KEYWORDS = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile
    while asm fortran typeof near far huge interrupt
    alignas alignof bool constexpr false nullptr static_assert thread_local true typeof_unqual
    and and_eq bitand bitor catch char16_t char32_t char8_t class co_await co_return co_yield compl concept
    const_cast consteval constinit decltype delete dynamic_cast explicit export final friend import module
    mutable namespace new noexcept not not_eq operator or or_eq override private protected public
    reinterpret_cast requires static_cast template this throw try typeid typename using virtual wchar_t xor
    xor_eq
    """.split()
)
"""Of C up to C23, of C++, whose programs include the header, and of compilers for small machines."""

MACROS = frozenset(
    """
    I J complex imaginary CMPLX CMPLXF CMPLXL NULL offsetof errno EDOM ERANGE EILSEQ assert NDEBUG EOF stdin
    stdout stderr BUFSIZ RAND_MAX CLOCKS_PER_SEC INFINITY NAN HUGE HUGE_VAL HUGE_VALF HUGE_VALL MAXFLOAT
    FP_FAST_FMA FP_ILOGB0 FP_ILOGBNAN FP_INFINITE FP_NAN FP_NORMAL FP_SUBNORMAL FP_ZERO MATH_ERRNO
    MATH_ERREXCEPT math_errhandling DOMAIN SING OVERFLOW UNDERFLOW PLOSS TLOSS X_TLOSS
    M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI M_SQRT2 M_SQRT1_2 M_TWOPI
    PI TWO_PI HALF_PI EULER DEG_TO_RAD RAD_TO_DEG HIGH LOW INPUT OUTPUT DEFAULT F
    FLT_EVAL_METHOD FLT_RADIX FLT_ROUNDS DECIMAL_DIG SIZE_MAX PTRDIFF_MAX PTRDIFF_MIN WCHAR_MAX WCHAR_MIN
    SIG_ATOMIC_MAX SIG_ATOMIC_MIN WINT_MAX WINT_MIN UINT8_C UINT16_C UINT32_C UINT64_C INT8_C INT16_C INT32_C
    INT64_C INTMAX_C UINTMAX_C LANES ROUNDER
    unix linux i386 i486 i586 i686 sun vax mips hpux sgi arm pdp11 m68k sparc BSD
    min max small hyper interface pascal cdecl stdcall IN OUT OPTIONAL CONST VOID FAR NEAR TRUE FALSE ERROR
    BOOL DELETE STRICT
    fpclassify isfinite isgreater isgreaterequal isinf isless islessequal islessgreater isnan isnormal
    isunordered signbit signgam
    """.split()
    + [
        f"{kind}_{limit}"
        for kind in ("FLT", "DBL", "LDBL")
        for limit in "DIG EPSILON MANT_DIG MAX MAX_10_EXP MAX_EXP MIN MIN_10_EXP MIN_EXP".split()
    ]
    + [
        f"{sign}INT{kind}_{limit}"
        for sign in ("", "U")
        for kind in ("MAX", "PTR", *(f"{k}{n}" for k in ("", "_FAST", "_LEAST") for n in (8, 16, 32, 64)))
        for limit in ("MAX", "MIN")
    ]
)
"""Of the headers that the code includes, of compilers that define names without underscores, and of headers
that firmware and Windows programs often include first."""

FUNCTIONS = frozenset(
    """
    main size_t ptrdiff_t
    sqrt exp log log2 ldexp ceil fmax fmin sin cos tan sinh cosh tanh fabs hypot pow copysign
    creal cimag
    memcpy uint64_t
    """.split()
).union(*PARTS)
"""What the code calls, and the types it uses."""

LOCALS = frozenset("s p omega n i j w x g re im real imag sign value padded near is_near count".split())
"""Arguments and variables that every function has under these names."""

RESERVED = KEYWORDS | MACROS
"""What a member of the structure of parameters cannot be called."""

TAKEN = RESERVED | FUNCTIONS | LOCALS
"""What a variable cannot be called besides."""
