// Inflates the tube on the stage; film.js, which knows its states, stands before this in the page.
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
  const SECONDS = 5;

  const at = moving(film, substeps);

  function each(selector, act) {
    document.querySelectorAll(selector).forEach(act);
  }

  function show(step) {
    const { bar, air, theta, points } = at(step);
    const outline = ring(points, 0, points.length / 4 - 1);
    each("[data-tube]", (path) => path.setAttribute("d", outline));
    each("[data-window]", (path) => {
      const [from, , to] = film.windows[path.dataset.window];
      path.setAttribute("d", ring(points, from, to));
    });
    each("[data-joint]", (badge) => {
      const [x, y] = middle(points, film.windows[badge.dataset.joint][1]);
      badge.setAttribute("transform", `translate(${x} ${y})`);
    });
    each(".theta", (cell, k) => { cell.textContent = signed(theta[k]); });
    document.getElementById("air").textContent = air.toFixed(1);
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
