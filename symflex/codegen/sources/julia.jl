# What generated Julia code calls: parts, each under a line that says what it defines.

#: _mean_over_circle
"""
Numerator over denominator, each the mean of its values on a circle.

Both are analytic, so the mean is the value at the center s, where the formula itself cancels.
`parts` returns numerator, denominator, the logarithm of what both were divided by, and the
radius.
"""
function _mean_over_circle(parts, s, points)
    _, _, center, radius = parts(s)
    num, den = zero(s), zero(s)
    for k in 0:(points - 1)
        turn = cis(2 * pi * (k + 0.5) / points)
        above, below, growth, _ = parts(s + radius * turn)
        scale = exp(growth - center)
        num += above * scale
        den += below * scale
    end
    return num / den
end

#: _series_solutions
"""
Solutions of a linear differential equation at 1, by Taylor series.

The equation is y^(n) + c[n] y^(n-1) + ... + c[1] y = 0; solution k starts from y^(k-1)(0) = 1
and zeros for the other derivatives below n.
"""
function _series_solutions(c, terms)
    n = length(c)
    found = zeros(eltype(c), n)
    first = 1.0
    for k in 1:n
        derivatives = zeros(eltype(c), n)
        derivatives[k] = 1
        total = derivatives[k] / first
        first *= k
        divisor = 1.0
        for m in 1:(terms - 1)
            divisor *= m
            m < n && continue
            following = zero(eltype(c))
            for i in 1:n
                if !iszero(c[i])
                    following -= c[i] * derivatives[i]
                end
            end
            derivatives = [derivatives[2:n]; following]
            total += following / divisor
        end
        found[k] = total
    end
    return found
end

#: _propagated
"""
h, h', ..., h^(n-1) at 1 for coefficients of any size.

h solves h^(n) + c[n] h^(n-1) + ... + c[1] h = 0 and starts from h^(n-1)(0) = 1 and zeros. The
exponential of the companion matrix, by scaling and squaring.
"""
function _propagated(c)
    n = length(c)
    all(isfinite, c) || return fill(complex(NaN, NaN), n)
    largest = max(maximum(abs(c[i])^(1 / (n - i + 1)) for i in 1:n), 1e-30)
    companion = zeros(ComplexF64, n, n)
    for i in 1:(n - 1)
        companion[i, i + 1] = largest
    end
    for i in 1:n
        companion[n, i] -= c[i] / largest^(n - i)
    end
    halvings = ceil(Int, log2(max(largest, 1.0))) + 3
    small = companion / 2.0^halvings
    identity = [ComplexF64(i == k) for i in 1:n, k in 1:n]
    grown = identity
    for m in 18:-1:1
        grown = identity + small * grown / m
    end
    for _ in 1:halvings
        grown = grown * grown
    end
    return [grown[k, n] * largest^float(k - n) for k in 1:n]
end

#: _characteristic_roots _refined
"""
Roots of x^n + c[n] x^(n-1) + ... + c[1], and the least distance of two.

Eigenvalues of the companion matrix, then steps of Aberth and Ehrlich, which give small roots
besides large ones their digits.
"""
function _characteristic_roots(c)
    n = length(c)
    all(isfinite, c) || return fill(complex(NaN, NaN), n + 1)
    largest = max(maximum(abs(c[i])^(1 / (n - i + 1)) for i in 1:n), 1e-30)
    scaled = [ComplexF64(c[i]) / largest^(n - i + 1) for i in 1:n]
    companion = zeros(ComplexF64, n, n)
    for i in 1:(n - 1)
        companion[i, i + 1] = 1
    end
    for i in 1:n
        companion[n, i] -= scaled[i]
    end
    x = LinearAlgebra.eigvals(companion)
    for _ in 1:(n > 1 ? 8 : 0)
        x = [_refined(x, i, scaled) for i in 1:n]
    end
    least = Inf
    for i in 1:n, k in 1:n
        if i != k
            least = min(least, abs(x[i] - x[k]))
        end
    end
    return [x .* largest; complex(least * largest)]
end

"""One root after a step of Aberth and Ehrlich."""
function _refined(x, i, scaled)
    value, slope = one(ComplexF64), zero(ComplexF64)
    for k in length(scaled):-1:1
        slope = slope * x[i] + value
        value = value * x[i] + scaled[k]
    end
    away = zero(ComplexF64)
    for other in x
        if other != x[i]
            away += 1.0 / (x[i] - other)
        end
    end
    change = value / (slope - value * away)
    return abs(change) < 1.0 ? x[i] - change : x[i]
end

#: _mode_values _modal_value
"""
Exponents of all roots at a length, and x^k/chi'(x) of each for k = 0, 1, ...

The last of `roots` is their least distance, which is left out.
"""
function _mode_values(roots, len)
    n = length(roots) - 1
    powers = Vector{ComplexF64}[]
    for i in 1:n
        slope = one(ComplexF64)
        for k in 1:n
            if k != i
                slope *= roots[i] - roots[k]
            end
        end
        own = [1.0 / slope]
        for _ in 2:n
            push!(own, own[end] * roots[i])
        end
        push!(powers, own)
    end
    return [roots[i] * len for i in 1:n], powers
end

"""A sum of exponentials over the largest one, and the logarithm of that."""
function _modal_value(modes, coefficients, frames)
    found = Tuple{ComplexF64, ComplexF64}[]
    for (slots, terms, keys) in frames, (key, divisor) in keys
        # One slot after the other; terms with the same orders left are summed.
        left = Tuple{Tuple{Vararg{Int}}, ComplexF64}[(orders, coefficients[i]) for (orders, i) in terms]
        exponent = zero(ComplexF64)
        for (slot, root) in zip(slots, key)
            exponents, powers = modes[slot]
            exponent += exponents[root]
            merged = Tuple{Tuple{Vararg{Int}}, ComplexF64}[]
            for (orders, value) in left
                term = value * powers[root][orders[1]]
                rest = Base.tail(orders)
                at = findfirst(x -> x[1] == rest, merged)
                if at === nothing
                    push!(merged, (rest, term))
                else
                    merged[at] = (rest, merged[at][2] + term)
                end
            end
            left = merged
        end
        push!(found, (left[1][2] / divisor, exponent))
    end
    growth = maximum(real(exponent) for (_, exponent) in found)
    total = zero(ComplexF64)
    for (amplitude, exponent) in found
        total += amplitude * exp(exponent - growth)
    end
    return [total, complex(growth)]
end
