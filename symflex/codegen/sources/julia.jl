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
