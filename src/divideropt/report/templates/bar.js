// The bar that says how many designs are selected, lets go of them, and saves them.

let missingWords = ""; // of the address

function announceMissing(missing, all) {
  missingWords = missing + " of the " + counted(all, "design") + " that the address names " + (missing === 1 ? "is" : "are") + " not in this page. ";
  byId("announced").textContent = missingWords;
  byId("bar").classList.remove("idle");
}

function tellBar() {
  const { active, lead } = selection;
  const count = selection.ids.size;
  const bar = byId("bar");
  const told = byId("announced");
  const begun = told.textContent !== "";
  bar.classList.toggle("idle", !active && !missingWords);
  bar.querySelector(".actions").hidden = !active;
  for (const button of bar.querySelectorAll("[data-save]")) button.disabled = count === 0;
  const words = (count || "No") + (count === 1 ? " design" : " designs") + " of " + drawnDesigns + " selected";
  if (active) told.textContent = missingWords + words + (count > 1 ? "; " + lead + " is shown closely" : count ? ": " + lead : "");
  else if (begun) told.textContent = missingWords || "Nothing selected";
  missingWords = "";
}

// --- files ---

const csvCell = (text) => (/[",\r\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text);
const inert = (name) => (/^[=+\-@\t\r]/.test(name) ? "'" + name : name); // spreadsheets take such a heading for a formula
const valueOf = (row, i) => report.designs.values[i][row];

/** A row a design, in the platform's units: variables, and if asked for what is minimised, `|name|` for a magnitude. */
function csvOf(rows, withObjectives) {
  const shownFields = [...fields.keys()].slice(0, withObjectives ? fields.length : firstObjective);
  const heading = shownFields.map((i) => inert(fields[i].magnitude ? "|" + fields[i].name + "|" : fields[i].name));
  const lines = rows.map((row) => [ids[row], ...shownFields.map((i) => String(valueOf(row, i) ?? ""))]);
  return [["design_id", ...heading], ...lines].map((line) => line.map(csvCell).join(",") + "\n").join("");
}

const quoted = (text) => JSON.stringify(text).replace(/[\u007f-\uffff]/g, (c) => "\\u" + c.charCodeAt(0).toString(16).padStart(4, "0"));
const yamlKey = (name) => (/^[A-Za-z]\w+_\w+$/.test(name) ? name : quoted(name)); // one with _ is no word of YAML's own

/** A document a design: what a campaign's `model` may have as `set`, read back to the same bits. */
function yamlOf(rows) {
  const variables = [...fields.keys()].slice(0, firstObjective);
  const measure = (row, i) => (valueOf(row, i) + " " + fields[i].unit).trim();
  const plainNames = variables.every((i) => /^\w+$/.test(fields[i].name));
  return rows.map((row) => {
    const lines = ["# design " + quoted(ids[row]) + " of campaign " + quoted(report.name)];
    if (report.simulates && plainNames) {
      lines.push("# divideropt simulate campaign.yaml " + variables.map((i) => "--set " + fields[i].name + "='" + measure(row, i) + "'").join(" "));
    }
    const block = variables.map((i) => "  " + yamlKey(fields[i].name) + ": " + (fields[i].unit ? quoted(measure(row, i)) : measure(row, i)));
    return [...lines, "set:", ...block, ""].join("\n");
  }).join("---\n");
}

function save(text, ending, kind) {
  const name = report.name.replace(/[^A-Za-z0-9_-]+/g, "-").slice(0, 64) || "campaign";
  offer(text, name + "-selection" + ending, kind);
}

function followInBar() {
  const rows = () => [...selection.ids].map((id) => rowOf.get(id));
  const files = {
    csv: () => save(csvOf(rows(), true), ".csv", "text/csv"),
    designs: () => save(csvOf(rows(), false), "-designs.csv", "text/csv"),
    yaml: () => save(yamlOf(rows()), ".yaml", "application/yaml"),
  };
  for (const button of byId("bar").querySelectorAll("[data-save]")) button.addEventListener("click", files[button.dataset.save]);
  byId("let-go").addEventListener("click", clearSelection);
  follow(tellBar);
}
