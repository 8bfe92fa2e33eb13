// The design shown closely, to scale, with the outlines of others that are selected. sketch_svg.py draws the same for
// files: what is changed here is changed there.

const MOST_TRACED = 12; // other designs whose outlines are drawn
const SHORT = 26; // [px] below which a dimension line has its arrows outside
const LETTER = 6.4; // [px] width of a letter, to judge whether a label fits

function svgMake(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes || {})) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

/** A design's dimensions, in the units shown, in the order of the drawing's columns. */
function dimensionsOf(row) {
  const values = [];
  for (const column of report.sketch.columns) {
    values.push(typeof column === "number" ? column : Array.isArray(column) ? column[row] : values[column.of] * column.times);
  }
  return values;
}

const trimmed = (text) => (text.includes(".") && !text.includes("·") ? text.replace(/\.?0+$/, "") : text);

function measureText(column, values) {
  const unit = report.sketch.units[column];
  return trimmed(number(values[column])) + (unit === "°" || unit === "" ? unit : " " + unit);
}

const labelText = (column, values) => report.sketch.symbols[column] + " = " + measureText(column, values);

function place(form, values) {
  let sum = form[0];
  for (let i = 1; i < form.length; i += 2) sum += form[i + 1] * values[form[i]];
  return sum;
}

function outlineOf(item, values) {
  const at = (form) => place(form, values).toFixed(2);
  return item.steps.map(([letter, ...parts]) => {
    if (letter === "Z") return "Z";
    if (letter !== "A") return letter + at(parts[0]) + " " + at(parts[1]);
    return "A" + at(parts[0]) + " " + at(parts[0]) + " 0 0 " + parts[1] + " " + at(parts[2]) + " " + at(parts[3]);
  }).join("");
}

/** Lower what follows an underscore, raise what follows a circumflex. */
function sketchText(x, y, text, style, anchor) {
  const element = svgMake("text", { class: style, x: x.toFixed(2), y: y.toFixed(2), "text-anchor": anchor || "middle" });
  let shift = 0;
  for (const part of text.match(/_[A-Za-z0-9]+|\^[0-9]|[^_^]+|./g) || []) {
    const want = part.length < 2 ? 0 : { _: 3, "^": -4 }[part[0]] || 0;
    const span = svgMake("tspan", { dy: want - shift }, want ? part.slice(1) : part);
    if (want) span.setAttribute("class", "small");
    element.append(span);
    shift = want;
  }
  return element;
}

function measureNodes(item, values) {
  const level = item.side === "above" || item.side === "below";
  const [along, across] = level ? [0, 1] : [1, 0];
  const ends = [item.begin, item.end].map((point) => point.map((form) => place(form, values)));
  const [low, high] = ends.map((end) => [end[along], end[across]]).sort((a, b) => a[0] - b[0]);
  const isShort = high[0] - low[0] < SHORT;
  const point = (a, b) => (level ? a.toFixed(2) + " " + b.toFixed(2) : b.toFixed(2) + " " + a.toFixed(2));
  const line = (a, b, c, d) => "M" + point(a, b) + "L" + point(c, d);
  const { at } = item;
  const between = isShort ? line(low[0] - 14, at, low[0], at) + line(high[0], at, high[0] + 14, at) : line(low[0], at, high[0], at);
  const path = line(low[0], low[1], low[0], at) + line(high[0], high[1], high[0], at) + between;
  const arrow = (tip, turn) => "M" + point(tip, at) + "L" + point(tip + turn * 8, at - 2.6) + "L" + point(tip + turn * 8, at + 2.6) + "Z";
  const turn = isShort ? -1 : 1;
  const text = labelText(item.column, values);
  return [
    svgMake("path", { class: "measure", d: path }),
    svgMake("path", { class: "arrow", d: arrow(low[0], turn) + arrow(high[0], -turn) }),
    measureLabel(item, text, level, low[0], high[0], isShort ? 18 : 6),
  ];
}

function measureLabel(item, text, level, low, high, beside) {
  const middle = (low + high) / 2;
  if (!level) return sketchText(item.side === "left" ? item.at - 8 : item.at + 8, middle + 4, text, "label", item.side === "left" ? "end" : "start");
  if (LETTER * text.length + 12 <= high - low) return sketchText(middle, item.at - 5, text, "label");
  if (middle < item.middle - 1) return sketchText(low - beside, item.at + 4, text, "label", "end");
  return sketchText(high + beside, item.at + 4, text, "label", "start");
}

function itemNodes(item, values) {
  if (item.kind === "shape") return [svgMake("path", { class: item.style, d: outlineOf(item, values) })];
  if (item.kind === "measure") return measureNodes(item, values);
  if (item.kind === "word") return [sketchText(place(item.x, values), place(item.y, values) + 4, item.text, "word")];
  if (item.kind === "note") return [sketchText(item.x, item.y, item.columns.map((i) => labelText(i, values)).join(", "), "note")];
  if (item.kind === "title") return [sketchText(item.x, item.y, item.text, "title")];
  const tick = (x) => "M" + x.toFixed(2) + " " + (item.y - 4).toFixed(2) + "v8";
  const path = tick(item.x) + "M" + item.x.toFixed(2) + " " + item.y.toFixed(2) + "h" + item.width.toFixed(2) + tick(item.x + item.width);
  return [svgMake("path", { class: "bar", d: path }), sketchText(item.x + item.width + 8, item.y + 4, item.text, "scale", "start")];
}

function tellSketch() {
  const { lead } = selection;
  const group = byId("sketch-drawn");
  const others = [...selection.ids].filter((id) => id !== lead);
  const traced = [];
  for (const id of others) {
    if (traced.length === MOST_TRACED) break; // of thousands the dimensions are not asked for
    if (!dimensionsOf(rowOf.get(id)).includes(null)) traced.push(id);
  }
  byId("sketched-others").hidden = others.length === 0;
  byId("sketched-others").textContent = "Thin lines: " + (traced.length < others.length ? "the first " + traced.length + " of " : "the outlines of ") + counted(others.length, "other selected design") + ".";
  const values = lead === null ? [null] : dimensionsOf(rowOf.get(lead));
  if (values.includes(null)) {
    byId("sketch-title").textContent = lead === null ? "No design selected" : "Of " + lead + " not every dimension is known";
    byId("sketch-words").textContent = "";
    group.replaceChildren();
    return;
  }
  byId("sketch-title").textContent = "Design " + lead + ", drawn to scale";
  byId("sketch-words").textContent = report.sketch.main.map((i) => report.sketch.names[i] + " " + measureText(i, values)).join(", ");
  const outlines = report.sketch.items.filter((item) => item.traced);
  const trace = (id) => svgMake("path", { class: "other", d: outlines.map((item) => outlineOf(item, dimensionsOf(rowOf.get(id)))).join("") });
  group.replaceChildren(...report.sketch.items.flatMap((item) => itemNodes(item, values)), ...traced.map(trace));
}

function followInSketch() {
  if (!report.sketch) return;
  const parsed = new DOMParser().parseFromString('<svg xmlns="http://www.w3.org/2000/svg">' + report.sketch.defs + "</svg>", "image/svg+xml");
  byId("sketch-defs").replaceWith(document.importNode(parsed.documentElement.firstChild, true));
  followThen(tellSketch);
}
