% What generated MATLAB code calls: parts, each under a line that says what it defines.

%: numbers
function given = numbers(overrides, names)
%NUMBERS  Values of parameters: those given, and the defaults for the others.
  values = default_parameters();
  if numel(overrides) == 1 && isstruct(overrides{1}) && isscalar(overrides{1})
    fields = fieldnames(overrides{1});
    found = struct2cell(overrides{1});
  elseif mod(numel(overrides), 2) == 0
    fields = overrides(1:2:end);
    found = overrides(2:2:end);
  else
    error('symflex:parameter', 'parameters are a struct, or names and values in turn');
  end
  for k = 1:numel(fields)
    if ~(ischar(fields{k}) || isa(fields{k}, 'string')) || ~isfield(values, fields{k})
      error('symflex:parameter', 'there is no parameter ''%s''', char(fields{k}));
    end
    values.(char(fields{k})) = found{k};
  end
  given = cell(1, numel(names));
  for k = 1:numel(names)
    x = values.(names{k});
    if isempty(x)
      error('symflex:parameter', 'parameter ''%s'' has no value', names{k});
    elseif ~(isnumeric(x) || islogical(x))
      error('symflex:parameter', 'parameter ''%s'' is not a number', names{k});
    end
    given{k} = double(x);
  end
end

%: columns
function [s, given, shape] = columns(s, given)
%COLUMNS  Arguments of one size as columns, numbers among the parameters as they are.
  if ~(isnumeric(s) || islogical(s))
    error('symflex:argument', 'the first argument is not a number');
  end
  total = zeros(size(s));
  for k = 1:numel(given)
    total = total + zeros(size(given{k}));
  end
  shape = size(total);
  s = double(s) .* ones(shape);
  s = s(:);
  for k = 1:numel(given)
    if ~isscalar(given{k})
      x = given{k} .* ones(shape);
      given{k} = x(:);
    end
  end
end

%: everywhere
function value = everywhere(formula, s, given)
%EVERYWHERE  What one formula gives for all elements.
  [s, given, shape] = columns(s, given);
  value = reshape(formula(s, given{:}) .* ones(size(s)), shape);
end

%: in_pieces
function value = in_pieces(number_of, pieces, s, given)
%IN_PIECES  What the piece that serves gives, element by element.
  [s, given, shape] = columns(s, given);
  number = number_of(s, given{:}) + zeros(size(s));
  value = complex(zeros(size(s)));
  for k = unique(number(:)).'
    where = number == k;
    own = chosen(given, where);
    value(where) = pieces{k + 1}(s(where), own{:});
  end
  value = reshape(value, shape);
end

%: in_real_pieces
function value = in_real_pieces(number_of, pieces, omega, given, is_turned)
%IN_REAL_PIECES  The response at angular frequencies of any sign.
%   Pieces give numerator and denominator at a positive frequency, without the
%   factor 1i of a response that is_turned; at a negative one it is conjugate.
  [omega, given, shape] = columns(omega, given);
  if ~(isreal(omega) && all(cellfun(@isreal, given)))
    error('symflex:argument', 'angular frequency and parameters must be real');
  end
  is_negative = omega < 0;
  omega = abs(omega);
  number = number_of(omega, given{:}) + zeros(size(omega));
  value = complex(zeros(size(omega)));
  for k = unique(number(:)).'
    where = number == k;
    own = chosen(given, where);
    [num, den] = pieces{k + 1}(omega(where), own{:});
    found = num ./ den;
    if ~is_turned
      value(where) = found;
    elseif isreal(found)
      value(where) = complex(zeros(size(found)), found);
    else
      value(where) = 1i .* found;
    end
  end
  value(is_negative) = conj(value(is_negative));
  value = reshape(value, shape);
end

%: chosen
function given = chosen(given, where)
%CHOSEN  Elements of columns; numbers stay as they are.
  for k = 1:numel(given)
    if ~isscalar(given{k})
      given{k} = given{k}(where);
    end
  end
