

def advance(t, state, h, *arguments, side=None):
    """One step of length h with inputs held, cut at the events within it: the state at its end, and the sides of all guards for the next
    step. A side is 1, -1, or 0 where the guard is held at zero, as by dry friction at rest. Without sides those at the start are taken."""
    state = np.array(state, dtype=float)
    side = settle(t, state, *arguments) if side is None else _following(t, state, h, arguments, side)
    done = 0.0
    for _ in range(100):
        left = h - done
        end = _classical(t + done, state, left, arguments, side)
        if np.all(_margins(t + h, end, arguments, side) >= 0.0):
            return end, side
        low, high = 0.0, left
        for _ in range(52):
            middle = 0.5 * (low + high)
            there = _classical(t + done, state, middle, arguments, side)
            inside = np.all(_margins(t + done + middle, there, arguments, side) >= 0.0)
            low, high = (middle, high) if inside else (low, middle)
        state = _classical(t + done, state, high, arguments, side)
        done += high
        crossed = _margins(t + done, state, arguments, side) < 0.0
        after = _decide(t + done, state, arguments, side, crossed)
        if high < 1e-12 * h and np.array_equal(after, side):
            after = np.where(crossed, np.sign(guards(t + h, end, *arguments)), side)
        side = after
    return end, side


def run(times, state, *arguments, **options):
    """The state at each of these times, by scipy.integrate.solve_ivp from event to event; options are its own. Inputs are numbers, or a
    function of time without jumps between two times."""
    from scipy.integrate import solve_ivp

    options = {"rtol": 1e-9, "atol": 1e-12, **options}
    state = np.array(state, dtype=float)
    states = [state]
    side = settle(times[0], state, *arguments)
    for t, stop in zip(times[:-1], times[1:]):
        for _ in range(1000):

            def rates(t, x, side=side):
                return rates_by_side(t, x, *arguments, _held(t, x, arguments, side))

            def event(k, side=side):
                def margin(t, x):
                    return _margins(t, x, arguments, side)[k] + 1e-15

                margin.terminal, margin.direction = True, -1.0
                return margin

            found = solve_ivp(rates, (t, stop), state, events=[event(k) for k in range(len(side))], **options)
            state = found.y[:, -1]
            if found.status != 1:
                break
            crossed = np.array([len(at) > 0 for at in found.t_events])
            moved, t = found.t[-1] - t, found.t[-1]
            after = _decide(t, state, arguments, side, crossed)
            if moved <= 0.0 and np.array_equal(after, side):
                after = np.where(crossed, -side, side)
            side = after
        states.append(state)
    return np.array(states)


def settle(t, state, *arguments):
    """The sides of all guards at an instant."""
    guard = guards(t, state, *arguments)
    return _decide(t, state, arguments, np.sign(guard), guard == 0.0)


def _following(t, state, h, arguments, side):
    """Sides where no guard is held, or kept on a side, that has moved away from it, as by an input that jumped."""
    side = np.array(side, dtype=float)
    guard = guards(t, state, *arguments)
    apart = np.flatnonzero(np.where(side == 0.0, guard != 0.0, side * guard < 0.0))
    if len(apart) > 0:
        start, slope = _contacts(t, state, arguments, side, apart)
        reach = h * (np.abs(start) + np.abs(slope).sum(axis=1))
        gone = apart[np.abs(guard[apart]) > 1e-7 * reach]
        side[gone] = np.sign(guard[gone])
    return side


def _contacts(t, state, arguments, side, contact):
    """The rates of guards that are contacts: start + slope times their sides."""
    rest = np.array(side, dtype=float)
    rest[contact] = 0.0
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
    size = np.abs(start) + np.abs(slope).sum(axis=1)
    for _ in range(200):
        free = np.flatnonzero(held)
        own[free] = 0.0
        own[free] = _solved(slope[np.ix_(free, free)], -(start + slope @ own)[free])
        rate = start + slope @ own
        wrong = np.where(held, np.abs(own) >= 1.0 - 1e-9, own * rate < -2e-9 * size)
        if not wrong.any():
            break
        i = np.argmax(wrong)
        if held[i]:
            held[i], own[i] = False, np.sign(own[i])
        elif attracts[i]:
            held[i] = True
        else:
            own[i] = np.sign(rate[i])
    side[contact] = np.where(held, 0.0, own)
    return side


def _held(t, state, arguments, side):
    """Sides with which all held guards stay at zero."""
    contact = np.flatnonzero(side == 0.0)
    if len(contact) == 0:
        return side
    full = np.array(side, dtype=float)
    start, slope = _contacts(t, state, arguments, side, contact)
    full[contact] = _solved(slope, -start)
    return full


def _solved(slope, right):
    """Where guards hold the same motion together, the least of the sides that do."""
    return np.linalg.lstsq(slope, right, rcond=1e-10)[0]


def _margins(t, state, arguments, side):
    """What stays above zero until the next event."""
    full = _held(t, state, arguments, side)
    return np.where(side == 0.0, 1.0 - np.abs(full), side * guards(t, state, *arguments))


def _classical(t, state, h, arguments, side):
    def rates(t, x):
        return rates_by_side(t, x, *arguments, _held(t, x, arguments, side))

    k1 = rates(t, state)
    k2 = rates(t + 0.5 * h, state + 0.5 * h * k1)
    k3 = rates(t + 0.5 * h, state + 0.5 * h * k2)
    k4 = rates(t + h, state + h * k3)
    return state + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
