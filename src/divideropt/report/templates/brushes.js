// The axes of the parallel coordinates, and on each a brush: dragged by the pointer, or its ends moved by keys.

const STRIP = 15; // how far beside an axis a drag is still on it [px]
const STEP = 0.01; // share of an axis that a key moves an end by; ten times that with Shift or by page
const PAUSE = 60; // without a move, while dragging, until the other views follow [ms]

function svg(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

function drawAxes(picture, room) {
  const { order, places } = parallel;
  const focused = picture.contains(document.activeElement) ? document.activeElement.dataset.end : null;
  picture.replaceChildren(...order.map((i, k) => axisOf(i, places[k], room)));
  tellBrushes();
  if (focused) picture.querySelector('[data-end="' + focused + '"]').focus();
}

function axisOf(i, x, room) {
  const group = svg("g", { class: "axis", transform: "translate(" + x + ",0)", "data-field": i });
  const [top, bottom] = [FRAME.top, FRAME.height - FRAME.bottom];
  group.append(headingOf(i, room));
  group.append(svg("line", { class: "spine", y1: top, y2: bottom }));
  for (const value of ticks(...parallel.ranges[i])) {
    const y = placeOf(i, value);
    group.append(svg("line", { class: "tick", x1: -5, x2: 0, y1: y, y2: y }));
    group.append(svg("text", { class: "value", x: -11, y: y + 4, "text-anchor": "end" }, tickWords(value)));
  }
  const strip = svg("rect", { class: "strip", x: -STRIP, width: 2 * STRIP, y: top - 8, height: bottom - top + 16 });
  group.append(strip, svg("rect", { class: "brush", x: -7, width: 14, rx: 2 }));
  for (const end of ["lower", "upper"]) group.append(endOf(i, end));
  group.addEventListener("pointerdown", (event) => beginDrag(event, i, group));
  return group;
}

function headingOf(i, room) {
  const lines = wrapped(fields[i].words, Math.floor(room / 7)).concat(fields[i].detail ? [fields[i].detail] : []);
  const heading = svg("text", { class: "heading", "text-anchor": "middle" });
  heading.append(svg("title", {}, fields[i].label));
  lines.forEach((line, n) => heading.append(svg("tspan", { x: 0, y: FRAME.top - 20 - 15 * (lines.length - 1 - n) }, line)));
  return heading;
}

/** Words in at most three lines of so many letters; what is longer is cut, and whole in the title. */
function wrapped(words, most) {
  const lines = [""];
  for (const word of words.split(" ")) {
    const line = lines[lines.length - 1];
    if (line && line.length + 1 + word.length > most) lines.push(word);
    else lines[lines.length - 1] = line ? line + " " + word : word;
  }
  if (lines.length > 3) lines.splice(2, Infinity, lines[2] + " …");
  return lines.map((line) => (line.length > most + 2 ? line.slice(0, most) + "…" : line));
}

function ticks(low, high) {
  const rough = (high - low) / 6;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * (1 - 1e-9));
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, n) => Number(((first + n) * step).toPrecision(12)));
}

const tickWords = (value) => {
  const size = Math.abs(value);
  return (size !== 0 && (size < 1e-4 || size >= 1e6) ? raised(value) : String(Number(value.toPrecision(6)))).replace("-", "−");
};

// --- an end of a brush, for keys ---

function endOf(i, end) {
  const handle = svg("g", { class: "end", role: "slider", tabindex: 0, "data-end": end + i, "aria-orientation": "vertical", "aria-label": fields[i].words + ", " + end + " end of the brush" });
  handle.append(svg("path", { d: end === "upper" ? "M-8 0H8L0 -8z" : "M-8 0H8L0 8z" }));
  handle.addEventListener("keydown", (event) => onEndKey(event, i, end));
  return handle;
}

function onEndKey(event, i, end) {
  const [low, high] = parallel.ranges[i];
  const wide = high - low;
  const far = event.shiftKey || event.key.startsWith("Page") ? 10 * STEP : STEP;
  const brush = [...(parallel.brushes.get(i) || [low, high])];
  const at = end === "lower" ? 0 : 1;
  const moves = { ArrowUp: far, ArrowRight: far, PageUp: far, ArrowDown: -far, ArrowLeft: -far, PageDown: -far, Home: -Infinity, End: Infinity };
  if (event.ctrlKey && event.key in { ArrowLeft: 0, ArrowRight: 0 }) moveAxis(i, parallel.order.indexOf(i) + Math.sign(moves[event.key]));
  else if (event.key === "Delete" || event.key === "Backspace") brushAxis(i, null);
  else if (event.key in moves) {
    const limits = at === 0 ? [low, brush[1]] : [brush[0], high];
    brush[at] = Math.min(limits[1], Math.max(limits[0], brush[at] + moves[event.key] * wide));
    brushAxis(i, brush);
  } else return;
  event.preventDefault();
}

