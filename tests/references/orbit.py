"""Energy errors of two-body orbits by textbook schemes, in plain Python: the references of `nbody-energy`.

Two bodies on an orbit of eccentricity 0.5 start at the pericentre (half axis, total mass and G are 1). The largest |E/E0 - 1| along 100
orbits is printed for 64, 256, 1024 and 4096 steps an orbit, seen every step, or 256 times an orbit where steps are shorter. Only the
relative position is followed: E/E0 is that of the two bodies. With `--rebound`, REBOUND's leapfrog (drift, kick, drift) is set beside
this program's.

    python3 tests/references/orbit.py
    python3 tests/references/orbit.py --rebound      # needs `pip install rebound==5.2.2`
"""

import math
import sys

ECCENTRICITY = 0.5
ORBITS = 100
STEPS = (64, 256, 1024, 4096)
LOOKS = 256


def attraction(x, y):
    cube = (x * x + y * y) ** 1.5
    return -x / cube, -y / cube


def jerk(x, y, u, v):
    square = x * x + y * y
    cube, along = square**1.5, 3.0 * (x * u + y * v) / square
    return -(u - along * x) / cube, -(v - along * y) / cube


def energy(x, y, u, v):
    return 0.5 * (u * u + v * v) - 1.0 / math.hypot(x, y)


def start():
    near = 1.0 - ECCENTRICITY
    return near, 0.0, 0.0, math.sqrt((1.0 + ECCENTRICITY) / near)


def damped_euler(state, dt):
    """PWP's scheme with damping 1: velocity first, then the position with the new velocity."""
    x, y, u, v = state
    a, b = attraction(x, y)
    u, v = u + dt * a, v + dt * b
    return x + dt * u, y + dt * v, u, v


def kick_drift_kick(state, dt):
    x, y, u, v = state
    a, b = attraction(x, y)
    u, v = u + 0.5 * dt * a, v + 0.5 * dt * b
    x, y = x + dt * u, y + dt * v
    a, b = attraction(x, y)
    return x, y, u + 0.5 * dt * a, v + 0.5 * dt * b


def drift_kick_drift(state, dt):
    x, y, u, v = state
    x, y = x + 0.5 * dt * u, y + 0.5 * dt * v
    a, b = attraction(x, y)
    u, v = u + dt * a, v + dt * b
    return x + 0.5 * dt * u, y + 0.5 * dt * v, u, v


def composed(state, dt, shares):
    """Leapfrogs of the shares from the middle outwards, on both sides (Yoshida 1990, Phys. Lett. A 150, 262)."""
    middle = 1.0 - 2.0 * sum(shares)
    for share in (*reversed(shares), middle, *shares):
        state = kick_drift_kick(state, share * dt)
    return state


def yoshida_4(state, dt):
    return composed(state, dt, (1.0 / (2.0 - 2.0 ** (1.0 / 3.0)),))


def yoshida_6(state, dt):
    """Solution A of Yoshida's table 1."""
    return composed(state, dt, (-1.17767998417887, 0.235573213359357, 0.784513610477560))


def yoshida_8(state, dt):
    """Solution D of Yoshida's table 2."""
    shares = (
        0.102799849391985,
        -1.96061023297549,
        1.93813913762276,
        -0.158240635368243,
        -1.44485223686048,
        0.253693336566229,
        0.914844246229740,
    )
    return composed(state, dt, shares)


def runge_kutta_4(state, dt):
    """The classical scheme (Kutta 1901)."""

    def slope(s):
        return s[2], s[3], *attraction(s[0], s[1])

    def moved(by, k):
        return tuple(s + by * d for s, d in zip(state, k))

    a = slope(state)
    b = slope(moved(0.5 * dt, a))
    c = slope(moved(0.5 * dt, b))
    d = slope(moved(dt, c))
    return tuple(s + dt / 6.0 * (p + 2.0 * q + 2.0 * r + t) for s, p, q, r, t in zip(state, a, b, c, d))


