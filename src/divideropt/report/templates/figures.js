// Plotly's figures: drawn, recoloured with the page's theme, and marked with the selection.

const shown = new Map(); // element's id → figure that is drawn there
const NARROW = 600; // [px]
const QUIET = 2000; // without a touch, before WebGL is drawn where nobody looks [ms]
const PAGE = { portrait: 900, landscape: 620 }; // that any paper has room for [px]
const SMALLEST = 0.5; // that a figure is shrunk to before its parts move together
const STEADY = 100; // that a place has its width before a figure follows [ms]
const DIMMED = 0.12; // opacity of what is not selected

let themed = null; // kept until the theme changes: to ask for it makes the browser style the whole page

function theme() {
  if (themed) return themed;
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue("--" + name).trim();
  themed = { ink: colour("ink"), quiet: colour("quiet"), missed: colour("missed"), grid: colour("grid"), line: colour("line"), paper: colour("paper"), series: report.colours.map((_, i) => colour("series-" + i)) };
  return themed;
}

function exchanged(style, t) {
  if (!style) return style;
  let text = JSON.stringify(style);
  report.colours.forEach((hex, i) => { text = text.replaceAll(hex, t.series[i]); });
  return JSON.parse(text);
}

function coloured(figure) {
  const t = theme();
  const layout = structuredClone(figure.layout);
  const axis = { color: t.ink, gridcolor: t.grid, zerolinecolor: t.line, linecolor: t.line, tickcolor: t.line };
  layout.font = { ...layout.font, color: t.ink };
  layout.hoverlabel = { bgcolor: t.paper, bordercolor: t.line, font: { color: t.ink } };
  layout.modebar = { bgcolor: "rgba(0,0,0,0)", color: t.quiet, activecolor: t.ink };
  for (const key of Object.keys(layout)) {
    if (/^[xy]axis/.test(key)) layout[key] = { exponentformat: "power", minexponent: 5, showgrid: !isDotted(figure), zeroline: false, showline: true, ticks: "outside", ticklen: 4, ...axis, ...layout[key] };
  }
  if (layout.scene) {
    if (byId(figure.id).clientWidth < NARROW) {
      for (const key of ["x", "y", "z"]) layout.scene.camera.eye[key] *= 1.5; // step back: the labels fit
    }
    for (const key of ["xaxis", "yaxis", "zaxis"]) {
      layout.scene[key] = { ...layout.scene[key], ...axis, gridcolor: t.line, showbackground: false, zeroline: false };
    }
  }
  layout.height = fitHeight(figure);
  figure.width = byId(figure.id).clientWidth;
  layout.width = figure.width || undefined; // plotly would ask later, when the page may have been printed or be as wide as before
  for (const shape of layout.shapes || []) shape.line.color = t.quiet;
  const data = figure.data.map((trace) => {
    const copy = { ...trace };
    for (const key of ["line", "marker"]) if (trace[key]) copy[key] = exchanged(trace[key], t);
    if (figure.axes && trace.customdata) copy.text = trace.text ??= labelsOf(figure, trace);
    if (isRing(trace)) copy.marker = { ...copy.marker, color: t.ink, line: { ...copy.marker.line, color: t.ink } };
    return copy;
  });
  return { data: isDotted(figure) ? withoutMarks(figure, data) : data, layout };
}

/** What a point's label says below its name: Plotly writes 12345 as 1.2e+4. */
function labelsOf(figure, trace) {
  const axes = figure.axes.map((objective, k) => ({ values: trace["xyz"[k]], words: plain(fields[firstObjective + objective].words), unit: plain(fields[firstObjective + objective].shown) }));
  return trace.customdata.map((_, i) => axes.map(({ values, words, unit }) => words + " " + number(values[i]) + " " + unit).join("<br>"));
}

/** A figure's height [px]; on paper it fits a page: it is made smaller as far as it can be read, then lower. */
function fitHeight({ id, layout }) {
  const most = onPaper() ? PAGE[document.documentElement.clientWidth > 850 ? "landscape" : "portrait"] : Infinity;
  const share = Math.min(1, Math.max(SMALLEST, most / layout.height));
  const height = Math.min(layout.height, most / share);
  Object.assign(byId(id).style, { height: height + "px", zoom: share < 1 ? share : "" });
  return height;
}

