"""Names and texts that mean something in a language that code is exported to, and models that have them.

They are written down here, not taken from the program, so that a name it forgets to leave alone is noticed.
"""

import builtins
import keyword
from dataclasses import replace

from symflex import pipeline
from symflex.expressions import Name, substitute

HOSTILE = [
    '"""', "'''", '"""\nimport os\nos.abort()\n"""', 'r"""', "\\", "\\\\", '\\"""', '\\\\"""',
    "ends with a backslash \\", 'ends with a quote "', "ends with a quote '", "\n", "\r", "\r\nimport os",
    "line\nbreak", "\x0bvertical tab", "\x0cform feed", "\x1cfile separator", "\x85next line",
    "\u2028line separator", "\u2029paragraph separator", "\x00nul", "\x07bell", "\x08\x08backspace",
    "\x1b[31mred", "\x7fdelete", "\u202eright to left override", "\u2066isolate\u2069", "\u200bzero width",
    "\u200djoiner", "\ufeffbyte order mark", "\ud800lone surrogate", "\U000e0001tag", "\U0001f600 emoji",
    "\N{CYRILLIC SMALL LETTER A}", "\N{FULLWIDTH QUOTATION MARK}" * 3, "a\u0301combining",
    "# coding: utf-7", "-*- coding: utf-16 -*-", "# type: ignore", "# noqa", "# ruff: noqa",
    ">>> import os; os.abort()", "x >>> 1/0", ">>> >>> >>>1/0", "... 1/0", ".. include:: /etc/passwd",
    ".. raw:: html", "{0.__class__}", "{m}", "%s%n", "${HOME}", "$(reboot)", "`reboot`", "\\N{DIGIT ONE}",
    "\\x41", "\\u0041", "\\U0001F600", "\\8", "__import__('os').abort()", "1); import os; os.abort(); (1",
    "1 if 1 else", "lambda: 0", "*args", "a, b=1/0", "a: int = 1/0", "m=1/0", ") -> None: ...", "]}",
    "@decorator", "Parameters\n----------", "Returns", " ", "\t", "x" * 5000, "y " * 300,
    "<script>alert(1)</script>", "\\begin{document}", "=cmd|' /C calc'!A0",
]  # fmt: skip
"""What could end a docstring, a string or a line of it, or be obeyed in one."""

IN_COMMENTS = [
    "*/", "*/ int main(void) { abort(); } /*", "/* */", "**//", "*\\", "*\\\n/", "??/", "*??/\n/ abort();",
    "??=include </etc/passwd>", "*?" + "?/" * 3, "// \\", "\n#include </etc/passwd>",
    "#define double float", "*\t/", "* /", "*/" * 2000, "/" * 500, "*" * 500, "<::>%:",
]  # fmt: skip
"""What could end a comment of C, or begin something else in one."""

IN_MATLAB = [
    "%{", "%}", "%{\nunlink('x')\n%}", "a ...", "'); unlink('x'); ('", "end\nend\nsystem('ls')",
    "%!test error('ran')", "-*- texinfo -*-\n@include /etc/passwd", '<a href="matlab:exit">see</a>',
    "Copyright of nobody", "x' * y'", "!ls", "%#ok", "%d%s\\x",
]  # fmt: skip
IN_JULIA = [
    "$(run(`ls`))", "$x", "\\$(exit())", "\\\\$(exit())", "$", "```jldoctest\njulia> exit()\n```",
    "```@eval\nexit()\n```", "~~~@eval", "#= comment", "=#", '""" module X; exit(); end', "end # module",
    "@eval exit()", 'raw"',
]  # fmt: skip
TEXTS = tuple(dict.fromkeys([*HOSTILE, *IN_COMMENTS, *IN_MATLAB, *IN_JULIA]))

