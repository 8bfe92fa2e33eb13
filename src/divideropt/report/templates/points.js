// The points of the projections, on canvases beneath plotly's axes: what was tried, the front, and what is selected of it.
// Plotly draws the axes, finds the point under the pointer and lets boxes be drawn; its own marks are an element each.

const LAYERS = ["tried", "all", "some"]; // from below
const TRIED = { size: 2, opacity: 0.3 }; // of a mark [px]
const CROSS = [[-1.2, -0.4], [-0.4, -0.4], [-0.4, -1.2], [0.4, -1.2], [0.4, -0.4], [1.2, -0.4], [1.2, 0.4], [0.4, 0.4], [0.4, 1.2], [-0.4, 1.2], [-0.4, 0.4], [-1.2, 0.4]];
const OUTLINES = { // by plotly's names, of a mark with radius 1; without one it is a circle
  square: [[-1, -1], [1, -1], [1, 1], [-1, 1]],
  diamond: [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]],
  cross: CROSS,
  x: CROSS.map(([x, y]) => [(x - y) * Math.SQRT1_2, (x + y) * Math.SQRT1_2]),
};

const unpacked = (text, Numbers) => new Numbers(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
const tried = report.tried && {
  values: report.tried.values.map((text, i) => unpacked(text, Float32Array).map((value) => value * fields[firstObjective + i].scale)),
  feasible: unpacked(report.tried.feasible, Uint8Array),
};

const isDotted = (figure) => isProjection(figure) && figure.dotted; // its points are drawn here

/** Where plotly has put the axes [px], and what they show. */
function frameOf(element) {
  const { xaxis, yaxis } = element._fullLayout;
  return { left: xaxis._offset, top: yaxis._offset, width: xaxis._length, height: yaxis._length, x: xaxis.range.map(Number), y: yaxis.range.map(Number) };
}

// --- marks ---

/** How a trace's marks are drawn, each filled by itself: three times as fast as a picture put down again and again. */
function lookOf(marker) {
  const { color, symbol, size, opacity } = exchanged(marker, theme());
  const outline = new Path2D();
  if (OUTLINES[symbol]) OUTLINES[symbol].forEach(([x, y]) => outline.lineTo((x * size) / 2, (y * size) / 2));
  else outline.arc(0, 0, size / 2, 0, 2 * Math.PI);
  outline.closePath();
  return { color, outline, opacity, isOpen: symbol === "circle-open" };
}

function fitted(canvas, frame, ratio) {
  for (const key of ["left", "top", "width", "height"]) canvas.style[key] = frame[key] + "px";
  canvas.width = Math.round(frame.width * ratio);
  canvas.height = Math.round(frame.height * ratio);
  const context = canvas.getContext("2d", { willReadFrequently: true }); // by the processor, see parallel.js
  context.scale(ratio, ratio);
  return context;
}

function drawFront(context, traces, frame, ratio, isDrawn) {
  const [wide, high] = [frame.width / (frame.x[1] - frame.x[0]), frame.height / (frame.y[1] - frame.y[0])];
  const marks = traces.flatMap(({ x, y, marker, customdata }) => {
    const look = lookOf(marker);
    return [...customdata.keys()].filter((i) => isDrawn(customdata[i])).map((i) => ({ look, x: x[i], y: y[i] }));
  });
  for (const { look, x, y } of mixed(marks)) {
    context.setTransform(ratio, 0, 0, ratio, ratio * (x - frame.x[0]) * wide, ratio * (frame.height - (y - frame.y[0]) * high));
    context.globalAlpha = look.opacity;
    if (look.isOpen) {
      context.strokeStyle = look.color;
      context.stroke(look.outline);
    } else {
      context.fillStyle = look.color;
      context.fill(look.outline);
    }
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.globalAlpha = 1;
}

function drawTried(context, axes, frame) {
  const [xs, ys] = axes.map((objective) => tried.values[objective]);
  const [wide, high] = [frame.width / (frame.x[1] - frame.x[0]), frame.height / (frame.y[1] - frame.y[0])];
  context.globalAlpha = TRIED.opacity;
  [context.fillStyle, context.strokeStyle] = [theme().quiet, theme().missed];
  const { size } = TRIED;
  context.beginPath();
  for (let i = 0; i < xs.length; i += 1) {
    const [x, y] = [(xs[i] - frame.x[0]) * wide, frame.height - (ys[i] - frame.y[0]) * high];
    if (x < -size || y < -size || x > frame.width + size || y > frame.height + size) continue;
    if (tried.feasible[i]) context.fillRect(x - size / 2, y - size / 2, size, size);
    else { // a cross: what breaks a constraint
      context.moveTo(x - size, y - size);
      context.lineTo(x + size, y + size);
      context.moveTo(x - size, y + size);
      context.lineTo(x + size, y - size);
    }
  }
  context.stroke();
}

function drawRing(context, axes, frame) {
  if (selection.lead === null) return;
  const [x, y] = axes.map((objective) => columns[firstObjective + objective][rowOf.get(selection.lead)]);
  context.strokeStyle = theme().ink;
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(((x - frame.x[0]) / (frame.x[1] - frame.x[0])) * frame.width, frame.height * (1 - (y - frame.y[0]) / (frame.y[1] - frame.y[0])), 6.5, 0, 2 * Math.PI);
  context.stroke();
}

function drawLayer(figure, name, frame, ratio) {
  const context = fitted(figure.layers[name], frame, ratio);
  const traces = figure.data.filter((trace) => trace.customdata);
  if (name === "tried") drawTried(context, figure.axes, frame);
  else drawFront(context, traces, frame, ratio, name === "all" ? () => true : (id) => selection.ids.has(id));
  if (name === "some") drawRing(context, figure.axes, frame);
}

// --- with plotly ---

/** Draw what is out of date: all where the axes or the theme have changed, else what is selected. */
function dot(figure, anew) {
  const element = byId(figure.id);
  const [frame, ratio] = [frameOf(element), crisp()];
  const place = JSON.stringify([frame, ratio]);
  const all = anew || figure.place !== place;
  figure.place = place;
  for (const name of all ? LAYERS : ["some"]) drawLayer(figure, name, frame, ratio);
  element.dataset.selected = selection.active ? selection.ids.size : "";
}

function followInDots(figure) {
  if (!shown.has(figure.id)) return undefined;
  dot(figure, false);
  const element = byId(figure.id);
  if (selection.by === figure.id || !(element.layout.selections || []).length) return undefined;
  figure.drawing = true; // the outline of a box is another selection's
  return Plotly.relayout(element, { selections: [] }).finally(() => { figure.drawing = false; });
}

/** All that was tried, or again the front: what a double click does that lets go of nothing. */
function showMore(figure) {
  const [element, { xaxis, yaxis }] = [byId(figure.id), figure.layout];
  const atFront = [0, 1].every((end) => element.layout.xaxis.range[end] === xaxis.range[end] && element.layout.yaxis.range[end] === yaxis.range[end]);
  return Plotly.relayout(element, atFront ? { "xaxis.autorange": true, "yaxis.autorange": true } : { "xaxis.range": [...xaxis.range], "yaxis.range": [...yaxis.range] });
}

function beginDots(figure) {
  const element = byId(figure.id);
  const canvases = LAYERS.map((name) => make("canvas", undefined, { class: "points " + name, "aria-hidden": "true" }));
  figure.layers = Object.fromEntries(LAYERS.map((name, i) => [name, canvases[i]]));
  element.prepend(...canvases);
  dot(figure, true);
  const moved = () => { if (JSON.stringify([frameOf(element), crisp()]) !== figure.place) dot(figure, true); };
  element.on("plotly_afterplot", moved);
  element.on("plotly_relayouting", moved);
}

/** What plotly is given of a figure whose points are drawn here: the points without marks, and the corners of what was tried, which a double click shows. */
function withoutMarks(figure, data) {
  const [x, y] = figure.axes.map((objective) => {
    const [low, high] = tried.values[objective].reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
    return [low - 0.02 * (high - low), high + 0.02 * (high - low)];
  });
  const corners = { x, y, mode: "none", hoverinfo: "skip", name: "tried" };
  const bare = data.filter((trace) => !isRing(trace)).map((trace) => ({ ...trace, mode: "none" }));
  return tried.feasible.length ? [corners, ...bare] : bare;
}

const isWithin = (low, value, high) => Math.min(low, high) <= value && value <= Math.max(low, high);

/** Whether a point is in an outline that plotly drew: a box, or a path of straight lines. */
function isInside({ type, x0, x1, y0, y1, path }, x, y) {
  if (type === "rect") return isWithin(x0, x, x1) && isWithin(y0, y, y1);
  const numbers = path.match(/[-+]?[\d.]+(?:e[-+]?\d+)?/gi).map(Number);
  let inside = false;
  for (let i = 0, j = numbers.length - 2; i < numbers.length; j = i, i += 2) {
    const [[a, b], [c, d]] = [numbers.slice(i, i + 2), numbers.slice(j, j + 2)];
    if (b > y !== d > y && x < ((c - a) * (y - b)) / (d - b) + a) inside = !inside;
  }
  return inside;
}

function idsOutlined(figure) {
  const outlines = byId(figure.id).layout.selections || [];
  const isChosen = (x, y) => outlines.some((outline) => isInside(outline, x, y));
  return figure.data.filter((trace) => trace.customdata).flatMap(({ x, y, customdata }) => customdata.filter((_, i) => isChosen(x[i], y[i])));
}

/** The figure as a file: plotly's picture of the axes, with the canvases as an image below. */
function savePicture(element, figure) {
  const { width, height } = figure.layers.all;
  const canvas = make("canvas", undefined, { width, height });
  const context = canvas.getContext("2d");
  for (const name of LAYERS) {
    context.globalAlpha = Number(getComputedStyle(figure.layers[name]).opacity);
    if (!figure.layers[name].hidden) context.drawImage(figure.layers[name], 0, 0);
  }
  const image = { source: canvas.toDataURL(), xref: "paper", yref: "paper", x: 0, y: 1, sizex: 1, sizey: 1, sizing: "stretch", layer: "below" };
  const layout = { ...element.layout, images: [image], selections: [], paper_bgcolor: theme().paper };
  return Plotly.downloadImage({ data: element.data, layout }, { format: "png", scale: 2, filename: figure.id, width: element.clientWidth, height: element.clientHeight });
}

function followToggle() {
  const box = byId("show-tried");
  if (!box) return;
  box.addEventListener("change", () => {
    for (const canvas of document.querySelectorAll("canvas.tried")) canvas.hidden = !box.checked;
  });
}
