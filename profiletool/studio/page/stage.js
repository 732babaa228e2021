// The stage: one SVG over the picture. A scene is either the photograph, in its pixels, or the object
// with the tube beside it, in mm.
import { handle, lengthOf, line, make, nearest, pathOf, placeOf } from "./draw.js";
import { middle, ring } from "./film.js";

const svg = document.getElementById("stage");
const HANDLE = 0.75; // of the size of a letter
let em = 1;

export function frame([x, y, width, height]) {
  svg.setAttribute("viewBox", `${x} ${y} ${width} ${height}`);
  // As the report: 46 letters across, of what the screen shows.
  const { width: w, height: h } = svg.getBoundingClientRect();
  const scale = Math.max(width / Math.max(w, 1), height / Math.max(h, 1)); // units of a CSS pixel
  em = 15 * scale;
  svg.style.setProperty("--em", `${em}px`);
}

// Draw anew, but keep the focus where it was.
export function show(parts) {
  const kept = document.activeElement?.closest?.("#stage [data-key]")?.dataset.key;
  svg.replaceChildren(defs(), ...parts.filter(Boolean));
  if (kept) svg.querySelector(`[data-key="${kept}"]`)?.focus({ preventScroll: true });
}

function defs() {
  const step = 0.35 * em;
  return make("defs", {}, make("pattern", {
    id: "hatch", width: step, height: step, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)",
  }, make("path", { class: "hatch", d: `M0,0V${step}` })));
}

// --- the photograph --------------------------------------------------------------------------

export function photo({ file, px: [width, height] }) {
  frame([-0.5, -0.5, width, height]);
  return make("image", { href: `picture/${encodeURIComponent(file)}`, x: -0.5, y: -0.5, width, height });
}

export function hints({ point, box }) {
  const parts = [];
  if (box) parts.push(make("path", { class: "hint", d: `M${box[0]},${box[1]}h${box[2]}v${box[3]}h${-box[2]}Z` }));
  if (point) {
    const r = 0.6 * em;
    parts.push(make("path", { class: "hint", d: `M${point[0] - r},${point[1]}h${2 * r}M${point[0]},${point[1] - r}v${2 * r}` }));
  }
  return parts;
}

export const candidate = ({ outline }, act) => {
  const path = line("candidate", outline);
  path.addEventListener("click", act);
  return path;
};

// Let the user point at the picture, or draw a box on it: `act` gets [x, y] or [x, y, w, h].
export function pointing(kind, act, draft) {
  svg.classList.toggle("pointing", Boolean(kind));
  svg.onpointerdown = !kind ? null : (event) => {
    event.preventDefault();
    const from = placeOf(svg, event);
    if (kind === "point") return act(from.map(Math.round));
    const box = (to) => [0, 1].map((c) => Math.round(Math.min(from[c], to[c])))
      .concat([0, 1].map((c) => Math.round(Math.abs(from[c] - to[c]))));
    svg.setPointerCapture(event.pointerId);
    svg.onpointermove = (next) => draft(box(placeOf(svg, next)));
    svg.onpointerup = (next) => {
      svg.onpointermove = svg.onpointerup = null;
      act(box(placeOf(svg, next)));
    };
  };
}

// --- the object ------------------------------------------------------------------------------

export function object(subject) {
  const parts = [];
  const picture = subject.picture;
  if (picture) {
    const [x, y, width, height] = picture.place;
    parts.push(make("image", {
      href: `picture/${encodeURIComponent(picture.file)}`, x, y, width, height, preserveAspectRatio: "none",
      transform: picture.turn ? `rotate(${picture.turn} ${x + width / 2} ${y + height / 2})` : null,
    }));
  }
  parts.push(line("halo", subject.outline), line("silhouette", subject.outline));
  return parts;
}

const partOf = (side, from, to) => {
  const last = side.length - 1;
  const at = (pct) => {
    const i = Math.min(Math.floor(pct / 100 * last), last - 1);
    const t = pct / 100 * last - i;
    return [0, 1].map((c) => side[i][c] + t * (side[i + 1][c] - side[i][c]));
  };
  const inside = side.filter((_, i) => i > from / 100 * last && i < to / 100 * last);
  return [at(from), ...inside, at(to)];
};

// The stretch to follow, with a handle at each end.
export function stretch(side, ends, changed) {
  const [from, to] = ends;
  const d = pathOf(partOf(side, from, to));
  const parts = [line("side", pathOf(side)), line("halo wide", d), line("profile", d)];
  const total = lengthOf(side);
  const least = 1;
  ends.forEach((pct, k) => {
    const clamped = (value) => (k ? Math.min(Math.max(value, from + least), 100) : Math.max(Math.min(value, to - least), 0));
    const set = (value, done) => changed(k, clamped(Math.round(2 * value) / 2), done);
    const grip = handle(svg, HANDLE * em, k ? "To" : "From", {
      move: (place) => set(100 * nearest(side, place) / total, false),
      end: () => changed(k, null, true),
      step: (by) => set(pct + by, true),
    });
    const [x, y] = partOf(side, pct, Math.min(pct + 1e-6, 100))[0];
    grip.append(make("circle", { class: "grip", r: HANDLE * em }));
    set_slider(grip, `end-${k}`, pct, 0, 100, `${pct} %`);
    grip.setAttribute("transform", `translate(${x} ${y})`);
    parts.push(grip, label(`${k ? "to" : "from"} ${pct} %`, x, y - 1.6 * HANDLE * em));
  });
  return parts;
}

