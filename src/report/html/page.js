// Behaviour of the page, and formatting of numbers.
"use strict";

/** Returns a power of ten with superscript digits. */
const powerOfTen = (exponent) =>
  "10" + [...String(exponent)].map((digit) => (digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit])).join("");

/** Formats a number with significant digits: thousands separated by thin spaces, very large and small numbers with a power of ten. */
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

/** Makes an element with a class inside another. */
function element(kind, className, parent) {
  const made = document.createElement(kind);
  if (className) made.className = className;
  if (parent) parent.append(made);
  return made;
}

for (const button of document.querySelectorAll("[data-copy]")) {
  button.addEventListener("click", async () => {
    const code = button.parentElement.querySelector("code");
    window.getSelection().selectAllChildren(code);
    try {
      await navigator.clipboard.writeText(code.textContent);
      button.textContent = "Copied";
    } catch {
      // Files opened from disk may have no clipboard; the text is selected for the reader to copy.
      button.textContent = "Press Ctrl+C";
    }
    setTimeout(() => (button.textContent = "Copy"), 2000);
  });
}

// Marks the item in view in the table of contents.
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

// Unfolds everything for printing.
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((details) => (details.open = true)));
