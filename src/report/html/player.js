// Player of films: a screen with controls for mouse and keyboard.
"use strict";

const RATES = [1, 2, 5, 10, 20, 40]; // frames per second
const DOTS_ON_PAPER = 3; // dots per pixel in print

const LOW = 480; // height of a film among text (pixels)
const ELSE = 210; // height of everything but the film on a separate page (pixels)
const LASTS = 20; // maximum duration on a separate page, if a rate allows it (seconds)

/** Formats times with the number of decimals that the most precise one needs. */
function timesAsText(times, unit) {
  const decimals = times.map((time) => (String(Number(time.toPrecision(6))).split(".")[1] ?? "").length);
  const most = Math.max(0, ...decimals);
  return times.map((time) => `t = ${time.toFixed(most)}\u202f${unit}`);
}

/** Adds a legend of the colours. */
function colourBar(parent, { label, ends }) {
  const bar = element("div", "colour-bar", parent);
  element("span", "", bar).textContent = label + ":";
  element("span", "", bar).textContent = readable(ends[0], 3);
  element("span", "shades", bar).style.background = `linear-gradient(to right, ${shadesOf(ends).join(", ")})`;
  element("span", "", bar).textContent = readable(ends[1], 3);
}

/** Adds the controls of a player. */
function filmControls(player, film, usual) {
  const controls = element("div", "controls", player);
  const button = element("button", "play", controls);
  button.type = "button";
  const slider = element("input", "", controls);
  Object.assign(slider, { type: "range", min: 0, max: film.times.length - 1, step: 1, value: 0 });
  slider.setAttribute("aria-label", "Time");
  const time = element("output", "time", controls);
  const label = element("label", "", controls);
  label.append("Speed ");
  const speed = element("select", "", label);
  for (const rate of RATES) speed.add(new Option(`${rate} frames/s`, rate, rate === usual, rate === usual));
  colourBar(controls, film.shade);
  return { button, slider, time, speed };
}

for (const holder of document.querySelectorAll(".film")) {
  const film = JSON.parse(holder.querySelector("script").textContent);
  const last = film.times.length - 1;
  if (last < 0) {
    element("p", "", holder).textContent = "The film has no frames.";
    continue;
  }
  const player = element("div", "player", holder);
  player.tabIndex = 0;
  player.setAttribute("role", "group");
  const keys = "Space: play or pause. Arrow keys: next or previous frame.";
  player.setAttribute("aria-label", `${holder.dataset.label}. ${keys}`);
  const canvas = element("canvas", "", player);
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", holder.dataset.label);
  const alone = document.body.classList.contains("alone");
  const usual = alone ? (RATES.find((rate) => rate >= 5 && last / rate <= LASTS) ?? RATES.at(-1)) : 5;
  const { button, slider, time, speed } = filmControls(player, film, usual);
  const screen = filmScreen(film, canvas);
  const texts = timesAsText(film.times, film.units[1]);

  let frame = 0;
  const go = (to) => {
    frame = Math.min(Math.max(to, 0), last);
    slider.value = player.dataset.frame = frame;
    slider.setAttribute("aria-valuetext", texts[frame]);
    time.textContent = texts[frame];
    screen.show(frame);
  };

  let next; // the request for the next frame while the film plays
  const play = (wanted) => {
    cancelAnimationFrame(next);
    next = undefined;
    const playing = wanted && last > 0;
    button.textContent = playing ? "❚❚ Pause" : "▶ Play";
    if (!playing) return;
    if (frame === last) go(0);
    const [begin, begun] = [frame, performance.now()];
    const tick = (now) => {
      const to = begin + Math.floor(((now - begun) / 1000) * Number(speed.value));
      if (to > frame) go(to);
      if (frame === last) play(false);
      else next = requestAnimationFrame(tick);
    };
    next = requestAnimationFrame(tick);
  };
  const toggle = () => play(next === undefined);
  const step = (to) => {
    play(false);
    go(to);
  };

  button.addEventListener("click", toggle);
  slider.addEventListener("input", () => step(Number(slider.value)));
  speed.addEventListener("change", () => play(next !== undefined));
  (alone ? document : player).addEventListener("keydown", (event) => {
    if (event.target !== player && event.target !== document.body) return;
    const doings = {
      " ": toggle,
      ArrowRight: () => step(frame + 1),
      ArrowLeft: () => step(frame - 1),
      Home: () => step(0),
      End: () => step(last),
    };
    if (!Object.hasOwn(doings, event.key)) return;
    event.preventDefault();
    doings[event.key]();
  });

  const fit = (dots) => {
    if (holder.clientWidth === 0) return;
    screen.size(holder.clientWidth, alone ? Math.max(innerHeight - ELSE, LOW / 2) : LOW, dots);
    go(frame);
  };
  const fitScreen = () => fit(window.devicePixelRatio || 1);
  new ResizeObserver(fitScreen).observe(holder);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", fitScreen);
  window.addEventListener("beforeprint", () => fit(DOTS_ON_PAPER));
  window.addEventListener("afterprint", fitScreen);
  fitScreen();
  const asked = alone && /^#frame=(\d+)$/.exec(location.hash);
  if (asked) go(Number(asked[1]));
  play(alone && !asked && !matchMedia("(prefers-reduced-motion: reduce)").matches);
}
