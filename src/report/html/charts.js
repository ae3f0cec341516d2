// Charts: lines, points with spreads, hatched bands, and a legend that hides and shows them.
"use strict";

/** The outlines of the markers about a point, for a radius of one: the twins of those of the pictures in SVG. */
const PLUS = "M-.42-1.25H.42V-.42H1.25V.42H.42V1.25H-.42V.42H-1.25V-.42H-.42Z";
const MARKERS = {
  disc: "M0-1A1 1 0 0 1 0 1A1 1 0 0 1 0-1Z",
  square: "M-.9-.9H.9V.9H-.9Z",
  triangle: "M0-1.2L1.13.76H-1.13Z",
  wedge: "M0 1.2L-1.13-.76H1.13Z",
  diamond: "M0-1.25L1.25 0L0 1.25L-1.25 0Z",
  plus: PLUS,
  cross: PLUS,
  star: "M0-1.4L.35-.49L1.33-.43L.57.19L.82 1.13L0 .6L-.82 1.13L-.57.19L-1.33-.43L-.35-.49Z",
};

function drawMarker(ctx, { colour, marker, hollow }, { x, y }, dots) {
  const radius = 4.5 * dots;
  const place = new DOMMatrix([radius, 0, 0, radius, x, y]).rotate(marker === "cross" ? 45 : 0);
  const outline = new Path2D();
  outline.addPath(new Path2D(MARKERS[marker]), place);
  // A white rim keeps full markers apart that lie on one another.
  [ctx.fillStyle, ctx.strokeStyle] = hollow ? ["#fff", colour] : [colour, "#fff"];
  ctx.lineWidth = (hollow ? 1.8 : 0.8) * dots;
  ctx.fill(outline);
  ctx.stroke(outline);
}

/** Draws the line of a series through places that are already in dots of a canvas, `dots` to a pixel. */
function drawLine(ctx, { colour, dash, marker, steps }, middles, dots) {
  if (!dash) return;
  const places = steps ? outline(middles) : middles;
  ctx.strokeStyle = colour;
  ctx.lineJoin = "round";
  ctx.lineWidth = (marker ? 1.4 : 2.2) * dots;
  ctx.setLineDash(dash.map((length) => length * dots));
  ctx.beginPath();
  places.forEach(({ x, y }) => ctx.lineTo(x, y));
  ctx.stroke();
  ctx.setLineDash([]);
}

/** The outline of a histogram whose bins have these middles: each bin reaches halfway to its neighbours. */
function outline(middles) {
  const edge = (i) => (middles[i].x + middles[i + 1].x) / 2;
  const last = middles.length - 1;
  if (last < 1) return middles;
  return middles.flatMap(({ x, y }, i) => [
    { x: i === 0 ? 2 * x - edge(0) : edge(i - 1), y },
    { x: i === last ? 2 * x - edge(last - 1) : edge(i), y },
  ]);
}

/** The light ground of a band across the plane; of several the first is the lightest. */
const GROUNDS = ["#ecf2f7", "#d4e3ef"];

/** Draws how far the values of a series are spread. */
function drawSpreads(ctx, { colour }, places, dots) {
  const cap = 3.5 * dots;
  ctx.strokeStyle = colour;
  ctx.lineWidth = 1.4 * dots;
  for (const { x, ends } of places) {
    if (!ends) continue;
    ctx.beginPath();
    ctx.moveTo(x, ends[0]);
    ctx.lineTo(x, ends[1]);
    ends.forEach((y) => (ctx.moveTo(x - cap, y), ctx.lineTo(x + cap, y)));
    ctx.stroke();
  }
}

/** Draws the markers of a series. */
function drawMarkers(ctx, look, places, dots) {
  if (look.marker) places.forEach((place) => drawMarker(ctx, look, place, dots));
}

/** Slanted lines over a box. */
function hatch(ctx, left, top, width, height, dots) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, top, width, height);
  ctx.clip();
  ctx.fillStyle = "rgba(0,0,0,0.04)";
  ctx.fillRect(left, top, width, height);
  ctx.strokeStyle = "rgba(0,0,0,0.28)";
  ctx.lineWidth = dots;
  ctx.beginPath();
  for (let at = left - height; at < left + width; at += 8 * dots) {
    ctx.moveTo(at, top + height);
    ctx.lineTo(at + height, top);
  }
  ctx.stroke();
  ctx.restore();
}

/** The point of a piece of line that is nearest to a place. */
function nearestOn(a, b, x, y) {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const length = dx * dx + dy * dy;
  const along = length > 0 ? Math.min(Math.max(((x - a.x) * dx + (y - a.y) * dy) / length, 0), 1) : 0;
  return { x: a.x + along * dx, y: a.y + along * dy };
}