PYTHON = [
    *keyword.kwlist,
    *keyword.softkwlist,
    *[name for name in dir(builtins) if name.islower() or name.startswith("__")][::4],
    *"complex float abs zip tuple any all isinstance list next iter max min len range sum type bool".split(),
    *"np numpy ArrayLike NDArray annotations arguments self cls jax jnp xp sys cmath math importlib".split(),
    *"Any Array space BLOCK PARAMETERS TRANSFER_FUNCTIONS FREQUENCY_RESPONSES STATES INPUTS OUTPUTS".split(),
    *"_numbers _real_numbers _in_blocks _shape _in_pieces _in_array _in_real_pieces _is_left".split(),
    *"_complex_exp".split(),
    *"_series_solutions _propagated _characteristic_roots _mode_values _modal_amplitudes".split(),
    *"_modal_value _mean_over_circle _namespace _place _serves _found _is_idle _size".split(),
    *"_larger _settled _stacked _largest _root_steps".split(),
    *"_grown _squared _MOST_HALVINGS _matrix_product _in_front".split(),
    *"series_solutions propagated characteristic_roots mode_values modal_amplitudes modal_value".split(),
    *"mean_over_circle state_space exp log sqrt sin cos tan sinh cosh tanh atan real imag where".split(),
    *"asarray value limit is_far inverse num den c_1 t_1 e_1 sum0 z x_ omega omega_ s pi _ l O m k b".split(),
    *"gamma held place PARAMETERS X_over_F _X_over_F A B C D".split(),
]
C = """
    auto break case char const continue default do double else enum extern float for goto if inline int long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile
    while _Bool _Complex _Imaginary asm typeof alignas alignof bool constexpr nullptr static_assert
    thread_local catch class const_cast delete explicit export friend mutable namespace new operator private
    protected public reinterpret_cast template this throw try typeid typename using virtual wchar_t
    I J complex imaginary CMPLX NULL offsetof errno EDOM ERANGE EILSEQ assert NDEBUG EOF stdin stdout stderr
    INFINITY NAN HUGE HUGE_VAL M_PI M_E M_LN2 DBL_EPSILON DBL_MAX FLT_EVAL_METHOD SIZE_MAX UINT64_C LANES
    ROUNDER CX_ORDER unix linux i386 sun vax arm min max near far small PI F main size_t ptrdiff_t uint64_t
    memcpy hypot pow copysign fabs fmax fmin ldexp log2 ceil creal cimag isnan isfinite signbit j0 y1 gamma
    cx cx_of cx_add cx_mul cx_div cx_roots cx_mode cx_modes cx_modal cx_exponent cx_matrix cx_propagated
    cx_step cx_size cx_series cx_circle complex_of lane_exp p omega n i j w g re im sign padded plan sums
    modes coefficients plant_parameters plant_defaults value_of_X_over_F piece_0_of_X_over_F __LINE__
    __FILE__ __cplusplus __STDC_VERSION__
""".split()
JULIA = """
    baremodule begin end function module quote let local macro mutable outer where isa public import
    nothing missing undef im Inf NaN ans Base Main Core Number Real Complex Float64 Int Dict String Function
    NamedTuple LinearAlgebra conj eval include ccall signbit float zeros ones eigvals Vector Matrix
    TransferFunctions ComplexF64 pairs haskey @show var if for while const true false in e exp abs sqrt
    complex real s z number k p PARAMETERS TRANSFER_FUNCTIONS X_over_F _X_over_F value
""".split()
JAVASCRIPT = """
    arguments await class const delete enum eval export extends function import in instanceof interface let
    new null package static super this throw typeof undefined var void with yield Infinity NaN Math Object
    Array Float64Array globalThis window document self imaginary quotient size root solutions circle over
    given checked evaluated offered piece_0 value_0 number values s_re s_im into
    p r_1 t_1_re PARAMETERS TRANSFER_FUNCTIONS
    X_over_F value_of_X_over_F constructor prototype toString hasOwnProperty valueOf
""".split()
MATLAB = """
    elseif endfunction endif endwhile endfor end_try_catch unwind_protect until parfor spmd classdef methods
    events properties enumeration otherwise persistent varargin varargout nargin nargout eps Inf e inputname
    numel size zeros ones eye isscalar isreal isfield fieldnames strcmp ischar cellfun repmat reshape find
    any all isfinite eig diag feval evalin assignin clear disp error arrayfun bitand cell columns rows
    everywhere given chosen numbers in_pieces in_real_pieces rows_of default_parameters parameters units
    descriptions transfer_functions frequency_responses G frame slots orders positions keys divisors
    X_over_F_value X_over_F_at X_over_F_0 X_over_F systems coefficients tf zpk ss end function if else for
    while switch case i j pi exp abs sqrt complex real imag s p k z value number model plant
""".split()
TEX = """
    alpha beta lambda mu Omega hat dot text frac left right begin{x} end{document} \\input \\def\\x{} $x$
    a_b_c x^2 50% #1 ~ & {} }{ a{b a}b \\\\ ^^M ^^5c
""".split()
ODD = [
    *"2m a-b a_b a.b - __ a__b _y y lambda_ I_ a/b a'b".split(),
    *("", "a b", 'a"b', "x" * 63, "x" * 64, "x" * 200),
]

