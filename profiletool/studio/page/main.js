// The page: it asks the server for its state, again and again, and shows it.
import * as ask from "./ask.js";
import { get, post, Refused } from "./net.js";
import * as joints from "./joints.js";
import * as stage from "./stage.js";

const by = (id) => document.getElementById(id);
const TABS = ["object", "joints", "files"];
const [BUSY_MS, IDLE_MS] = [200, 1200];

let state = null; // the server's last word
let found = null; // the object, as it was last found
let tab = "object";
let tool = null; // "point" or "box", while the user shows where the object is
let draft = null; // a box that is being drawn, or a stretch that is being dragged
let timer = null;

// --- asking ----------------------------------------------------------------------------------

let asked = 0;

async function poll() {
  clearTimeout(timer);
  asked += 1;
  const mine = asked;
  try {
    const known = found ? state?.found_revision : "";
    const turns = ask.turns();
    const next = await get(`state?found=${known ?? ""}`);
    if (mine !== asked) return; // a younger question is under way, and answers can overtake each other
    by("gone").hidden = true;
    const started = state?.current !== next.current && next.current !== null;
    if ("found" in next) found = next.found;
    const changed = !state || state.revision !== next.revision || state.server !== next.server;
    const first = !state;
    state = next;
    if (started) {
      await joints.open(state);
      if (tab === "object" && !first) choose("joints");
    }
    if (state.running?.near) await joints.near(state);
    if (first && state.current !== null) choose("joints");
    if (turns === ask.turns() && ask.settled()) ask.fill(state.values);
    if (changed || state.running) show();
  } catch (error) {
    if (mine !== asked) return;
    const restarted = error instanceof Refused;
    by("gone").textContent = restarted
      ? "The studio was started again: open the address that it printed. Nothing is lost."
      : "The server is gone. Nothing is lost: start profiletool studio again, and open its new address.";
    by("gone").hidden = false;
  }
  timer = setTimeout(poll, state?.running ? BUSY_MS : IDLE_MS);
}

// What the user does reaches the server in that order: a cancel after what it ends.
let last = Promise.resolve();

async function act(call) {
  try {
    say("");
    const done = last.then(call);
    last = done.catch(() => {});
    await done;
  } catch (error) {
    if (!(error instanceof Refused)) return poll();
    say(error.message);
  }
  return poll();
}

function say(text) {
  by("said").textContent = text;
  by("said").hidden = !text;
}

// --- showing ---------------------------------------------------------------------------------

const KINDS = { find: "Looking for the object", design: "Designing", edit: "Finite elements of the change",
  refine: "Finite elements correct it", report: "Finite elements of the design" };

function show() {
  const running = state.running;
  by("work").hidden = !running;
  if (running) {
    by("working").textContent = running.line ? `${KINDS[running.kind]}: ${running.line}` : `${KINDS[running.kind]} …`;
    if (running.share > 0) by("share").value = running.share;
    else by("share").removeAttribute("value");
  }
  if (state.said) say(state.said);
  by("name").textContent = state.picture ?? joints.name() ?? "Studio";
  by("picture").textContent = state.picture ?? "PNG, JPEG, TIFF, BMP or WebP; DXF, SVG or CSV.";
  by("design").disabled = !found?.sized;
  for (const name of ["joints", "files"]) by(`tab-${name}`).disabled = state.current === null;
  by("toml").textContent = state.toml || "# all options have their defaults";
  showFound();
  joints.show(state);
  by("where").textContent = state.folder;
  by("commands").textContent = state.commands.join("\n");
  draw();
}

function showFound() {
  const object = found?.found;
  by("found").textContent = !state.picture ? "" : !found ? "Looking …"
    : object ? `Found by ${object.by}, sure to ${Math.round(100 * object.confidence)} %.`
      : found.outline ? "Drawn." : found.error ?? "";
  const [width, height] = found?.size ?? [];
  const { source, mm_per_px: scale } = found?.scale ?? {};
  by("size").textContent = found?.sized
    ? `${width.toFixed(1)} × ${height.toFixed(1)} mm` + (object ? `, ${scale.toPrecision(4)} mm per pixel from ${source}.` : ".")
    : found?.error && found.outline ? found.error : "";
  const buttons = (found?.candidates ?? []).map((one) => {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", className: "quiet", textContent: `Take this: ${one.said}` });
    button.addEventListener("click", () => take(one));
    return button;
  });
  by("candidates").replaceChildren(...buttons);
}

