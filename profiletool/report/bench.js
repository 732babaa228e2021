// Shows one picture of the film at a time.
"use strict";

(() => {
  const film = document.getElementById("film");
  const shots = [...film.querySelectorAll(".shot")];
  const slider = document.getElementById("picture");

  function show(k) {
    const shown = Math.min(Math.max(k, 0), shots.length - 1);
    slider.value = shown;
    slider.setAttribute("aria-valuetext", shots[shown].dataset.bar);
    shots.forEach((shot, i) => { shot.classList.toggle("away", i !== shown); });
  }

  slider.addEventListener("input", () => show(Number(slider.value)));
  document.getElementById("back").addEventListener("click", () => show(Number(slider.value) - 1));
  document.getElementById("next").addEventListener("click", () => show(Number(slider.value) + 1));
  film.querySelectorAll("[type=checkbox]").forEach((box) => {
    box.checked = true; // some browsers remember
    box.addEventListener("change", () => film.classList.toggle(`no-${box.value}`, !box.checked));
  });
  document.getElementById("controls").hidden = false;
  show(shots.length - 1);
})();
