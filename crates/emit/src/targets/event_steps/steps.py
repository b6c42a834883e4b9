@JUMPS


# Each jump of states: its guard, and the side that the guard leaves.
_JUMPS = (@JUMP_PAIRS@,)
# For each guard that is the speed of a contact, the guard of its gap; else -1.
_GAPS = np.array([@GAPS@])
# The side of a guard that waits: the speed of bodies apart, the gap of bodies that lie on each other.
_WAITS = 2.0
@END


def advance(t, state, h, *arguments, side=None):
    """One step of length h with inputs held, cut at the events within it: the state at its end, and the sides of all guards for the next
    step. A side is 1, -1, or 0 where the guard is held at zero, as by dry friction at rest. Without sides those at the start are taken.
    The state is NaN where events accumulate."""
    state = np.array(state, dtype=float)
@STILL
    side = settle(t, state, *arguments) if side is None else _following(t, state, h, arguments, side)
@JUMPS
    side = _touching(t, state, h, arguments) if side is None else side
    state, side = _following(t, state, h, arguments, side)
@END
    done = 0.0
    for _ in range(1000):
        left = h - done
        end = _classical(t + done, state, left, arguments, side)
        margins = _margins(t + h, end, arguments, side)
        if not np.all(np.isfinite(end)) or np.all(margins >= 0.0):
            return end, side
        floor = _floor(t + done, state, arguments, side)
        if np.all(margins >= floor):
            return end, side
        low, high = 0.0, left
        for _ in range(52):
            middle = 0.5 * (low + high)
            there = _classical(t + done, state, middle, arguments, side)
            inside = np.all(_margins(t + done + middle, there, arguments, side) >= floor)
            low, high = (middle, high) if inside else (low, middle)
@STILL
        state = _classical(t + done, state, high, arguments, side)
        done += high
        crossed = _margins(t + done, state, arguments, side) < floor
        after = _decide(t + done, state, arguments, side, crossed)
        if high < 1e-12 * h and np.array_equal(after, side):
            after = np.where(crossed, np.sign(guards(t + h, end, *arguments)), side)
@JUMPS
        there = _classical(t + done, state, high, arguments, side)
        crossed = _margins(t + done + high, there, arguments, side) < floor
        # States jump where their guards are still on the sides that they leave.
        at = low if np.all(_jumps_at(side)[crossed]) else high
        before = _classical(t + done, state, at, arguments, side)
        done += at
        state, after = _passed(t + done, before, h, arguments, side, crossed)
        if high < 1e-12 * h and np.array_equal(after, side) and np.array_equal(state, before):
            after = _beyond(side, crossed, np.sign(guards(t + h, end, *arguments)))
@END
        side = after
    return np.full_like(end, np.nan), side


def run(times, state, *arguments, **options):
    """The state at each of these times, by scipy.integrate.solve_ivp from event to event; options are its own. Inputs are numbers, or a
    function of time without jumps between two times. States are NaN where events accumulate."""
    from scipy.integrate import solve_ivp

    options = {"rtol": 1e-9, "atol": 1e-12, **options}
    state = np.array(state, dtype=float)
    states = [state]
@STILL
    side = settle(times[0], state, *arguments)
@JUMPS
    side = _touching(times[0], state, times[1] - times[0], arguments) if len(times) > 1 else None
@END
    for t, stop in zip(times[:-1], times[1:]):
@JUMPS
        span = stop - t
@END
        for _ in range(1000):
            floor = _floor(t, state, arguments, side)

            def rates(t, x, side=side):
                return rates_by_side(t, x, *arguments, _held(t, x, arguments, side))

            def event(k, side=side, floor=floor):
                def margin(t, x):
                    return _margins(t, x, arguments, side)[k] - floor[k] + 1e-15

                margin.terminal, margin.direction = True, -1.0
                return margin

            found = solve_ivp(rates, (t, stop), state, events=[event(k) for k in range(len(side))], **options)
            state = found.y[:, -1]
            if found.status != 1:
                break
            crossed = np.array([len(at) > 0 for at in found.t_events])
            moved, t = found.t[-1] - t, found.t[-1]
@STILL
            after = _decide(t, state, arguments, side, crossed)
            if moved <= 0.0 and np.array_equal(after, side):
                after = np.where(crossed, -side, side)
            side = after
@JUMPS
            before = state
            state, after = _passed(t, before, span, arguments, side, crossed)
            jumped = not np.array_equal(state, before)
            if moved <= 0.0 and np.array_equal(after, side) and not jumped:
                after = _beyond(side, crossed, -side)
            side = after
            if jumped:  # The solver begins a little off the guard.
                off = min(1e-6 * span, stop - t)
                state, t = _classical(t, state, off, arguments, side), t + off
@END
        else:
            state = np.full_like(state, np.nan)
        states.append(state)
    return np.array(states)


def settle(t, state, *arguments):
    """The sides of all guards at an instant."""
@STILL
    side = np.sign(guards(t, state, *arguments))
