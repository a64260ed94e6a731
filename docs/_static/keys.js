// The page of the keys gets a field: only rows in which all its words are stay, and their sections.
addEventListener("DOMContentLoaded", () => {
  const page = document.querySelector("section#model-keys");
  if (!page) return;
  const field = document.createElement("input");
  field.type = "search";
  field.className = "key-search";
  field.placeholder = "part of a key, a unit, a word of its meaning";
  field.setAttribute("aria-label", "look for keys");
  const count = document.createElement("output");
  page.querySelector("h1").after(field, count);

  // A heading and what stands above a table count as words of each of its rows.
  const rows = [...page.querySelectorAll("tbody tr")].map((row) => {
    const section = row.closest("section");
    const table = row.closest(".table-wrapper") || row.closest("table");
    const above = table.previousElementSibling;
    const about = above && above.tagName === "P" ? above.textContent : "";
    const title = section.querySelector("h2").textContent;
    return { row, table, section, above, text: `${title} ${about} ${row.textContent}`.toLowerCase() };
  });

  function look() {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = rows.filter(({ text }) => words.every((word) => text.includes(word)));
    const shown = new Set(kept.flatMap(({ row, table, section }) => [row, table, section]));
    for (const { row, table, section, above } of rows) {
      for (const part of [row, table, section]) part.hidden = !shown.has(part);
      if (above && above.tagName === "P") above.hidden = !shown.has(table);
    }
    const keys = kept.filter(({ section }) => section.id !== "a-to-z").length;
    count.textContent = words.length ? ` ${keys} found` : "";
  }

  field.addEventListener("input", look);
  field.value = new URLSearchParams(location.search).get("key") || "";
  look();
});
