// What the page itself does, and numbers as people read them.
"use strict";

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

/** A new element with a class, inside another. */
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

// On paper nothing is folded.
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((details) => (details.open = true)));
