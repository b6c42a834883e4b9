
function [state, side] = advance(t, state, h, side, varargin)
% One step of length h with inputs held, cut at the events within it. A side is 1, -1, or 0 where the guard is held at zero, as by dry
% friction at rest; [] takes those at the start. The state is NaN where events accumulate.
  state = state(:);
  if isempty(side)
@STILL
    side = first_sides(t, state, varargin{:});
@JUMPS
    side = touching(t, state, h, varargin{:});
@END
  end
@STILL
  side = following(t, state, h, side(:), varargin{:});
@JUMPS
  [state, side] = following(t, state, h, side(:), varargin{:});
@END
  done = 0;
  for event = 1:1000
    low = 0;
    high = h - done;
    final = classical(t + done, state, high, side, varargin{:});
    margin = margins(t + h, final, side, varargin{:});
    lowest = zeros(size(side));
    if all(isfinite(final)) && any(margin < 0)
      lowest = floors(t + done, state, side, varargin{:});
    end
    if ~all(isfinite(final)) || all(margin >= lowest)
      state = final;
      return
    end
    for halving = 1:52
      middle = 0.5 * (low + high);
      there = classical(t + done, state, middle, side, varargin{:});
      if all(margins(t + done + middle, there, side, varargin{:}) >= lowest)
        low = middle;
      else
        high = middle;
      end
    end
@STILL
    state = classical(t + done, state, high, side, varargin{:});
    done = done + high;
    crossed = margins(t + done, state, side, varargin{:}) < lowest;
    after = decide(t + done, state, side, crossed, varargin{:});
    if high < 1e-12 * h && isequal(after, side)
      guard = guards(t + h, final, varargin{:});
      after(crossed) = 1 - 2 * (guard(crossed) < 0);
    end
@JUMPS
    there = classical(t + done, state, high, side, varargin{:});
    crossed = margins(t + done + high, there, side, varargin{:}) < lowest;
    at = high;
    if all(jumps_at(side) | ~crossed) % States jump where their guards are still on the sides that they leave.
      at = low;
    end
    before = classical(t + done, state, at, side, varargin{:});
    done = done + at;
    [state, after] = passed(t + done, before, h, side, crossed, true, varargin{:});
    if high < 1e-12 * h && isequal(after, side) && isequal(state, before)
      after = beyond(side, crossed, 1 - 2 * (guards(t + h, final, varargin{:}) < 0));
    end
@END
    side = after;
  end
  state = NaN(size(final));
end

function [times, states] = run(times, state, varargin)
% The state at each of these times, a row each, by ode45 from event to event. Inputs are numbers.
  state = state(:);
  states = zeros(numel(times), numel(state));
  states(1, :) = state.';
@STILL
  side = first_sides(times(1), state, varargin{:});
@JUMPS
  side = touching(times(1), state, times(2) - times(1), varargin{:});
@END
  for k = 2:numel(times)
    t = times(k - 1);
    for event = 1:1000
      lowest = floors(t, state, side, varargin{:});
      options = odeset('RelTol', 1e-9, 'AbsTol', 1e-12, 'Events', @(t, x) stops(t, x, side, lowest, varargin{:}));
@STILL
      [at, path] = ode45(@(t, x) rates_by_side(t, x, varargin{:}, held_sides(t, x, side, varargin{:})), [t, times(k)], state, options);
      moved = at(end) - t;
      t = at(end);
      state = path(end, :).';
      if t >= times(k)
        break
      end
      crossed = margins(t, state, side, varargin{:}) - lowest < 1e-9;
      after = decide(t, state, side, crossed, varargin{:});
      if moved <= 0 && isequal(after, side)
        after(crossed) = -side(crossed);
      end
      side = after;
    end
@JUMPS
      off = min(1e-3 * (times(k) - times(k - 1)), times(k) - t);
      at = [t, t];
      path = [state, state].';
      if all(margins(t + off, classical(t, state, off, side, varargin{:}), side, varargin{:}) >= lowest)
        % The solver shows no event at its start.
        [at, path] = ode45(@(t, x) rates_by_side(t, x, varargin{:}, held_sides(t, x, side, varargin{:})), [t, times(k)], state, options);
      end
      if at(end) >= times(k)
        t = times(k);
        state = path(end, :).';
        break
      end
      % Past the event in fixed steps, from the last point before it.
      t = at(end - 1);
      state = path(end - 1, :).';
      h = min(max(off, 2 * (at(end) - t)), times(k) - t) / 10;
      for step = 1:10
        [state, side] = advance(t, state, h, side, varargin{:});
        t = t + h;
      end
      if times(k) - t < 1e-9 * off
        t = times(k);
        break
      end
    end
@END
    if t < times(k)
      state = NaN(size(state));
    end
    states(k, :) = state.';
  end
end

function [value, terminal, direction] = stops(t, state, side, lowest, varargin)
  value = margins(t, state, side, varargin{:}) - lowest;
  terminal = ones(size(value));
  direction = -ones(size(value));
end

