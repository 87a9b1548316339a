// What the server tells, by column, as a table that can be filtered; and the fields to filter by.
function readTable(told) {
  const { moments, episodes } = told, word = (column, at) => column.words[column.codes[at]] ?? "";
  const count = moments.place.length;
  const columns = {
    kind: (at) => told.kinds[moments.kind[at]],
    outcome: (at) => word(episodes.outcome, moments.place[at]),
    reason: (at) => word(moments.reason, at),
    actor: (at) => word(moments.actor, at),
    method: (at) => word(episodes.method, moments.place[at]),
    store: (at) => told.stores[episodes.store[moments.place[at]]],
  };
  const key = (at) => `${moments.place[at]}/${moments.step[at]}/${moments.kind[at]}`;
  const row = (at) => {
    const place = moments.place[at], step = moments.step[at];
    return {
      place, step, key: key(at), code: moments.kind[at],
      margin: moments.margin[at], text: moments.text[at] ?? "",
      name: episodes.name[place], round: episodes.round[place], steps: episodes.steps[place],
      rateHz: episodes.rate_hz[place],
      ...Object.fromEntries(Object.entries(columns).map(([name, of]) => [name, of(at)])),
    };
  };
  // What a text is looked for in; made once, when it is first wanted.
  const texts = new Array(count), all = Object.values(columns);
  const textOf = (at) => texts[at] ??=
    `${episodes.name[moments.place[at]]} ${moments.text[at] ?? ""} ${all.map((of) => of(at)).join(" ")}`.toLowerCase();
  return { count, columns, key, row, textOf };
}

// The rows that fit all that is wanted: of each column one value, of the text every word.
function matching(table, wanted) {
  const exact = Object.entries(wanted.values).filter(([, value]) => value);
  const words = wanted.text.toLowerCase().split(/\s+/).filter(Boolean), found = [];
  for (let at = 0; at < table.count; at++)
    if (exact.every(([name, value]) => table.columns[name](at) === value) &&
        words.every((each) => table.textOf(at).includes(each))) found.push(at);
  return found;
}

function makeFilters(onChange) {
  const form = document.createElement("form"), selects = {};
  form.onsubmit = (event) => event.preventDefault();
  const labelled = (name, field) => {
    const label = document.createElement("label"), words = document.createElement("span");
    words.textContent = name;
    label.append(words, field);
    form.append(label);
    return label;
  };
  const text = document.createElement("input");
  text.type = "search";
  text.placeholder = "method, note, seed …";
  text.oninput = onChange;
  labelled("text ( / )", text).className = "wide";
  for (const name of ["kind", "outcome", "reason", "actor", "method", "store"]) {
    selects[name] = document.createElement("select");
    selects[name].onchange = onChange;
    labelled(name, selects[name]);
  }
  return {
    form, text,
    get wanted() {
      const values = Object.fromEntries(Object.entries(selects).map(([name, each]) => [name, each.value]));
      return { values, text: text.value };
    },
    // Offers what occurs, with how often; what was chosen stays chosen.
    offer(table) {
      for (const [name, select] of Object.entries(selects)) {
        const counts = new Map(), chosen = select.value;
        for (let at = 0; at < table.count; at++) {
          const value = table.columns[name](at);
          if (value) counts.set(value, (counts.get(value) ?? 0) + 1);
        }
        if (chosen && !counts.has(chosen)) counts.set(chosen, 0);
        select.replaceChildren(new Option("all", ""), ...[...counts].map(
          ([value, count]) => new Option(`${value} (${count})`, value, false, value === chosen)));
        select.closest("label").hidden = counts.size < 2 && !chosen;
      }
    },
  };
}