const isRing = (trace) => trace.name === "selected" && trace.mode === "markers";

// --- drawing ---

function webgl() {
  try {
    const context = document.createElement("canvas").getContext("webgl");
    if (!context) return false;
    const loser = context.getExtension("WEBGL_lose_context");
    if (loser) loser.loseContext();
    return true;
  } catch (error) {
    return false;
  }
}

function leaveOut(element) {
  Plotly.purge(element);
  element.hidden = true;
  const { parentElement } = element;
  for (const caption of parentElement.querySelectorAll(":scope > figcaption")) caption.hidden = true;
  for (const sentence of parentElement.querySelectorAll(":scope > .missing")) sentence.hidden = false;
}

function configOf(figure) {
  if (!isProjection(figure)) return report.config;
  const removed = report.config.modeBarButtonsToRemove.filter((name) => !/^(select|lasso)2d$/.test(name));
  if (!isDotted(figure)) return { ...report.config, modeBarButtonsToRemove: removed };
  const button = { name: "save", title: "Download plot as a PNG", icon: Plotly.Icons.camera, click: (element) => savePicture(element, figure) };
  return { ...report.config, modeBarButtonsToRemove: [...removed, "toImage"], modeBarButtonsToAdd: [button] };
}

const isProjection = (figure) => figure.axes && figure.axes.length === 2;

async function draw(figure) {
  const element = byId(figure.id);
  if (!element) return;
  figure.begun = true;
  const { data, layout } = coloured(figure);
  await Plotly.newPlot(element, data, layout, configOf(figure));
  if (element.querySelector(".no-webgl, a[href]")) return leaveOut(element); // plotly's own words, with a link
  element.setAttribute("role", "group"); // no image: plotly's buttons in it are reached by Tab
  for (const drawing of element.querySelectorAll(".main-svg, .gl-container")) drawing.setAttribute("aria-hidden", "true"); // the label says what it is; the numbers are in the tables
  shown.set(figure.id, figure);
  widths.observe(element);
  if (isDotted(figure)) beginDots(figure);
  if (figure.stale) redraw(figure);
  if (!figure.axes) return;
  const later = (action) => setTimeout(action, 0); // plotly has not done yet when it tells
  element.on("plotly_click", (event) => later(() => pick(event.points[0].customdata, figure.id, event.event)));
  element.on("plotly_selected", (event) => { // plotly tells of one also when it draws again
    if (!event || figure.drawing) return;
    later(() => choose(isDotted(figure) ? idsOutlined(figure) : event.points.map((point) => point.customdata), figure.id));
  });
  element.on("plotly_deselect", () => later(() => (isDotted(figure) && !selection.active ? showMore(figure) : clearSelection())));
}

/** A figure is as wide as its place whatever changes that: the window, the paper, or that it is unfolded. */
const widths = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    clearTimeout(target.fitting);
    if (onPaper()) fit(target);
    else target.fitting = setTimeout(() => fit(target), STEADY);
  }
});

function fit(element) {
  const figure = shown.get(element.id);
  if (element.clientWidth && element.clientWidth !== figure.width) redraw(figure);
}

const whenIdle = (action) => (window.requestIdleCallback ? requestIdleCallback(action, { timeout: 1000 }) : setTimeout(action, 100));
const idle = () => new Promise((done) => whenIdle(() => done()));

/** Act when nothing has been touched for a while. */
function whenQuiet(action) {
  const kinds = ["pointermove", "pointerdown", "keydown", "wheel", "touchmove"];
  let waiting;
  const again = () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      for (const kind of kinds) removeEventListener(kind, again, true);
      whenIdle(action);
    }, QUIET);
  };
  for (const kind of kinds) addEventListener(kind, again, { capture: true, passive: true });
  again();
}