function side = first_sides(t, state, varargin)
  guard = guards(t, state, varargin{:});
@STILL
  side = decide(t, state, 1 - 2 * (guard < 0), guard == 0, varargin{:});
@JUMPS
  [jump_guards, jump_sides, gaps] = jump_tables();
  side = sign(guard);
  for r = 1:numel(jump_guards)
    if side(jump_guards(r)) == 0
      side(jump_guards(r)) = jump_sides(r);
    end
  end
  side(gaps > 0) = 2;
  side = decide(t, state, side, side == 0, varargin{:});
  pull = guard_rates(t, state, varargin{:}, held_sides(t, state, side, varargin{:}));
  for k = find(gaps > 0).'
    if guard(gaps(k)) == 0 && guard(k) == 0 && pull(k) < 0
      side([gaps(k), k]) = [2, 0];
    end
  end
  side = decide(t, state, side, side == 0, varargin{:});
@END
end
@JUMPS

function [jump_guards, jump_sides, gaps] = jump_tables()
% Each jump of states: its guard, and the side that the guard leaves. For each guard that is the speed of a contact, the guard of its gap;
% else 0. A side is 2 where a guard waits: the speed of bodies apart, the gap of bodies that lie on each other.
  jump_guards = [@JUMP_GUARDS@] + 1;
  jump_sides = [@JUMP_SIDES@];
  gaps = [@GAPS@].' + 1;
end

function [state, side] = passed(t, state, h, side, crossed, are_zero, varargin)
% State and sides after an event, at which the crossed guards are zero, or an input that jumped has moved them. States jump where guards
% leave the sides at which they do; one jump may set off another.
  [jump_guards, jump_sides, gaps] = jump_tables();
  landed = false(size(side));
  arrival = zeros(size(side));
  left = [];
  for round = 1:64
    fired = find(crossed(jump_guards).' & side(jump_guards).' == jump_sides);
    if isempty(fired)
      guard = guards(t, state, varargin{:});
      away = (crossed | landed) & guard ~= 0 & side ~= 0 & ~are_zero;
      decided = side;
      decided(away) = sign(guard(away));
      decided = decide(t, state, decided, crossed & ~away, varargin{:});
      rates = guard_rates(t, state, varargin{:}, held_sides(t, state, decided, varargin{:}));
      past = landed & ~away & side .* rates < -1e-9 * arrival; % The jump did not turn them.
      decided(past) = -side(past);
      again = jump_guards(side(jump_guards).' == jump_sides & decided(jump_guards).' == -jump_sides & ~ismember(jump_guards, left));
      if isempty(again)
        side = decided;
        return
      end
      crossed(again) = true;
      left = [];
      continue
    end
    before = state;
    guard_before = guards(t, before, varargin{:});
    rows = jumps(t, before, varargin{:});
    for r = fired
      moved = rows(r, :).' ~= before;
      state(moved) = rows(r, moved).';
    end
    guard = guards(t, state, varargin{:});
    left = jump_guards(fired);
    rates = guard_rates(t, before, varargin{:}, held_sides(t, before, side, varargin{:}));
    arrival(left) = abs(rates(left));
    crossed(left) = false;
    landed(left) = true;
    for k = find(guard ~= guard_before & side ~= 2).'
      if side(k) == 0 && gaps(k) > 0
        crossed(gaps(k)) = guard(k) < 0;
        side = opened(side, k);
      elseif ~any(left == k) && any(jump_guards == k & jump_sides == side(k)) && side(k) * guard(k) < 0
        crossed(k) = true;
        landed(k) = false;
      elseif guard(k) ~= 0
        side(k) = sign(guard(k));
        landed(k) = false;
      elseif ~any(jump_guards == k & jump_sides == side(k))
        crossed(k) = true;
      end
    end
    for k = find(gaps > 0).'
      gap = gaps(k);
      if ~any(left == gap) || ~landed(gap)
        continue
      end
      pull = guard_rates(t, state, varargin{:}, held_sides(t, state, side, varargin{:}));
      turned = guard(k) >= 1e-9 * guard_before(k);
      if turned && pull(k) < 0 && 2 * guard(k) < -1e-4 * h * pull(k) % The flight would last a small part of the step.
        if guard(k) ~= guard_before(k) % Where the jump would end at rest.
          state = before + guard_before(k) / (guard_before(k) - guard(k)) * (state - before);
        end
        side(gap) = 2;
        side(k) = 0;
        landed(gap) = false;
      end
    end
  end
  state = NaN(size(state));
end

