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
  const groups = JSON.parse(box.querySelector(".groups").textContent);
  const figure = box.querySelector(".chart");
  const { chart } = figure;

  select.addEventListener("change", () => {
    const { names, styles, group } = groups[select.selectedIndex];
    chart.data.curves.forEach((curve, k) => {
      curve.name = names[group[k]];
      curve.style = styles[group[k]];
    });
    chart.hidden.clear();
    const legend = figure.querySelector(".legend");
    legend.replaceChildren();
    [...new Set(group)].sort((a, b) => a - b).forEach((k) => {
      const item = document.createElement("li");
      item.innerHTML =
        `<svg class="key" viewBox="0 0 20 10" aria-hidden="true"><path class="line ${styles[k]}" ` +
        'd="M0,5H20"/></svg><span></span>';
      item.querySelector("span").textContent = names[k];
      legend.append(item);
    });
    chart.addSwitches(figure);
    chart.draw();
  });
}
