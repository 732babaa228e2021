// The joints: handles on the tube, numbers beside them, undo and redo, and the pressure that is shown.
import { dial } from "./dial.js";
import { moving, signed } from "./film.js";
import { get, latest, post, Refused } from "./net.js";
import { Pending } from "./pending.js";
import * as stage from "./stage.js";

const by = (id) => document.getElementById(id);
const SUBSTEPS = 24;
const SECONDS = 4;

let page = null; // act, redraw and state of the page
let number = null; // the version that is shown
let view = null;
let first = null; // the view of the first version, where it is shown too
let at = null; // the tube at a step of the slider
let pending = new Pending();
let sent = new Pending();
let good = new Pending(); // the last changes that can be built
let bent = null; // the tube with the changes, by the joint response
let chosen = 0;
let told = null; // the job that finite elements said something first of
let responses = []; // angles by the joint response, of the change
let began = null; // the change of the joint when a drag began
let started = null; // when the tube began to inflate, where it does

export const name = () => view?.name ?? null;
export const moves = () => Boolean(view && view.film.lines.length > 1 && !bent);

// Show what finite elements say first of the change that they are at.
export async function near(state) {
  const { ticket } = state.running;
  if (told === ticket) return;
  told = ticket;
  const early = await get("near");
  if (JSON.stringify(sent.edits) === JSON.stringify(pending.edits) && sent.bar === pending.bar) bent = early;
}

export function forget() {
  for (const changes of [pending, sent, good]) changes.clear();
  bent = null;
}

// Show another version of the design.
export async function open(state) {
  view = await get(`view/${state.current}`);
  number = state.current;
  at = moving(view.film, SUBSTEPS);
  pending.rebase(sent);
  sent.clear();
  good.clear();
  bent = null;
  first = null;
  chosen = Math.min(chosen, view.joints.length - 1);
  const slider = by("slider");
  slider.max = SUBSTEPS * (view.film.lines.length - 1);
  slider.value = SUBSTEPS * view.film.shown;
  by("folder").value ||= `${view.name.replace(/\.[^.]*$/, "").replace(/[^\w .+-]/g, "_")}_design`;
  for (const [id, file] of [["report", "report.html"], ["template", "template.pdf"]]) by(id).href = `files/${number}/${file}`;
  by("zip").href = `zip/${number}`;
  if (pending.any) bend();
}

// --- drawing ---------------------------------------------------------------------------------

export function draw() {
  if (!view) return stage.show([]);
  stage.frame(view.box);
  const free = at(Number(by("slider").value));
  by("bar").textContent = free.bar.toFixed(2);
  by("slider").setAttribute("aria-valuetext", `${free.bar.toFixed(2)} bar`);
  const windows = view.film.windows;
  const shown = bent
    ? { points: bent.film.lines, windows: bent.film.windows, by: bent.by }
    : { points: free.points, windows, by: view.by };
  const now = { ...view, joints: view.joints.map((joint) => pending.of(joint)) };
  const ghost = bent ? stage.outlineOf(at(SUBSTEPS * view.film.shown).points)
    : first ? stage.outlineOf(first.film.lines[first.film.shown]) : null;
  const colour = shown.by === "fe" ? "fe" : shown.by === "joint response" ? "response" : "formula";
  const named = shown.by === "fe" ? "finite elements" : `the ${shown.by}`;
  stage.legend([
    ["profile", "profile to follow"], [`tube ${colour}`, `tube by ${named}`], [`window ${colour}`, "cuts"],
    ...(ghost ? [["ghost", bent ? "before the change" : "the first"]] : []),
    ...(view.band && !bent ? [["band", "95 % of builds"]] : []), ["rest", "tube at rest"], ["clamped", "clamp"],
  ]);
  return stage.show([
    ...(view.subject ? stage.object(view.subject) : []), ...stage.around(view, !bent),
    ...(ghost ? [stage.ghost(ghost)] : []), ...stage.tube(shown),
    ...stage.joints(shown, now, chosen, { choose: pick, begin, moved, end, step }),
  ]);
}

