// What all pictures of the page share: colours, numbers as people read them, data from Rust; and what the page itself
// does.
"use strict";

/** The colours of magnitudes, and those of signed quantities, from the lowest to the highest. */
const [MAGNITUDES, SIGNED] = JSON.parse(document.getElementById("shades").textContent);

/** The colours of shades between two ends: 0 in the middle has a colour of its own. */
const shadesOf = ([low, high]) => (low < 0 && low === -high ? SIGNED : MAGNITUDES);

/** The number of the shade of a value between two ends. */
function shadeOf(value, [low, high]) {
  const place = high > low ? (value - low) / (high - low) : 0.5;
  return Math.round(Math.min(Math.max(place, 0), 1) * (MAGNITUDES.length - 1));
}

/** The numbers of a `Quantised` of Rust; NaN where there is none. */
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

/** Ten to a whole power, with raised digits. */
const powerOfTen = (exponent) =>
  "10" + [...String(exponent)].map((digit) => (digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit])).join("");

/** A number for reading, with that many digits: thousands set apart by thin blanks, a power of ten far from one. */
function readable(value, digits = 4) {
  if (value === 0) return "0";
  const rounded = Number(value.toPrecision(digits));
  const exponent = Math.floor(Math.log10(Math.abs(rounded)) + 1e-12);
  if (exponent < -4 || exponent > 6) {
    const mantissa = Number((rounded / 10 ** exponent).toPrecision(digits));
    const sign = mantissa < 0 ? "−" : "";
    return sign + (Math.abs(mantissa) === 1 ? "" : Math.abs(mantissa) + "·") + powerOfTen(exponent);
  }
  const [whole, fraction] = String(Math.abs(rounded)).split(".");
  const grouped = whole.replace(/\B(?=(\d{3})+$)/g, "\u202f");
  return (rounded < 0 ? "−" : "") + grouped + (fraction ? "." + fraction : "");
}

/** A number with its unit. */
const withUnit = (value, unit) => readable(value) + (unit ? "\u202f" + unit : "");

/** An axis's label with its unit. */
const heading = ({ label, unit }) => (unit ? `${label} (${unit})` : label);

/** A new element with a class, inside another. */
function element(kind, className, parent) {
  const made = document.createElement(kind);
  if (className) made.className = className;
  if (parent) parent.append(made);
  return made;
}

/** A drawing surface of a size in pixels of the page, sharp on screens with finer dots. */
function sizeCanvas(canvas, width, height, dots = window.devicePixelRatio || 1) {
  canvas.width = Math.round(width * dots);
  canvas.height = Math.round(height * dots);
  canvas.style.width = width + "px";
  canvas.style.height = height + "px";
  const ctx = canvas.getContext("2d");
  ctx.setTransform(dots, 0, 0, dots, 0, 0);
  return ctx;
}

/** A bar that says what the colours mean. */
function colourBar(parent, { label, unit, log, ends }) {
  const bar = element("div", "colour-bar", parent);
  element("span", "", bar).textContent = heading({ label, unit }) + (log ? ", logarithmic:" : ":");
  element("span", "", bar).textContent = readable(ends[0], 3);
  element("span", "shades", bar).style.background = `linear-gradient(to right, ${shadesOf(ends).join(", ")})`;
  element("span", "", bar).textContent = readable(ends[1], 3);
}

/** Makes the pictures of a kind. Where that fails, the drawing for readers without scripts is shown. */
function pictures(kind, make) {
  for (const holder of document.querySelectorAll(`.picture[data-kind="${kind}"]`)) {
    try {
      make(holder, JSON.parse(holder.querySelector("script").textContent));
    } catch (error) {
      console.error(holder.dataset.label, error);
      holder.querySelectorAll(":scope > div").forEach((part) => part.remove());
      holder.querySelector(".on-paper")?.classList.add("instead");
    }
  }
}

for (const button of document.querySelectorAll("[data-copy]")) {
  button.addEventListener("click", async () => {
    const code = button.parentElement.querySelector("code");
    window.getSelection().selectAllChildren(code);
    try {
      await navigator.clipboard.writeText(code.textContent);
      button.textContent = "Copied";
    } catch {
      // Files opened from the disk may have no clipboard; the text is marked for the reader to copy.
      button.textContent = "Press Ctrl+C";
    }
    setTimeout(() => (button.textContent = "Copy"), 2000);
  });
}

// The list of contents marks the item one reads.
const marker = new IntersectionObserver(
  (entries) => {
    for (const { target, isIntersecting } of entries) {
      const link = document.querySelector(`.contents a[href="#${CSS.escape(target.id)}"]`);
      if (isIntersecting) link?.setAttribute("aria-current", "true");
      else link?.removeAttribute("aria-current");
    }
  },
  { rootMargin: "-20% 0px -70% 0px" },
);
document.querySelectorAll("main > section, #summary").forEach((section) => marker.observe(section));
