// Parallel coordinates: the lines on two canvases, all of them below and the selected ones above; axes and brushes in SVG
// over both. A value that is missing is a gap in its line.

const AXIS_ROOM = 104; // least width of an axis with its heading [px]
const FRAME = { top: 84, bottom: 24, side: 62, height: 450 }; // [px]
const MOST_HASTY = 1000; // lines that are drawn in each frame of a drag
const NEAR = 8; // how far from a line a click may be [px]

const parallel = {
  order: fields.map((_, i) => i), // fields from left to right
  ranges: fields.map((_, i) => rangeOf(i)),
  brushes: new Map(), // field → its lowest and highest value, in its unit
  box: null, // the element that holds it all
  places: [], // of the axes [px]
};

/** A variable's axis has its bounds; an objective's goes from the least to the greatest value. */
function rangeOf(i) {
  const { lower, upper, scale } = fields[i];
  if (lower !== null) return [lower * scale, upper * scale];
  const values = columns[i].subarray(0, drawnDesigns).filter(Number.isFinite);
  if (!values.length) return [0, 1];
  const [low, high] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  const half = low < high ? 0 : Math.abs(low) / 2 || 0.5;
  return [low - half, high + half];
}

const depth = () => FRAME.height - FRAME.top - FRAME.bottom;

function placeOf(i, value) {
  const [low, high] = parallel.ranges[i];
  return FRAME.top + depth() * (1 - (value - low) / (high - low));
}

function valueAt(i, y) {
  const [low, high] = parallel.ranges[i];
  return low + (high - low) * Math.min(1, Math.max(0, 1 - (y - FRAME.top) / depth()));
}

/** Rows through every brush; a line with a gap at a brushed axis goes through none. */
function rowsBrushed() {
  const brushes = [...parallel.brushes];
  return [...Array(drawnDesigns).keys()].filter((row) =>
    brushes.every(([i, [low, high]]) => columns[i][row] >= low && columns[i][row] <= high));
}

// --- lines ---

function drawLine(context, row) {
  let joined = false;
  context.beginPath();
  parallel.order.forEach((i, k) => {
    const value = columns[i][row];
    if (!Number.isFinite(value)) { joined = false; return; }
    const [x, y] = [parallel.places[k], placeOf(i, value)];
    if (!joined) context.moveTo(x, y); // and to itself, so that a point between two gaps is a dot
    context.lineTo(x, y);
    joined = true;
  });
  context.stroke();
}

function cleared(canvas) {
  const ratio = crisp();
  const width = parallel.box.clientWidth;
  canvas.width = width * ratio;
  canvas.height = FRAME.height * ratio;
  const context = canvas.getContext("2d", { willReadFrequently: true }); // by the processor: thousands of thin lines stall WebGL in software
  context.scale(ratio, ratio);
  context.lineJoin = "round";
  context.lineCap = "round";
  return context;
}

function drawRows(context, rows, width) {
  const { series } = theme();
  context.globalAlpha = Math.max(0.12, Math.min(0.75, 8 / Math.sqrt(rows.length))); // many lines: their density shows
  context.lineWidth = width;
  for (const row of mixed(rows)) {
    context.strokeStyle = series[report.designs.strategy[row] % series.length];
    drawLine(context, row);
  }
}

/** Elsewhere, then copied as one picture: of many lines drawn on a canvas in the page Chromium prints none. */
function drawAll() {
  const canvas = parallel.box.querySelector(".all");
  const apart = document.createElement("canvas");
  drawRows(cleared(apart), [...Array(drawnDesigns).keys()], 1);
  const context = cleared(canvas);
  context.resetTransform();
  context.drawImage(apart, 0, 0);
}

/** Draw the selected lines; hastily, while a brush is dragged, an even part of them where they are many. */
function drawSelected(rows, active, lead, hasty) {
  parallel.box.dataset.selected = active ? rows.length : "";
  const context = cleared(parallel.box.querySelector(".some"));
  const step = hasty ? Math.ceil(rows.length / MOST_HASTY) : 1;
  drawRows(context, rows.filter((_, i) => i % step === 0), rows.length > MOST_HASTY ? 1 : 1.4); // hairlines are drawn twice as fast
  if (lead === undefined) return;
  context.globalAlpha = 1;
  context.lineWidth = 2.4;
  context.strokeStyle = theme().ink;
  drawLine(context, lead);
}

/** The line nearest to a place, undefined where none is near. */
function nearestRow(x, y, rows) {
  const k = parallel.places.findIndex((place, at) => at > 0 && x <= place) - 1;
  if (k < 0 || x < parallel.places[0]) return undefined;
  const [left, right] = [parallel.order[k], parallel.order[k + 1]];
  const share = (x - parallel.places[k]) / (parallel.places[k + 1] - parallel.places[k]);
  let [best, least] = [undefined, NEAR];
  for (const row of rows) {
    const away = Math.abs(y - (1 - share) * placeOf(left, columns[left][row]) - share * placeOf(right, columns[right][row]));
    if (away < least) [best, least] = [row, away]; // never of a line with a gap here: its place is NaN
  }
  return best;
}

/** Select the line at the pointer; of those selected, if there are any, unless it is to be added. */
function pickLine(event) {
  const { left, top } = parallel.box.getBoundingClientRect();
  const adds = event.shiftKey || event.ctrlKey || event.metaKey;
  const all = [...Array(drawnDesigns).keys()];
  const rows = selection.ids.size && !adds ? all.filter((row) => selection.ids.has(ids[row])) : all;
  const row = nearestRow(event.clientX - left, event.clientY - top, rows);
  if (row !== undefined) pick(ids[row], "parallel", event);
}

// --- all of it ---

function layOut() {
  const { box, order } = parallel;
  box.style.minWidth = 2 * FRAME.side + AXIS_ROOM * (order.length - 1) + "px";
  box.style.height = FRAME.height + "px";
  const room = (box.clientWidth - 2 * FRAME.side) / Math.max(1, order.length - 1);
  parallel.places = order.map((_, k) => FRAME.side + k * room);
  drawAll();
  drawAxes(box.querySelector("svg"), room);
  followInLines();
}

function followInLines() {
  const rows = [...selection.ids].map((id) => rowOf.get(id)).filter((row) => row < drawnDesigns);
  const lead = selection.lead === null ? undefined : rowOf.get(selection.lead);
  drawSelected(rows, selection.active, lead < drawnDesigns ? lead : undefined);
}

function beginParallel() {
  const box = byId("parallel");
  parallel.box = box;
  box.append(make("canvas", undefined, { class: "all", "aria-hidden": "true" }), make("canvas", undefined, { class: "some", "aria-hidden": "true" }));
  const picture = box.appendChild(svg("svg", {}));
  let began = null; // where the pointer went down, if beside the axes: a drag along one ends with a click, too
  picture.addEventListener("pointerdown", (event) => { began = event.target; });
  picture.addEventListener("click", (event) => { if (event.target === picture && began === picture) pickLine(event); });
  layOut();
  let width = box.clientWidth;
  new ResizeObserver(() => {
    if (box.clientWidth === width) return;
    width = box.clientWidth;
    layOut();
  }).observe(box);
  follow(() => {
    if (selection.by !== "brushes" && parallel.brushes.size) {
      parallel.brushes.clear();
      tellBrushes();
    }
    followInLines();
  });
}
