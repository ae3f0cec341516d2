// Drawing of discs on a canvas. A window much longer than wide is cut into strips, one below the other, to be read like the lines of a
// text.
"use strict";

/** Colours of magnitudes and of signed quantities, from the lowest to the highest. */
const [MAGNITUDES, SIGNED] = JSON.parse(document.getElementById("shades").textContent);

/** Returns the colours of shades between two ends; 0 in the middle has a distinct colour. */
const shadesOf = ([low, high]) => (low < 0 && low === -high ? SIGNED : MAGNITUDES);

/** Returns the index of the shade of a value between two ends. */
function shadeOf(value, [low, high]) {
  const place = high > low ? (value - low) / (high - low) : 0.5;
  return Math.round(Math.min(Math.max(place, 0), 1) * (MAGNITUDES.length - 1));
}

/** Decodes the numbers of a `Quantised` of Rust. */
function numbers({ low, high, bytes, codes }) {
  const all = Uint8Array.from(atob(codes), (letter) => letter.charCodeAt(0));
  const out = new Float64Array(all.length / bytes);
  const highest = 256 ** bytes - 2;
  for (let i = 0; i < out.length; i++) {
    const code = bytes === 1 ? all[i] : all[2 * i] + 256 * all[2 * i + 1];
    out[i] = code > highest ? NaN : low + (code / highest) * (high - low);
  }
  return out;
}

/** Sets the size of a canvas in pixels of the page, sharp on high-resolution screens. */
function sizeCanvas(canvas, width, height, dots = window.devicePixelRatio || 1) {
  canvas.width = Math.round(width * dots);
  canvas.height = Math.round(height * dots);
  canvas.style.width = width + "px";
  canvas.style.height = height + "px";
  const ctx = canvas.getContext("2d");
  ctx.setTransform(dots, 0, 0, dots, 0, 0);
  return ctx;
}

const GUTTER = 64; // space for the coordinate at the start of a strip (pixels)
const LOWEST_STRIP = 34; // minimum height of a strip that shows discs (pixels)
const MOST_STRIPS = 16;

const STILL = "#b0b0b0"; // colour of discs without a shade
const LEAST = 0.8; // minimum radius of a visible disc (pixels)

/** Returns the layout on a canvas of a width and a maximum height: height of a strip, scale, and conversion from lengths to pixels. */
function layOut(film, width, tallest) {
  const [[left, bottom], [right, top]] = film.window;
  const [wide, high] = [right - left, top - bottom];
  // A tall window is rotated, with its lower end to the right.
  const tall = film.long && high > wide;
  const [length, thick] = tall ? [high, wide] : [wide, high];
  // During layout the page may not have a width yet.
  const free = Math.max(film.long ? width - GUTTER : width, 1);
  let strips = 1;
  if (film.long) {
    strips = Math.min(Math.max(Math.ceil((LOWEST_STRIP * length) / (free * thick)), 4), MOST_STRIPS);
  }
  const scale = film.long ? (free * strips) / length : Math.min(free / length, tallest / thick);
  const gap = film.long ? 10 : 0;
  const head = film.long ? 26 : 0;
  return {
    strips,
    scale,
    head,
    gap,
    left: film.long ? GUTTER : (width - length * scale) / 2,
    stripLength: length / strips,
    stripHeight: thick * scale,
    height: head + strips * (thick * scale + gap) - gap,
    /** Distance along the long side and across it (length), from the upper left corner of the picture. */
    along: tall ? (x, y) => top - y : (x) => x - left,
    across: tall ? (x) => right - x : (x, y) => top - y,
    /** Coordinate on the axis of the long side at a distance along it. */
    place: (along) => (tall ? top - along : left + along),
  };
}

/** Calls `circle(x, y, radius)` in pixels if a strip shows a part of a disc. */
function inStrip(layout, x, y, radius, strip, circle) {
  const along = layout.along(x, y) - strip * layout.stripLength;
  if (along + radius < 0 || along - radius > layout.stripLength) return;
  const seen = Math.max(radius * layout.scale, LEAST);
  circle(layout.left + along * layout.scale, layout.across(x, y) * layout.scale, seen);
}

/** Draws the hint above the strips, and the arrow of gravity if it points along them. */
function drawHead(ctx, falls) {
  const y = 10;
  const [from, to] = falls ? [GUTTER + 48, GUTTER + 100] : [GUTTER, GUTTER - 14];
  ctx.textAlign = "left";
  ctx.fillText("each line continues in the next", to + 14, y);
  if (!falls) return;
  ctx.fillText("gravity", GUTTER, y);
  ctx.lineWidth = 1.5;
  ctx.beginPath();
  ctx.moveTo(from, y);
  ctx.lineTo(to, y);
  ctx.moveTo(to - 7, y - 5);
  ctx.lineTo(to, y);
  ctx.lineTo(to - 7, y + 5);
  ctx.stroke();
}