/** WebGL takes seconds where a processor computes it: it is drawn when it is looked at or all else is done, and again only where it is looked at. */
function drawWhenSeen(figure, able) {
  const element = byId(figure.id);
  if (!able) return leaveOut(element);
  figure.away = true;
  new IntersectionObserver((entries) => {
    figure.away = !entries[entries.length - 1].isIntersecting;
    if (!figure.away) see(figure);
  }, { rootMargin: "200px" }).observe(element);
  return undefined;
}

async function see(figure) {
  if (figure.begun) {
    if (figure.stale) redraw(figure);
    return;
  }
  markFigure(figure);
  await draw(figure);
  copyForPaper(byId(figure.id));
  byId(figure.id).dataset.drawn = "yes";
}

/** Draw a figure as the selection, the theme and its place now are, at once; WebGL that nobody sees, when it is seen. */
function redraw(figure) {
  figure.stale = Boolean((figure.away && !onPaper()) || (figure.begun && !shown.has(figure.id)));
  if (figure.stale || !shown.has(figure.id)) return;
  const element = byId(figure.id);
  const { data, layout } = coloured(figure);
  if (isProjection(figure) && !isDotted(figure)) {
    layout.selections = selection.by === figure.id ? element.layout.selections : []; // outlines of boxes
    layout.selectionrevision = selection.by === figure.id ? figure.id : String(Math.random());
  }
  figure.drawing = true;
  Plotly.react(element, data, layout, configOf(figure)).finally(() => { figure.drawing = false; });
  if (isDotted(figure)) dot(figure, true);
  if (figure.webgl) copyForPaper(element);
}

/** Chromium prints of a WebGL canvas the last frame, which has the screen's size and colours: a copy of it is printed. */
function copyForPaper(element) {
  if (!onPaper()) return;
  const { glplot } = element._fullLayout.scene._scene;
  glplot.redraw();
  const { width, height } = glplot.canvas;
  const copy = element.querySelector(".printed") ?? element.appendChild(make("canvas", undefined, { class: "printed", "aria-hidden": "true" }));
  [copy.width, copy.height] = [width, height]; // what was in it is gone
  copy.getContext("2d", { willReadFrequently: true }).drawImage(glplot.canvas, 0, 0);
}

// --- the selection in the figures of the front ---

function markFigure(figure) {
  const isChosen = (id) => selection.ids.has(id);
  for (const trace of figure.data) {
    if (!trace.customdata || trace.name === "chosen") continue;
    if (isProjection(figure)) {
      trace.unselected = { marker: { opacity: DIMMED } };
      trace.selectedpoints = selection.active ? [...trace.customdata.keys()].filter((i) => isChosen(trace.customdata[i])) : null;
    } else {
      trace.opacity = selection.active ? DIMMED : 1;
    }
  }
  const over = figure.data.find((trace) => trace.name === "chosen"); // WebGL has one opacity a trace
  if (over) fill(figure, over, figure.data.filter((trace) => trace.customdata && trace !== over), isChosen);
  const ring = figure.data.find(isRing);
  figure.axes.forEach((objective, i) => {
    ring["xyz"[i]] = selection.lead === null ? [] : [columns[firstObjective + objective][rowOf.get(selection.lead)]];
  });
}

function fill(figure, over, traces, isChosen) {
  const places = traces.flatMap((trace) => [...trace.customdata.keys()].filter((i) => isChosen(trace.customdata[i])).map((i) => [trace, i]));
  for (const trace of traces) trace.text ??= labelsOf(figure, trace);
  for (const key of ["x", "y", "z", "customdata", "text"]) over[key] = places.map(([trace, i]) => trace[key][i]);
  for (const key of ["color", "symbol"]) over.marker[key] = places.map(([trace]) => trace.marker[key]);
}

function followInFigures() {
  const fronts = report.figures.filter((figure) => figure.axes);
  follow(() => fronts.filter(isDotted).forEach(followInDots));
  for (const figure of fronts.filter((other) => !isDotted(other))) followThen(() => followInFigure(figure));
}

async function followInFigure(figure) {
  if (figure.webgl) {
    if (!figure.begun) return; // it begins with the selection in it
    await idle();
    if (figure.told === told) return; // whoever was overtaken has drawn the same
  }
  figure.told = told;
  markFigure(figure);
  await redraw(figure);
}