pictures("chart", (holder, chart) => {
  chart.series.forEach((series) => (series.shown = true));

  /** The points of a series on the plane, in pixels or in dots of the canvas. */
  const places = (u, series, inDots) => {
    const at = (value, key) => u.valToPos(value, key, inDots);
    // What a logarithmic axis cannot show ends at the bottom.
    const low = (value) => (chart.y.log && value <= 0 ? u.scales.y.min / 10 : value);
    return Array.from(series.x, (x, i) => ({
      x: at(x, "x"),
      y: at(series.y[i], "y"),
      ends: series.spreads[i]?.map((end) => at(low(end), "y")),
    }));
  };

  const draw = (u, ctx) => {
    const dots = uPlot.pxRatio;
    const across = chart.bands.filter((band) => band.along === "Y");
    across.forEach((band, i) => {
      const { left, top, width, height } = u.bbox;
      const [low, high] = band.ends.map((end) => Math.min(Math.max(u.valToPos(end, "y", true), top), top + height));
      ctx.fillStyle = GROUNDS[Math.min(i, GROUNDS.length - 1)];
      ctx.fillRect(left, high, width, low - high);
    });
    for (const band of chart.bands.filter((each) => each.along === "X")) {
      // An end that the axis cannot show lies beyond it.
      const ends = band.ends.map((end) => (chart.x.log && !(end > 0) ? u.bbox.left : u.valToPos(end, "x", true)));
      const [left, right] = [Math.max(ends[0], u.bbox.left), Math.min(ends[1], u.bbox.left + u.bbox.width)];
      if (right > left) hatch(ctx, left, u.bbox.top, right - left, u.bbox.height, dots);
    }
    // Lines below, markers on top, whichever series they belong to.
    const shown = chart.series.filter((series) => series.shown).map((series) => [series.look, places(u, series, true)]);
    for (const layer of [drawLine, drawSpreads, drawMarkers]) shown.forEach(([look, at]) => layer(ctx, look, at, dots));
  };

  const probe = (u, left, top) => {
    let best = { distance: 30 };
    const offer = (series, { x, y }, index) => {
      // A marker before the line that runs through it: it is what was measured.
      const distance = Math.hypot(x - left, y - top) + (index === undefined ? 5 : 0);
      if (distance < best.distance) best = { distance, series, x, y, index };
    };
    for (const series of chart.series.filter(({ shown }) => shown)) {
      const at = places(u, series, false);
      at.forEach((place, i) => {
        if (series.look.marker) offer(series, place, i);
        else if (i > 0) offer(series, nearestOn(at[i - 1], place, left, top));
      });
    }
    if (!best.series) {
      const x = u.posToVal(left, "x");
      const band = chart.bands.find((each) => each.along === "X" && x >= each.ends[0] && x <= each.ends[1]);
      return band && { lines: [band.label, `${readable(band.ends[0])} to ${withUnit(band.ends[1], chart.x.unit)}`] };
    }
    const { series, index } = best;
    const x = index === undefined ? u.posToVal(best.x, "x") : series.x[index];
    const y = index === undefined ? u.posToVal(best.y, "y") : series.y[index];
    const lines = [
      series.name,
      `${chart.x.label}: ${withUnit(x, chart.x.unit)}`,
      `${chart.y.label}: ${withUnit(y, chart.y.unit)}`,
    ];
    const spread = series.spreads[index];
    if (spread) lines.push(`between ${readable(spread[0])} and ${withUnit(spread[1], chart.y.unit)}`);
    return { lines, at: [best.x, best.y] };
  };

  const { u, below } = plane(holder, chart, draw, probe, ", press a name to hide it");
  below.before(legend(chart, () => u.redraw(false)));
});

/** The names of what is drawn; pressing one hides or shows it. */
function legend(chart, redraw) {
  const box = element("div", "legend");
  const sample = (parent, draw) => {
    const canvas = element("canvas", "", parent);
    canvas.setAttribute("aria-hidden", "true");
    draw(sizeCanvas(canvas, 44, 14, Math.max(2, window.devicePixelRatio || 1)));
  };
  for (const series of chart.series) {
    const button = element("button", "", box);
    button.type = "button";
    button.setAttribute("aria-pressed", "true");
    sample(button, (ctx) => {
      const [left, middle, right] = [0, 22, 44].map((x) => ({ x, y: 7 }));
      drawLine(ctx, series.look, [left, right], 1);
      drawMarkers(ctx, series.look, [middle], 1);
    });
    button.append(series.name);
    button.addEventListener("click", () => {
      series.shown = !series.shown;
      button.setAttribute("aria-pressed", String(series.shown));
      redraw();
    });
  }
  for (const band of chart.bands) {
    const entry = element("span", "entry", box);
    const number = chart.bands.filter((each) => each.along === "Y").indexOf(band);
    sample(entry, (ctx) => {
      if (number < 0) return hatch(ctx, 0, 0, 44, 14, 1);
      ctx.fillStyle = GROUNDS[Math.min(number, GROUNDS.length - 1)];
      ctx.fillRect(0, 0, 44, 14);
    });
    entry.append(band.label);
  }
  return box;
}