@JUMPS
    guard = guards(t, state, *arguments)
    side = np.sign(guard)
    for k, leaves in _JUMPS:
        side[k] = leaves if side[k] == 0.0 else side[k]
    side[_GAPS >= 0] = _WAITS
    side = _decide(t, state, arguments, side, side == 0.0)
    pull = guard_rates(t, state, *arguments, _held(t, state, arguments, side))
    for k, gap in enumerate(_GAPS):
        if gap >= 0 and guard[gap] == guard[k] == 0.0 and pull[k] < 0.0:
            side[gap], side[k] = _WAITS, 0.0
@END
    return _decide(t, state, arguments, side, side == 0.0)


@JUMPS
def _touching(t, state, h, arguments):
    """The sides at an instant, with bodies apart that rounding has put into each other: by less than the flights that a step shows."""
    side, guard = settle(t, state, *arguments), guards(t, state, *arguments)
    pull = guard_rates(t, state, *arguments, _held(t, state, arguments, side))
    for k, gap in enumerate(_GAPS):
        if gap >= 0 and (gap, -side[gap]) in _JUMPS and abs(guard[gap]) <= 1e-9 * h * h * abs(pull[k]):
            side[gap] = -side[gap]
    return side


@END
def _following(t, state, h, arguments, side):
@STILL
    """Sides where no guard is held, or kept on a side, that has moved away from it, as by an input that jumped."""
@JUMPS
    """State and sides where no guard is held, or kept on a side, that has moved away from it, as by an input that jumped."""
@END
    side = np.array(side, dtype=float)
    guard = guards(t, state, *arguments)
@STILL
    apart = np.flatnonzero(np.where(side == 0.0, guard != 0.0, side * guard < 0.0))
@JUMPS
    apart = np.flatnonzero((side != _WAITS) & np.where(side == 0.0, guard != 0.0, side * guard < 0.0))
@END
    if len(apart) > 0:
        gone = apart[np.abs(guard[apart]) > 1e-7 * _reach(t, state, h, arguments, side, apart)]
@STILL
        side[gone] = np.sign(guard[gone])
    return side
@JUMPS
        if len(gone) > 0:
            crossed = np.zeros(len(side), dtype=bool)
            crossed[gone] = True
            return _passed(t, state, h, arguments, side, crossed, are_zero=False)
    return state, side


def _passed(t, state, h, arguments, side, crossed, are_zero=True):
    """State and sides after an event, at which the crossed guards are zero, or an input that jumped has moved them. States jump where
    guards leave the sides at which they do; one jump may set off another."""
    side, crossed, landed = np.array(side, dtype=float), np.array(crossed), np.zeros(len(side), dtype=bool)
    left, arrival = [], np.zeros(len(side))
    for _ in range(64):
        fired = [r for r, (k, leaves) in enumerate(_JUMPS) if crossed[k] and side[k] == leaves]
        if not fired:
            guard, decided = guards(t, state, *arguments), np.array(side)
            away = (crossed | landed) & (guard != 0.0) & (side != 0.0) & (not are_zero)
            decided[away] = np.sign(guard[away])
            decided = _decide(t, state, arguments, decided, crossed & ~away)
            rates = guard_rates(t, state, *arguments, _held(t, state, arguments, decided))
            beyond = landed & ~away & (side * rates < -1e-9 * arrival)  # The jump did not turn them.
            decided[beyond] = -side[beyond]
            again = [k for k, leaves in _JUMPS if side[k] == leaves and decided[k] == -leaves and k not in left]
            if not again:
                return state, decided
            crossed[again], left = True, []
            continue
        before, guard_before, rows = state, guards(t, state, *arguments), jumps(t, state, *arguments)
        for r in fired:
            state = np.where(rows[r] != before, rows[r], state)
        guard = guards(t, state, *arguments)
        left = [_JUMPS[r][0] for r in fired]
        arrival[left] = np.abs(guard_rates(t, before, *arguments, _held(t, before, arguments, side))[left])
        crossed[left], landed[left] = False, True
        for k in np.flatnonzero((guard != guard_before) & (side != _WAITS)):
            if side[k] == 0.0 and _GAPS[k] >= 0:
                crossed[_GAPS[k]] = guard[k] < 0.0
                _open(side, k)
            elif k not in left and (k, side[k]) in _JUMPS and side[k] * guard[k] < 0.0:
                crossed[k], landed[k] = True, False
            elif guard[k] != 0.0:
                side[k], landed[k] = np.sign(guard[k]), False
            elif (k, side[k]) not in _JUMPS:
                crossed[k] = True
        for k in [k for k, gap in enumerate(_GAPS) if gap in left and landed[gap]]:
            pull = guard_rates(t, state, *arguments, _held(t, state, arguments, side))[k]
            turned = guard[k] >= 1e-9 * guard_before[k]
            if turned and pull < 0.0 and 2.0 * guard[k] < -1e-4 * h * pull:  # The flight would last a small part of the step.
                if guard[k] != guard_before[k]:  # Where the jump would end at rest.
                    state = before + guard_before[k] / (guard_before[k] - guard[k]) * (state - before)
                side[_GAPS[k]], side[k], landed[_GAPS[k]] = _WAITS, 0.0, False
    return np.full_like(state, np.nan), side