function set_slider(element, key, now, least, most, text) {
  element.dataset.key = key;
  const told = { valuenow: now, valuemin: least, valuemax: most, valuetext: text };
  for (const [name, value] of Object.entries(told)) element.setAttribute(`aria-${name}`, value);
}

// A text of 12 CSS pixels about a place, but inside the drawing.
function label(text, x, y) {
  const { x: left, width, y: top, height } = svg.viewBox.baseVal;
  const half = 0.25 * em * text.length;
  return make("text", {
    class: "label", x: Math.min(Math.max(x, left + half), left + width - half),
    y: Math.min(Math.max(y, top + em), top + height - 0.3 * em),
  }, text);
}

// --- the tube --------------------------------------------------------------------------------

export function around(view, told) {
  return [
    line("rest", view.rest), told && view.band && line("band", view.band),
    make("path", { class: "hatched", fill: "url(#hatch)", d: view.clamp }), line("clamped", view.clamp),
    line("halo wide", view.profile), line("profile", view.profile), ...view.missed.map((d) => line("missed", d)),
  ];
}

const colourOf = (by) => ({ fe: "fe", "joint response": "response" })[by] || "formula";

export const outlineOf = (points) => ring(points, 0, points.length / 4 - 1);

export function tube({ points, windows, by }) {
  const outline = outlineOf(points);
  const colour = colourOf(by);
  return [
    line("halo", outline), make("path", { class: `tube ${colour}`, d: outline, id: "tube" }),
    ...windows.map(([from, , to]) => line(`window ${colour}`, ring(points, from, to))),
  ];
}

// The tube's middle line: points [x, y].
export const middleLine = (points) =>
  Array.from({ length: points.length / 4 }, (_, i) => middle(points, i));

// Badges of all joints, which are dragged along the tube, and the ends of the chosen joint's cut.
// `act` has choose(k), begin(), moved(k, part, mm), end() and step(k, part, by); parts are
// "place", "start" and "end".
export function joints({ points, windows }, view, chosen, act) {
  const along = middleLine(points);
  const radius = Math.min(0.75 * em, 0.32 * view.tube.diameter);
  const parts = [];
  let held = null; // the line and the place on it where a drag began
  const grip = (k, part, name) => handle(svg, radius, name, {
    begin: (place) => { held = [along, nearest(along, place)]; act.begin(k, part); },
    move: (place) => act.moved(k, part, nearest(held[0], place) - held[1]),
    end: () => act.end(),
    step: (by) => act.step(k, part, by),
  });
  view.joints.forEach((joint, k) => {
    const [x, y] = middle(points, windows[k][1]);
    const place = grip(k, "place", `Joint ${joint.number}, place along the tube`);
    place.append(make("g", { class: k === chosen ? "badge chosen" : "badge" },
      make("circle", { r: radius }),
      make("text", { dy: "0.36em", style: `font-size: ${1.25 * radius}px` }, `${joint.number}`)));
    place.setAttribute("transform", `translate(${x} ${y})`);
    set_slider(place, `joint-${k}`, joint.centre.toFixed(1), 0, view.tube.length, `${joint.centre.toFixed(1)} mm`);
    place.addEventListener("focus", () => act.choose(k));
    if (k === chosen) {
      [["start", 0], ["end", 2]].forEach(([part, at]) => {
        const [ex, ey] = middle(points, windows[k][at]);
        const end = grip(k, part, `Joint ${joint.number}, ${part} of the cut`);
        const size = 0.55 * radius;
        end.append(make("rect", { class: "grip", x: -size, y: -size, width: 2 * size, height: 2 * size }));
        end.setAttribute("transform", `translate(${ex} ${ey})`);
        set_slider(end, `${part}-${k}`, joint.openF, 0, view.tube.length, `cut ${joint.openF} mm`);
        parts.push(end);
      });
      const [fx, fy] = [0, 1].map((c) => points[points.length / 2 + 2 * windows[k][1] + c] / 100);
      const [ux, uy] = [fx - x, fy - y].map((v) => v / Math.hypot(fx - x, fy - y));
      const threads = `${Math.round(10 * joint.alpha / view.thread) / 10}`;
      const said = `${joint.centre.toFixed(1)} mm, cut ${joint.openF} mm, ${threads} threads`;
      const beside = Math.abs(ux) > 0.3 ? Math.sign(ux) * (em + 0.25 * em * said.length) : 0;
      parts.push(label(said, fx + beside, fy + 1.6 * em * uy + 0.3 * em));
    }
    parts.push(place);
  });
  return parts;
}

// Say what the lines are: pairs of a line's class and words.
export function legend(rows) {
  document.getElementById("legend").replaceChildren(...rows.map(([kind, words]) => {
    const item = document.createElement("li");
    const shown = kind.startsWith("window") ? "M2,1H26V11H2Z" : "M1,6H27";
    item.append(make("svg", { viewBox: "0 0 28 12", "aria-hidden": "true" }, line(kind, shown)), words);
    return item;
  }));
}

export const ghost = (outline) => line("ghost", outline);
