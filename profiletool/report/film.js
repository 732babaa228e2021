// The states of a tube: between the pressures that finite elements were asked for, every point goes
// along a cubic through its own places (parabolic slopes), so lines keep their lengths.
"use strict";

// `film` as film.py writes it; a step is a place between its states, `substeps` to each.
export function moving(film, substeps) {
  const last = film.bar.length - 1;
  // One row of numbers a state: all that changes with pressure.
  const rows = film.bar.map((_, k) => [film.air[k], ...film.theta[k], ...film.lines[k]]);
  // The free states make one curve, those against the object another.
  const curves = [[0, film.shown], [film.shown, last]].map(([first, end]) =>
    rows.map((_, k) => (first < end && first <= k && k <= end ? slope(k, first, end) : null)));

  function slope(k, first, end) {
    const rate = (a) => rows[a].map((v, i) => (rows[a + 1][i] - v) / (film.bar[a + 1] - film.bar[a]));
    if (end - first === 1) return rate(first);
    const a = Math.min(Math.max(k - 1, first), end - 2); // three states at or around this one
    const [before, after] = [rate(a), rate(a + 1)];
    const [p, q, r] = [film.bar[a], film.bar[a + 1], film.bar[a + 2]];
    const share = (2 * film.bar[k] - p - q) / (r - p);
    return before.map((v, i) => v + share * (after[i] - v));
  }

  function row(step) {
    const k = Math.min(Math.floor(step / substeps), last - 1);
    const t = step / substeps - k;
    const width = film.bar[k + 1] - film.bar[k];
    const [s, u] = [t * t * (3 - 2 * t), 1 - t];
    const slopes = curves[k < film.shown ? 0 : 1];
    const values = rows[k].map((v, i) =>
      v + s * (rows[k + 1][i] - v) +
      width * t * u * (u * slopes[k][i] - t * slopes[k + 1][i]));
    return { bar: film.bar[k] + t * width, values };
  }

  // The tube at a step: pressure in bar, air in ml, angles in deg, points in hundredths of a mm.
  return (step) => {
    const { bar, values } = last ? row(step) : { bar: film.bar[0], values: rows[0] };
    const count = film.windows.length;
    const points = values.slice(1 + count).map((v) => Math.round(v) + 0);
    return { bar, air: values[0], theta: values.slice(1, 1 + count), points };
  };
}

const pair = (points, i) => `${points[i] / 100},${points[i + 1] / 100}`;

// Path around the part of the tube between two of its points.
export function ring(points, from, to) {
  const half = points.length / 2;
  const found = [];
  for (let i = from; i <= to; i++) found.push(pair(points, 2 * i));
  for (let i = to; i >= from; i--) found.push(pair(points, half + 2 * i));
  return "M" + found.join(" ") + "Z";
}

// Place of the tube's middle at one of its points, mm.
export function middle(points, i) {
  const half = points.length / 2;
  return [0, 1].map((c) => Math.floor((points[2 * i + c] + points[half + 2 * i + c]) / 2) / 100);
}

export const signed = (value) =>
  value.toFixed(1).replace(/^-(?=0\.0$)/, "").replace("-", "\u2212") + "°";