def _jumps_at(side):
    """Of each guard whether states jump where it leaves its side."""
    return np.array([(k, s) in _JUMPS for k, s in enumerate(side)])


def _open(side, k):
    """Lets the bodies of a contact part; k is the guard of their speed."""
    side[k] = _WAITS
    side[_GAPS[k]] = [leaves for gap, leaves in _JUMPS if gap == _GAPS[k]][0]


def _beyond(side, crossed, there):
    """Sides where crossed guards are taken to be on those that they have a step later."""
    side = np.array(side)
    for k in np.flatnonzero(crossed & ~_jumps_at(side)):
        if _GAPS[k] >= 0:
            _open(side, k)
        else:
            side[k] = there[k]
    return side
@END


def _reach(t, state, h, arguments, side, contact):
    """How far guards can move in a step."""
    start, slope = _contacts(t, state, arguments, side, contact)
    return h * (np.abs(start) + np.abs(slope).sum(axis=1))


def _contacts(t, state, arguments, side, contact):
    """The rates of guards that are contacts: start + slope times their sides."""
    rest = np.array(side, dtype=float)
    rest[contact] = 0.0
@JUMPS
    rest[rest == _WAITS] = 0.0
@END
    start = guard_rates(t, state, *arguments, rest)[contact]
    slope = np.zeros((len(contact), len(contact)))
    for j, k in enumerate(contact):
        rest[k] = 1.0
        slope[:, j] = guard_rates(t, state, *arguments, rest)[contact] - start
        rest[k] = 0.0
    return start, slope


def _decide(t, state, arguments, side, crossed):
    """Sides after an event. A guard at zero is held if some side between -1 and 1 keeps it there; else it goes where the rates lead."""
    side = np.array(side, dtype=float)
    contact = np.flatnonzero(crossed | (side == 0.0))
    start, slope = _contacts(t, state, arguments, side, contact)
    attracts = np.diag(slope) < 0.0
    held, own = attracts.copy(), np.where(attracts, 0.0, np.where(start < 0.0, -1.0, 1.0))
@JUMPS
    touches = _GAPS[contact] >= 0  # Bodies only push each other: the side is 0 or below it.
    own[touches] = 0.0
@END
    size = np.abs(start) + np.abs(slope).sum(axis=1)
    for _ in range(200):
        free = np.flatnonzero(held)
        own[free] = 0.0
        own[free] = _solved(slope[np.ix_(free, free)], -(start + slope @ own)[free])
        rate = start + slope @ own
        wrong = np.where(held, np.abs(own) >= 1.0 - 1e-9, own * rate < -2e-9 * size)
@JUMPS
        wrong[touches] = np.where(held, own >= 0.0, rate < -2e-9 * size)[touches]
@END
        if not wrong.any():
            break
        i = np.argmax(wrong)
        if held[i]:
@STILL
            held[i], own[i] = False, np.sign(own[i])
@JUMPS
            held[i], own[i] = False, 0.0 if touches[i] else np.sign(own[i])
@END
        elif attracts[i]:
            held[i] = True
        else:
            own[i] = np.sign(rate[i])
    side[contact] = np.where(held, 0.0, own)
@JUMPS
    for k in contact[touches & ~held]:
        _open(side, k)
@END
    return side


def _held(t, state, arguments, side):
    """Sides with which all held guards stay at zero."""
    contact = np.flatnonzero(side == 0.0)
@STILL
    if len(contact) == 0:
        return side
    full = np.array(side, dtype=float)
@JUMPS
    full = np.where(side == _WAITS, 0.0, side)
    if len(contact) == 0:
        return full
@END
    start, slope = _contacts(t, state, arguments, side, contact)
    full[contact] = _solved(slope, -start)
    return full


def _solved(slope, right):
    """Where guards hold the same motion together, the least of the sides that do."""
    return np.linalg.lstsq(slope, right, rcond=1e-10)[0]


def _margins(t, state, arguments, side):
    """What stays above its floor until the next event."""
    full = _held(t, state, arguments, side)
@STILL
    return np.where(side == 0.0, 1.0 - np.abs(full), side * guards(t, state, *arguments))
@JUMPS
    held = np.where(_GAPS >= 0, -full, 1.0 - np.abs(full))
    return np.where(side == 0.0, held, np.where(side == _WAITS, 1.0, side * guards(t, state, *arguments)))
@END


def _floor(t, state, arguments, side):
    """Zero, or what rounding left below it where a guard has just gone to its side."""
    return np.where(side == 0.0, 0.0, np.minimum(_margins(t, state, arguments, side), 0.0))


def _classical(t, state, h, arguments, side):
    def rates(t, x):
        return rates_by_side(t, x, *arguments, _held(t, x, arguments, side))

    k1 = rates(t, state)
    k2 = rates(t + 0.5 * h, state + 0.5 * h * k1)
    k3 = rates(t + 0.5 * h, state + 0.5 * h * k2)
    k4 = rates(t + h, state + h * k3)
    return state + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