function jumps = jumps_at(side)
% Of each guard whether states jump where it leaves its side.
  [jump_guards, jump_sides] = jump_tables();
  jumps = false(size(side));
  jumps(jump_guards(side(jump_guards).' == jump_sides)) = true;
end

function side = opened(side, k)
% Lets the bodies of a contact part; k is the guard of their speed.
  [jump_guards, jump_sides, gaps] = jump_tables();
  side(k) = 2;
  side(gaps(k)) = jump_sides(find(jump_guards == gaps(k), 1));
end

function side = beyond(side, crossed, there)
% Sides where crossed guards are taken to be on those that they have a step later.
  [~, ~, gaps] = jump_tables();
  for k = find(crossed & ~jumps_at(side)).'
    if gaps(k) > 0
      side = opened(side, k);
    else
      side(k) = there(k);
    end
  end
end
@END

function [start, slope] = contacts(t, state, side, contact, varargin)
% The rates of guards that are contacts: start + slope times their sides.
  side(contact) = 0;
@JUMPS
  side(side == 2) = 0;
@END
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

@JUMPS
function side = touching(t, state, h, varargin)
% The sides at an instant, with bodies apart that rounding has put into each other: by less than the flights that a step shows.
  [jump_guards, jump_sides, gaps] = jump_tables();
  side = first_sides(t, state, varargin{:});
  guard = guards(t, state, varargin{:});
  pull = guard_rates(t, state, varargin{:}, held_sides(t, state, side, varargin{:}));
  for k = find(gaps > 0).'
    gap = gaps(k);
    if any(jump_guards == gap & jump_sides == -side(gap)) && abs(guard(gap)) <= 1e-9 * h^2 * abs(pull(k))
      side(gap) = -side(gap);
    end
  end
end

@END
@STILL
function side = following(t, state, h, side, varargin)
% Sides where no guard is held, or kept on a side, that has moved away from it, as by an input that jumped.
  guard = guards(t, state, varargin{:});
  apart = find((side == 0 & guard ~= 0) | side .* guard < 0);
  if ~isempty(apart)
    gone = apart(abs(guard(apart)) > 1e-7 * reaches(t, state, h, side, apart, varargin{:}));
    side(gone) = sign(guard(gone));
  end
end
@JUMPS
function [state, side] = following(t, state, h, side, varargin)
% State and sides where no guard is held, or kept on a side, that has moved away from it, as by an input that jumped.
  guard = guards(t, state, varargin{:});
  apart = find(side ~= 2 & ((side == 0 & guard ~= 0) | side .* guard < 0));
  if ~isempty(apart)
    crossed = false(size(side));
    crossed(apart) = abs(guard(apart)) > 1e-7 * reaches(t, state, h, side, apart, varargin{:});
    if any(crossed)
      [state, side] = passed(t, state, h, side, crossed, false, varargin{:});
    end
  end
end
@END

function reach = reaches(t, state, h, side, contact, varargin)
% How far guards can move in a step.
  [start, slope] = contacts(t, state, side, contact, varargin{:});
  reach = h * (abs(start) + sum(abs(slope), 2));
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
@JUMPS
  [~, ~, gaps] = jump_tables();
  touches = gaps(contact) > 0; % Bodies only push each other: the side is 0 or below it.
  own(touches) = 0;
@END
  extent = abs(start) + sum(abs(slope), 2);
  for pivot = 1:200
    own(held) = 0;
    rate = start + slope * own;
    own(held) = -least_sides(slope(held, held), rate(held));
    rate = start + slope * own;
    wrong = (held & abs(own) >= 1 - 1e-9) | (~held & own .* rate < -2e-9 * extent);
@JUMPS
    one_way = (held & own >= 0) | (~held & rate < -2e-9 * extent);
    wrong(touches) = one_way(touches);
@END
    i = find(wrong, 1);
    if isempty(i)
      break
    end
    if held(i)
      held(i) = false;
@STILL
      own(i) = sign(own(i));
@JUMPS
      own(i) = ~touches(i) * sign(own(i));
@END
    elseif attracts(i)
      held(i) = true;
    else
      own(i) = 1 - 2 * (rate(i) < 0);
    end
  end
  own(held) = 0;
  side(contact) = own;
@JUMPS
  for k = contact(touches & ~held).'
    side = opened(side, k);
  end
@END
end

function side = held_sides(t, state, side, varargin)
% Sides with which all held guards stay at zero.
  contact = find(side == 0);
@JUMPS
  side(side == 2) = 0;
@END
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
% What stays above its floor until the next event.
  value = side .* guards(t, state, varargin{:});
  held = side == 0;
  full = held_sides(t, state, side, varargin{:});
  value(held) = 1 - abs(full(held));
@JUMPS
  [~, ~, gaps] = jump_tables();
  value(held & gaps > 0) = -full(held & gaps > 0);
  value(side == 2) = 1;
@END
end

function value = floors(t, state, side, varargin)
% Zero, or what rounding left below it where a guard has just gone to its side.
  value = min(margins(t, state, side, varargin{:}), 0);
  value(side == 0) = 0;
end

function final = classical(t, state, h, side, varargin)
  rates = @(t, x) rates_by_side(t, x, varargin{:}, held_sides(t, x, side, varargin{:}));
  k1 = rates(t, state);
  k2 = rates(t + 0.5 * h, state + 0.5 * h * k1);
  k3 = rates(t + 0.5 * h, state + 0.5 * h * k2);
  k4 = rates(t + h, state + h * k3);
  final = state + h / 6 * (k1 + 2 * (k2 + k3) + k4);
end