end

%: mean_over_circle
function value = mean_over_circle(parts, s, points)
%MEAN_OVER_CIRCLE  Numerator over denominator, each the mean of its values on a circle.
%   Both are analytic, so the mean is the value at the center s, where the formula
%   itself cancels. parts gives numerator, denominator, the logarithm of what both
%   were divided by, and the radius.
  [~, ~, center, radius] = parts(s);
  num = 0;
  den = 0;
  for k = 0:points - 1
    turn = exp(2i .* pi .* (k + 0.5) ./ points);
    [above, below, growth] = parts(s + radius .* turn);
    scale = exp(growth - center);
    num = num + above .* scale;
    den = den + below .* scale;
  end
  value = num ./ den;
end

%: series_solutions
function found = series_solutions(c, terms)
%SERIES_SOLUTIONS  Solutions of a linear differential equation at 1, by Taylor series.
%   The equation is y^(n) + c{n} y^(n-1) + ... + c{1} y = 0; solution k starts from
%   y^(k-1)(0) = 1 and zeros for the other derivatives below n.
  n = numel(c);
  zero = 0 .* c{1};
  used = find(cellfun(@(x) any(x(:) ~= 0), c));
  found = cell(1, n);
  first = 1;
  for k = 1:n
    derivatives = repmat({zero}, 1, n);
    derivatives{k} = zero + 1;
    total = derivatives{k} ./ first;
    first = first .* k;
    divisor = 1;
    for m = 1:terms - 1
      divisor = divisor .* m;
      if m >= n
        following = zero;
        for i = used
          following = following - c{i} .* derivatives{i};
        end
        derivatives = [derivatives(2:end), {following}];
        total = total + following ./ divisor;
      end
    end
    found{k} = total;
  end
end

%: rows_of
function [rows, largest] = rows_of(c)
%ROWS_OF  Coefficients as rows of a matrix, and about the largest root of each row.
  n = numel(c);
  total = 0;
  for k = 1:n
    total = total + zeros(size(c{k}));
  end
  rows = complex(zeros(numel(total), n));
  for k = 1:n
    rows(:, k) = c{k}(:);
  end
  largest = max(abs(rows) .^ (1 ./ (n:-1:1)), [], 2);
  largest = max(largest, 1e-30);
end

%: propagated
function found = propagated(c)
%PROPAGATED  h, h', ..., h^(n-1) at 1 for coefficients of any size.
%   h solves h^(n) + c{n} h^(n-1) + ... + c{1} h = 0 and starts from h^(n-1)(0) = 1 and
%   zeros. The exponential of the companion matrix, by scaling and squaring.
  n = numel(c);
  [rows, largest] = rows_of(c);
  values = complex(NaN(size(rows)));
  for e = 1:size(rows, 1)
    r = largest(e);
    if ~all(isfinite(rows(e, :)))
      continue;
    end
    companion = zeros(n);
    for i = 1:n - 1
      companion(i, i + 1) = r;
    end
    companion(n, :) = companion(n, :) - rows(e, :) ./ r .^ (n - 1:-1:0);
    halvings = ceil(log2(max(r, 1))) + 3;
    small = companion ./ 2 .^ halvings;
    grown = eye(n);
    for m = 18:-1:1
      grown = eye(n) + small * grown ./ m;
    end
    for k = 1:halvings
      grown = grown * grown;
    end
    values(e, :) = grown(:, n).' .* r .^ (1 - n:0);
  end
  found = cell(1, n);
  for k = 1:n
    found{k} = values(:, k);
  end
end

