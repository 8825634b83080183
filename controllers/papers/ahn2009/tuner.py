"""Online tuning of a fuzzy system's parameters by a (robust) EKF, (33)–(49) of the paper.

The kernels for one axis (P, I or D): its vector θ (34) is a random walk (35), its measurement is
the plant's output, its innovation the control error e = reference − measured, and

    H = ∂y/∂u · ∂u/∂U · ∂U/∂θ                                                (39), (43), (46)

with ∂y/∂u from `quotient` or from outside, ∂u/∂U of (41) and ∂U/∂θ of `fuzzy_gradient`. P_0 = 0.

**Full or reduced.** With the reduced vector (49) one sample works on at most twelve components:
of each input the two functions with the highest membership (centre, and the half-width on the
side of x), and the weights that their four rules name. Q is added to these alone. The covariance
is kept in full, and what happens to it when the set changes is: a component that leaves keeps
its variance and loses its correlations; one that enters comes with its variance and none. That
leaves P positive semidefinite, as cancelling the coupling between two groups always does.

**Projection.** After an update the centres are put in order with a gap, half-widths are raised
to a floor, half-widths of neighbours that no longer meet are widened equally until they do, the
outer ones reach 0 and 1, and weights are limited to [0, 1]. So on [0, 1] some function of each
input, and therefore some rule, always fires. P is left as it is.

This module refuses to know a control law; `tuned_fuzzy_pid` ties the two together.
"""

from __future__ import annotations

from controllers.core.block import Array
from controllers.core.limit import limit
from controllers.fuzzy.inference import (
    FUNCTION_FIELDS,
    FUNCTIONS_AT,
    N_FUNCTIONS,
    N_RULES,
    RULES_AT,
    WEIGHTS_AT,
)
from controllers.kalman.extended_kalman import add_noise, update

REDUCED_SIZE = 12
RULE_FIELDS = 3  # two antecedents and one consequent


def quotient(
    previous: float, dy: float, du: float, smallest: float, low: float, high: float
) -> float:
    """Δy/Δu of (40), limited to [low, high]; `previous` where |Δu| is below `smallest`."""
    if du == 0.0 or abs(du) < smallest:
        return previous
    return limit(dy / du, low, high)


def strongest(s: Array, mu: Array, which: int, but: int) -> int:
    """Function of input `which` with the highest membership above 0, leaving out `but`; or −1."""
    best = -1
    height = 0.0
    for j in range(int(s[N_FUNCTIONS])):
        mine = int(s[FUNCTIONS_AT + FUNCTION_FIELDS * j]) == which
        if mine and j != but and mu[j] > height:
            best = j
            height = mu[j]
    return best


def put_function(s: Array, theta: Array, x: Array, j: int, index: Array, count: int) -> int:
    """Append centre and active half-width of triangle j to `index`; returns the new count."""
    if j < 0:
        return count
    row = FUNCTIONS_AT + FUNCTION_FIELDS * j
    place = int(s[row + 2])
    side = 2
    if x[int(s[row])] <= theta[place]:
        side = 1
    index[count] = float(place)
    index[count + 1] = float(place + side)
    return count + 2


def active_components(s: Array, theta: Array, x: Array, mu: Array, index: Array) -> int:
    """Places in θ of the reduced vector (49), into `index` (REDUCED_SIZE); returns how many."""
    first_e = strongest(s, mu, 0, -1)
    second_e = strongest(s, mu, 0, first_e)
    first_de = strongest(s, mu, 1, -1)
    second_de = strongest(s, mu, 1, first_de)
    count = put_function(s, theta, x, first_e, index, 0)
    count = put_function(s, theta, x, second_e, index, count)
    count = put_function(s, theta, x, first_de, index, count)
    count = put_function(s, theta, x, second_de, index, count)
    functions = count
    for r in range(int(s[N_RULES])):
        row = int(s[RULES_AT]) + RULE_FIELDS * r
        i = int(s[row])
        j = int(s[row + 1])
        if i in (first_e, second_e) and j in (first_de, second_de):
            place = s[WEIGHTS_AT] + s[row + 2]
            known = False
            for c in range(functions, count):
                if index[c] == place:
                    known = True
            if not known:
                index[count] = place
                count = count + 1
    return count


