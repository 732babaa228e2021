// The request: picture, object, size, side and stretch, all options.
import { get, post, put } from "./net.js";

const by = (id) => document.getElementById(id);
const inputs = () => [...document.querySelectorAll("[data-field]")];
const LISTS = ["point", "box"];

let fields = [];

export const defaultOf = (name) => fields.find((row) => row.name === name)?.default;

// Make the inputs of all options that the page has none for.
export async function build(changed) {
  fields = await get("form");
  const known = new Set(inputs().map((input) => input.dataset.field));
  for (const row of fields) {
    if (known.has(row.name) || ["mask", ...LISTS].includes(row.name)) continue;
    by("options").append(inputOf(row));
  }
  for (const input of inputs()) input.addEventListener("change", () => input.checkValidity() && changed());
  for (const name of LISTS) by(name).addEventListener("change", () => changed());
}

function inputOf({ name, label, help, kind, choices, default: usual }) {
  const choice = choices.length || kind === "bool" || name === "formula";
  const input = document.createElement(choice ? "select" : "input");
  if (choice) {
    const all = name === "formula" ? ["paper", "fe"] : kind === "bool" ? ["yes", "no"] : choices;
    const said = kind === "bool" ? (usual ? "yes" : "no") : usual ?? "";
    input.append(new Option(said ? `${said} (default)` : "default", ""),
      ...all.filter((word) => word !== said).map((word) => new Option(word, word)));
  } else {
    input.type = ["float", "int"].includes(kind) ? "number" : "text";
    if (kind === "float") input.step = "any";
    input.placeholder = usual ?? "";
  }
  Object.assign(input.dataset, { field: name, kind });
  const said = document.createElement("small");
  said.textContent = help;
  const whole = document.createElement("label");
  whole.append(label, input, said);
  return whole;
}

// Options as they are typed, by field name.
export function values(mask) {
  const found = {};
  for (const input of inputs()) {
    const { field, kind } = input.dataset;
    if (input.type === "radio" && !input.checked) continue;
    if (input.value === "") continue;
    if (kind === "bool") found[field] = input.value === "yes";
    else if (input.type === "number") found[field] = Number(input.value);
    else if (field === "rotate" && input.value !== "auto") found[field] = Number(input.value);
    else found[field] = input.value;
    if (found[field] === defaultOf(field)) delete found[field];
  }
  for (const name of LISTS) {
    const typed = by(name).value.split(",").map((part) => part.trim()).filter(Boolean);
    if (typed.length) found[name] = typed.map(Number);
  }
  if (mask) found.mask = mask;
  return found;
}

// Show options, but leave the one alone that is being typed.
export function fill(known) {
  for (const input of inputs()) {
    const { field, kind } = input.dataset;
    const value = known[field];
    if (input.type === "radio") input.checked = input.value === (value ?? defaultOf(field));
    else if (input !== document.activeElement) {
      const shown = value ?? (["start_pct", "end_pct"].includes(field) ? defaultOf(field) : "");
      input.value = kind === "bool" && value !== undefined ? (value ? "yes" : "no") : shown;
    }
  }
  for (const name of LISTS) {
    if (by(name) !== document.activeElement) by(name).value = (known[name] ?? []).join(", ");
  }
}

// How often options began or ended to be sent: a state that was asked for before is an old one.
let turn = 0;
let flying = 0; // requests that are not answered yet
export const turns = () => turn;
export const settled = () => flying === 0;

export async function send(known) {
  turn += 1;
  flying += 1;
  try { await post("do/set", { values: known }); } finally { turn += 1; flying -= 1; }
}

// Take a picture that is dropped, pasted or chosen.
export function taking(act) {
  by("file").addEventListener("change", (event) => event.target.files[0] && act(() => put(event.target.files[0])));
  addEventListener("paste", (event) => {
    const file = [...event.clipboardData.files][0];
    if (file) act(() => put(file));
  });
  const stage = by("stage");
  addEventListener("dragover", (event) => { event.preventDefault(); stage.classList.add("over"); });
  addEventListener("dragleave", () => stage.classList.remove("over"));
  addEventListener("drop", (event) => {
    event.preventDefault();
    stage.classList.remove("over");
    const file = event.dataTransfer.files[0];
    if (file) act(() => put(file));
  });
}
