// The dimension sheet of the design shown closely: as it is, and rounded to a step as the report's writer simulated it.
// The step chosen, 0 for none, is the drawing's too.

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

const chosenStep = () => (report.sheets ? Number(byId("step").value) : 0);
const stepWords = () => report.sheets.steps[chosenStep() - 1];

/** A design as rounded to the step chosen; undefined where none is, or the page has no sheet of it. */
const roundedOf = (id) => (chosenStep() ? (sheetOf(id) || [])[chosenStep()] : undefined);

/** The columns shown: as it is and, where a step is chosen, rounded. */
const shownColumns = (columns) => (chosenStep() ? [columns[0], columns[chosenStep()]] : [columns[0]]);
const columnTitles = () => ["as it is", "rounded"].slice(0, chosenStep() ? 2 : 1);

function sheetSentence(columns) {
  const [exact, other] = shownColumns(columns);
  const words = (column) => column.outcome + (column.text ? " (" + column.text + ")" : "") + ", " + (column.feasible ? "feasible" : "not feasible") + goalsMet(sheetValues(column)) + (column.valid === false ? ", beyond what the model assumes" : "");
  const asItIs = "As it is: " + words(exact) + ".";
  if (!other) return asItIs;
  if (other.error) return "Rounded to " + stepWords() + " there is no such valve: " + other.error + ". " + asItIs;
  if (!other.outcome) return "Rounded to " + stepWords() + ": simulated not in this page, but by the command below. " + asItIs;
  return "Rounded to " + stepWords() + ": " + words(other) + ". " + asItIs;
}

/** A symbol, what follows an underscore lowered. */
function symbolCell(symbol) {
  const cell = make("td", undefined, { class: "symbol" });
  for (const part of symbol.match(/_[A-Za-z0-9]+|[^_]+|_/g) || []) cell.append(/^_./.test(part) ? make("sub", part.slice(1)) : part);
  return cell;
}

function sheetTable(lines, values) {
  const table = make("table");
  const head = table.createTHead().insertRow();
  const titles = columnTitles();
  for (const text of ["", "", ...titles, ""]) head.append(make(text ? "th" : "td", text, text ? { scope: "col", class: "number" } : {}));
  const body = table.createTBody();
  let section = "";
  for (const [line, i] of lines) {
    if (line.section !== section) {
      section = line.section;
      const row = body.insertRow();
      row.append(make("th", section, { colspan: 3 + titles.length, scope: "colgroup" }));
    }
    const row = body.insertRow();
    row.append(make("th", line.words, { scope: "row" }), symbolCell(line.symbol));
    for (const column of values) {
      const cell = make("td", sheetNumber(column[i]), { class: "number" });
      const isMet = goalMet(line, column[i]);
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
  byId("sheet-command").textContent = "divideropt sheet . " + (lead ?? "RUN/INDEX") + (chosenStep() ? " --step '" + stepWords() + "'" : "");
  if (!columns) {
    byId("sheet-said").textContent = lead === null ? "" : "The page holds no sheet of " + lead + "; the command below makes it.";
    return;
  }
  byId("sheet-said").textContent = sheetSentence(columns);
  const values = shownColumns(columns).map(sheetValues);
  byId("sheet-lines").replaceChildren(...sheetParts().map((lines) => sheetTable(lines, values)));
}

// --- files ---

function sheetCsv(columns) {
  const shownOnes = shownColumns(columns);
  const values = shownOnes.map(sheetValues);
  const inSi = (value, line) => (value === null ? "" : String(Number((value / line.scale).toPrecision(6))));
  const rows = report.sheets.lines.map((line, i) => [line.section.toLowerCase(), line.name, line.symbol, line.unit, ...values.map((column) => inSi(column[i], line))]);
  rows.push(["outcome", "outcome", "", "", ...shownOnes.map((column) => column.outcome || "")]);
  const heading = ["section", "name", "symbol", "unit", "exact", "rounded"].slice(0, 4 + values.length);
  return [heading, ...rows].map((row) => row.map(csvCell).join(",") + "\n").join("");
}

function sheetSvg(columns) {
  const { width, height } = report.sketch;
  const file = byId("sketch").cloneNode(true);
  const text = (x, y, words, style, anchor) => sketchText(x, y, words.replace(/[_^]/g, ""), style, anchor || "start");
  const values = shownColumns(columns).map(sheetValues);
  const places = [318, 398].slice(-values.length);
  file.append(text(24, height + 24, "Design " + selection.lead + " of " + report.name + ", drawn " + drawnWords(selection.lead), "title"));
  let lowest = 0;
  sheetParts().forEach((lines, part) => {
    const x = 24 + 496 * part;
    let y = height + 64;
    columnTitles().forEach((title, k) => file.append(text(x + places[k], y - 12, title, "note", "end")));
    let section = "";
    for (const [line, i] of lines) {
      if (line.section !== section) {
        section = line.section;
        file.append(text(x, y + 6, section, "title"), svgMake("path", { class: "measure", d: "M" + x + " " + (y + 12) + "h456" }));
        y += SHEET_LINE + 8;
      }
      const symbol = LETTER * line.words.length < 172 ? line.symbol : ""; // else one would lie on the other
      file.append(text(x, y, line.words), sketchText(x + 178, y, symbol, "note", "start"), ...values.map((column, k) => text(x + places[k], y, sheetNumber(column[i]), "", "end")), text(x + 404, y, line.shown, "note"));
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
  byId("step").addEventListener("change", () => {
    tellSketch();
    tellSheet();
  });
  byId("sheet-csv").addEventListener("click", () => save(sheetCsv(sheetOf(selection.lead)), name() + ".csv", "text/csv"));
  byId("sheet-svg").addEventListener("click", () => save(sheetSvg(sheetOf(selection.lead)), name() + ".svg", "image/svg+xml"));
  followThen(tellSheet);
}
