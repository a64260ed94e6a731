// The table of the runs, sorted by the column whose heading is chosen; blanks come last.
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];

  function value(row, k) {
    const cell = row.cells[k];
    const text = cell.dataset.v === undefined ? cell.textContent : cell.dataset.v;
    return text === "" || Number.isNaN(Number(text)) ? text : Number(text);
  }

  function before(a, b) {
    if (typeof a === typeof b) return a < b ? -1 : a > b ? 1 : 0;
    return typeof a === "number" ? -1 : 1;
  }

  heads.forEach((head, k) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      const rows = [...body.rows].map((row) => [value(row, k), row]);
      rows.sort(([a], [b]) => {
        if (a === "" || b === "") return (a === "") - (b === "");
        return up ? before(a, b) : before(b, a);
      });
      body.append(...rows.map(([, row]) => row));
    });
  });
}

// The curves of the runs, coloured by the factor that is chosen.
for (const box of document.querySelectorAll(".coloured")) {
  const select = box.querySelector("select");
  if (!select) continue;
  const changes = JSON.parse(box.querySelector(".changes").textContent);
  const plot = box.querySelector(".chart > div");
  select.addEventListener("change", () => Plotly.restyle(plot, changes[select.selectedIndex]));
}
