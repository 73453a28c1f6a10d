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

%: entries
function value = entries(formula, s, given, count)
%ENTRIES  What one formula gives for all entries of a matrix, row by row.
  [s, given, shape] = columns(s, given);
  parts = formula(s, given{:});
  places = reshape(1:prod(count), count).';
  value = complex(zeros(prod(count), numel(s)));
  for k = 1:numel(parts)
    value(places(k), :) = parts{k};
  end
  value = beside(value, count, shape);
end

%: replaced
function values = replaced(values, others, where)
%REPLACED  Each of some values, and another one in its place where that holds.
  for k = 1:numel(values)
    value = values{k} .* ones(size(where));
    other = others{k} .* ones(size(where));
    value(where) = other(where);
    values{k} = value;
  end
end

%: stacked
function value = stacked(parts)
%STACKED  Values of all entries of a matrix, whose rows and columns come first.
  whole = 0;
  for k = 1:numel(parts)
    whole = whole + zeros(size(parts{k}));
  end
  value = complex(zeros(numel(parts), numel(whole)));
  for k = 1:numel(parts)
    value(k, :) = reshape(parts{k} + whole, 1, []);
  end
  value = beside(value, size(parts), size(whole));
end

%: beside
function value = beside(value, count, shape)
%BESIDE  Values of all entries, the rows and columns of the matrix before the shape of s.
  if numel(shape) == 2 && any(shape == 1)
    shape = prod(shape);
  end
  value = reshape(value, [count, shape]);
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

%: on_axis
function value = on_axis(response, omega, given)
%ON_AXIS  The values of a function of s at angular frequencies of any sign.
  if ~(isreal(omega) && all(cellfun(@(x) isstruct(x) || isreal(x), given)))
    error('symflex:argument', 'angular frequency and parameters must be real');
  end
  value = response(1i .* double(omega), given{:});
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
