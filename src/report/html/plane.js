// A plane with two axes that charts and maps are drawn on: ticks, zoom by dragging, what lies below the pointer.
// uPlot draws the axes and minds the pointer; what lies on the plane is ours.
"use strict";

/** How many texts have room along a side of the plane. */
function room({ bbox }, axis) {
  const [length, text] = axis === 0 ? [bbox.width, 75] : [bbox.height, 42];
  return Math.max(2, Math.floor(length / uPlot.pxRatio / text));
}

/** What uPlot must know of an axis: 0 is the horizontal one. */
function side(key, index, axis) {
  const labels = (u, ticks) => labelsOf(axis, ticks, u.scales[key].min, u.scales[key].max, room(u, index));
  // Only what has a text gets a line through the plane.
  const labelled = (u, ticks) => labels(u, ticks).map((text, i) => (text ? ticks[i] : null));
  const widest = (texts) => Math.max(0, ...(texts ?? []).map((text) => text.length));
  return {
    scale: key,
    label: heading(axis),
    labelFont: "600 13px system-ui, sans-serif",
    labelSize: 24,
    font: "13px system-ui, sans-serif",
    stroke: "#222",
    gap: 4,
    size: (u, texts) => (index === 0 ? 30 : 18 + 7.5 * widest(texts)),
    grid: { stroke: "#e4e4e4", width: 1, filter: labelled },
    ticks: { stroke: "#888", width: 1, size: 5 },
    splits: (u, _, low, high) => ticksOf(axis, low, high, room(u, index)),
    values: labels,
    filter: (u, ticks) => ticks, // uPlot's own choice among logarithmic ticks would empty some texts
  };
}

/**
 * Makes a plane inside `holder`. `draw(u, ctx)` draws on it, in dots of the canvas, clipped to the plane;
 * `probe(u, left, top)` says what lies at a pixel: `{ lines, at }`, or nothing. `more` is what else a reader can do.
 */
function plane(holder, axes, draw, probe, more = "") {
  const view = { x: axes.x.ends, y: axes.y.ends };
  const box = element("div", "plane", holder);
  box.setAttribute("role", "img");
  box.setAttribute("aria-label", holder.dataset.label);
  const below = element("div", "below", holder);
  const hint = element("span", "hint", below);
  hint.textContent = "Point to read values, drag to zoom, double-click for all" + more + ".";
  const whole = element("button", "", below);
  whole.type = "button";
  whole.textContent = "Show all";
  whole.hidden = true;

  const scale = (key) => ({ time: false, distr: axes[key].log ? 3 : 1, range: () => view[key] });
  const extent = () => ({
    width: holder.clientWidth,
    height: Math.round(Math.min(Math.max(holder.clientWidth * 0.52, 300), 480)),
  });

  const show = (ends) => {
    Object.assign(view, ends);
    u.batch(() => ["x", "y"].forEach((key) => u.setScale(key, { min: view[key][0], max: view[key][1] })));
    whole.hidden = view.x === axes.x.ends && view.y === axes.y.ends;
  };
  const all = () => show({ x: axes.x.ends, y: axes.y.ends });
  whole.addEventListener("click", all);

  const chosen = (u) => {
    const { left, top, width, height } = u.select;
    if (width < 4 && height < 4) return;
    const part = (key, from, to) => [from, to].map((at) => u.posToVal(at, key));
    // A drag along one side chooses the whole of the other.
    const ends = {};
    if (width < u.over.clientWidth) ends.x = part("x", left, left + width);
    if (height < u.over.clientHeight) ends.y = part("y", top + height, top);
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    // Closer than that, ticks would no longer be different numbers.
    const near = ([low, high]) => high - low < 1e-9 * Math.max(Math.abs(low), Math.abs(high));
    if (!Object.values(ends).some(near)) show(ends);
  };

  const marks = (u) => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    draw(u, ctx);
    ctx.restore();
    ctx.strokeStyle = "#555";
    ctx.lineWidth = uPlot.pxRatio;
    ctx.strokeRect(bbox.left, bbox.top, bbox.width, bbox.height);
  };

  const read = element("div", "read-out", box);
  const ring = element("div", "ring");
  const follow = (u) => {
    const { left, top } = u.cursor;
    const found = left >= 0 && top >= 0 ? probe(u, left, top) : undefined;
    read.hidden = ring.hidden = !found;
    if (!found) return;
    read.replaceChildren(
      ...found.lines.map((line, i) =>
        Object.assign(document.createElement(i ? "div" : "strong"), { textContent: line }),
      ),
    );
    const [x, y] = found.at ?? [left, top];
    ring.hidden = !found.at;
    ring.style.transform = `translate(${x}px, ${y}px)`;
    // Beside the point, on the side where there is more room.
    const right = x < u.over.clientWidth / 2;
    read.style.left = u.over.offsetLeft + x + (right ? 14 : -14 - read.offsetWidth) + "px";
    read.style.top = u.over.offsetTop + Math.min(Math.max(y - 20, 0), u.over.clientHeight - read.offsetHeight) + "px";
  };

  const u = new uPlot(
    {
      ...extent(),
      padding: [12, 18, 0, 0],
      legend: { show: false },
      cursor: {
        drag: { setScale: false, x: true, y: true, uni: 15 },
        points: { show: false },
        bind: { dblclick: () => () => all() },
      },
      scales: { x: scale("x"), y: scale("y") },
      axes: [side("x", 0, axes.x), side("y", 1, axes.y)],
      // uPlot wants a series for its scales; the marks are drawn by the hook.
      series: [{}, { show: false }],
      hooks: { draw: [marks], setSelect: [chosen], setCursor: [follow] },
    },
    [
      [1, 2],
      [1, 2],
    ],
    box,
  );
  u.over.append(ring);
  read.hidden = ring.hidden = true;
  new ResizeObserver(() => {
    if (holder.clientWidth > 0 && holder.clientWidth !== u.width) u.setSize(extent());
  }).observe(holder);
  return { u, below };
}