def change_active_set(n: int, P: Array, active: Array, index: Array, count: int) -> None:
    """Correlations of the components that leave the set become 0; `active` (n,) is renewed."""
    for c in range(count):
        active[int(index[c])] = active[int(index[c])] + 2.0
    for i in range(n):
        if active[i] == 1.0:
            for j in range(n):
                if j != i:
                    P[i * n + j] = 0.0
                    P[j * n + i] = 0.0
    for i in range(n):
        if active[i] >= 2.0:
            active[i] = 1.0
        else:
            active[i] = 0.0


def update_full(
    n: int, theta: Array, P: Array, h: Array, noise: Array, innovation: Array, R: Array, q: Array,
    gamma: Array, work: Array,
) -> float:  # fmt: skip
    """Predict and update all n components; returns γ²."""
    add_noise(n, P, noise)
    return update(n, 1, theta, P, innovation, h, R, q, gamma, work)


def update_reduced(
    n: int, count: int, index: Array, theta: Array, P: Array, h: Array, noise: Array,
    innovation: Array, R: Array, q: Array, gamma: Array, work: Array,
) -> float:  # fmt: skip
    """Predict and update the components in `index` alone; returns γ²."""
    part = work[:count]
    slope = work[count : 2 * count]
    added = work[2 * count : 3 * count]
    block = work[3 * count : 3 * count + count * count]
    for a in range(count):
        i = int(index[a])
        part[a] = theta[i]
        slope[a] = h[i]
        added[a] = noise[i]
        for b in range(count):
            block[a * count + b] = P[i * n + int(index[b])]
    add_noise(count, block, added)
    rest = work[3 * count + count * count :]
    squared = update(count, 1, part, block, innovation, slope, R, q, gamma, rest)
    for a in range(count):
        i = int(index[a])
        theta[i] = part[a]
        for b in range(count):
            P[i * n + int(index[b])] = block[a * count + b]
    return squared


def tune_work(n: int) -> int:
    """Length of the work space of both updates for n components."""
    reduced = 3 * REDUCED_SIZE + 2 * REDUCED_SIZE * REDUCED_SIZE + 3 * REDUCED_SIZE + 1
    full = n * n + 3 * n + 1
    return max(reduced, full)


def order_centres(theta: Array, first: int, count: int, gap: float) -> None:
    """Centres of `count` triangles from place `first` on into [0, 1], `gap` apart."""
    low = 0.0
    for j in range(count):
        place = first + 3 * j
        high = 1.0 - gap * float(count - 1 - j)
        theta[place] = limit(limit(theta[place], low, 1.0), 0.0, high)
        low = theta[place] + gap


def widen(theta: Array, first: int, count: int, floor: float) -> None:
    """Half-widths not below `floor`, neighbours overlapping by it, the outer ones past 0 and 1."""
    for j in range(count):
        place = first + 3 * j
        if theta[place + 1] < floor:
            theta[place + 1] = floor
        if theta[place + 2] < floor:
            theta[place + 2] = floor
    for j in range(count - 1):
        place = first + 3 * j
        reach = theta[place + 2] + theta[place + 4]
        missing = theta[place + 3] - theta[place] + floor - reach
        if missing > 0.0:
            theta[place + 2] = theta[place + 2] + 0.5 * missing
            theta[place + 4] = theta[place + 4] + 0.5 * missing
    if theta[first + 1] < theta[first] + floor:
        theta[first + 1] = theta[first] + floor
    last = first + 3 * (count - 1)
    if theta[last + 2] < 1.0 - theta[last] + floor:
        theta[last + 2] = 1.0 - theta[last] + floor


def project(theta: Array, n: int, m: int, floor: float, gap: float) -> None:
    """θ of n + m triangles and weights back to where it can be meant; see the module."""
    order_centres(theta, 0, n, gap)
    order_centres(theta, 3 * n, m, gap)
    widen(theta, 0, n, floor)
    widen(theta, 3 * n, m, floor)
    for k in range(3 * (n + m), theta.shape[0]):
        theta[k] = limit(theta[k], 0.0, 1.0)
