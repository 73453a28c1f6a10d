"""Names that mean something in a language that code is exported to, for parameters, inputs and outputs.

They are written down here, not taken from the program, so that a name it forgets to leave alone is noticed.
"""

from __future__ import annotations

import builtins
import keyword
from dataclasses import replace

from symflex import pipeline
from tests.unit.codegen.test_numpy_hostile import renamed

PYTHON = [
    *keyword.kwlist,
    *keyword.softkwlist,
    *(name for name in dir(builtins) if name.islower() or name.startswith("__")),
    *"np numpy ArrayLike NDArray annotations arguments self cls jax jnp xp sys cmath math importlib".split(),
    *"Any Array space BLOCK PARAMETERS TRANSFER_FUNCTIONS FREQUENCY_RESPONSES STATES INPUTS OUTPUTS".split(),
    *"_numbers _real_numbers _in_blocks _shape _in_pieces _in_array _in_real_pieces _is_left".split(),
    *"_complex_exp".split(),
    *"_series_solutions _propagated _characteristic_roots _mode_values _modal_amplitudes".split(),
    *"_modal_value _mean_over_circle _namespace _place _serves _found _is_idle _size".split(),
    *"_larger _settled _stacked _largest _root_steps".split(),
    *"_grown _squared _MOST_HALVINGS _matrix_product _in_front".split(),
    *"series_solutions propagated characteristic_roots mode_values modal_amplitudes modal_value".split(),
    *"mean_over_circle state_space exp log sqrt sin cos tan sinh cosh tanh real imag where asarray".split(),
    *"value limit is_far inverse num den c_1 t_1 sum0 z x_ omega omega_ s pi _ l O m k b".split(),
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
    TransferFunctions ComplexF64 pairs haskey @show var
""".split()
MATLAB = """
    elseif endfunction endif endwhile endfor end_try_catch unwind_protect until parfor spmd classdef methods
    events properties enumeration otherwise persistent varargin varargout nargin nargout eps Inf e inputname
    numel size zeros ones eye isscalar isreal isfield fieldnames strcmp ischar cellfun repmat reshape find
    any all isfinite eig diag feval evalin assignin clear disp error arrayfun bitand cell columns rows
    everywhere given chosen numbers in_pieces in_real_pieces rows_of default_parameters parameters units
    descriptions transfer_functions frequency_responses G frame slots orders positions keys divisors
    X_over_F_value X_over_F_at X_over_F_0
""".split()
TEX = """
    alpha beta lambda mu Omega hat dot text frac left right begin{x} end{document} \\input \\def\\x{} $x$
    a_b_c x^2 50% #1 ~ & {} }{ a{b a}b \\\\ ^^M ^^5c
""".split()
ODD = ["2m", "a-b", "a b", "a.b", "", "-", "__", "a__b", "x" * 63, "x" * 64, "x" * 200, "a/b", "a'b", 'a"b']

NAMES = tuple(dict.fromkeys([*PYTHON, *C, *JULIA, *MATLAB, *TEX, *ODD]))

PARAMETERS = tuple(f"{name} " if name in ("s", "pi") else name for name in NAMES)
"""As names of parameters: the formula language has a meaning of its own for two."""

SPRING = """
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


def mass_on_springs(names):
    """Return a mass on parallel springs whose stiffnesses, 1 N/m, 2 N/m, ... have these names."""
    plain = [f"p{i}" for i in range(len(names))]
    values = "\n".join(f'{p} = "{i + 1} N/m"' for i, p in enumerate(plain))
    model = pipeline.loads(SPRING.format(values=values, total=" + ".join(plain)))
    return renamed(model, {p: name for p, name in zip(plain, names, strict=True) if p != name})


def benign(count):
    """Return names that mean nothing anywhere."""
    return [f"p{i}" for i in range(count)]


def with_names(tf, outputs, inputs):
    """Return copies of a transfer function for every pair of names."""
    return tuple(
        replace(tf, output=replace(tf.output, name=y), input=replace(tf.input, name=u))
        for y, u in zip(outputs, inputs, strict=True)
    )