def hermite_4(state, dt):
    """One prediction, one evaluation, one correction (Makino and Aarseth 1992, Publ. Astron. Soc. Japan 44, 141).

    Acceleration and jerk of the next step's start are those of the predicted place.
    """
    x, y, u, v = state[:4]
    a, b, j, k = state[4:] if len(state) > 4 else (*attraction(x, y), *jerk(x, y, u, v))
    # Predicted, evaluated, corrected: each of the four.
    px = x + dt * (u + dt * (a / 2.0 + dt * j / 6.0))
    py = y + dt * (v + dt * (b / 2.0 + dt * k / 6.0))
    pu, pv = u + dt * (a + dt * j / 2.0), v + dt * (b + dt * k / 2.0)
    (na, nb), (nj, nk) = attraction(px, py), jerk(px, py, pu, pv)
    nu = u + dt / 2.0 * (a + na) + dt * dt / 12.0 * (j - nj)
    nv = v + dt / 2.0 * (b + nb) + dt * dt / 12.0 * (k - nk)
    nx = x + dt / 2.0 * (u + nu) + dt * dt / 12.0 * (a - na)
    ny = y + dt / 2.0 * (v + nv) + dt * dt / 12.0 * (b - nb)
    return nx, ny, nu, nv, na, nb, nj, nk


GEAR = (3.0 / 20.0, 251.0 / 360.0, 1.0, 11.0 / 18.0, 1.0 / 6.0, 1.0 / 60.0)


def gear_start(dt):
    """Exact derivatives of the orbit at the pericentre by recursion of its Taylor series, scaled by dt^k/k!."""
    x, y, u, v = start()
    xs, ys = [x, u], [y, v]
    # s = r^2, p = r^-3 as series: s p' = -3/2 s' p.
    for k in range(4):
        s = [sum(xs[i] * xs[n - i] + ys[i] * ys[n - i] for i in range(n + 1)) for n in range(k + 1)]
        p = [s[0] ** -1.5]
        for n in range(1, k + 1):
            total = sum((-1.5 * i - (n - i)) * s[i] * p[n - i] for i in range(1, n + 1))
            p.append(total / (n * s[0]))
        for series in (xs, ys):
            force = -sum(series[i] * p[k - i] for i in range(k + 1))
            series.append(force / ((k + 1) * (k + 2)))
    return [[c * dt**k for k, c in enumerate(series)] for series in (xs, ys)]


def gear_6(derivatives, dt):
    """Six values of each coordinate; coefficients of Allen and Tildesley, appendix E, with 3/20."""
    predicted = [
        [sum(math.comb(m, k) * series[m] for m in range(k, 6)) for k in range(6)] for series in derivatives
    ]
    new = attraction(predicted[0][0], predicted[1][0])
    corrected = []
    for series, a in zip(predicted, new):
        off = 0.5 * dt * dt * a - series[2]
        corrected.append([q + c * off for q, c in zip(series, GEAR)])
    return corrected


def largest_error(scheme, steps):
    dt = 2.0 * math.pi / steps
    first = energy(*start())
    between = -(-steps // LOOKS)
    state = gear_start(dt) if scheme is gear_6 else start()
    worst = 0.0
    for step in range(1, ORBITS * steps + 1):
        state = scheme(state, dt)
        if step % between == 0:
            if scheme is gear_6:
                (x, u, *_), (y, v, *_) = state
                now = energy(x, y, u / dt, v / dt)
            else:
                now = energy(*state[:4])
            worst = max(worst, abs(now / first - 1.0))
    return worst


def rebound_error(steps):
    import rebound

    simulation = rebound.Simulation()
    x, _, _, v = start()
    for side in (-0.5, 0.5):
        simulation.add(m=0.5, x=side * x, vy=side * v)
    simulation.integrator, simulation.dt = "leapfrog", 2.0 * math.pi / steps
    first = simulation.energy()
    between = -(-steps // LOOKS)
    worst = 0.0
    for _ in range(ORBITS * steps // between):
        simulation.steps(between)
        simulation.synchronize()
        worst = max(worst, abs(simulation.energy() / first - 1.0))
    return worst


def main():
    schemes = [damped_euler, kick_drift_kick, yoshida_4, yoshida_6, yoshida_8, runge_kutta_4, hermite_4, gear_6]
    if "--rebound" in sys.argv[1:]:
        import rebound

        print("REBOUND", rebound.__version__, *(f"{rebound_error(steps):.6e}" for steps in STEPS))
        schemes = [drift_kick_drift]
    for scheme in schemes:
        print(scheme.__name__, *(f"{largest_error(scheme, steps):.6e}" for steps in STEPS))


if __name__ == "__main__":
    main()
