// Tooltips with the values of charts and maps at the pointer, or from point to point by arrow keys. All data are read from the
// picture: its plane states the axes, titles name the series.
"use strict";

const REACH = 30; // distance from a point within which its values are shown (pixels of the picture)
const STRIDE = 10; // step of an arrow key on a map (pixels of the picture)

const [ring, tip] = ["ring", "tip"].map((name) => element("div", name, document.body));
tip.setAttribute("role", "status");
const hide = () => (tip.hidden = ring.hidden = true);
hide();
document.addEventListener("scroll", hide, { capture: true, passive: true });

const clamp = (number, low, high) => Math.max(Math.min(number, high), low);

/** Parses the description of an axis. */
function axisOf(text) {
  const [scale, ...rest] = text.split(" ");
  const [from, to, low, high] = rest.slice(0, 4).map(Number);
  const [heading, ...names] = scale === "names" ? rest.slice(4).join(" ").split("|") : [rest.slice(4).join(" ")];
  return { log: scale === "log", from, to, low, high, heading, names };
}

/** Returns the value at a position of an axis, with the digits resolved by a hundredth of a pixel; or the name there. */
function valueAt({ log, from, to, low, high, names }, place) {
  const at = (pixels) => {
    const part = (pixels - from) / (to - from);
    return log ? low * (high / low) ** part : low + part * (high - low);
  };
  if (names.length) return names[Math.round(at(place))] ?? "";
  const [value, step] = [at(place), Math.abs(at(place + 0.01) - at(place))];
  return Math.abs(value) < step ? "0" : readable(value, clamp(Math.floor(Math.log10(Math.abs(value) / step)), 2, 5));
}

/** Returns the corners of a path of relative steps. */
function corners(path) {
  const numbers = path.getAttribute("d").match(/-?(\d+\.?\d*|\.\d+)/g).map(Number);
  const [all, at] = [[], { x: 0, y: 0 }];
  for (let i = 0; i + 1 < numbers.length; i += 2) {
    at.x += numbers[i];
    at.y += numbers[i + 1];
    all.push({ ...at });
  }
  return all;
}

/** Returns the point of a line segment nearest to another point. */
function nearestOn(a, b, { x, y }) {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const along = clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy) || 0, 0, 1);
  return { x: a.x + along * dx, y: a.y + along * dy };
}

/** Reads a series: its name, its points, true if they have markers, and the ends of their spreads by position on the other axis. */
function seriesOf(group) {
  const marks = group.querySelector("[style] > path");
  const [bars, curve] = [":is([d*=V], [d*=H])", ":not([d*=V], [d*=H])"].map((which) => group.querySelector(`:scope > path${which}`));
  const bar = /M(-?[\d.]+) (-?[\d.]+)([hv])9m(?:-4.5 0V|0-4.5H)([\d.-]+)m/g;
  const spreads = [...(bars?.getAttribute("d") ?? "").matchAll(bar)].map(([, left, up, way, end]) => {
    const [side, at, begin] = way === "h" ? ["x", left, up] : ["y", up, left];
    return { side, at: Number(at) + 4.5, ends: [begin, end].map(Number) };
  });
  return {
    name: group.dataset.name,
    marked: marks !== null,
    places: marks || curve ? corners(marks ?? curve) : [],
    spreads,
  };
}

for (const plane of document.querySelectorAll(".picture [data-x]")) {
  const svg = plane.closest(".picture > svg");
  const { value } = plane.dataset;
  const [x, y] = [plane.dataset.x, plane.dataset.y].map(axisOf);
  // The browser's own tooltips would cover ours.
  for (const title of plane.querySelectorAll("title")) {
    title.parentElement.dataset.name = title.textContent;
    title.remove();
  }
  const series = value ? [] : [...plane.querySelectorAll("[data-name]:not(:has(> rect))")].map(seriesOf);
  // Measured points, or lines without any.
  const marked = series.filter((of) => of.marked);
  const points = (marked.length ? marked : series).flatMap((of) => of.places.map((place) => ({ of, place })));
  const onScreen = (place) => new DOMPoint(place.x, place.y).matrixTransform(plane.getScreenCTM());

  const show = (lines, place, ringed) => {
    const at = onScreen(place);
    [tip.hidden, ring.hidden] = [false, !ringed];
    tip.replaceChildren(...lines.map((line, i) => Object.assign(element(i ? "div" : "strong"), { textContent: line })));
    // On the side of the point with more room.
    const left = at.x < innerWidth / 2 ? at.x + 14 : at.x - 14 - tip.offsetWidth;
    const [right, down] = [innerWidth - tip.offsetWidth - 4, innerHeight - tip.offsetHeight - 4];
    tip.style.translate = `${clamp(left, 4, right)}px ${clamp(at.y - 20, 4, down)}px`;
    ring.style.translate = `${at.x}px ${at.y}px`;
  };
  const values = (place) => [`${x.heading}: ${valueAt(x, place.x)}`, `${y.heading}: ${valueAt(y, place.y)}`];
  const showPoint = ({ of, place }) => {
    const spread = of.spreads.find(({ side, at }) => Math.abs(at - place[side]) < 0.02);
    const along = spread?.side === "y" ? x : y;
    const ends = spread ? [`between ${spread.ends.map((end) => valueAt(along, end)).join(" and ")}`] : [];
    show([of.name, ...values(place), ...ends], place, true);
  };
  const look = (at, target) => {
    // Prefer a marker to a nearby line, because it was measured.
    const offers = series.flatMap((of) => {
      const near = of.marked ? of.places : of.places.slice(1).map((end, i) => nearestOn(of.places[i], end, at));
      return near.map((place) => ({ of, place, away: Math.hypot(place.x - at.x, place.y - at.y) + (of.marked ? 0 : 5) }));
    });
    const best = offers.reduce((best, each) => (each.away < best.away ? each : best), { away: REACH });
    const name = target?.closest("[data-name]")?.dataset.name;
    if (best.of) showPoint(best);
    else if (name) show(value ? [`${value}: ${name}`, ...values(at)] : [name], at);
    else hide();
  };
  const follow = ({ clientX, clientY, target }) =>
    look(new DOMPoint(clientX, clientY).matrixTransform(plane.getScreenCTM().inverse()), target);
  ["pointermove", "pointerdown"].forEach((what) => svg.addEventListener(what, follow));
  ["pointerleave", "blur"].forEach((what) => svg.addEventListener(what, hide));

  let [number, place] = [-1, { x: (x.from + x.to) / 2, y: (y.from + y.to) / 2 }];
  svg.addEventListener("keydown", (event) => {
    const { key } = event;
    if (!/^Arrow/.test(key)) return;
    event.preventDefault();
    const [right, down] = [(key === "ArrowRight") - (key === "ArrowLeft"), (key === "ArrowDown") - (key === "ArrowUp")];
    number = (Math.max(number, right + down < 0 ? 0 : -1) + right + down + points.length) % points.length;
    if (points.length) return showPoint(points[number]);
    place = { x: clamp(place.x + right * STRIDE, x.from + 1, x.to - 1), y: clamp(place.y + down * STRIDE, y.to + 1, y.from - 1) };
    const at = onScreen(place);
    look(place, document.elementFromPoint(at.x, at.y));
  });
}
