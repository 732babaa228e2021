// The dial: the tube's cross-section with the uncut sector of a joint, dragged in whole threads.
import { handle, make } from "./draw.js";

const svg = document.getElementById("dial");
const R = 46;

const at = (degrees) => [R * Math.cos(degrees * Math.PI / 180), -R * Math.sin(degrees * Math.PI / 180)];

// `changed(threads, done)`: done is false while it is dragged.
export function dial(joint, thread, changed) {
  const kept = svg.contains(document.activeElement);
  const [half, mid] = [joint.alpha / 2, joint.center];
  const most = Math.floor(359 / thread);
  const threads = joint.alpha / thread;
  const parts = [make("circle", { class: "ring", r: R })];
  const [[ax, ay], [bx, by]] = [at(mid - half), at(mid + half)];
  parts.push(make("path", { class: "uncut", d: `M${ax},${ay}A${R},${R} 0 ${half > 90 ? 1 : 0} 0 ${bx},${by}` }));
  let wanted = threads;
  const set = (value, done) => changed(Math.min(Math.max(Math.round(value), 1), most), done);
  const grip = handle(svg, 6, `Joint ${joint.number}, uncut sector in threads`, {
    move: (place) => {
      const angle = Math.atan2(-place[1], place[0]) * 180 / Math.PI;
      const off = Math.abs(((angle - mid) % 360 + 540) % 360 - 180);
      wanted = 2 * off / thread;
      set(wanted, false);
    },
    end: () => set(wanted, true),
    step: (by) => set(threads + by, true),
  });
  grip.append(make("circle", { class: "grip", r: 6 }));
  grip.setAttribute("transform", `translate(${bx} ${by})`);
  for (const [name, value] of Object.entries({ valuenow: threads.toFixed(1), valuemin: 1, valuemax: most })) {
    grip.setAttribute(`aria-${name}`, value);
  }
  parts.push(
    make("text", { y: mid > 180 ? 30 : -24 }, mid > 180 ? "toward" : "away"),
    make("text", { y: 3 }, `${joint.alpha.toFixed(1)}°`), grip);
  svg.replaceChildren(...parts);
  if (kept) grip.focus({ preventScroll: true });
}
