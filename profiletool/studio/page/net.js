// What the page asks of its server; addresses are relative, so the token comes along.

export class Refused extends Error {}

async function told(answer) {
  const tree = (answer.headers.get("content-type") || "").includes("json") ? await answer.json() : {};
  if (!answer.ok) throw new Refused(tree.error || `the server refused it (${answer.status})`);
  return tree;
}

export const get = async (place) => told(await fetch(place));

export const post = async (place, tree) =>
  told(await fetch(place, {
    method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(tree),
  }));

export const put = async (file) =>
  told(await fetch(`put/${encodeURIComponent(file.name || "pasted.png")}`, { method: "POST", body: file }));

// Calls one at a time; of those that come meanwhile only the last one is made.
export function latest(act) {
  let busy = false;
  let next = null;
  return async function call(...given) {
    if (busy) { next = given; return; }
    busy = true;
    try { await act(...given); } finally {
      busy = false;
      if (next) { const last = next; next = null; call(...last); }
    }
  };
}
