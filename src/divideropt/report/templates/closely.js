// The design shown closely: its values, its response among those of the others selected, and the table of these.

const MOST_COMPARED = 12; // rows

function tellDetails(row) {
  const list = byId("details");
  list.replaceChildren();
  if (row === undefined) return;
  const add = (label, text, goal, isMet) => {
    const group = make("div");
    const value = make("dd", text);
    if (goal) value.append(make("span", isMet ? "✓" : "✗", { class: isMet ? "met" : "missed" }), make("span", " goal " + goal, { class: "goal" }));
    group.append(make("dt", label), value);
    list.append(group);
  };
  if (report.designs.attainment) add("max λ", number(attainment(row)));
  const order = [...fields.keys()];
  for (const i of [...order.slice(firstObjective), ...order.slice(0, firstObjective)]) {
    add(fields[i].label, number(columns[i][row]), fields[i].goal_words, met(row, i));
  }
}

// --- responses ---

function tellResponse() {
  const figure = report.figures.find((other) => other.id === "response");
  const { lead } = selection;
  const others = [...selection.ids].filter((id) => id !== lead);
  const whose = lead + (others.length ? " and " + counted(others.length, "other") : "");
  byId("selected-title").textContent = lead === null ? "No design selected" : "Selected design: " + whose;
  if (!figure) return undefined;
  byId("response-title").textContent = lead === null ? "Step response" : "Step response of " + whose;
  const response = lead === null ? undefined : report.responses[lead];
  byId("unstored").hidden = lead === null || Boolean(response);
  const traces = figure.data.slice(-4);
  traces.slice(2).forEach((trace, i) => {
    trace.x = response ? response.t : [];
    trace.y = response ? response.q[i] : [];
    trace.name = plain(response ? lead : lead === null ? "no design selected" : "no response of " + lead);
  });
  tellOthers(traces.slice(0, 2), others);
  if (response) {
    const range = [Math.max(response.t[0], -0.08 * response.window), response.window];
    for (const key of ["xaxis", "xaxis2"]) figure.layout[key] = { ...figure.layout[key], range: [...range] };
  }
  return redraw(figure);
}

function tellOthers(traces, others) {
  const there = others.map((id) => report.responses[id]).filter(Boolean);
  traces.forEach((trace, i) => {
    trace.visible = there.length > 0;
    trace.x = there.flatMap((response) => [...response.t, null]); // a gap between one and the next
    trace.y = there.flatMap((response) => [...response.q[i], null]);
    trace.name = counted(there.length, "other") + " selected";
  });
  const without = others.length - there.length;
  byId("unsimulated").hidden = others.length === 0 || without === 0;
  byId("unsimulated").textContent = "Of the " + counted(others.length, "other selected design") + " the page holds " + counted(there.length, "response") + ".";
}

function tellChoice() {
  const choice = byId("choice");
  const other = choice.querySelector("option.other");
  if (other) other.remove();
  const { lead } = selection;
  if (lead !== null && ![...choice.options].some((option) => option.value === lead)) {
    const option = new Option(lead + " (no response in the page)", lead);
    option.className = "other";
    choice.append(option);
  }
  choice.value = lead ?? "";
}

// --- the comparison ---

function tellComparison() {
  const frame = byId("comparison");
  frame.hidden = selection.ids.size < 2;
  if (frame.hidden) return;
  const table = byId("compared");
  const body = table.tBodies[0];
  const order = [...fields.keys()];
  const shownFields = [...order.slice(firstObjective), ...order.slice(0, firstObjective)];
  const rows = [...selection.ids].map((id) => rowOf.get(id));
  const cell = (text) => make("td", text, { class: "number" });
  const focused = body.contains(document.activeElement);
  body.replaceChildren(...rows.slice(0, MOST_COMPARED).map((row) => {
    const line = make("tr", undefined, { "data-id": ids[row] });
    line.append(make("td", ids[row]));
    if (report.designs.attainment) line.append(cell(number(attainment(row))));
    for (const i of shownFields) {
      const value = cell(number(columns[i][row]));
      if (fields[i].goal !== null) value.append(make("span", met(row, i) ? "✓" : "✗", { class: met(row, i) ? "met" : "missed", role: "img", "aria-label": met(row, i) ? "goal met" : "goal missed" }));
      line.append(value);
    }
    return line;
  }));
  if (focused) focusRow([...body.rows].find((line) => line.dataset.id === selection.lead));
  const extent = (values) => {
    const finite = values.filter(Number.isFinite);
    return finite.length ? number(Math.min(...finite)) + " … " + number(Math.max(...finite)) : "–";
  };
  const foot = make("tr");
  foot.append(make("th", "all " + rows.length, { scope: "row" }));
  if (report.designs.attainment) foot.append(cell(extent(rows.map(attainment))));
  for (const i of shownFields) foot.append(cell(extent(rows.map((row) => columns[i][row]))));
  table.tFoot.replaceChildren(foot);
  byId("more-compared").hidden = rows.length <= MOST_COMPARED;
  byId("more-compared").textContent = "The first " + MOST_COMPARED + " of " + rows.length + ", in the order of the table below; the last line has the extent of all.";
}

function followClosely() {
  byId("choice").addEventListener("change", (event) => pick(event.target.value, "choice"));
  followThen(() => {
    tellChoice();
    tellDetails(selection.lead === null ? undefined : rowOf.get(selection.lead));
    tellComparison();
  });
  followThen(tellResponse);
}
