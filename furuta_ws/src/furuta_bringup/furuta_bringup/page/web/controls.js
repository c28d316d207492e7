// What can be set: lists, sliders and fields, in sight or among all parameters.
export const make = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

// A control for a knob, of a kind that its description tells: `values` with `words` (a list), or with the number that
// is multiplied, `base` (a slider); else a `slider` from, to, by (in sight), or a field. `choose` is called with what is
// chosen.
class Control {
  constructor(knob, choose) {
    const { name, title, symbol, meaning, unit, base, fixed, in_sight: inSight } = knob;
    this.knob = knob;
    this.output = make("output");
    this.input = this.makeInput((value) => choose({ [name]: value }));
    Object.assign(this.input, { id: `${knob.twin ? "field" : "knob"}-${name}`, disabled: Boolean(fixed) });
    const isRange = this.input.type === "range", shownUnit = unit && base === undefined ? [` [${unit}]`] : [];
    const label = make("label", { htmlFor: this.input.id }, title, " ", symbol, ...(isRange ? [this.output] : shownUnit));
    this.refusal = make("small", { className: "refusal", role: "alert" });
    this.element = make("div", { className: "knob" }, label, this.input, this.refusal);
    if (!inSight) this.element.append(make("small", { textContent: meaning }));
    this.words = `${name} ${title} ${meaning}`.toLowerCase();
  }

  makeInput(chosen) {
    const { values, words, base, slider, in_sight: inSight } = this.knob;
    const range = (ends, oninput) => make("input", { type: "range", ...ends, oninput });
    if (base !== undefined) return range({ min: 0, max: values.length - 1 }, () => chosen(values[this.input.value]));
    if (values) {
      const onchange = () => chosen(values[this.input.selectedIndex]);
      return make("select", { onchange }, ...words.map((word, i) => new Option(word, values[i])));
    }
    if (inSight && slider) {
      const [min, max, step] = slider;
      return range({ min, max, step }, () => chosen(Number(this.input.value)));
    }
    return make("input", { type: "text", spellcheck: false, onchange: () => chosen(this.input.value) });
  }

  // A field in which the user types is left alone.
  show(value, isTyped = document.activeElement === this.input) {
    const { values, base, unit } = this.knob, { input } = this;
    const has = values ? values.indexOf(value) : value;
    if (input.tagName === "SELECT") input.selectedIndex = has;
    else if (input.type === "text") {
      if (!isTyped) input.value = Array.isArray(value) ? `[${value.join(", ")}]` : value;
    } else {
      if (!values) [input.min, input.max] = [Math.min(input.min, has), Math.max(input.max, has)];
      input.value = has;
      input.style.setProperty("--part", `${(100 * (input.value - input.min)) / (input.max - input.min)}%`);
      const number = base === undefined ? value : base * Number(value);
      input.ariaValueText = this.output.textContent = `${Number(number.toFixed(4))} ${unit}`.trim();
    }
    this.refusal.textContent = "";
  }
}

// The controls of a source, with those that are not in sight by their group.
export class Controls {
  constructor(source, choose) {
    Object.assign(this, { source, choose, all: [], search: document.getElementById("search") });
    this.search.oninput = () => this.find();
  }

  // Makes them anew; what was open stays so.
  build() {
    const place = document.getElementById("knobs"), groups = new Map();
    const open = [...place.querySelectorAll("details[open]")].map((each) => each.dataset.group);
    const focused = document.activeElement?.id;
    // A parameter in sight is also among all of its node, with the number.
    const twin = (knob) => ({ ...knob, title: knob.name.replace(/^[^.]*\./, ""), symbol: "", in_sight: 0, twin: true });
    const twins = this.source.knobs.filter((knob) => knob.in_sight && knob.group).map(twin);
    this.all = [...this.source.knobs, ...twins].map((knob) => new Control(knob, this.choose));
    this.named = Object.fromEntries(this.all.filter(({ knob }) => !knob.twin).map((each) => [each.knob.name, each]));
    document.getElementById("sliders").replaceChildren(...this.all.filter(({ knob }) => knob.in_sight).map((each) => each.element));
    for (const control of this.all) {
      const { group = "", in_sight: inSight } = control.knob;
      if (!inSight) groups.set(group, [...(groups.get(group) ?? []), control]);
    }
    place.replaceChildren(...[...groups].flatMap(([group, members]) => {
      const elements = members.map((each) => each.element);
      if (!group) return elements;
      const details = make("details", { open: open.includes(group) }, make("summary", { textContent: group }), ...elements);
      details.dataset.group = group;
      return [details];
    }));
    this.search.hidden = this.all.length < 20;
    this.show();
    if (focused) document.getElementById(focused)?.focus();
  }

  show() {
    const { values } = this.source;
    for (const control of this.all) {
      const { name, idle, fixed, twin } = control.knob;
      control.show(values[name]);
      // It can be set, but it does nothing now.
      if (idle && !twin) control.input.disabled = fixed || Object.entries(idle).every(([other, value]) => values[other] === value);
    }
  }

  refuse(name, reason) {
    for (const control of this.all.filter(({ knob }) => knob.name === name)) {
      control.show(this.source.values[name], false);
      control.refusal.textContent = reason;
    }
  }

  // Shows what has all words of the search.
  find() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const { element, words: own } of this.all) {
      element.hidden = !element.closest("#sliders") && !words.every((word) => own.includes(word));
    }
    for (const details of document.querySelectorAll("#knobs details")) {
      const found = details.querySelector(".knob:not([hidden])");
      details.hidden = !found;
      if (words.length) details.open = Boolean(found);
    }
  }
}
