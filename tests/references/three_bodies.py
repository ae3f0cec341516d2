"""Burrau's three bodies by Taylor series in many bits: the reference of the preset `pythagorean`.

Masses 3, 4 and 5 start at rest at (1, 3), (-2, -1) and (1, -1), with G = 1. Positions and velocities at times 10, 20 and 70 are printed, with the relative
energy error and the nearest encounter. Order 30 with 128 bits and order 40 with 160 bits agree to 15 digits. With `--rebound`, REBOUND's IAS15 is printed too.

    python3 tests/references/three_bodies.py            # needs `pip install gmpy2`; three minutes
    python3 tests/references/three_bodies.py --rebound  # needs `pip install rebound==5.2.2`
"""

import sys

BODIES = [(3, (1, 3)), (4, (-2, -1)), (5, (1, -1))]
TIMES = (10, 20, 70)


def taylor(bits, order, tolerance):
    import gmpy2
    from gmpy2 import mpfr

    gmpy2.get_context().precision = bits
    mass = [mpfr(m) for m, _ in BODIES]
    x = [[mpfr(c) for c in at] for _, at in BODIES]
    v = [[mpfr(0)] * 2 for _ in BODIES]
    pairs = [(i, j) for i in range(3) for j in range(i)]

    def distance(i, j):
        return gmpy2.sqrt(sum((x[i][a] - x[j][a]) ** 2 for a in range(2)))

    def energy():
        kinetic = sum(mass[i] * sum(c * c for c in v[i]) / 2 for i in range(3))
        return kinetic - sum(mass[i] * mass[j] / distance(i, j) for i, j in pairs)

    start, nearest, now, left = energy(), (1e9, 0.0), mpfr(0), list(TIMES)
    while left:
        # Coefficients of positions, displacements, squares of distances, and their powers -3/2, order by order.
        path = [[[x[i][a], v[i][a]] + [mpfr(0)] * order for a in range(2)] for i in range(3)]
        apart = {p: [[mpfr(0)] * order for _ in range(2)] for p in pairs}
        square = {p: [mpfr(0)] * order for p in pairs}
        cube = {p: [mpfr(0)] * order for p in pairs}
        for k in range(order):
            force = [[mpfr(0)] * 2 for _ in range(3)]
            for p in pairs:
                (i, j), d, s, q = p, apart[p], square[p], cube[p]
                for a in range(2):
                    d[a][k] = path[j][a][k] - path[i][a][k]
                s[k] = sum(d[a][n] * d[a][k - n] for a in range(2) for n in range(k + 1))
                if k == 0:
                    q[0] = 1 / (s[0] * gmpy2.sqrt(s[0]))
                else:
                    q[k] = sum((mpfr(-3) / 2 * n - (k - n)) * s[n] * q[k - n] for n in range(1, k + 1)) / (k * s[0])
                for a in range(2):
                    term = sum(d[a][n] * q[k - n] for n in range(k + 1))
                    force[i][a] += mass[j] * term
                    force[j][a] -= mass[i] * term
            for i in range(3):
                for a in range(2):
                    path[i][a][k + 2] = force[i][a] / ((k + 1) * (k + 2))
        steps = []
        for k in (order, order + 1):
            largest = max(abs(path[i][a][k]) for i in range(3) for a in range(2))
            steps.append(gmpy2.exp(gmpy2.log(mpfr(tolerance) / largest) / k))
        h = min(*steps, left[0] - now)
        for i in range(3):
            for a in range(2):
                c = path[i][a]
                x[i][a] = sum(c[k] * h**k for k in range(order + 1, -1, -1))
                v[i][a] = sum(k * c[k] * h ** (k - 1) for k in range(order + 1, 0, -1))
        now += h
        nearest = min(nearest, min((float(distance(i, j)), float(now)) for i, j in pairs))
        if now == left[0]:
            left.pop(0)
            print(f"{bits} bits, order {order}, time {float(now)}: energy error {float(energy() / start - 1):.1e}, nearest {nearest}")
            for i in range(3):
                print("  ", *(f"{float(c):.17g}" for c in x[i] + v[i]))


def rebound_ias15():
    import rebound

    for time in TIMES:
        simulation = rebound.Simulation()
        for mass, (x, y) in BODIES:
            simulation.add(m=mass, x=x, y=y)
        simulation.integrator = "ias15"
        start = simulation.energy()
        simulation.integrate(time)
        print(f"REBOUND {rebound.__version__}, time {time}: energy error {simulation.energy() / start - 1:.1e}")
        for body in simulation.particles:
            print("  ", body.x, body.y, body.vx, body.vy)


if __name__ == "__main__":
    if "--rebound" in sys.argv:
        rebound_ias15()
    else:
        taylor(128, 30, "1e-30")
        taylor(160, 40, "1e-40")
