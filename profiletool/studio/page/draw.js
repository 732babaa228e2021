// Elements of SVG, and geometry on lines of points [x, y].

export function make(name, attributes = {}, ...inner) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined) element.setAttribute(key, value);
  }
  element.append(...inner);
  return element;
}

export const line = (kind, d) => make("path", { class: kind, d });

export const pathOf = (points) => "M" + points.map(([x, y]) => `${x},${y}`).join(" ");

// Place of a pointer in the units of an SVG element.
export function placeOf(svg, event) {
  const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  return [x, y];
}

// Arc length of the point of a line that is nearest to a place.
export function nearest(points, [x, y]) {
  let [best, found, gone] = [Infinity, 0, 0];
  for (let i = 1; i < points.length; i++) {
    const [[ax, ay], [bx, by]] = [points[i - 1], points[i]];
    const [dx, dy] = [bx - ax, by - ay];
    const length = Math.hypot(dx, dy);
    const share = length ? Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / length ** 2, 0), 1) : 0;
    const off = Math.hypot(ax + share * dx - x, ay + share * dy - y);
    if (off < best) [best, found] = [off, gone + share * length];
    gone += length;
  }
  return found;
}

export const lengthOf = (points) =>
  points.slice(1).reduce((sum, [x, y], i) => sum + Math.hypot(x - points[i][0], y - points[i][1]), 0);

// A round handle that is dragged and moved by keys. `act` has begin(place), move(place) and end(),
// and step(by) for the arrow keys; `size` is in units of the SVG.
export function handle(svg, size, label, act) {
  const group = make("g", { class: "handle", tabindex: 0, role: "slider", "aria-label": label });
  group.append(make("circle", { class: "reach", r: 2.2 * size }));
  group.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    event.preventDefault();
    event.stopPropagation();
    group.focus({ preventScroll: true });
    const from = placeOf(svg, event);
    act.begin?.(from);
    const move = (next) => act.move(placeOf(svg, next));
    const end = () => {
      removeEventListener("pointermove", move);
      removeEventListener("pointerup", end);
      removeEventListener("pointercancel", end);
      act.end?.();
    };
    addEventListener("pointermove", move);
    addEventListener("pointerup", end);
    addEventListener("pointercancel", end);
  });
  group.addEventListener("keydown", (event) => {
    const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    act.step(by * (event.shiftKey ? 5 : 1));
  });
  return group;
}