export function show(state) {
  if (!view) return;
  const off = bent?.off ?? view.off;
  const told = bent ? "Changed by hand" : !view.verified ? "NOT VERIFIED" : view.feasible ? "Verified by finite elements" : "INFEASIBLE";
  by("verdict").className = `verdict ${view.verified && view.feasible ? "good" : "bad"}`;
  const lines = [`${off.rms.toFixed(2)} mm RMS, ${off.max.toFixed(2)} mm at most off the profile` + (bent ? `, by ${bent.by === "fe" ? "finite elements" : `the ${bent.by}`}` : "")];
  if (!bent && view.built) lines.push(view.built);
  by("verdict").replaceChildren(said("word", told), ...lines.map((text) => said("", text)));
  by("notes").replaceChildren(...view.notes.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
  const here = state.versions.find((version) => version.number === number);
  by("undo").disabled = !pending.any && (here?.base ?? null) === null;
  by("redo").disabled = pending.any || !next(state);
  by("first").disabled = (here?.base ?? null) === null;
  by("refine").disabled = Boolean(state.running);
  numbers();
}

function said(kind, text) {
  return Object.assign(document.createElement("p"), { className: kind, textContent: text });
}

function numbers() {
  const rows = view.joints.map((joint) => pending.of(joint));
  const joint = rows[chosen];
  const set = (id, value) => { if (by(id) !== document.activeElement) by(id).value = value; };
  by("joint-name").textContent = `Joint ${joint.number}`;
  set("centre", Math.round(100 * joint.centre) / 100);
  set("openF", joint.openF);
  by("openF").step = by("openF").min = view.pitch;
  set("threads", Math.round(100 * joint.alpha / view.thread) / 100);
  set("pressure", pending.bar ?? view.bar);
  for (const input of document.getElementsByName("sense")) input.checked = Number(input.value) === joint.center;
  dial(joint, view.thread, (threads, done) => change({ alpha: threads * view.thread }, done));
  by("pick").replaceChildren(...rows.map((row, k) => {
    const button = Object.assign(document.createElement("button"), { type: "button", className: "quiet", textContent: row.number });
    button.setAttribute("role", "radio");
    button.setAttribute("aria-checked", k === chosen);
    button.setAttribute("aria-pressed", k === chosen);
    button.setAttribute("aria-label", `Joint ${row.number}`);
    button.addEventListener("click", () => pick(k));
    return button;
  }));
  const angle = (value) => (value === null || value === undefined ? "–" : signed(value));
  by("table").replaceChildren(...rows.map((row, k) => {
    const response = bent ? bent.joints[k].response ?? responses[k] : row.response;
    const cells = [row.centre.toFixed(1), row.openF, (row.alpha / view.thread).toFixed(1), angle(row.target),
      angle(response), angle(bent ? (bent.by === "fe" ? bent.joints[k].fe : null) : row.fe)];
    const line = document.createElement("tr");
    line.append(Object.assign(document.createElement("th"), { scope: "row", textContent: row.number }),
      ...cells.map((text) => Object.assign(document.createElement("td"), { textContent: text })));
    return line;
  }));
}

// --- changing --------------------------------------------------------------------------------

function pick(k) {
  if (k === chosen) return;
  chosen = k;
  show(page.state());
  page.redraw();
}

const bend = latest(async () => {
  const [asked, base] = [pending.copy(), number];
  if (!asked.any) { bent = null; update(); return; }
  try {
    const answer = await post("bend", { version: base, edits: asked.edits, pressure_bar: asked.bar });
    if (base === number && pending.any) bent = answer;
    if (base === number) good = asked;
    responses = answer.joints.map((joint) => joint.response);
    page.refused("");
  } catch (error) {
    page.refused(error.message);
  }
  update();
});

function update() {
  show(page.state());
  page.redraw();
}

// Change the chosen joint; where it is done, let finite elements bend it.
function change(wanted, done) {
  pending.set(view.joints[chosen], wanted);
  numbers();
  bend();
  if (done) release();
}

function release() {
  if (!pending.any) { sent.clear(); bent = null; return page.act(() => post("do/cancel", {})); }
  sent = pending.copy();
  return page.act(async () => {
    const ask = () => post("do/change", { version: number, edits: sent.edits, pressure_bar: sent.bar });
    try {
      await ask();
    } catch (error) { // it cannot be built: back to what can
      if (!(error instanceof Refused)) throw error;
      pending = good.copy();
      sent = good.copy();
      if (pending.any) await ask();
      bend();
      throw error;
    }
  });
}

function begin(k) {
  pick(k);
  began = { move: 0, openF: view.joints[k].openF, ...pending.joints[view.joints[k].number] };
}

const snapped = (mm) => view.pitch * Math.round(mm / view.pitch);

function moved(k, part, mm) {
  const by_ = snapped(mm);
  if (part === "place") return change({ move: began.move + by_ }, false);
  const toward = part === "end" ? 1 : -1;
  const openF = Math.max(began.openF + toward * by_, view.pitch);
  return change({ openF, move: began.move + toward * (openF - began.openF) / 2 }, false);
}

const end = () => release();

function step(k, part, steps) {
  begin(k);
  moved(k, part, steps * view.pitch);
  release();
}

// --- versions --------------------------------------------------------------------------------

const next = (state) => state.versions.filter((version) => version.base === number).at(-1);

const go = (version) => page.act(() => post("do/go", { version }));

function undo() {
  if (pending.any) { forget(); update(); return page.act(() => post("do/cancel", {})); }
  return go(page.state().versions.find((version) => version.number === number).base);
}

async function compare() {
  if (first) first = null;
  else {
    const versions = new Map(page.state().versions.map((version) => [version.number, version]));
    let root = number;
    while (versions.get(root).base !== null) root = versions.get(root).base;
    first = await get(`view/${root}`);
  }
  by("first").setAttribute("aria-pressed", Boolean(first));
  page.redraw();
}

// --- the pressure that is shown ---------------------------------------------------------------

function stop() {
  started = null;
  by("play").textContent = "Inflate";
}

function tick(now) {
  if (started === null) return;
  const slider = by("slider");
  const share = Math.min(Math.max((now - started) / 1000 / SECONDS, 0), 1);
  slider.value = share * slider.max;
  page.redraw();
  if (share < 1) requestAnimationFrame(tick);
  else stop();
}

export function start(given) {
  page = given;
  by("slider").addEventListener("input", () => { stop(); page.redraw(); });
  by("play").addEventListener("click", () => {
    if (started !== null) return stop();
    const slider = by("slider");
    started = performance.now() - (slider.value % slider.max) / slider.max * SECONDS * 1000;
    by("play").textContent = "Stop";
    return requestAnimationFrame(tick);
  });
  const typed = (id, wanted) => by(id).addEventListener("change", (event) => {
    const value = Number(event.target.value);
    if (event.target.value !== "" && Number.isFinite(value)) wanted(value);
  });
  typed("centre", (mm) => change({ move: mm - view.joints[chosen].centre }, true));
  typed("openF", (mm) => change({ openF: mm }, true));
  typed("threads", (count) => change({ alpha: count * view.thread }, true));
  typed("pressure", (bar) => { pending.bar = bar === view.bar ? null : bar; bend(); release(); });
  for (const input of document.getElementsByName("sense")) {
    input.addEventListener("change", () => change({ center: Number(input.value) }, true));
  }
  by("undo").addEventListener("click", undo);
  by("redo").addEventListener("click", () => go(next(page.state()).number));
  by("first").addEventListener("click", compare);
  by("refine").addEventListener("click", () => page.act(() => post("do/refine", {})));
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
    if (event.target.matches?.("input, select")) return;
    event.preventDefault();
    by(event.shiftKey ? "redo" : "undo").click();
  });
}
