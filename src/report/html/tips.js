// What a chart or a map says where the pointer is, or, by arrow keys, from point to point. All is read from the pictures: their
// planes say where numbers lie, titles name what is drawn.
"use strict";

const REACH = 30; // how far from a point its values are shown (pixels of the picture)
const STRIDE = 10; // how far an arrow key goes on a map (pixels of the picture)

const ring = element("div", "ring", document.body);
const tip = element("div", "tip", document.body);
tip.setAttribute("role", "status");
const hide = () => (tip.hidden = ring.hidden = true);
hide();
document.addEventListener("scroll", hide, { capture: true, passive: true });

/** An axis as its plane states it. */
function axisOf(text) {
  const [scale, ...rest] = text.split(" ");
  const [from, to, low, high] = rest.slice(0, 4).map(Number);
  return { log: scale === "log", from, to, low, high, heading: rest.slice(4).join(" ") };
}

/** The value at a place of an axis, with the digits that a hundredth of a pixel tells. */
function valueAt({ log, from, to, low, high }, place) {
  const at = (pixels) => {
    const part = (pixels - from) / (to - from);
    return log ? low * (high / low) ** part : low + part * (high - low);
  };
  const [value, step] = [at(place), Math.abs(at(place + 0.01) - at(place))];
  return Math.abs(value) < step ? "0" : readable(value, Math.min(Math.max(Math.floor(Math.log10(Math.abs(value) / step)), 2), 5));
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
  const part = ((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy) || 0;
  const along = Math.min(Math.max(part, 0), 1);
  return { x: a.x + along * dx, y: a.y + along * dy };
}

/** A series: its name, its places, whether they are marked, and the ends of their spreads by the place across. */
function seriesOf(group) {
  const marks = group.querySelector("[style] > path");
  const [bars, curve] = [group.querySelector(":scope > path[d*=V]"), group.querySelector(":scope > path:not([d*=V])")];
  const spreads = [...(bars?.getAttribute("d") ?? "").matchAll(/M(\S+) (\S+)h9m-4.5 0V([\d.-]+)m/g)];
  return {
    name: group.dataset.name,
    marked: marks !== null,
    places: marks || curve ? corners(marks ?? curve) : [],
    spreads: spreads.map(([, left, low, high]) => ({ x: Number(left) + 4.5, ends: [low, high].map(Number) })),
  };
}

for (const plane of document.querySelectorAll(".picture [data-x]")) {
  const svg = plane.closest(".picture > svg");
  const [x, y] = [axisOf(plane.dataset.x), axisOf(plane.dataset.y)];
  const { value } = plane.dataset;
  // The browser's own tips would lie upon ours.
  for (const title of plane.querySelectorAll("title")) {
    title.parentElement.dataset.name = title.textContent;
    title.remove();
  }
  const series = value ? [] : [...plane.querySelectorAll("[data-name]:not(:has(> rect))")].map(seriesOf);
  // What was measured, or lines where nothing was.
  const marked = series.filter((of) => of.marked);
  const points = (marked.length ? marked : series).flatMap((of) => of.places.map((place) => ({ of, place })));

  const show = (lines, place, ringed) => {
    const at = new DOMPoint(place.x, place.y).matrixTransform(plane.getScreenCTM());
    tip.hidden = false;
    ring.hidden = !ringed;
    tip.replaceChildren(...lines.map((line, i) => Object.assign(element(i ? "div" : "strong"), { textContent: line })));
    // Beside the place, on the side where there is more room.
    const within = (at, length, whole) => Math.max(Math.min(at, whole - length - 4), 4);
    const left = at.x < innerWidth / 2 ? at.x + 14 : at.x - 14 - tip.offsetWidth;
    const [right, down] = [within(left, tip.offsetWidth, innerWidth), within(at.y - 20, tip.offsetHeight, innerHeight)];
    tip.style.translate = `${right}px ${down}px`;
    ring.style.translate = `${at.x}px ${at.y}px`;
  };
  const values = (place) => [`${x.heading}: ${valueAt(x, place.x)}`, `${y.heading}: ${valueAt(y, place.y)}`];
  const showPoint = ({ of, place }) => {
    const spread = of.spreads.find((each) => Math.abs(each.x - place.x) < 0.02);
    const ends = spread ? [`between ${spread.ends.map((end) => valueAt(y, end)).join(" and ")}`] : [];
    show([of.name, ...values(place), ...ends], place, true);
  };
  const look = (place, target) => {
    let best = { distance: REACH };
    const offer = (of, at, distance) => distance < best.distance && (best = { of, place: at, distance });
    const away = (at) => Math.hypot(at.x - place.x, at.y - place.y);
    for (const of of series) {
      // A marker before the line that runs past it: it is what was measured.
      if (of.marked) of.places.forEach((at) => offer(of, at, away(at)));
      else of.places.slice(1).forEach((end, i) => ((at) => offer(of, at, away(at) + 5))(nearestOn(of.places[i], end, place)));
    }
    const name = target?.closest("[data-name]")?.dataset.name;
    if (best.of) showPoint(best);
    else if (value && name) show([`${value}: ${name}`, ...values(place)], place);
    else if (name) show([name], place);
    else hide();
  };

  const follow = (event) => {
    const toPlane = plane.getScreenCTM().inverse();
    look(new DOMPoint(event.clientX, event.clientY).matrixTransform(toPlane), event.target);
  };
  svg.addEventListener("pointermove", follow);
  svg.addEventListener("pointerdown", follow);
  svg.addEventListener("pointerleave", hide);

  let [at, place] = [-1, { x: (x.from + x.to) / 2, y: (y.from + y.to) / 2 }];
  svg.addEventListener("blur", hide);
  svg.addEventListener("keydown", (event) => {
    const [right, down] = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1] }[event.key] ?? [];
    if (right === undefined) return;
    event.preventDefault();
    at = (at + right + down + points.length) % points.length;
    if (points.length) return showPoint(points[at]);
    const within = (number, { from, to }) => Math.min(Math.max(number, Math.min(from, to) + 1), Math.max(from, to) - 1);
    place = { x: within(place.x + right * STRIDE, x), y: within(place.y + down * STRIDE, y) };
    const screen = new DOMPoint(place.x, place.y).matrixTransform(plane.getScreenCTM());
    look(place, document.elementFromPoint(screen.x, screen.y));
  });
}
