"""Compares the structure functions of runs, also those by species, with `freud`, `MDAnalysis` and naive sums, in boxes of every kind.

    python structure.py STRIPMINE

Needs the packages `freud-analysis`, `MDAnalysis`, `gsd` and `numpy`; if one is not installed, the check prints SKIPPED and exits with 0.

Each scene writes 64 rows and 64 frames at the same moments, in blocks of two; the second half of the blocks is sampled. g(r) is compared with pairs counted
by freud over those of an ideal gas computed here, psi6 with freud, displacements with MDAnalysis, the rest with sums over the frames. Prints the largest
difference of each function in each box. Exits with 1 if one differs by more than 1e-9 of its largest value; 1e-4 where freud or GSD
use single precision, 5e-3 where a pair may fall in the next bin, 2e-2 where the ideal gas between wall discs comes from random numbers.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

OPEN = ("vibrating-floor", "hot-floor")  # presets without a ceiling
LOOKS = 64
BLOCK = 2  # samples of a block: 64 samples in at most 32 blocks
HARD = {"particles.generate": '"random"', "run.time": 32.0, "run.snapshot_every": 0.5, "run.thermo_every": 0.5}
BOXES = {
    "square": ("hard-disks", HARD | {"domain.sides": "[20.0, 20.0]", "particles.count": 150}),
    "4 x 60": ("hard-disks", HARD | {"domain.sides": "[4.0, 60.0]", "particles.count": 90}),
    "closed": ("hard-disks", HARD | {"domain.sides": "[20.0, 14.0]", "particles.count": 100, "domain.periodic": "[false, false]"}),
    "open top": ("vibrating-floor", HARD | {"domain.sides": "[20.0, 12.0]", "particles.count": 60}),
    "open top, mixture": (
        "hot-floor",
        HARD | {"domain.sides": "[16.0, 14.0]", "domain.periodic": "[false, false]", "domain.gravity": "[0.0, -0.3]",
                "particles.count": 50, "particles.second_radius": 1.0, "particles.second_share": 0.2},
    ),
    "mixture 1:12": ("mixture.toml", {}),
    "binary": (
        "hard-disks",
        HARD | {"domain.sides": "[24.0, 20.0]", "particles.count": 160, "particles.second_radius": 0.8, "particles.second_share": 0.3},
    ),
    "5 particles": ("hard-disks", HARD | {"domain.sides": "[9.0, 9.0]", "particles.count": 5}),
    "channel": (
        "pipe-small",
        {"run.time": 0.64, "run.snapshot_every": 100, "run.thermo_every": 100},
    ),
    "bath": ("langevin-dense", {"run.time": 32.0, "run.snapshot_every": 100, "run.thermo_every": 100}),
}
OF_TWO = ("binary", "mixture 1:12")  # boxes whose functions by species are compared
FUNCTIONS = {
    "g(r)": 5e-3, "S(k)": 1e-9, "coordination": 1e-9, "psi6": 1e-4, "velocities": 1e-9, "density(x)": 1e-9, "density(y)": 1e-9,
    "g_ab(r)": 5e-3, "S_ab(k)": 1e-9, "coordination_ab": 1e-9, "msd_a": 1e-4, "flow(x)": 1e-9, "flow(y)": 1e-9, "temperature(x)": 1e-9, "temperature(y)": 1e-9, "msd": 1e-4, "vacf": 1e-9,
}


def mixture():
    """A scene of 54 small discs and 6 discs twelve times as large, without overlaps."""
    import random

    random.seed(1)
    placed = []
    for radius in [3.0] * 6 + [0.25] * 54:
        while True:
            at = [random.uniform(0, 40), random.uniform(0, 30)]
            apart = lambda other: (
                min(abs(at[0] - other[0]), 40 - abs(at[0] - other[0])) ** 2
                + min(abs(at[1] - other[1]), 30 - abs(at[1] - other[1])) ** 2
            ) ** 0.5
            if all(apart(other) > 1.01 * (radius + other[2]) for other in placed):
                placed.append([*at, radius])
                break
    velocities = [[random.gauss(0, 1), random.gauss(0, 1)] for _ in placed]
    return (
        'format = 2\nunits = "reduced"\n[method]\nkind = "hard-disks"\n[domain]\nsides = [40.0, 30.0]\n[particles]\ngenerate = "list"\n'
        f"radius = 0.25\nmass = 1.0\npositions = {[it[:2] for it in placed]}\nradii = {[it[2] for it in placed]}\n"
        f"velocities = {velocities}\n[run]\ntime = 32.0\nsnapshot_every = 0.5\nthermo_every = 0.5\n"
    )


def frames(path, numpy):
    """Box, periodic sides, and positions, velocities, radii and masses of grains and walls of each frame."""
    lines = path.read_text().splitlines()
    at = 0
    while at < len(lines):
        count, comment = int(lines[at]), lines[at + 1]
        cell = [float(part) for part in comment.split('Lattice="')[1].split('"')[0].split()]
        origin = [float(part) for part in comment.split('Origin="')[1].split('"')[0].split()] if "Origin=" in comment else [0, 0]
        periodic = [word == "T" for word in comment.split('pbc="')[1].split('"')[0].split()[:2]]
        properties = comment.split("Properties=")[1].split()[0].split(":")
        column, names = 0, {}
        for name, width in zip(properties[::3], properties[2::3]):
            names[name] = column
            column += int(width)
        rows = [line.split() for line in lines[at + 2 : at + 2 + count]]
        species = [row[names["species"]] for row in rows]
        take = lambda name, width: numpy.array([row[names[name] : names[name] + width] for row in rows], dtype=float)
        grains = numpy.array([word != "W" for word in species])
        yield {
            "sides": numpy.array([cell[0], cell[4]]), "origin": numpy.array(origin[:2]), "periodic": periodic, "grains": grains,
            "at": take("pos", 2), "v": take("velo", 2), "radius": take("radius", 1)[:, 0], "mass": take("mass", 1)[:, 0],
        }
        at += 2 + count


class Box:
    """The sampled frames of a run, and naive sums over them."""

    def __init__(self, folder, numpy, freud, has_open_top):
        self.np, self.freud, self.has_open_top = numpy, freud, has_open_top
        taken = list(frames(folder / "trajectory.xyz", numpy))
        # The first frame is the start, and the last moment occurs once.
        assert len(taken) == LOOKS + 1, f"{len(taken)} frames"
        self.all = taken[1:]
        self.counted = self.all[LOOKS // 2 :]
        first = taken[0]
        self.sides, self.periodic, self.origin, self.grains = (first[key] for key in ("sides", "periodic", "origin", "grains"))
        self.radius, self.mass = first["radius"][self.grains], first["mass"][self.grains]
        self.walls = first["at"][~self.grains], first["radius"][~self.grains]
        self.start = first["at"][self.grains]
        # The box that discs above an open top need.
        self.room = self.sides.copy()
        if has_open_top:
            self.room[1] = 2 * max(frame["at"][:, 1].max() for frame in taken) + self.sides[1]

    def of_grains(self, name):
        return [frame[name][self.grains] for frame in self.counted]

    def shifted(self, places):
        """Positions relative to the middle of the box, as in freud."""
        points = self.np.zeros((len(places), 3))
        points[:, :2] = places - self.origin - 0.5 * self.room
        return points

    def freud_box(self):
        box = self.freud.box.Box(*self.room)
        box.periodic = [*self.periodic, False]
        return box

    def ways(self, places):
        """Vectors from each disc to each other one, by the nearest image."""
        ways = places[None, :, :] - places[:, None, :]
        for axis in range(2):
            if self.periodic[axis]:
                ways[:, :, axis] -= self.sides[axis] * self.np.round(ways[:, :, axis] / self.sides[axis])
        return ways

    def ideal(self, edges):
        """Probability that a pair of an ideal gas is in each bin, between closed sides and wall discs: by random pairs."""
        np = self.np
        if all(self.periodic):
            return np.pi * np.diff(edges**2) / self.sides.prod()
        random = np.random.default_rng(1)
        chance, rounds = np.zeros(len(edges) - 1), 100 if len(self.walls[0]) else 400
        for _ in range(rounds):
            at = []
            numbers = random.integers(len(self.radius), size=4000)
            radii = self.radius[numbers]
            at = self.origin + random.uniform(size=(4000, 2)) * self.sides
            inside = np.ones(4000, dtype=bool)
            for axis in range(2):
                if not self.periodic[axis]:
                    low = self.origin[axis]
                    inside &= (at[:, axis] > low + radii) & (at[:, axis] < low + self.sides[axis] - radii)
            places, sizes = self.walls
            if len(places):
                ways = at[:, None, :] - places[None, :, :]
                for axis in range(2):
                    if self.periodic[axis]:
                        ways[:, :, axis] -= self.sides[axis] * np.round(ways[:, :, axis] / self.sides[axis])
                inside &= (np.hypot(ways[:, :, 0], ways[:, :, 1]) > sizes[None, :] + radii[:, None]).all(axis=1)
                # In a channel along x, positions beyond the walls cannot be reached.
                low, high = self.start[:, 1].min(), self.start[:, 1].max()
                below, above = places[places[:, 1] < low, 1], places[places[:, 1] > high, 1]
                inside &= (at[:, 1] > below.max()) & (at[:, 1] < above.min())
            at = at[inside]
            distances = np.hypot(*np.moveaxis(self.ways(at), 2, 0))[np.triu_indices(len(at), 1)]
            chance += np.histogram(distances, edges)[0] / len(distances)
        return chance / rounds

    def pair_correlation(self, ours):
        np, width = self.np, ours[1, 0] - ours[0, 0]
        edges = np.arange(len(ours) + 1) * width
        counts = np.zeros(len(ours))
        for places in self.of_grains("at"):
            # Below an open top a bin has so few pairs that one pair, moved by freud's single precision, is two percent.
            if edges[-1] < 0.499 * min(self.sides) and not self.has_open_top:
                rdf = self.freud.density.RDF(len(ours), edges[-1])
                rdf.compute((self.freud_box(), self.freud_box().wrap(self.shifted(places))))
                counts += rdf.bin_counts / 2
            else:
                # freud's range ends below half a side.
                distances = np.hypot(*np.moveaxis(self.ways(places), 2, 0))
                counts += np.histogram(distances[np.triu_indices(len(places), 1)], edges)[0]
        pairs = len(self.radius) * (len(self.radius) - 1) / 2
        if self.has_open_top:
            return self.above_floor(ours, counts, edges)
        ideal = self.ideal(edges)
        if not all(self.periodic):
            # Bins of a tenth of a diameter, since the ideal gas is computed from random numbers.
            join = lambda values: values[: len(values) // 5 * 5].reshape(-1, 5).sum(axis=1)
            areas = np.diff(edges**2)
            return join(ours[:, 1] * areas) / join(areas), join(counts) / (len(self.counted) * pairs * join(ideal))
        return ours[:, 1], counts / (len(self.counted) * pairs * ideal)

    def species(self):
        """Members of the two species: the smaller and the larger discs."""
        small = self.radius == self.radius.min()
        return [small, ~small]

    def partial_correlations(self, ours):
        np, width = self.np, ours[1, 2] - ours[0, 2]
        bins = round(ours[:, 2].max() / width + 0.5)
        edges, species, theirs = np.arange(bins + 1) * width, self.species(), []
        for a, b in ((0, 0), (0, 1), (1, 1)):
            one, other = species[a], species[b]
            counts = np.zeros(bins)
            for places in self.of_grains("at"):
                if edges[-1] < 0.499 * min(self.sides):
                    wrapped = lambda members: self.freud_box().wrap(self.shifted(places[members]))
                    rdf = self.freud.density.RDF(bins, edges[-1])
                    rdf.compute((self.freud_box(), wrapped(one)), query_points=None if a == b else wrapped(other))
                    counts += rdf.bin_counts / (2 if a == b else 1)
                else:
                    distances = np.hypot(*np.moveaxis(self.ways(places), 2, 0))[np.ix_(one, other)]
                    distances = distances[np.triu_indices(len(distances), 1)] if a == b else distances.ravel()
                    counts += np.histogram(distances, edges)[0]
            pairs = one.sum() * (one.sum() - 1) / 2 if a == b else one.sum() * other.sum()
            theirs.append(counts / (len(self.counted) * pairs * self.ideal(edges)))
        return ours[:, 3], np.concatenate(theirs)

    def partial_factors(self, ours):
        np, species = self.np, self.species()

        def of(a, b, k):
            sums = [[np.exp(1j * places[species[it]] @ k).sum() for places in self.of_grains("at")] for it in (a, b)]
            norm = np.sqrt(species[a].sum() * species[b].sum())
            return np.mean([(x * np.conj(y)).real / norm for x, y in zip(*sums)])

        return ours[:, 4], np.array([of(int(row[0]) - 1, int(row[1]) - 1, row[2:4]) for row in ours])

    def partial_coordination(self, ours):
        np, species = self.np, self.species()
        reach, found = 1.5 * (self.radius[:, None] + self.radius[None, :]), np.zeros((2, 2))
        for places in self.of_grains("at"):
            near = np.hypot(*np.moveaxis(self.ways(places), 2, 0)) < reach
            np.fill_diagonal(near, False)
            found += [[near[np.ix_(a, b)].sum() / a.sum() for b in species] for a in species]
        return ours[:, 2], found.ravel() / len(self.counted)

    def above_floor(self, ours, counts, edges):
        """Pair density of discs with their own heights and uniform positions along the floor: that of the difference of two uniform numbers."""
        np, pairs = self.np, self.np.zeros(len(ours))
        upper = np.triu_indices(len(self.radius), 1)
        rooms = self.sides[0] - 2 * self.radius * (not self.periodic[0])
        one, other = rooms[upper[0]], rooms[upper[1]]

        def nearer(along):
            if self.periodic[0]:
                return 2 * along / self.sides[0]
            # Positions of the first disc that the second reaches, in the middle and at both ends.
            steps = (np.arange(64) + 0.5) / 64
            ways = along[:, None] * steps[None, :]
            overlap = np.clip(0.5 * (one + other)[:, None] - ways, 0, np.minimum(one, other)[:, None])
            return 2 * along * overlap.mean(axis=1) / (one * other)

        for places in self.of_grains("at"):
            heights = abs(places[upper[0], 1] - places[upper[1], 1])
            within = [nearer(np.sqrt(np.maximum(edge**2 - heights**2, 0))).sum() for edge in edges]
            pairs += np.diff(within)
        return ours[:, 1], counts / pairs

    def factor(self, ours):
        np = self.np
        of = lambda places, k: abs(np.exp(1j * places @ k).sum()) ** 2 / len(places)
        return ours[:, 2], np.array([np.mean([of(places, k) for places in self.of_grains("at")]) for k in ours[:, :2]])

    def coordination(self, ours):
        np = self.np
        reach = 1.5 * (self.radius[:, None] + self.radius[None, :])
        shares = np.zeros(len(ours))
        for places in self.of_grains("at"):
            near = np.hypot(*np.moveaxis(self.ways(places), 2, 0)) < reach
            numbers = near.sum(axis=1) - 1
            shares += np.bincount(numbers, minlength=len(ours))[: len(ours)] / len(places)
        return ours[:, 1], shares / len(self.counted)

    def hexatic(self, summary):
        np, orders = self.np, []
        count = min(6, len(self.radius) - 1)
        for places in self.of_grains("at"):
            ways = self.ways(places)
            if count == 6 and (all(self.periodic) or self.has_open_top) and min(self.sides) > 10:
                hexatic = self.freud.order.Hexatic(k=6)
                points = self.freud_box().wrap(self.shifted(places))
                order = hexatic.compute((self.freud_box(), points), neighbors={"num_neighbors": 6}).particle_order
            else:
                # In narrow boxes freud counts several images of a disc.
                distances = np.hypot(ways[:, :, 0], ways[:, :, 1])
                nearest = np.argsort(distances, axis=1)[:, 1 : count + 1]
                angles = np.arctan2(ways[:, :, 1], ways[:, :, 0])
                order = np.exp(6j * np.take_along_axis(angles, nearest, axis=1)).mean(axis=1)
            orders.append([abs(order.mean()), abs(order).mean()])
        return np.array([it["mean"] for it in summary["headlines"]]), np.mean(orders, axis=0)

    def velocities(self, ours):
        np, density = self.np, self.np.zeros(len(ours))
        for v in self.of_grains("v"):
            temperature = (self.mass[:, None] * v**2).mean()
            scaled = (v * np.sqrt(self.mass / temperature)[:, None]).ravel()
            density += np.histogram(scaled, np.linspace(-5, 5, 101))[0] / (len(scaled) * 0.1)
        return ours[:, 1], density / len(self.counted)

    def profile(self, ours, axis, what):
        np, width = self.np, self.sides[axis] / 100
        is_high = self.has_open_top and axis == 1
        blocks = []
        for block in range(LOOKS // 2 // BLOCK):
            top, bottom = np.zeros(100), np.zeros(100)
            for frame in self.counted[BLOCK * block : BLOCK * (block + 1)]:
                at, v = frame["at"][self.grains], frame["v"][self.grains]
                # Discs above an open top are in no slice.
                slices = np.minimum((at[:, axis] - self.origin[axis]) / width, 100 if is_high else 99).astype(int)
                sums = lambda weights: np.bincount(slices, weights, minlength=101)[:100]
                count, mass = sums(np.ones(len(at))), sums(self.mass)
                momenta = [sums(self.mass * v[:, along]) for along in range(2)]
                if what == "density":
                    height = at[:, 1].max() - self.origin[1] if self.has_open_top and axis == 0 else self.sides[1]
                    top, bottom = top + count * 100 / self.sides[0], bottom + height
                elif what == "flow":
                    top, bottom = top + momenta[1 - axis], bottom + mass
                else:
                    square = sums(self.mass * (v**2).sum(axis=1))
                    with np.errstate(invalid="ignore", divide="ignore"):
                        beside = np.where(count > 1, square - (momenta[0] ** 2 + momenta[1] ** 2) / mass, 0)
                    top, bottom = top + beside, bottom + 2 * np.maximum(count - 1, 0)
            blocks.append([top, bottom])
        tops, bottoms = np.moveaxis(np.array(blocks), 1, 0)
        slices = np.rint((ours[:, 0] - self.origin[axis]) / width - 0.5).astype(int)
        return ours[:, 1], (tops.sum(axis=0)[slices] / bottoms.sum(axis=0)[slices])

    def over_lags(self, ours, of):
        """Means over the blocks of the second half except the last: lags from 0 to the length of a block begin in a block."""
        np, whole = self.np, LOOKS // BLOCK - 1
        found = []
        for lag in range(len(ours)):
            blocks = [of(lag, BLOCK * block) for block in range(-(-whole // 2), whole)]
            found.append(np.mean(blocks))
        return ours[:, 1], np.array(found)

    def displacements(self, ours, folder, members=slice(None)):
        import gsd.hoomd
        import MDAnalysis
        from MDAnalysis.analysis.msd import EinsteinMSD

        np = self.np
        with gsd.hoomd.open(folder / "trajectory.gsd") as trajectory:
            of = lambda frame: frame.particles.position[:, :2] + frame.particles.image[:, :2] * frame.configuration.box[:2]
            places = np.array([of(frame)[self.grains][members] for frame in trajectory[1 : LOOKS + 1]])
        places = np.concatenate([places, np.zeros((*places.shape[:2], 1))], axis=2)
        universe = MDAnalysis.Universe.empty(places.shape[1], trajectory=True)
        universe.load_new(places)

        def mean(lag, first):
            if lag == 0:
                return 0.0
            einstein = EinsteinMSD(universe, msd_type="xy", fft=False)
            einstein.run(start=first, stop=first + BLOCK + lag)
            return einstein.results.timeseries[lag]

        return self.over_lags(ours, mean)

    def products(self, ours):
        v = self.np.array([frame["v"][self.grains] for frame in self.all])
        of = lambda lag, first: self.np.mean([(v[at] * v[at + lag]).sum(axis=1).mean() for at in range(first, first + BLOCK)])
        return self.over_lags(ours, of)


def differences(stripmine, scene, settings, numpy, freud, folder, has_species):
    """Yields the largest difference of each function, relative to its largest value."""
    if scene.endswith(".toml"):
        (folder / scene).write_text(mixture())
        scene = str(folder / scene)
    allowed = [name for name in FUNCTIONS if has_species or "_a" not in name]
    names = [name for name in allowed if not (name == "S(k)" and "false, false" in str(settings.get("domain.periodic")))]
    settings = settings | {"output.structure": json.dumps(names), "output.structure_share": 1000.0, "output.gsd": "true"}
    sets = [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
    out = folder / "run"
    done = subprocess.run([stripmine, "run", scene, "--quiet", "--out", out, *sets], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    box = Box(out, numpy, freud, scene in OPEN)
    structure = {it["name"]: it for it in json.loads((out / "summary.json").read_text())["structure"]}
    assert all(structure[name]["looks_of_a_block"] == BLOCK for name in names), structure
    found = {}
    for name in names:
        ours = numpy.loadtxt(out / structure[name]["file"], delimiter=",", skiprows=1, ndmin=2)
        if len(ours) == 0:
            assert structure[name].get("doubt"), name
            continue
        kind, _, axis = name.partition("(")
        if name == "g(r)":
            ours, theirs = box.pair_correlation(ours)
        elif name == "S(k)":
            ours, theirs = box.factor(ours)
        elif name == "coordination":
            ours, theirs = box.coordination(ours)
        elif name == "psi6":
            ours, theirs = box.hexatic(structure[name])
        elif name == "velocities":
            ours, theirs = box.velocities(ours)
        elif name == "msd":
            ours, theirs = box.displacements(ours, out)
        elif name == "g_ab(r)":
            ours, theirs = box.partial_correlations(ours)
        elif name == "S_ab(k)":
            ours, theirs = box.partial_factors(ours)
        elif name == "coordination_ab":
            ours, theirs = box.partial_coordination(ours)
        elif name == "msd_a":
            each = [box.displacements(ours[ours[:, 0] == it + 1][:, 1:], out, members) for it, members in enumerate(box.species())]
            ours, theirs = (numpy.concatenate(parts) for parts in zip(*each))
        elif name == "vacf":
            ours, theirs = box.products(ours)
        else:
            ours, theirs = box.profile(ours, "xy".index(axis[0]), kind)
        found[name] = abs(ours - theirs).max() / abs(theirs).max()
    return found


def main(stripmine):
    try:
        import freud
        import gsd
        import MDAnalysis
        import numpy
    except ImportError as error:
        print(f"SKIPPED: {error}")
        return 0
    print(f"freud {freud.__version__}, MDAnalysis {MDAnalysis.__version__}")
    wrong, table = 0, {}
    for name, (scene, settings) in BOXES.items():
        with tempfile.TemporaryDirectory() as folder:
            table[name] = differences(stripmine, scene, settings, numpy, freud, Path(folder), name in OF_TWO)
        for function, most in FUNCTIONS.items():
            most = 2e-2 if function == "g(r)" and name in ("closed", "channel") else most
            off = table[name].get(function)
            is_wrong = off is not None and not off <= most
            wrong += is_wrong
            print(f"{name}: {function}: {'nothing' if off is None else f'{off:.1e}'}{' WRONG' if is_wrong else ''}")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
