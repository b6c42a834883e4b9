
function [state, side] = advance(t, state, h, side, varargin)
% One step of length h with inputs held, cut at the events within it. A side is 1, -1, or 0 where the guard is held at zero, as by dry
% friction at rest; [] takes those at the start.
  state = state(:);
  if isempty(side)
    side = first_sides(t, state, varargin{:});
  end
  side = following(t, state, h, side(:), varargin{:});
  done = 0;
  for event = 1:100
    low = 0;
    high = h - done;
    final = classical(t + done, state, high, side, varargin{:});
    if all(margins(t + h, final, side, varargin{:}) >= 0)
      break
    end
    for halving = 1:52
      middle = 0.5 * (low + high);
      there = classical(t + done, state, middle, side, varargin{:});
      if all(margins(t + done + middle, there, side, varargin{:}) >= 0)
        low = middle;
      else
        high = middle;
      end
    end
    state = classical(t + done, state, high, side, varargin{:});
    done = done + high;
    crossed = margins(t + done, state, side, varargin{:}) < 0;
    after = decide(t + done, state, side, crossed, varargin{:});
    if high < 1e-12 * h && isequal(after, side)
      guard = guards(t + h, final, varargin{:});
      after(crossed) = 1 - 2 * (guard(crossed) < 0);
    end
    side = after;
  end
  state = final;
end

function [times, states] = run(times, state, varargin)
% The state at each of these times, a row each, by ode45 from event to event. Inputs are numbers.
  state = state(:);
  states = zeros(numel(times), numel(state));
  states(1, :) = state.';
  side = first_sides(times(1), state, varargin{:});
  for k = 2:numel(times)
    t = times(k - 1);
    for event = 1:1000
      options = odeset('RelTol', 1e-9, 'AbsTol', 1e-12, 'Events', @(t, x) stops(t, x, side, varargin{:}));
      [at, path] = ode45(@(t, x) rates_by_side(t, x, varargin{:}, held_sides(t, x, side, varargin{:})), [t, times(k)], state, options);
      moved = at(end) - t;
      t = at(end);
      state = path(end, :).';
      if t >= times(k)
        break
      end
      crossed = margins(t, state, side, varargin{:}) < 1e-9;
      after = decide(t, state, side, crossed, varargin{:});
      if moved <= 0 && isequal(after, side)
        after(crossed) = -side(crossed);
      end
      side = after;
    end
    states(k, :) = state.';
  end
end

function [value, terminal, direction] = stops(t, state, side, varargin)
  value = margins(t, state, side, varargin{:});
  terminal = ones(size(value));
  direction = -ones(size(value));
end

function side = first_sides(t, state, varargin)
  guard = guards(t, state, varargin{:});
  side = decide(t, state, 1 - 2 * (guard < 0), guard == 0, varargin{:});
end

function [start, slope] = contacts(t, state, side, contact, varargin)
% The rates of guards that are contacts: start + slope times their sides.
  side(contact) = 0;
  start = guard_rates(t, state, varargin{:}, side);
  start = start(contact);
  slope = zeros(numel(contact));
  for j = 1:numel(contact)
    side(contact(j)) = 1;
    moved = guard_rates(t, state, varargin{:}, side);
    side(contact(j)) = 0;
    slope(:, j) = moved(contact) - start;
  end
end

function side = following(t, state, h, side, varargin)
% Sides where no guard is held, or kept on a side, that has moved away from it, as by an input that jumped.
  guard = guards(t, state, varargin{:});
  apart = find((side == 0 & guard ~= 0) | side .* guard < 0);
  if ~isempty(apart)
    [start, slope] = contacts(t, state, side, apart, varargin{:});
    gone = apart(abs(guard(apart)) > 1e-7 * h * (abs(start) + sum(abs(slope), 2)));
    side(gone) = sign(guard(gone));
  end
end

function side = decide(t, state, side, crossed, varargin)
% Sides after an event. A guard at zero is held if some side between -1 and 1 keeps it there; else it goes where the rates lead.
  contact = find(crossed | side == 0);
  if isempty(contact)
    return
  end
  [start, slope] = contacts(t, state, side, contact, varargin{:});
  attracts = diag(slope) < 0;
  held = attracts;
  own = 1 - 2 * (start < 0);
  extent = abs(start) + sum(abs(slope), 2);
  for pivot = 1:200
    own(held) = 0;
    rate = start + slope * own;
    own(held) = -least_sides(slope(held, held), rate(held));
    rate = start + slope * own;
    wrong = (held & abs(own) >= 1 - 1e-9) | (~held & own .* rate < -2e-9 * extent);
    i = find(wrong, 1);
    if isempty(i)
      break
    end
    if held(i)
      held(i) = false;
      own(i) = sign(own(i));
    elseif attracts(i)
      held(i) = true;
    else
      own(i) = 1 - 2 * (rate(i) < 0);
    end
  end
  own(held) = 0;
  side(contact) = own;
end

function side = held_sides(t, state, side, varargin)
% Sides with which all held guards stay at zero.
  contact = find(side == 0);
  if ~isempty(contact)
    [start, slope] = contacts(t, state, side, contact, varargin{:});
    side(contact) = -least_sides(slope, start);
  end
end

function x = least_sides(slope, right)
% Where guards hold the same motion together, the least of the sides that do.
  x = right;
  if ~isempty(slope)
    x = pinv(slope, 1e-10 * max(max(abs(slope)))) * right;
  end
end

function value = margins(t, state, side, varargin)
% What stays above zero until the next event.
  value = side .* guards(t, state, varargin{:});
  held = side == 0;
  full = held_sides(t, state, side, varargin{:});
  value(held) = 1 - abs(full(held));
end

function final = classical(t, state, h, side, varargin)
  rates = @(t, x) rates_by_side(t, x, varargin{:}, held_sides(t, x, side, varargin{:}));
  k1 = rates(t, state);
  k2 = rates(t + 0.5 * h, state + 0.5 * h * k1);
  k3 = rates(t + 0.5 * h, state + 0.5 * h * k2);
  k4 = rates(t + h, state + h * k3);
  final = state + h / 6 * (k1 + 2 * (k2 + k3) + k4);
end