const take = (one) => act(() => ask.send(ask.values(one.mask)));

function draw() {
  by("empty").hidden = Boolean(found || state.current !== null);
  const photograph = found?.photo && tab === "object" && (tool || !found.outline);
  stage.legend([]);
  by("controls").hidden = tab === "object" || !joints.moves();
  if (photograph) {
    const hints = { ...state.values, ...(tool === "box" && draft ? { box: draft } : {}) };
    stage.show([
      stage.photo(found.photo), found.found && stage.candidate({ outline: found.found.outline }, () => {}),
      ...found.candidates.map((one) => stage.candidate(one, () => tool || take(one))), ...stage.hints(hints),
    ]);
  } else if (tab === "object" && found?.outline) {
    const [x, y, width, height] = found.box;
    const room = 0.12 * Math.max(width, height);
    stage.frame([x - room, y - room, width + 2 * room, height + 2 * room]);
    const ends = draft ?? [state.values.start_pct ?? 0, state.values.end_pct ?? 100];
    stage.show([...stage.object(found), ...stage.stretch(found.side, ends, stretched)]);
  } else if (tab !== "object") {
    joints.draw();
  } else stage.show([]);
  stage.pointing(photograph ? tool : null, pointed, (box) => { draft = box; draw(); });
  for (const name of ["point", "box"]) by(`tool-${name}`).setAttribute("aria-pressed", tool === name);
}

function stretched(k, value, done) {
  const ends = draft ?? [state.values.start_pct ?? 0, state.values.end_pct ?? 100];
  draft = value === null ? ends : ends.map((old, i) => (i === k ? value : old));
  by("object").querySelector(`[data-field="${k ? "end_pct" : "start_pct"}"]`).value = draft[k];
  if (done) {
    draft = null;
    act(() => ask.send(ask.values(state.values.mask)));
  } else draw();
}

function pointed(value) {
  by(tool).value = value.join(", ");
  [tool, draft] = [null, null];
  act(() => ask.send(ask.values()));
}

// --- what the user does ----------------------------------------------------------------------

function choose(name) {
  tab = name;
  for (const other of TABS) {
    by(other).hidden = other !== name;
    by(`tab-${other}`).setAttribute("aria-selected", other === name);
    by(`tab-${other}`).tabIndex = other === name ? 0 : -1;
  }
  if (state) draw();
}

for (const [k, name] of TABS.entries()) {
  by(`tab-${name}`).addEventListener("click", () => choose(name));
  by(`tab-${name}`).addEventListener("keydown", (event) => {
    const by_ = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const next = by_ && by(`tab-${TABS[(k + by_ + 3) % 3]}`);
    if (next && !next.disabled) { next.click(); next.focus(); }
  });
}
for (const name of ["point", "box"]) {
  by(`tool-${name}`).addEventListener("click", () => { tool = tool === name ? null : name; draw(); });
}
by("forget").addEventListener("click", () => {
  by("point").value = by("box").value = "";
  act(() => ask.send(ask.values()));
});
by("design").addEventListener("click", () => act(() => post("do/design", {})));
by("cancel").addEventListener("click", () => { joints.forget(); act(() => post("do/cancel", {})); });
by("export").addEventListener("click", () => act(async () => {
  const { folder } = await post("do/export",
    { version: state.current, name: by("folder").value, force: by("force").checked });
  by("exported").textContent = `Written: ${folder}`;
}));
addEventListener("resize", () => state && draw());

joints.start({ act, refused: say, redraw: () => state && draw(), state: () => state });
ask.taking((call) => act(async () => { tool = null; found = null; choose("object"); await call(); }));
await ask.build(() => act(() => ask.send(ask.values(state.values.mask))));
poll();