/** Returns a screen for a film: `size(width, tallest, dots)` sets its layout, `show(frame)` draws a frame. */
function filmScreen(film, canvas) {
  const radii = numbers(film.radii);
  const [xs, ys, shades] = [film.x, film.y, film.shades].map(numbers);
  const fixed = { x: numbers(film.fixed.x), y: numbers(film.fixed.y), radii: numbers(film.fixed.radii) };
  const colour = (shade) => (Number.isNaN(shade) ? STILL : shadesOf(film.shade.ends)[shadeOf(shade, film.shade.ends)]);
  // Parts that do not change between frames are drawn once.
  const still = document.createElement("canvas");
  let layout, ctx, width;

  const top = (strip) => layout.head + strip * (layout.stripHeight + layout.gap);
  const eachStrip = (onto, paint) => {
    for (let strip = 0; strip < layout.strips; strip++) {
      onto.save();
      onto.translate(0, top(strip));
      onto.beginPath();
      onto.rect(layout.left, 0, layout.stripLength * layout.scale, layout.stripHeight);
      onto.clip();
      paint(strip);
      onto.restore();
    }
  };
  const disc = (onto, x, y, radius, strip) =>
    inStrip(layout, x, y, radius, strip, (...circle) => {
      onto.beginPath();
      onto.arc(...circle, 0, 2 * Math.PI);
      onto.fill();
      if (circle[2] > 2) onto.stroke();
    });

  /** Returns a colour of the page. */
  const ofPage = (name) => getComputedStyle(canvas).getPropertyValue(name);

  /** Draws sides of the box or walls within a strip; periodic sides are dashed. */
  const drawSides = (onto, strip, sides) => {
    onto.strokeStyle = ofPage("--quiet");
    onto.lineWidth = 2;
    for (const { ends, is_periodic } of sides) {
      onto.setLineDash(is_periodic ? [6, 5] : []);
      onto.beginPath();
      for (const [x, y] of ends) {
        const along = layout.along(x, y) - strip * layout.stripLength;
        onto.lineTo(layout.left + along * layout.scale, layout.across(x, y) * layout.scale);
      }
      onto.stroke();
    }
    onto.setLineDash([]);
  };

  const drawStill = (onto) => {
    onto.fillStyle = ofPage("--paper");
    onto.fillRect(0, 0, width, layout.height);
    eachStrip(onto, (strip) => {
      onto.fillStyle = ofPage("--box");
      onto.fillRect(layout.left, 0, layout.stripLength * layout.scale, layout.stripHeight);
      onto.fillStyle = STILL;
      onto.strokeStyle = "#8a8a8a";
      onto.lineWidth = 0.5;
      fixed.radii.forEach((radius, i) => disc(onto, fixed.x[i], fixed.y[i], radius, strip));
      drawSides(onto, strip, film.sides);
    });
    if (!film.long) return;
    onto.fillStyle = onto.strokeStyle = ofPage("--text");
    onto.font = "12px system-ui, sans-serif";
    onto.textBaseline = "middle";
    onto.textAlign = "right";
    for (let strip = 0; strip < layout.strips; strip++) {
      const begin = `${readable(layout.place(strip * layout.stripLength), 3)}\u202f${film.units[0]}`;
      onto.fillText(begin, GUTTER - 8, top(strip) + layout.stripHeight / 2);
    }
    drawHead(onto, film.falls);
  };

  return {
    size(wide, tallest, dots) {
      width = wide;
      layout = layOut(film, width, tallest);
      drawStill(sizeCanvas(still, width, layout.height, dots));
      ctx = sizeCanvas(canvas, width, layout.height, dots);
    },
    show(frame) {
      ctx.drawImage(still, 0, 0, width, layout.height);
      eachStrip(ctx, (strip) => {
        ctx.strokeStyle = ofPage("--rim");
        ctx.lineWidth = 0.6;
        radii.forEach((radius, i) => {
          const at = frame * radii.length + i;
          if (Number.isNaN(xs[at])) return;
          ctx.fillStyle = colour(shades[at]);
          disc(ctx, xs[at], ys[at], radius, strip);
        });
        const walls = film.walls?.[frame] ?? [];
        if (walls.length > 0) drawSides(ctx, strip, walls.map((ends) => ({ ends, is_periodic: false })));
      });
    },
  };
}
