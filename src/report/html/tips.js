// What a chart or a map says where the pointer is, or, by arrow keys, from point to point. All is read from the picture: its
// plane says where numbers lie, titles name what is drawn.
"use strict";

const REACH = 30; // how far from a point its values are shown (pixels of the picture)
const STRIDE = 10; // how far an arrow key goes on a map (pixels of the picture)

const [ring, tip] = ["ring", "tip"].map((name) => element("div", name, document.body));
tip.setAttribute("role", "status");
const hide = () => (tip.hidden = ring.hidden = true);
hide();
document.addEventListener("scroll", hide, { capture: true, passive: true });

const clamp = (number, low, high) => Math.max(Math.min(number, high), low);

/** An axis as its plane states it. */
function axisOf(text) {
  const [scale, ...rest] = text.split(" ");
  const [from, to, low, high] = rest.slice(0, 4).map(Number);
  const [heading, ...names] = scale === "names" ? rest.slice(4).join(" ").split("|") : [rest.slice(4).join(" ")];
  return { log: scale === "log", from, to, low, high, heading, names };
}

/** The value at a place of an axis, with the digits that a hundredth of a pixel tells; or the name there. */
function valueAt({ log, from, to, low, high, names }, place) {
  const at = (pixels) => {
    const part = (pixels - from) / (to - from);
    return log ? low * (high / low) ** part : low + part * (high - low);
  };
  if (names.length) return names[Math.round(at(place))] ?? "";
  const [value, step] = [at(place), Math.abs(at(place + 0.01) - at(place))];
  return Math.abs(value) < step ? "0" : readable(value, clamp(Math.floor(Math.log10(Math.abs(value) / step)), 2, 5));
}

/** The corners of a path that goes on in steps from its first. */
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

/** The place on a piece of line that is nearest to another. */
function nearestOn(a, b, { x, y }) {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const along = clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy) || 0, 0, 1);
  return { x: a.x + along * dx, y: a.y + along * dy };
}

/** A series: its name, its places, whether these are marked, and the ends of their spreads by the place on the other side. */
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
  // The browser's own tips would lie upon ours.
  for (const title of plane.querySelectorAll("title")) {
    title.parentElement.dataset.name = title.textContent;
    title.remove();
  }
  const series = value ? [] : [...plane.querySelectorAll("[data-name]:not(:has(> rect))")].map(seriesOf);
  // What was measured, or lines where nothing was.
  const marked = series.filter((of) => of.marked);
  const points = (marked.length ? marked : series).flatMap((of) => of.places.map((place) => ({ of, place })));
  const onScreen = (place) => new DOMPoint(place.x, place.y).matrixTransform(plane.getScreenCTM());

  const show = (lines, place, ringed) => {
    const at = onScreen(place);
    [tip.hidden, ring.hidden] = [false, !ringed];
    tip.replaceChildren(...lines.map((line, i) => Object.assign(element(i ? "div" : "strong"), { textContent: line })));
    // Beside the place, on the side where there is more room.
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
    // A marker before the line that runs past it: it is what was measured.
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
