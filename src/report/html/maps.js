// Maps: a number for each place of a grid, as a colour.
"use strict";

pictures("map", (holder, map) => {
  const { columns, rows, value } = map;
  const values = numbers(map.values);
  // The values are on the scale of their axis already; so must its ends be.
  const ends = value.ends.map((end) => (value.log ? Math.log10(end) : end));
  const colours = shadesOf(ends).map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)));

  const image = document.createElement("canvas");
  image.width = Math.max(columns, 1);
  image.height = Math.max(rows, 1);
  const ctx = image.getContext("2d");
  const pixels = ctx.createImageData(image.width, image.height);
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const number = values[row * columns + column];
      if (Number.isNaN(number)) continue; // no number is no colour
      // The first row of a map is the lowest, that of an image the topmost.
      pixels.data.set([...colours[shadeOf(number, ends)], 255], 4 * ((rows - 1 - row) * columns + column));
    }
  }
  ctx.putImageData(pixels, 0, 0);

  const draw = (u, onto) => {
    const [left, right] = map.x.ends.map((end) => u.valToPos(end, "x", true));
    const [bottom, top] = map.y.ends.map((end) => u.valToPos(end, "y", true));
    onto.imageSmoothingEnabled = false;
    onto.drawImage(image, left, top, right - left, bottom - top);
  };

  const probe = (u, left, top) => {
    // A cell's place on the plane is its place in the image, whatever the scales of the axes are.
    const part = (at, [from, to]) => (at - from) / (to - from);
    const edges = (key) => map[key].ends.map((end) => u.valToPos(end, key));
    const column = Math.floor(part(left, edges("x")) * columns);
    const row = Math.floor(part(top, edges("y")) * rows);
    if (column < 0 || column >= columns || row < 0 || row >= rows) return undefined;
    const number = values[row * columns + column];
    const shown = Number.isNaN(number) ? "none" : withUnit(value.log ? 10 ** number : number, value.unit);
    const place = (key, at) => `${map[key].label}: ${withUnit(u.posToVal(at, key), map[key].unit)}`;
    return { lines: [`${value.label}: ${shown}`, place("x", left), place("y", top)] };
  };

  const { below } = plane(holder, map, draw, probe);
  colourBar(below, value);
  below.prepend(below.lastChild);
});
