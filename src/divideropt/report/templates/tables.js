// Tables of designs: a row selects, by pointer and by keys; a heading sorts.

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

function onRowKey(event, act) {
  const row = event.target.closest("tr[data-id]");
  if (!row) return;
  const rows = [...row.parentElement.querySelectorAll("tr[data-id]")];
  const at = rows.indexOf(row);
  const go = { ArrowDown: rows[at + 1], ArrowUp: rows[at - 1], Home: rows[0], End: rows[rows.length - 1] };
  if (event.key in go) focusRow(go[event.key]);
  else if (event.key === "Enter" || event.key === " ") act(row.dataset.id, event);
  else return;
  event.preventDefault();
}

function listenTo(table, act) {
  table.setAttribute("role", "grid");
  table.setAttribute("aria-multiselectable", "true");
  const first = table.querySelector("tbody tr[data-id]");
  if (first) first.tabIndex = 0;
  table.addEventListener("keydown", (event) => onRowKey(event, act));
  table.addEventListener("click", (event) => {
    const row = event.target.closest("tr[data-id]");
    if (row) act(row.dataset.id, event);
  });
  for (const button of table.querySelectorAll("th button")) {
    button.addEventListener("click", () => sort(table, button.closest("th")));
  }
}

function tellRows() {
  for (const row of document.querySelectorAll("tr[data-id]")) {
    const id = row.dataset.id;
    const isSelected = String(selection.ids.has(id));
    if (row.getAttribute("aria-selected") !== isSelected) row.setAttribute("aria-selected", isSelected); // only what changes is styled anew
    if (id === selection.lead) row.setAttribute("aria-current", "true");
    else if (row.hasAttribute("aria-current")) row.removeAttribute("aria-current");
  }
  const first = document.querySelector("#compared tbody tr");
  if (first && !document.querySelector("#compared tbody tr[tabindex='0']")) first.tabIndex = 0;
  if (frontTableSeen) showCurrentRow(); // else when it comes into view: its thousand rows have not been laid out yet
}

let frontTableSeen = false;

function showCurrentRow() {
  const row = document.querySelector('#front-table tr[aria-current="true"]');
  if (!row) return;
  const frame = row.closest(".tall");
  const head = frame.querySelector("thead").offsetHeight;
  const top = row.offsetTop - head;
  if (top < frame.scrollTop || row.offsetTop + row.offsetHeight > frame.scrollTop + frame.clientHeight) frame.scrollTop = top;
}

function followInTables() {
  for (const id of ["front-table", "best", "choosing-table", "cost-bests"]) {
    const table = byId(id);
    if (table) listenTo(table, (design, event) => pick(design, id, event));
  }
  listenTo(byId("compared"), showClosely);
  new IntersectionObserver((entries) => {
    frontTableSeen = entries[entries.length - 1].isIntersecting;
    if (frontTableSeen) showCurrentRow();
  }).observe(byId("front-table").closest(".tall"));
  followThen(tellRows);
}
