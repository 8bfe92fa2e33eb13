"use strict";
(function () {
  const report = JSON.parse(document.getElementById("report-data").textContent);
  const shown = new Map(); // element's id → figure that is drawn there
  const NARROW = 600; // [px]
  const byId = (id) => document.getElementById(id);

  // --- colours: those of text and grids are the page's, and change with its theme ---

  function theme() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue("--" + name).trim();
    return { ink: colour("ink"), quiet: colour("quiet"), grid: colour("grid"), line: colour("line"), paper: colour("paper"), series: report.colours.map((_, i) => colour("series-" + i)) };
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
      if (/^[xy]axis/.test(key)) layout[key] = { showgrid: true, zeroline: false, showline: true, ticks: "outside", ticklen: 4, ...axis, ...layout[key] };
    }
    if (layout.scene) {
      if (byId(figure.id).clientWidth < NARROW) {
        for (const key of ["x", "y", "z"]) layout.scene.camera.eye[key] *= 1.5; // step back: the labels fit
      }
      for (const key of ["xaxis", "yaxis", "zaxis"]) {
        layout.scene[key] = { ...layout.scene[key], ...axis, gridcolor: t.line, showbackground: false, zeroline: false };
      }
    }
    for (const shape of layout.shapes || []) shape.line.color = t.quiet;
    const data = figure.data.map((plain) => {
      const trace = { ...plain };
      for (const key of ["line", "marker"]) if (plain[key]) trace[key] = exchanged(plain[key], t);
      if (trace.name === "selected" && trace.mode === "markers") {
        return { ...trace, marker: { ...trace.marker, color: t.ink, line: { ...trace.marker.line, color: t.ink } } };
      }
      if (trace.type === "parcoords") {
        return {
          ...trace,
          labelfont: { ...trace.labelfont, color: t.ink },
          tickfont: { ...trace.tickfont, color: t.ink },
                  };
      }
      return trace;
    });
    return { data, layout };
  }

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
    const sentence = element.closest("figure").querySelector(".missing");
    if (sentence) sentence.hidden = false;
  }

  async function draw(figure, able) {
    const element = byId(figure.id);
    if (!element) return;
    if (figure.webgl && !able) return leaveOut(element);
    const { data, layout } = coloured(figure);
    await Plotly.newPlot(element, data, layout, report.config);
    if (element.querySelector(".no-webgl, a[href]")) return leaveOut(element); // plotly's own words, with a link
    shown.set(figure.id, figure);
    element.on("plotly_click", (event) => {
      const id = event.points[0].customdata;
      if (typeof id === "string") select(id);
    });
  }

  function redraw(figure) {
    const element = byId(figure.id);
    if (!shown.has(figure.id)) return undefined;
    const { data, layout } = coloured(figure);
    return Plotly.react(element, data, layout, report.config);
  }

  // --- the selected design ---

  function raised(value) {
    const [mantissa, exponent] = value.toExponential(3).split("e");
    return mantissa + "·10" + exponent.replace("+", "").replace("-", "⁻").replace(/[0-9]/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);
  }

  const number = (value) => {
    const size = Math.abs(value);
    const text = size === 0 ? "0" : size < 1e-4 || size >= 1e6 ? raised(value) : value.toPrecision(4);
    return text.replace("-", "−");
  };

  function tellDetails(design) {
    const list = byId("details");
    list.replaceChildren();
    const add = (label, text, more, met) => {
      const group = document.createElement("div");
      const term = document.createElement("dt");
      const value = document.createElement("dd");
      term.textContent = label;
      value.textContent = text;
      if (more) {
        const goal = document.createElement("span");
        goal.className = "goal";
        goal.textContent = " goal " + more;
        const mark = document.createElement("span");
        mark.className = met ? "met" : "missed";
        mark.textContent = met ? "✓" : "✗";
        value.append(mark, goal);
      }
      group.append(term, value);
      list.append(group);
    };
    if (design.attainment !== null) add("max λ", number(design.attainment));
    const first = report.fields.length - report.objectives;
    const order = [...report.fields.keys()];
    for (const i of [...order.slice(first), ...order.slice(0, first)]) {
      const field = report.fields[i];
      add(field.label, number(design.v[i]), field.goal, design.met[i - first]);
    }
  }

  function ring(design) {
    const first = report.fields.length - report.objectives;
    const drawings = [];
    for (const figure of report.figures) {
      if (!figure.axes) continue;
      const trace = figure.data[figure.data.length - 1];
      figure.axes.forEach((objective, i) => { trace["xyz"[i]] = [design.v[first + objective]]; });
      drawings.push(redraw(figure));
    }
    return drawings;
  }

  const plain = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;"); // plotly reads tags

  function tellResponse(id) {
    const figure = shown.get("response");
    const response = report.responses[id];
    byId("selected-title").textContent = (figure ? "Step response of " : "Selected design: ") + id;
    if (!figure) return undefined;
    byId("unstored").hidden = Boolean(response);
    figure.data.slice(-2).forEach((trace, i) => {
      trace.x = response ? response.t : [];
      trace.y = response ? response.q[i] : [];
      trace.name = plain(response ? id : "no response of " + id);
    });
    if (response) {
      const range = [Math.max(response.t[0], -0.08 * response.window), response.window];
      for (const key of ["xaxis", "xaxis2"]) figure.layout[key] = { ...figure.layout[key], range: [...range] };
    }
    return redraw(figure);
  }

  function tellChoice(id) {
    const choice = byId("choice");
    const other = choice.querySelector("option.other");
    if (other) other.remove();
    if (![...choice.options].some((option) => option.value === id)) {
      const option = new Option(id + " (no response in the page)", id);
      option.className = "other";
      choice.append(option);
    }
    choice.value = id;
  }

  function tellRows(id) {
    for (const row of document.querySelectorAll("tr[data-id]")) {
      if (row.dataset.id === id) row.setAttribute("aria-current", "true");
      else row.removeAttribute("aria-current");
    }
    const row = document.querySelector('#front-table tr[aria-current="true"]');
    if (!row) return;
    const frame = row.closest(".tall");
    const head = frame.querySelector("thead").offsetHeight;
    const top = row.offsetTop - head;
    if (top < frame.scrollTop || row.offsetTop + row.offsetHeight > frame.scrollTop + frame.clientHeight) frame.scrollTop = top;
  }

  function select(id) {
    const design = report.designs[id];
    if (!design) return undefined;
    tellChoice(id);
    tellRows(id);
    tellDetails(design);
    return Promise.all([...ring(design), tellResponse(id)]);
  }

  // --- the table ---

  function sort(table, heading) {
    const column = [...heading.parentElement.children].indexOf(heading);
    const rising = heading.getAttribute("aria-sort") !== "ascending";
    for (const other of heading.parentElement.children) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", rising ? "ascending" : "descending");
    const numeric = heading.classList.contains("number");
    const key = (row) => row.children[column].dataset.order;
    const compare = numeric
      ? (a, b) => Number(key(a)) - Number(key(b))
      : (a, b) => key(a).localeCompare(key(b), "en", { numeric: true });
    const body = table.tBodies[0];
    body.append(...[...body.rows].sort((a, b) => (rising ? compare(a, b) : compare(b, a))));
  }

  function focusRow(row) {
    if (!row) return;
    for (const other of row.parentElement.rows) other.tabIndex = -1;
    row.tabIndex = 0;
    row.focus();
  }

  function onKey(event) {
    const row = event.target.closest("tr[data-id]");
    if (!row) return;
    const go = { ArrowDown: row.nextElementSibling, ArrowUp: row.previousElementSibling, Home: row.parentElement.firstElementChild, End: row.parentElement.lastElementChild };
    if (event.key in go) focusRow(go[event.key]);
    else if (event.key === "Enter" || event.key === " ") select(row.dataset.id);
    else return;
    event.preventDefault();
  }

  function listen() {
    const table = byId("front-table");
    for (const button of table.querySelectorAll("th button")) {
      button.addEventListener("click", () => sort(table, button.closest("th")));
    }
    table.addEventListener("keydown", onKey);
    for (const rows of document.querySelectorAll("#front-table tbody, #best tbody, #choosing-table tbody, #cost-bests tbody")) {
      rows.addEventListener("click", (event) => {
        const row = event.target.closest("tr[data-id]");
        if (row) select(row.dataset.id);
      });
    }
    byId("choice").addEventListener("change", (event) => select(event.target.value));
  }

  // --- one quantity over every parameter of a study ---

  function showQuantity(name) {
    const figure = shown.get("panels");
    const chosen = report.quantities[name];
    figure.data.forEach((trace, i) => { trace.y = chosen.y[i]; });
    for (const [key, axis] of Object.entries(figure.layout)) {
      if (!/^yaxis/.test(key)) continue;
      axis.range = [...chosen.range];
      if (axis.title) axis.title.text = chosen.label;
    }
    figure.layout.uirevision = name; // what was zoomed is another's
    return redraw(figure);
  }

  async function begin() {
    const pictures = report.figures.filter((figure) => figure.webgl);
    for (const figure of report.figures) if (!figure.webgl) await draw(figure, true);
    if (report.selected) {
      listen();
      await select(report.selected);
    }
    if (report.quantities) byId("quantity").addEventListener("change", (event) => showQuantity(event.target.value));
    const able = pictures.length > 0 && webgl();
    for (const figure of pictures) await draw(figure, able); // last: they take longest, the rest is there already
    for (const media of ["(prefers-color-scheme: dark)", "print"]) {
      window.matchMedia(media).addEventListener("change", () => shown.forEach(redraw));
    }
    for (const details of document.querySelectorAll("details")) {
      details.addEventListener("toggle", () => { // what was folded away when it was drawn had no width
        for (const element of details.querySelectorAll(".plot")) if (shown.has(element.id)) Plotly.Plots.resize(element);
      });
    }
    document.documentElement.dataset.drawn = "yes";
  }

  begin();
})();