NAMES = tuple(dict.fromkeys([*PYTHON, *C, *JULIA, *JAVASCRIPT, *MATLAB, *TEX, *ODD]))
CHOSEN = ("lambda", "complex", "end", "I", "a-b", "a_b", "2m", "x" * 64, "s ", '\'); %} */\n"""\nquit()')
"""One of each kind: a keyword, what code calls, what becomes one identifier with another, what is none."""

SPEC = """
symflex = 1
title = "tame"
source = "tame"
parameters.m = { value = "2 kg", doc = "tame" }
parameters.b = { value = "3 N*s/m", doc = "tame" }
parameters.k = { doc = "tame" }
elements.body = { type = "mass", at = "x", m = "m" }
elements.loss = { type = "damper", between = ["x", "ground"], b = "b" }
elements.spring = { type = "spring", between = ["x", "ground"], k = "sqrt(k*k)" }
inputs.F = { force = "x" }
outputs = { X = "x", V = "s*x" }
"""

SPRINGS = """
symflex = 1
[parameters]
m0 = "2 kg"
b0 = "3 N*s/m"
{values}
[elements]
body = {{ type = "mass", at = "node_q", m = "m0" }}
loss = {{ type = "damper", between = ["node_q", "ground"], b = "b0" }}
spring = {{ type = "spring", between = ["node_q", "ground"], k = "{total}" }}
[inputs]
u_in = {{ force = "node_q" }}
[outputs]
y_out = "node_q"
"""


def renamed(model, mapping):
    """Return the model with parameters renamed, as a program that builds models could name them."""
    to = {old: Name(new) for old, new in mapping.items()}
    parameters = tuple(replace(p, name=mapping.get(p.name, p.name)) for p in model.parameters)
    elements = tuple(
        replace(e, values=tuple((n, substitute(x, to)) for n, x in e.values)) for e in model.elements
    )
    return replace(model, parameters=parameters, elements=elements)


def mass_on_springs(names, spec=SPRINGS):
    """Return a mass on parallel springs whose stiffnesses, 1 N/m, 2 N/m, ... have these names."""
    plain = benign(len(names))
    values = "\n".join(f'{p} = "{i + 1} N/m"' for i, p in enumerate(plain))
    model = pipeline.loads(spec.format(values=values, total=" + ".join(plain)))
    # The formula language has a meaning of its own for two.
    given = [f"{name} " if name in ("s", "pi") else name for name in names]
    return renamed(model, {p: name for p, name in zip(plain, given, strict=True) if p != name})


def benign(count):
    """Return names that mean nothing anywhere."""
    return [f"p{i}" for i in range(count)]


def with_names(tf, outputs, inputs):
    """Return copies of a transfer function for every pair of names."""
    return tuple(
        replace(tf, output=replace(tf.output, name=y), input=replace(tf.input, name=u), solve=None)
        for y, u in zip(outputs, inputs, strict=True)
    )


def with_prose(model, text, parameters=None):
    """Return a model with a text as title and source, and texts as what its parameters are and as units."""
    texts = [text] * len(model.parameters) if parameters is None else parameters
    own = tuple(replace(p, doc=t, unit=t) for p, t in zip(model.parameters, texts, strict=True))
    return replace(model, title=text, source=text, parameters=own)