/** Set an axis's brush, or take it off; one over the whole axis is none. */
function brushAxis(i, brush) {
  const [low, high] = parallel.ranges[i];
  if (brush === null || (brush[0] <= low && brush[1] >= high)) parallel.brushes.delete(i);
  else parallel.brushes.set(i, brush);
  tellBrushes();
  if (!parallel.brushes.size) return clearSelection();
  const rows = rowsBrushed();
  drawSelected(rows, true, undefined, true); // at once; all of them and the other views when the pointer pauses
  clearTimeout(parallel.pausing);
  parallel.pausing = setTimeout(() => choose(rows.map((row) => ids[row]), "brushes"), PAUSE);
  return undefined;
}

function tellBrushes() {
  for (const group of parallel.box.querySelectorAll(".axis")) {
    const i = Number(group.dataset.field);
    const [low, high] = parallel.ranges[i];
    const brush = parallel.brushes.get(i);
    const [from, to] = brush || [low, high];
    const shape = group.querySelector(".brush");
    shape.setAttribute("y", placeOf(i, to));
    shape.setAttribute("height", Math.max(2, placeOf(i, from) - placeOf(i, to)));
    group.classList.toggle("brushed", Boolean(brush));
    for (const [end, value] of [["lower", from], ["upper", to]]) {
      const handle = group.querySelector('[data-end="' + end + i + '"]');
      handle.setAttribute("transform", "translate(0," + placeOf(i, value) + ")");
      handle.setAttribute("aria-valuemin", end === "lower" ? low : from);
      handle.setAttribute("aria-valuemax", end === "lower" ? to : high);
      handle.setAttribute("aria-valuenow", value);
      handle.setAttribute("aria-valuetext", number(value) + " " + fields[i].shown);
    }
  }
}

// --- the pointer ---

function beginDrag(event, i, group) {
  if (event.button !== 0) return;
  event.preventDefault();
  const picture = group.ownerSVGElement;
  const placeIn = (e) => [e.clientX - picture.getBoundingClientRect().left, e.clientY - picture.getBoundingClientRect().top];
  const begin = placeIn(event);
  const move = event.target.closest(".heading") ? headingMove(i, group, begin) : brushMove(i, event, begin);
  const onMove = (e) => move(placeIn(e), false);
  const onUp = (e) => {
    group.removeEventListener("pointermove", onMove);
    move(placeIn(e), true);
  };
  group.setPointerCapture(event.pointerId);
  group.addEventListener("pointermove", onMove);
  group.addEventListener("pointerup", onUp, { once: true });
}

function brushMove(i, event, [, begin]) {
  const [from, to] = parallel.brushes.get(i) || parallel.ranges[i];
  const end = event.target.closest(".end");
  const inside = event.target.closest(".brush") && parallel.brushes.has(i);
  if (end) end.focus({ preventScroll: true });
  let moved = false;
  return ([, y], last) => {
    moved = moved || Math.abs(y - begin) > 2;
    if (!moved) {
      if (last && !end) brushAxis(i, null); // a click without a drag takes the brush off
      return;
    }
    if (end) {
      const value = valueAt(i, y);
      const lower = end.dataset.end.startsWith("lower");
      brushAxis(i, lower ? [Math.min(value, to), to] : [from, Math.max(value, from)]);
    } else if (inside) {
      const [low, high] = parallel.ranges[i];
      const by = Math.min(high - to, Math.max(low - from, (begin - y) / depth() * (high - low)));
      brushAxis(i, [from + by, to + by]);
    } else {
      brushAxis(i, [valueAt(i, Math.max(begin, y)), valueAt(i, Math.min(begin, y))]);
    }
  };
}

// --- the order of the axes ---

function headingMove(i, group, [begin]) {
  return ([x], last) => {
    const { places, order } = parallel;
    const at = places[order.indexOf(i)] + x - begin;
    if (!last) group.setAttribute("transform", "translate(" + at + ",0)");
    else moveAxis(i, places.reduce((best, place, k) => (Math.abs(place - at) < Math.abs(places[best] - at) ? k : best), 0));
  };
}

function moveAxis(i, to) {
  const others = parallel.order.filter((other) => other !== i);
  others.splice(Math.min(others.length, Math.max(0, to)), 0, i);
  parallel.order = others;
  layOut();
}
