"use strict";
// Sorts the rows of the table of faces; values that are missing stand last in both directions.
const table = document.getElementById("faces");
const body = table.tBodies[0];
const heads = [...table.tHead.rows[0].cells];
const choice = document.getElementById("by");
const turn = document.getElementById("turn");
const told = document.getElementById("told");
const rows = [...body.rows];
let sorted = { column: 0, descending: false };

function compare(one, other, number) {
  if (one === "" || other === "") return (one === "") - (other === "") || 0;
  return number ? Number(one) - Number(other) : one.localeCompare(other, undefined, { numeric: true });
}

function sort(column, descending) {
  const number = heads[column].dataset.kind === "number";
  const keyed = rows.map((row, index) => [row.cells[column].dataset.value ?? "", index, row]);
  keyed.sort(([one, first], [other, second]) => {
    const missing = one === "" || other === "";
    const order = compare(one, other, number) * (descending && !missing ? -1 : 1);
    return order || first - second;
  });
  body.append(...keyed.map((each) => each[2]));
  sorted = { column, descending };
  heads.forEach((head, index) => {
    if (head.hasAttribute("aria-sort")) {
      head.setAttribute("aria-sort", index !== column ? "none" : descending ? "descending" : "ascending");
    }
  });
  choice.value = String(column);
  turn.textContent = descending ? "Descending" : "Ascending";
  told.textContent = `Sorted by ${heads[column].textContent.trim()}, ${descending ? "descending" : "ascending"}.`;
}

table.tHead.addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (!button) return;
  const column = button.parentElement.cellIndex;
  sort(column, sorted.column === column && !sorted.descending);
});
choice.addEventListener("change", () => sort(Number(choice.value), false));
turn.addEventListener("click", () => sort(sorted.column, !sorted.descending));
document.getElementById("sorting").hidden = false;
