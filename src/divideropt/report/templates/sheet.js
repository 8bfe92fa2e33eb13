// The dimension sheet of the design shown closely: as it is, and rounded to a step as the report's writer simulated it.

const SHEET_LINE = 19; // [px] of a saved sheet
const sheetOf = (id) => (report.sheets && id !== null ? report.sheets.designs[id] : undefined);

/** A column's values in the units shown, a line each. */
function sheetValues(column) {
  const values = report.sheets.lines.map((line) => line.value);
  if (!column.values) return values.map(() => null);
  report.sheets.varying.forEach((i, k) => { values[i] = column.values[k]; });
  return values;
}

const sheetNumber = (value) => (value === null ? "–" : trimmed(Math.abs(value) >= 1e-4 && Math.abs(value) < 1e6 ? value.toPrecision(6) : number(value)).replace("-", "−"));
const goalMet = (line, value) => (line.goal === null || value === null ? null : value <= line.goal * line.scale * (1 + 1e-9));

function goalsMet(values) {
  const known = report.sheets.lines.map((line, i) => [line, goalMet(line, values[i])]).filter(([line]) => line.goal !== null);
  return known.length ? ", " + known.filter(([, isMet]) => isMet).length + " of " + known.length + " goals met" : "";
}

const chosenStep = () => Number(byId("step").value);

function sheetSentence(columns) {
  const [exact, other] = [columns[0], columns[chosenStep()]];
  const step = report.sheets.steps[chosenStep() - 1];
  const words = (column) => column.outcome + (column.text ? " (" + column.text + ")" : "") + ", " + (column.feasible ? "feasible" : "not feasible") + goalsMet(sheetValues(column)) + (column.valid === false ? ", beyond what the model assumes" : "");
  if (other.error) return "Rounded to " + step + " there is no such valve: " + other.error + ".";
  return "Rounded to " + step + ": " + words(other) + ". As it is: " + words(exact) + ".";
}

function sheetTable(lines, first, second) {
  const table = make("table");
  const head = table.createTHead().insertRow();
  for (const [text, style] of [["", ""], ["", ""], ["as it is", "number"], ["rounded", "number"], ["", ""]]) {
    head.append(make(text ? "th" : "td", text, text ? { scope: "col", class: style } : { class: style }));
  }
  const body = table.createTBody();
  let section = "";
  for (const [line, i] of lines) {
    if (line.section !== section) {
      section = line.section;
      const row = body.insertRow();
      row.append(make("th", section, { colspan: 5, scope: "colgroup" }));
    }
    const row = body.insertRow();
    row.append(make("th", line.words, { scope: "row" }), make("td", line.symbol, { class: "symbol" }));
    for (const values of [first, second]) {
      const cell = make("td", sheetNumber(values[i]), { class: "number" });
      const isMet = goalMet(line, values[i]);
      if (isMet !== null) cell.append(make("span", isMet ? "✓" : "✗", { class: isMet ? "met" : "missed", role: "img", "aria-label": isMet ? "goal met" : "goal missed" }));
      row.append(cell);
    }
    row.append(make("td", line.shown));
  }
  return table;
}

/** Dimensions, and what follows from them: the sheet has a table of each. */
function sheetParts() {
  const all = report.sheets.lines.map((line, i) => [line, i]);
  const does = ["Parameters", "Objectives", "Constraints"];
  return [all.filter(([line]) => !does.includes(line.section)), all.filter(([line]) => does.includes(line.section))];
}

function tellSheet() {
  const { lead } = selection;
  const columns = sheetOf(lead);
  byId("sheet-details").hidden = byId("sheet-files").hidden = !columns;
  byId("sheet-command").textContent = "divideropt sheet . " + (lead ?? "RUN/INDEX") + " --step '" + report.sheets.steps[chosenStep() - 1] + "'";
  if (!columns) {
    byId("sheet-said").textContent = lead === null ? "" : "The page holds no sheet of " + lead + "; the command below makes it.";
    return;
  }
  byId("sheet-said").textContent = sheetSentence(columns);
  const [first, second] = [sheetValues(columns[0]), sheetValues(columns[chosenStep()])];
  byId("sheet-lines").replaceChildren(...sheetParts().map((lines) => sheetTable(lines, first, second)));
}

// --- files ---

function sheetCsv(columns) {
  const [first, second] = [sheetValues(columns[0]), sheetValues(columns[chosenStep()])];
  const inSi = (value, line) => (value === null ? "" : String(Number((value / line.scale).toPrecision(6))));
  const rows = report.sheets.lines.map((line, i) => [line.section.toLowerCase(), line.name, line.symbol, line.unit, inSi(first[i], line), inSi(second[i], line)]);
  const said = (column) => column.outcome || "";
  rows.push(["outcome", "outcome", "", "", said(columns[0]), said(columns[chosenStep()])]);
  return [["section", "name", "symbol", "unit", "exact", "rounded"], ...rows].map((row) => row.map(csvCell).join(",") + "\n").join("");
}

function sheetSvg(columns) {
  const { width, height } = report.sketch;
  const file = byId("sketch").cloneNode(true);
  const text = (x, y, words, style, anchor) => sketchText(x, y, words.replace(/[_^]/g, ""), style, anchor || "start");
  const [first, second] = [sheetValues(columns[0]), sheetValues(columns[chosenStep()])];
  file.append(text(24, height + 24, selection.lead + " of " + report.name + ", as it is and rounded to " + report.sheets.steps[chosenStep() - 1], "title"));
  let lowest = 0;
  sheetParts().forEach((lines, part) => {
    const x = 24 + 496 * part;
    let y = height + 48;
    let section = "";
    for (const [line, i] of lines) {
      if (line.section !== section) {
        section = line.section;
        file.append(text(x, y + 6, section, "title"), svgMake("path", { class: "measure", d: "M" + x + " " + (y + 12) + "h456" }));
        y += SHEET_LINE + 8;
      }
      file.append(text(x, y, line.words), text(x + 178, y, line.symbol, "note"), text(x + 318, y, sheetNumber(first[i]), "", "end"), text(x + 398, y, sheetNumber(second[i]), "", "end"), text(x + 404, y, line.shown, "note"));
      y += SHEET_LINE;
    }
    lowest = Math.max(lowest, y);
  });
  file.append(text(24, lowest + 24, sheetSentence(columns), "note"));
  file.setAttribute("viewBox", "0 0 " + width + " " + (lowest + 44));
  file.setAttribute("width", width);
  file.setAttribute("height", lowest + 44);
  file.prepend(svgMake("style", {}, report.sketch.style), svgMake("rect", { width: "100%", height: "100%", fill: "#ffffff" }));
  return new XMLSerializer().serializeToString(file);
}

function followInSheet() {
  if (!report.sheets) return;
  const name = () => "-" + selection.lead.replace(/[^A-Za-z0-9-]+/g, "-") + "-sheet";
  byId("step").addEventListener("change", tellSheet);
  byId("sheet-csv").addEventListener("click", () => save(sheetCsv(sheetOf(selection.lead)), name() + ".csv", "text/csv"));
  byId("sheet-svg").addEventListener("click", () => save(sheetSvg(sheetOf(selection.lead)), name() + ".svg", "image/svg+xml"));
  followThen(tellSheet);
}
