// Where the ticks of an axis lie, and what is written at them.
"use strict";

/** Round numbers between two values, about as many as asked for. */
function roundTicks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((each) => each >= rough * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    ticks.push(Number((i * step).toPrecision(12)));
  }
  return ticks;
}

/** The texts of round ticks, with as many digits as tell one from the next. */
function roundLabels(ticks) {
  const largest = Math.max(...ticks.map(Math.abs));
  const digits = ticks.length > 1 ? Math.ceil(Math.log10(largest / (ticks[1] - ticks[0]))) + 2 : 6;
  return ticks.map((tick) => readable(tick, Math.min(Math.max(digits, 3), 15)));
}

/** Ticks of a logarithmic axis: every digit of every decade; round numbers once less than a decade is to be seen. */
function logTicks(low, high, count) {
  if (high / low < 8) return roundTicks(low, high, count);
  const ticks = [];
  for (let exponent = Math.floor(Math.log10(low)); 10 ** exponent <= high; exponent++) {
    for (let digit = 1; digit < 10; digit++) {
      const tick = Number(`${digit}e${exponent}`);
      if (tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9)) ticks.push(tick);
    }
  }
  return ticks;
}

/** The texts of a logarithmic axis's ticks: those for which there is room, all in the same way of writing. */
function logLabels(ticks, low, high, count) {
  const decades = Math.log10(high / low);
  if (high / low < 8) return roundLabels(ticks);
  const powers = low < 1e-3 || high > 2e4;
  const every = Math.max(1, Math.ceil(decades / count));
  const digits = decades * 3 <= count ? [1, 2, 5] : [1];
  return ticks.map((tick) => {
    const exponent = Math.floor(Math.log10(tick) + 1e-9);
    const digit = Math.round(tick / 10 ** exponent);
    if (!digits.includes(digit) || exponent % every !== 0) return "";
    if (!powers || tick === 1 || tick === 10) return readable(tick);
    return (digit > 1 ? digit + "·" : "") + powerOfTen(exponent);
  });
}

/** The ticks between two ends of an axis with room for `count` texts. */
const ticksOf = ({ log }, low, high, count) => (log ? logTicks : roundTicks)(low, high, count);

/** The texts of these ticks, empty for those that get none. */
const labelsOf = ({ log }, ticks, low, high, count) => (log ? logLabels(ticks, low, high, count) : roundLabels(ticks));