%: characteristic_roots
function found = characteristic_roots(c)
%CHARACTERISTIC_ROOTS  Roots of x^n + c{n} x^(n-1) + ... + c{1}, and the least distance of two.
%   Eigenvalues of the companion matrix, then steps of Aberth and Ehrlich, which give
%   small roots besides large ones their digits.
  n = numel(c);
  [rows, largest] = rows_of(c);
  values = complex(NaN(size(rows)));
  least = NaN(size(largest));
  for e = 1:size(rows, 1)
    r = largest(e);
    if ~all(isfinite(rows(e, :)))
      continue;
    end
    scaled = rows(e, :) ./ r .^ (n:-1:1);
    companion = zeros(n);
    for i = 1:n - 1
      companion(i, i + 1) = 1;
    end
    companion(n, :) = companion(n, :) - scaled;
    x = eig(companion);
    for step = 1:8 * (n > 1)
      value = ones(n, 1);
      slope = zeros(n, 1);
      for k = n:-1:1
        slope = slope .* x + value;
        value = value .* x + scaled(k);
      end
      away = 1 ./ (x - x.');
      away(~isfinite(away)) = 0;
      change = value ./ (slope - value .* sum(away, 2));
      change(~(abs(change) < 1)) = 0;
      x = x - change;
    end
    values(e, :) = x.' .* r;
    apart = abs(x - x.') + diag(Inf(1, n));
    least(e) = min(apart(:)) .* r;
  end
  found = cell(1, n + 1);
  for k = 1:n
    found{k} = values(:, k);
  end
  found{n + 1} = least;
end

%: mode_values modal_value
function modes = mode_values(roots, len)
%MODE_VALUES  Exponents of all roots at a length, and x^k/chi'(x) of each for k = 0, 1, ...
%   The last of roots is their least distance, which is left out.
  n = numel(roots) - 1;
  modes.exponents = cell(1, n);
  modes.powers = cell(n, n);
  for i = 1:n
    slope = 1;
    for k = [1:i - 1, i + 1:n]
      slope = slope .* (roots{i} - roots{k});
    end
    own = 1 ./ slope;
    for k = 1:n
      modes.powers{i, k} = own;
      own = own .* roots{i};
    end
    modes.exponents{i} = roots{i} .* len;
  end
end

function found = modal_value(modes, coefficients, frames)
%MODAL_VALUE  A sum of exponentials over the largest one, and the logarithm of that.
  amplitudes = {};
  exponents = {};
  for f = 1:numel(frames)
    frame = frames{f};
    [slots, orders, positions, keys, divisors] = frame{:};
    for k = 1:size(keys, 1)
      % One slot after the other; terms with the same orders left are summed.
      rest = orders;
      values = coefficients(positions);
      exponent = 0;
      for at = 1:numel(slots)
        mode = modes{slots(at)};
        root = keys(k, at);
        exponent = exponent + mode.exponents{root};
        label = rest(:, 2:end) * 1000 .^ (0:size(rest, 2) - 2).';
        kept = [];
        sums = {};
        for t = 1:size(rest, 1)
          term = values{t} .* mode.powers{root, rest(t, 1)};
          same = find(label(kept) == label(t), 1);
          if isempty(same)
            kept(end + 1) = t;
            sums{end + 1} = term;
          else
            sums{same} = sums{same} + term;
          end
        end
        rest = rest(kept, 2:end);
        values = sums;
      end
      amplitudes{end + 1} = values{1} ./ divisors(k);
      exponents{end + 1} = exponent;
    end
  end
  found = scaled_sum(amplitudes, exponents);
end

%: fundamental_minors minors_by_octaves parts_at pieces_along slopes_of with_ends chebyshev_points minors_through compound
function found = fundamental_minors(along, start, len, bases, places, wanted)
%FUNDAMENTAL_MINORS  Minors of the matrix Z(len), Z' = A(start + x) Z, over the scales of their
%   sizes, and the logarithms of these. Part k of A is along(x){k} times powers of
%   the bases; a row of places has its row, its column, and these powers.
  n = max(max(places(:, 1:2)));
  pieces = @(limits, where) pieces_along(along, start, len, places, limits, where);
  found = minors_by_octaves(pieces, n, bases, wanted);
end

function found = minors_by_octaves(pieces, n, bases, wanted)
%MINORS_BY_OCTAVES  The same of a matrix of size n, given its pieces for bases up to limits.
  count = max(cellfun(@numel, bases));
  b = zeros(count, numel(bases));
  for k = 1:numel(bases)
    b(:, k) = bases{k}(:);
  end
  % Frequencies within a factor of four share their pieces.
  octaves = ceil(log2(abs(b)) ./ 4);
  octaves(b == 0) = -250;
  [every, ~, own] = unique(octaves, 'rows');
  values = complex(NaN(count, size(wanted, 1) + n));
  for k = find(all(isfinite(every), 2)).'
    limits = 16 .^ every(k, :);
    where = find(own == k);
    [powers, z] = pieces(limits, where);
    if ~isempty(z)
      values(where, :) = minors_through(powers, z, b(where, :) ./ limits, wanted);
    end
  end
  found = num2cell(values, 1);
end

function c = parts_at(along, start, len, rate, scales, where, shares)
%PARTS_AT  Parts of A times a rate, for bases at their limits, at shares of the length: a
%   row per element.
  x = start + len .* shares;
  c = along(x);
  for k = 1:numel(c)
    c{k} = scales(k) .* c{k} .* rate + zeros(size(x));
    if size(c{k}, 1) > 1
      c{k} = c{k}(where, :);
    end
  end
end

function [powers, z] = pieces_along(along, start, len, places, limits, where)
%PIECES_ALONG  Z on every piece: entries by powers of the bases over their limits.
%   Rows of z are row, column and powers, and z{k, 2} has a row per element and a
%   column per piece; empty where waves are too many to be followed.
  z = {};
  powers = [];
  n = max(max(places(:, 1:2)));
  scales = prod(limits .^ places(:, 3:end), 2);
  count = 64;
  c = parts_at(along, start, len, len, scales, where, ((1:count) - 0.5) ./ count);
  % Of a matrix without negative entries the largest eigenvalue is the norm, if states
  % are scaled well.
  growth = zeros(1, count);
  for i = 1:count
    sizes = zeros(n);
    for k = 1:numel(c)
      at = places(k, 1) + n * (places(k, 2) - 1);
      sizes(at) = sizes(at) + max(abs(c{k}(:, i)));
    end
    if ~all(isfinite(sizes(:)))
      return;
    end
    growth(i) = max(abs(eig(sizes))) ./ count;
  end
  growth = cumsum(growth);
  % Where waves grow by e^3, sums of terms of both signs lose a digit.
  number = floor(growth(end) ./ 3) + 1;
  if number > 4000
    return;
  end
  shares = [0, growth + 1e-9 .* (1:count)];
  edges = interp1(shares, (0:count) ./ count, shares(end) .* (0:number) ./ number);
  edges([1, end]) = [0, 1];
  [points, to_terms, integral] = chebyshev_points();
  % Pieces are halved until functions of x are polynomials there to the last digits.
  for turn = 0:12
    widths = diff(edges);
    places_of_x = edges(1:end - 1) + points .* widths;
    c = parts_at(along, start, len, len, scales, where, places_of_x(:).');
    rough = false(1, numel(widths));
    elements = max(cellfun(@(v) size(v, 1), c));
    for k = 1:numel(c)
      c{k} = reshape(repmat(c{k}, elements ./ size(c{k}, 1), 1).', numel(points), []);
      spectrum = abs(to_terms * c{k});
      bad = max(spectrum(end - 2:end, :), [], 1) > 1e-13 .* max(spectrum, [], 1);
      rough = rough | any(reshape(bad, numel(widths), []), 2).';
    end
    if turn == 12 || ~any(rough)
      break;
    end
    middles = edges(1:end - 1) + widths ./ 2;
    edges = sort([edges, middles(rough)]);
  end
  widths = repmat(widths, 1, elements);
  % Rows of Z by row, column and powers; each step of the iteration is one more factor A.
  keys = [kron([1; 1], 1:n).', zeros(n, numel(limits))];
  rows = repmat({ones(size(c{1}))}, n, 1);
  every = keys;
  total = repmat({ones(1, size(c{1}, 2))}, n, 1);
  size_left = 1;
  steps = 0;
  while size_left > 1e-18 || steps < 2 .* n
    steps = steps + 1;
    size_left = size_left .* growth(end) ./ number ./ steps;
    [keys, slopes] = slopes_of(keys, rows, places, c);
    rows = cellfun(@(v) integral * v .* widths, slopes, 'UniformOutput', false);
    [every, total] = with_ends(every, total, keys, rows);
  end
  powers = every;
  z = cellfun(@(v) reshape(v, [], elements).', total, 'UniformOutput', false);
end

function [made, slopes] = slopes_of(keys, rows, places, c)
%SLOPES_OF  Parts times the rows that they act on, summed by row, column and powers.
  made = zeros(0, size(keys, 2));
  slopes = {};
  for k = 1:numel(c)
    for i = find(keys(:, 1) == places(k, 2)).'
      key = [places(k, 1), keys(i, 2), keys(i, 3:end) + places(k, 3:end)];
      at = find(all(made == key, 2));
      if isempty(at)
        made(end + 1, :) = key;
        slopes{end + 1, 1} = c{k} .* rows{i};
      else
        slopes{at} = slopes{at} + c{k} .* rows{i};
      end
    end
  end
end

function [every, total] = with_ends(every, total, keys, rows)
%WITH_ENDS  Totals by row, column and powers, with what rows are at the last point added.
  for i = 1:size(keys, 1)
    at = find(all(every == keys(i, :), 2));
    if isempty(at)
      every(end + 1, :) = keys(i, :);
      total{end + 1, 1} = rows{i}(end, :);
    else
      total{at} = total{at} + rows{i}(end, :);
    end
  end
end

function [points, to_terms, integral] = chebyshev_points()
%CHEBYSHEV_POINTS  Points from 0 to 1, what makes Chebyshev's terms of values there, and
%   their integrals.
  order = 20;
  angles = pi .* (order:-1:0).' ./ order;
  terms = cos(angles * (0:order + 1));
  to_terms = inv(terms(:, 1:end - 1));
  m = 2:order;
  grown = terms(:, 4:end) ./ (2 .* (m + 1)) - terms(:, 2:end - 2) ./ (2 .* (m - 1));
  grown = [terms(:, 2), terms(:, 3) ./ 4, grown];
  integral = (grown - grown(1, :)) * to_terms ./ 2;
  points = (1 + cos(angles)) ./ 2;
end

function values = minors_through(powers, z, b, wanted)
%MINORS_THROUGH  Minors of the product of all pieces over their scales, and the logarithms.
  n = max(powers(:, 1));
  count = size(b, 1);
  factor = ones(count, size(powers, 1));
  for k = 1:size(b, 2)
    own = 1;
    for e = 0:max(powers(:, k + 2))
      at = powers(:, k + 2) == e;
      factor(:, at) = factor(:, at) .* own;
      own = own .* b(:, k);
    end
  end
  orders = cellfun(@numel, wanted(:, 1));
  values = complex(zeros(count, size(wanted, 1) + n));
  for order = unique(orders(:)).'
    lines = nchoosek(1:n, order);
    own = find(orders == order);
    state = cell(size(lines, 1), numel(own));
    for k = 1:numel(own)
      for i = 1:size(lines, 1)
        state{i, k} = double(isequal(lines(i, :), wanted{own(k), 2})) .* ones(count, 1);
      end
    end
    scale = zeros(count, 1);
    for piece = 1:size(z{1}, 2)
      entries = repmat({0}, n, n);
      for k = 1:numel(z)
        at = powers(k, 1) + n .* (powers(k, 2) - 1);
        entries{at} = entries{at} + z{k}(:, piece) .* factor(:, k);
      end
      taken = compound(entries, order);
      following = repmat({zeros(count, 1)}, size(state));
      largest = zeros(count, 1);
      for k = 1:numel(own)
        for i = 1:size(lines, 1)
          for j = 1:size(lines, 1)
            following{i, k} = following{i, k} + taken{i, j} .* state{j, k};
          end
          largest = max(largest, abs(following{i, k}));
        end
      end
      state = cellfun(@(v) v ./ largest, following, 'UniformOutput', false);
      scale = scale + log(largest);
    end
    values(:, size(wanted, 1) + order) = scale;
    for k = 1:numel(own)
      values(:, own(k)) = state{ismember(lines, wanted{own(k), 1}, 'rows'), k};
    end
  end
end

function found = compound(z, order)
%COMPOUND  All minors of one size, expanded along their first rows.
  found = z;
  if order == 1
    return;
  end
  n = size(z, 1);
  lines = nchoosek(1:n, order);
  smaller_lines = nchoosek(1:n, order - 1);
  smaller = compound(z, order - 1);
  found = cell(size(lines, 1));
  for i = 1:size(lines, 1)
    row = ismember(smaller_lines, lines(i, 2:end), 'rows');
    for j = 1:size(lines, 1)
      sum_of_terms = 0;
      for k = 1:order
        column = ismember(smaller_lines, lines(j, [1:k - 1, k + 1:order]), 'rows');
        term = z{lines(i, 1), lines(j, k)} .* smaller{row, column};
        sum_of_terms = sum_of_terms + (-1) .^ (k - 1) .* term;
      end
      found{i, j} = sum_of_terms;
    end
  end
end

%: minors_from_tip
function found = minors_from_tip(along, start, len, bases, places, wanted, tip)
%MINORS_FROM_TIP  What FUNDAMENTAL_MINORS gives, where a stiffness vanishes at the start.
%   With h the way from there z_i = h^powers_i v_i and h v' = B v. Parts of B follow
%   those of A in along(x). The tip is a cell: of each part of B its row, its column,
%   its powers of h and of the bases; the powers_i; the diagonal of B at the start,
%   which is in no part; and the states whose values there tell a solution.
  n = max(max(places(:, 1:2)));
  pieces = @(limits, where) pieces_from_tip(along, start, len, places, limits, where, tip);
  found = minors_by_octaves(pieces, n, bases, wanted);
end

%: pieces_from_tip
function [powers, z] = pieces_from_tip(along, start, len, places, limits, where, tip)
%PIECES_FROM_TIP  What PIECES_ALONG gives, after a piece that begins at a tip.
%   Near a tip A has no bound. It varies little on a stretch as long as all before it.
  powers = [];
  z = {};
  n = max(max(places(:, 1:2)));
  [at_tip, own_powers, exponents] = tip{1:3};
  beginning = @(x) parts_among(along(x), size(places, 1) + (1:size(at_tip, 1)));
  halvings = edge_at_tip(beginning, start, len, n, limits, where, at_tip);
  if isempty(halvings)
    return;
  end
  [keys, made] = begun_along(beginning, start, 2 .^ -halvings .* len, n, limits, where, tip);
  % A is told by B and h, in which no digits cancel: h is small where start - x would be.
  law = @(h) law_of_way(beginning(start + h), h, tip);
  left = find(own_powers + exponents).';
  at = [at_tip(:, [1, 2, 4:end]); [left, left, zeros(numel(left), numel(limits))]];
  for k = halvings:-1:1
    stretch = 2 .^ -k .* len;
    [own_keys, own] = pieces_along(law, stretch, stretch, at, limits, where);
    if isempty(own)
      return;
    end
    [keys, made] = joined_pieces(keys, made, own_keys, own);
  end
  powers = keys;
  z = made;
end

%: edge_at_tip
function halvings = edge_at_tip(beginning, start, len, n, limits, where, places)
%EDGE_AT_TIP  How often the length is halved for the piece that begins at a tip.
%   On it waves grow little, and functions of x are polynomials to the last digits;
%   empty where there is none such.
  halvings = [];
  shares = 2 .^ -(0:48);
  scales = prod(limits .^ places(:, 4:end), 2);
  c = parts_at(beginning, start, len, 1, scales, where, shares);
  way = at_elements(len, where);
  % Of a matrix without negative entries the largest eigenvalue is the norm, if states
  % are scaled well.
  growth = zeros(size(shares));
  for i = 1:numel(shares)
    sizes = zeros(n);
    for k = 1:numel(c)
      at = places(k, 1) + n * (places(k, 2) - 1);
      own = c{k}(:, i) .* (shares(i) .* way) .^ places(k, 3);
      sizes(at) = sizes(at) + max(abs(own));
    end
    if ~all(isfinite(sizes(:)))
      return;
    end
    growth(i) = log(2) .* max(abs(eig(sizes)));
  end
  growth = fliplr(cumsum(fliplr(growth)));
  [points, to_terms] = chebyshev_points();
  % Where waves grow by e^3, sums of terms of both signs lose a digit.
  for i = find(growth <= 3)
    c = parts_at(beginning, start, shares(i) .* len, 1, scales, where, points.');
    is_rough = false;
    for k = 1:numel(c)
      spectrum = abs(to_terms * c{k}.');
      bad = max(spectrum(end - 2:end, :), [], 1) > 1e-13 .* max(spectrum, [], 1);
      is_rough = is_rough || any(bad);
    end
    if ~is_rough
      halvings = i - 1;
      return;
    end
  end
end

%: begun_along
function [powers, z] = begun_along(beginning, start, len, n, limits, where, tip)
%BEGUN_ALONG  What PIECES_ALONG gives, of the piece that begins at a tip.
%   At h the state v_i is its value at the start or 0, and the integral over t from 0
%   to 1 of g_i(t h) t^(-b_i - 1), where g is B v without the diagonal b at the start.
  [places, own_powers, exponents, free] = tip{:};
  [points, to_terms] = chebyshev_points();
  scales = prod(limits .^ places(:, 4:end), 2);
  c = parts_at(beginning, start, len, 1, scales, where, points.');
  way = at_elements(len, where);
  elements = max([cellfun(@(v) size(v, 1), c), numel(way)]);
  way = way.' .* ones(1, elements);
  for k = 1:numel(c)
    c{k} = c{k}.' .* (points .* way) .^ places(k, 3);
  end
  % Nodes and weights of Gauss and Legendre from 0 to 1, by Jacobi's matrix.
  m = 1:47;
  beside = diag(m ./ sqrt(4 .* m .^ 2 - 1), 1);
  [vectors, nodes] = eig(beside + beside.');
  weights = vectors(1, :) .^ 2;
  nodes = (1 + diag(nodes)) ./ 2;
  integrals = repmat({zeros(numel(points))}, n, 1);
  for q = 1:numel(nodes)
    angles = acos(2 .* nodes(q) .* points - 1);
    inside = cos(angles * (0:numel(points) - 1)) * to_terms;
    for i = 1:n
      own = inside;
      if exponents(i) == 0
        % g_i vanishes at the start.
        own(:, 1) = own(:, 1) - 1;
      end
      integrals{i} = integrals{i} + weights(q) .* nodes(q) .^ (-exponents(i) - 1) .* own;
    end
  end
  % Rows of v by row, column and powers; each step is one more factor B.
  every = [kron([1; 1], 1:n).', zeros(n, numel(limits))];
  total = num2cell(double(ismember(1:n, free)).' .* ones(1, elements), 2);
  keys = every(free, :);
  rows = repmat({ones(numel(points), elements)}, numel(free), 1);
  largest = zeros(n * n, elements);
  quiet = 0;
  for step = 1:200
    [keys, slopes] = slopes_of(keys, rows, places(:, [1:2, 4:end]), c);
    rows = slopes;
    sizes = zeros(n * n, elements);
    for i = 1:size(keys, 1)
      rows{i} = integrals{keys(i, 1)} * slopes{i};
      at = keys(i, 1) + n * (keys(i, 2) - 1);
      sizes(at, :) = max(sizes(at, :), max(abs(rows{i}), [], 1));
    end
    [every, total] = with_ends(every, total, keys, rows);
    largest = max(largest, sizes);
    quiet = (quiet + 1) .* all(sizes(:) <= 1e-18 .* largest(:));
    if quiet == n
      break;
    end
  end
  powers = every;
  z = cell(size(total));
  for k = 1:numel(total)
    z{k} = (total{k} .* way .^ own_powers(powers(k, 1))).';
  end
end

%: at_elements
function way = at_elements(way, where)
%AT_ELEMENTS  A length at some elements.
  if numel(way) > 1
    way = way(where);
  end
end

%: law_of_way
function c = law_of_way(c, h, tip)
%LAW_OF_WAY  Parts of A by those of B, and its entries that B has none of.
  [places, powers, exponents] = tip{1:3};
  for k = 1:numel(c)
    c{k} = c{k} .* h .^ (places(k, 3) + powers(places(k, 1)) - powers(places(k, 2)) - 1);
  end
  for i = find(powers + exponents)
    c{end + 1} = (powers(i) + exponents(i)) ./ h;
  end
end

%: parts_among
function c = parts_among(c, numbers_of)
%PARTS_AMONG  Some of the parts that a function of x gives.
  c = c(numbers_of);
end

%: joined_pieces
function [every, joined] = joined_pieces(powers, z, more, after)
%JOINED_PIECES  Pieces, and those that come after them.
  [every, ~, at] = unique([powers; more], 'rows');
  column = ones(max(size(z{1}, 1), size(after{1}, 1)), 1);
  count = size(z{1}, 2);
  joined = repmat({zeros(numel(column), count + size(after{1}, 2))}, size(every, 1), 1);
  for k = 1:numel(z)
    joined{at(k)}(:, 1:count) = z{k} .* column;
  end
  for k = 1:numel(after)
    joined{at(numel(z) + k)}(:, count + 1:end) = after{k} .* column;
  end
end

%: scaled_sum
function found = scaled_sum(amplitudes, exponents)
%SCALED_SUM  A sum of amplitudes times exponentials over the largest one, and its logarithm.
  growth = real(exponents{1});
  for k = 2:numel(exponents)
    growth = max(growth, real(exponents{k}));
  end
  total = 0;
  for k = 1:numel(exponents)
    total = total + amplitudes{k} .* exp(exponents{k} - growth);
  end
  found = {total, growth};
end

%: system_of
function value = system_of(kind, num, den, delay, ends, units)
%SYSTEM_OF  An object of the Control System Toolbox, or of Octave's package control.
  switch kind
    case 'tf'
      value = tf(num, den);
    case 'zpk'
      value = zpk(roots(num), roots(den), num(find(num, 1)) / den(1));
    case 'ss'
      value = ss(tf(num, den));
    otherwise
      error('symflex:kind', 'a system is of kind ''tf'', ''zpk'' or ''ss''');
  end
  value.InputName = ends{1};
  value.OutputName = ends{2};
  try
    value.InputUnit = units{1};
    value.OutputUnit = units{2};
  catch
    % Systems of Octave have no units.
  end
  if delay ~= 0
    value.InputDelay = delay;
  end
end
