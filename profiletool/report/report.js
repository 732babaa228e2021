// Inflates the tube on the stage: between the pressures that finite elements were asked for, every
// point goes along a cubic through its own places (parabolic slopes), so lines keep their lengths.
"use strict";

(() => {
  const source = document.getElementById("states");
  if (!source) return;
  const film = JSON.parse(source.textContent);
  const slider = document.getElementById("slider");
  const button = document.getElementById("play");
  const substeps = Number(slider.dataset.substeps);
  const last = film.bar.length - 1;
  const end = last * substeps;
  const shown = film.shown * substeps; // free until here, beyond it against the object
  const half = film.lines[0].length / 2;
  const SECONDS = 5;

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

  function at(step) {
    const k = Math.min(Math.floor(step / substeps), last - 1);
    const t = step / substeps - k;
    const width = film.bar[k + 1] - film.bar[k];
    const [s, u] = [t * t * (3 - 2 * t), 1 - t];
    const slopes = curves[k < film.shown ? 0 : 1];
    const row = rows[k].map((v, i) =>
      v + s * (rows[k + 1][i] - v) +
      width * t * u * (u * slopes[k][i] - t * slopes[k + 1][i]));
    return { bar: film.bar[k] + t * width, row };
  }

  function ring(points, from, to) {
    const found = [];
    for (let i = from; i <= to; i++) found.push(pair(points, 2 * i));
    for (let i = to; i >= from; i--) found.push(pair(points, half + 2 * i));
    return "M" + found.join(" ") + "Z";
  }

  const pair = (points, i) => `${points[i] / 100},${points[i + 1] / 100}`;
  const signed = (value) => value.toFixed(1).replace(/^-(?=0\.0$)/, "").replace("-", "\u2212") + "°";

  function each(selector, act) {
    document.querySelectorAll(selector).forEach(act);
  }

  function show(step) {
    const { bar, row } = at(step);
    const count = film.windows.length;
    const points = row.slice(1 + count).map((v) => Math.round(v) + 0);
    const outline = ring(points, 0, half / 2 - 1);
    each("[data-tube]", (path) => path.setAttribute("d", outline));
    each("[data-window]", (path) => {
      const [from, , to] = film.windows[path.dataset.window];
      path.setAttribute("d", ring(points, from, to));
    });
    each("[data-joint]", (badge) => {
      const i = 2 * film.windows[badge.dataset.joint][1];
      const [x, y] = [0, 1].map((c) => Math.floor((points[i + c] + points[half + i + c]) / 2) / 100);
      badge.setAttribute("transform", `translate(${x} ${y})`);
    });
    each(".theta", (cell, k) => { cell.textContent = signed(row[1 + k]); });
    document.getElementById("air").textContent = row[0].toFixed(1);
    each(".bar", (place) => { place.textContent = bar.toFixed(2); });
    slider.setAttribute("aria-valuetext", `${bar.toFixed(2)} bar`);
    slider.style.setProperty("--share", step / end);
  }

  let started = null; // when the tube began to inflate, where it does
  function stop() {
    started = null;
    button.textContent = "Inflate";
  }

  function tick(now) {
    if (started === null) return;
    const share = Math.min(Math.max((now - started) / 1000 / SECONDS, 0), 1);
    slider.value = share * end;
    show(share * end);
    if (share < 1) requestAnimationFrame(tick);
    else stop();
  }

  button.addEventListener("click", () => {
    if (started !== null) return stop();
    const from = Number(slider.value) < shown ? Number(slider.value) : 0;
    started = performance.now() - (from / end) * SECONDS * 1000;
    button.textContent = "Stop";
    requestAnimationFrame(tick);
  });
  slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
  addEventListener("beforeprint", () => { stop(); slider.value = shown; show(shown); });

  slider.value = shown; // some browsers remember where it stood
  show(shown);
  document.getElementById("controls").hidden = false;
  document.getElementById("still").hidden = true;
})();
