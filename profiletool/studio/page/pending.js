// Changes by hand that finite elements have not bent yet, joint by joint, on top of a version.

export class Pending {
  constructor() { this.clear(); }

  clear() { this.joints = {}; this.bar = null; }

  get any() { return this.bar !== null || Object.keys(this.joints).length > 0; }

  // What the server takes: texts as "3:alpha=103.1,move=2".
  get edits() {
    return Object.entries(this.joints).map(([number, change]) =>
      `${number}:${Object.entries(change).map(([word, value]) => `${word}=${value}`).join(",")}`);
  }

  copy() {
    const made = new Pending();
    made.joints = structuredClone(this.joints);
    made.bar = this.bar;
    return made;
  }

  // Change a joint so that it stands as is wanted, from what it is in the version.
  set(joint, wanted) {
    const same = (a, b) => Math.abs(a - b) < 1e-6;
    const old = this.joints[joint.number] ?? {};
    const now = { move: 0, ...old, ...wanted };
    const change = {};
    if (now.alpha !== undefined && !same(now.alpha, joint.alpha)) change.alpha = now.alpha;
    if (now.openF !== undefined && !same(now.openF, joint.openF)) change.openF = now.openF;
    if (!same(now.move, 0)) change.move = now.move;
    if (now.center !== undefined && !same(now.center, joint.center)) change.center = now.center;
    delete this.joints[joint.number];
    if (Object.keys(change).length) this.joints[joint.number] = change;
  }

  // Leave out what a version that was made meanwhile holds already.
  rebase(sent) {
    for (const [number, change] of Object.entries(this.joints)) {
      const done = sent.joints[number];
      if (!done) continue;
      const rest = { ...change };
      for (const word of ["alpha", "openF", "center"]) if (rest[word] === done[word]) delete rest[word];
      rest.move = (change.move ?? 0) - (done.move ?? 0);
      if (Math.abs(rest.move) < 1e-6) delete rest.move;
      delete this.joints[number];
      if (Object.keys(rest).length) this.joints[number] = rest;
    }
    if (this.bar === sent.bar) this.bar = null;
  }

  // A joint of a version as it stands with the change.
  of(joint) {
    const change = this.joints[joint.number] ?? {};
    return {
      ...joint, alpha: change.alpha ?? joint.alpha, openF: change.openF ?? joint.openF,
      center: change.center ?? joint.center, centre: joint.centre + (change.move ?? 0),
    };
  }
}
