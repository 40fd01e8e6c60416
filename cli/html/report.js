"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);

  // ---- small helpers

  function element(name, properties = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (key in made) made[key] = value;
      else made.setAttribute(key, value);
    }
    made.append(...children);
    return made;
  }

  function decimal(value, digits = 4) {
    if (value === null) return "\u2013";
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-3 || size >= 1e6)) {
      const [mantissa, exponent] = value.toExponential(Math.min(digits - 1, 2)).split("e");
      return `${mantissa}\u00b710${superscript(Number(exponent))}`.replace("-", "\u2212");
    }
    return (Number.isInteger(value) ? String(value) : value.toPrecision(digits)).replace("-", "\u2212");
  }

  function superscript(integer) {
    return String(integer).replace(/./g, (c) => (c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c]));
  }

  const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
  const decodeBase64 = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

  // ---- pictures

  const halfValues = Float32Array.from({ length: 65536 }, (_, bits) => {
    const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, mantissa = bits & 1023;
    if (exponent === 31) return mantissa ? NaN : sign * Infinity;
    return sign * (exponent ? 2 ** (exponent - 15) * (1 + mantissa / 1024) : 2 ** -24 * mantissa);
  });

  // Shows a picture's half floats: the tone map of docs/comparing.md, as bytes.
  function toneTable(stops) {
    const scale = 2 ** stops;
    return Uint8Array.from(halfValues, (value) => {
      const light = Math.max(value * scale || 0, 0);
      const mapped = light <= 0.6 ? light : 0.6 + 0.4 * (1 - Math.exp((0.6 - light) / 0.4));
      return Math.floor(255 * (mapped <= 0.0031308 ? 12.92 * mapped : 1.055 * mapped ** (1 / 2.4) - 0.055) + 0.5);
    });
  }

  async function decodePng(text, width, height) {
    const blob = new Blob([decodeBase64(text)], { type: "image/png" });
    const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    context.drawImage(bitmap, 0, 0);
    bitmap.close();
    return context.getImageData(0, 0, width, height).data;
  }

  class Source {
    constructor(frame, content) {
      Object.assign(this, { name: content.of ? `${content.name}, ${content.of}` : content.name, content, width: frame.width, height: frame.height });
      this.canvas = new OffscreenCanvas(frame.width, frame.height);
    }
    // Fill the canvas with the colours that color(i, rgb) gives for pixel i.
    fill(color) {
      const context = this.canvas.getContext("2d"), image = context.createImageData(this.width, this.height);
      for (let i = 0, p = 0; p < image.data.length; ++i, p += 4) {
        color(i, image.data, p);
        image.data[p + 3] = 255;
      }
      context.putImageData(image, 0, 0);
    }
  }

  class Picture extends Source {
    async load() {
      const count = this.width * this.height, bytes = await decodePng(this.content.png, this.width, 2 * this.height);
      this.halves = new Uint16Array(3 * count);
      for (let i = 0; i < count; ++i) {
        for (let k = 0; k < 3; ++k) this.halves[3 * i + k] = (bytes[4 * i + k] << 8) | bytes[4 * (count + i) + k];
      }
    }
    paint(stops, table) {
      if (!this.halves || this.stops === stops) return;
      this.stops = stops;
      const halves = this.halves;
      this.fill((i, rgb, p) => {
        rgb[p] = table[halves[3 * i]];
        rgb[p + 1] = table[halves[3 * i + 1]];
        rgb[p + 2] = table[halves[3 * i + 2]];
      });
    }
    value(i) {
      const channels = [0, 1, 2].map((k) => halfValues[this.halves[3 * i + k]] / this.content.exposure);
      return channels.map((c) => decimal(c, 3)).join("  ");
    }
  }

  const palette = decodeBase64(data.palette);

  class ErrorMap extends Source {
    async load() {
      const bytes = await decodePng(this.content.png, this.width, this.height);
      this.levels = Uint8Array.from({ length: this.width * this.height }, (_, i) => bytes[4 * i]);
      this.fill((i, rgb, p) => {
        const color = 3 * this.levels[i];
        rgb[p] = palette[color];
        rgb[p + 1] = palette[color + 1];
        rgb[p + 2] = palette[color + 2];
      });
    }
    paint() {}
    value(i) {
      const { low, high, logarithmic } = this.content, share = this.levels[i] / 255;
      const value = logarithmic ? low * (high / low) ** share : low + (high - low) * share;
      return (logarithmic && share === 0 ? "\u2264 " : "") + decimal(value, 2);
    }
  }

  // ---- one view for every picture of the page

  const view = { zoom: 1, x: 0.5, y: 0.5, stops: 0 };
  const panes = new Set(), sources = new Set();
  let drawing = false;

  function redraw() {
    if (drawing) return;
    drawing = true;
    requestAnimationFrame(() => {
      drawing = false;
      const table = toneTable(view.stops);
      for (const source of sources) source.paint(view.stops, table);
      for (const pane of panes) pane.draw();
      byId("stops").value = `${view.stops > 0 ? "+" : view.stops < 0 ? "\u2212" : ""}${Math.abs(view.stops)} stops`;
      byId("exposure").value = view.stops;
      byId("zoom").value = view.zoom === 1 ? "fit" : `\u00d7${Number(view.zoom.toPrecision(3))}`;
    });
  }

  function expose(stops) {
    view.stops = clamp(Math.round(stops * 4) / 4, -8, 8);
    redraw();
  }

  function pan(dx, dy) {
    const half = Math.min(0.5 / view.zoom, 0.5);
    view.x = clamp(view.x + dx, half, 1 - half);
    view.y = clamp(view.y + dy, half, 1 - half);
    redraw();
  }

  // Zoom so that the point (x, y) of the picture, 0 to 1, stays where it is.
  function zoomTo(zoom, x = view.x, y = view.y) {
    const next = clamp(zoom, 1 / 16, 64), keep = view.zoom / next;
    view.x = x + (view.x - x) * keep;
    view.y = y + (view.y - y) * keep;
    view.zoom = next;
    pan(0, 0);
  }

  // ---- a pane: one source, or two with a divider between them

  class Pane {
    constructor(viewer, stage) {
      Object.assign(this, { viewer, stage, shown: [], split: 0.5 });
      this.canvas = element("canvas");
      this.box = element("div", { className: stage ? "pane stage" : "pane", tabIndex: stage ? -1 : 0 }, this.canvas);
      this.box.setAttribute("role", stage ? "group" : "img");
      if (stage) {
        this.divider = element("div", { className: "divider", tabIndex: 0, role: "slider" });
        this.divider.setAttribute("aria-label", "Divider between both pictures");
        this.divider.setAttribute("aria-valuemin", 0);
        this.divider.setAttribute("aria-valuemax", 100);
        this.box.append(this.divider);
      }
      new ResizeObserver(() => redraw()).observe(this.box);
      this.listen();
      panes.add(this);
    }

    // The rectangle of the picture in CSS pixels.
    rectangle() {
      const { clientWidth: w, clientHeight: h } = this.box, { width, height } = this.shown[0];
      const scale = Math.min(w / width, h / height) * view.zoom;
      return { scale, x: w / 2 - view.x * width * scale, y: h / 2 - view.y * height * scale };
    }

    draw() {
      if (this.shown.length === 0) return;
      const ratio = devicePixelRatio, w = Math.round(this.box.clientWidth * ratio), h = Math.round(this.box.clientHeight * ratio);
      if (this.canvas.width !== w || this.canvas.height !== h) Object.assign(this.canvas, { width: w, height: h });
      const context = this.canvas.getContext("2d"), { scale, x, y } = this.rectangle();
      context.clearRect(0, 0, w, h);
      context.imageSmoothingEnabled = scale * ratio < 1;
      context.imageSmoothingQuality = "high";
      this.shown.forEach((source, side) => {
        const from = side === 0 ? 0 : this.split * w, to = this.stage && side === 0 ? this.split * w : w;
        context.save();
        context.beginPath();
        context.rect(from, 0, to - from, h);
        context.clip();
        context.drawImage(source.canvas, x * ratio, y * ratio, source.width * scale * ratio, source.height * scale * ratio);
        context.restore();
      });
      this.box.classList.toggle("grab", view.zoom > 1);
      if (this.stage) this.describe();
    }

    describe() {
      const percent = Math.round(100 * this.split);
      this.divider.style.left = `${100 * this.split}%`;
      this.divider.setAttribute("aria-valuenow", percent);
      this.divider.setAttribute("aria-valuetext", `${percent} % ${this.shown[0].name}, ${100 - percent} % ${this.shown[1].name}`);
    }

    move(split) {
      this.split = clamp(split, 0, 1);
      redraw();
    }

    // Where an event is in the picture, 0 to 1.
    position(event) {
      const bounds = this.box.getBoundingClientRect(), { scale, x, y } = this.rectangle();
      const source = this.shown[0];
      return [(event.clientX - bounds.left - x) / (source.width * scale), (event.clientY - bounds.top - y) / (source.height * scale)];
    }

    listen() {
      const box = this.box;
      box.addEventListener("pointerdown", (event) => this.press(event));
      box.addEventListener("pointermove", (event) => this.drag(event));
      box.addEventListener("pointerup", () => (this.dragging = null));
      box.addEventListener("pointercancel", () => (this.dragging = null));
      box.addEventListener("pointerleave", () => this.viewer.read(null));
      box.addEventListener("dblclick", (event) => zoomTo(view.zoom > 1 ? 1 : 4, ...this.position(event)));
      box.addEventListener("keydown", (event) => this.key(event));
      box.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && !box.contains(document.activeElement)) return;
        event.preventDefault();
        zoomTo(view.zoom * 2 ** (-event.deltaY / 300), ...this.position(event));
      }, { passive: false });
    }

    press(event) {
      if (event.target.tagName === "SELECT") return;
      const bounds = this.box.getBoundingClientRect(), distance = event.clientX - bounds.left - this.split * bounds.width;
      this.dragging = this.stage && (view.zoom <= 1 || Math.abs(distance) < 24) ? "divider" : "picture";
      this.box.setPointerCapture(event.pointerId);
      if (this.dragging === "divider" && Math.abs(distance) >= 24) this.move((event.clientX - bounds.left) / bounds.width);
    }

    drag(event) {
      this.viewer.read(this.position(event));
      if (this.dragging === "divider") {
        const bounds = this.box.getBoundingClientRect();
        this.move((event.clientX - bounds.left) / bounds.width);
      } else if (this.dragging === "picture") {
        const { scale } = this.rectangle(), source = this.shown[0];
        pan(-event.movementX / (source.width * scale), -event.movementY / (source.height * scale));
      }
    }

    // At which a pixel of the picture is one of the screen.
    exactZoom() {
      return view.zoom / (this.rectangle().scale * devicePixelRatio);
    }

    key(event) {
      if (event.target.tagName === "SELECT" || event.ctrlKey || event.metaKey || event.altKey) return;
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      const actions = {
        "+": () => zoomTo(view.zoom * 1.5), "=": () => zoomTo(view.zoom * 1.5), "-": () => zoomTo(view.zoom / 1.5),
        "0": () => zoomTo(1), "1": () => zoomTo(this.exactZoom()), "[": () => expose(view.stops - 0.5),
        "]": () => expose(view.stops + 0.5),
      };
      if (this.stage) {
        Object.assign(actions, { " ": () => this.move(this.split > 0.5 ? 0 : 1), Home: () => this.move(0), End: () => this.move(1) });
      }
      if (step && event.shiftKey) pan((0.1 * step[0]) / view.zoom, (0.1 * step[1]) / view.zoom);
      else if (step && this.stage && step[0]) this.move(this.split + 0.02 * step[0]);
      else if (actions[event.key]) actions[event.key]();
      else return;
      event.preventDefault();
    }
  }

  // ---- a section's pictures: a tab for each frame, a stage with a divider, and panes for the rest

  class Viewer {
    constructor(frames) {
      this.frames = frames;
      this.tabs = element("div", { className: "tabs", role: "tablist" });
      this.tabs.setAttribute("aria-label", "Layers");
      this.facts = element("dl", { className: "facts" });
      this.grid = element("div", { className: "panes", role: "tabpanel" });
      this.strip = element("div", { className: "strip" });
      this.readout = element("p", { className: "readout" });
      this.box = element("div", { className: "viewer" },
        element("div", { className: "frame-head" }, this.tabs, this.facts), this.grid, this.strip, this.readout);
      frames.forEach((frame, index) => {
        const tab = element("button", { type: "button", textContent: frame.name });
        tab.setAttribute("role", "tab");
        tab.addEventListener("click", () => this.show(index));
        tab.addEventListener("keydown", (event) => {
          const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
          if (step) this.show((index + step + frames.length) % frames.length, true);
        });
        this.tabs.append(tab);
      });
      new IntersectionObserver((entries, observer) => {
        if (!entries.some((entry) => entry.isIntersecting)) return;
        observer.disconnect();
        this.show(0);
      }, { rootMargin: "800px" }).observe(this.box);
    }

    async show(index, focus) {
      const frame = this.frames[index];
      [...this.tabs.children].forEach((tab, i) => {
        tab.setAttribute("aria-selected", i === index);
        tab.tabIndex = i === index ? 0 : -1;
        if (focus && i === index) tab.focus();
      });
      this.grid.setAttribute("aria-label", frame.name);
      this.facts.replaceChildren(...(frame.facts || []).map((fact) =>
        element("div", {}, element("dt", { textContent: fact.name }), element("dd", { textContent: decimal(fact.value) }))));
      const loaded = [...frame.pictures.map((p) => new Picture(frame, p)), ...(frame.maps || []).map((m) => new ErrorMap(frame, m))];
      this.asked = index;
      await Promise.all(loaded.map((source) => source.load()));
      if (this.asked !== index) return;
      this.replaceSources(loaded, frame);
    }

    replaceSources(loaded, frame) {
      for (const source of this.sources || []) sources.delete(source);
      for (const source of loaded) sources.add(source);
      this.sources = loaded;
      this.pictureCount = frame.pictures.length;
      this.sides = this.sides || [0, Math.min(1, loaded.length - 1)];
      const shape = JSON.stringify(loaded.map(({ name, content }) => [name, content.low, content.high]));
      if (this.shape !== shape) this.makePanes(loaded);
      this.shape = shape;
      this.grid.style.setProperty("--aspect", `${frame.width} / ${frame.height}`);
      this.strip.style.setProperty("--aspect", `${frame.width} / ${frame.height}`);
      this.arrange();
      this.box.dataset.ready = frame.name;
      redraw();
    }

    // Maps of the picture on the left, or else on the right; maps that belong to no picture are always shown.
    shownMaps() {
      const maps = this.sources.slice(this.pictureCount), has = (name) => maps.some((map) => map.content.of === name);
      const subject = this.sides.map((side) => this.sources[side].content).find(({ name }) => has(name));
      const own = maps.filter(({ content }) => !content.of || (subject && content.of === subject.name));
      return own.length ? own : maps.filter(({ content }) => content.of === (maps[0] && maps[0].content.of));
    }

    // Give every pane what it is to show.
    arrange() {
      this.stagePane.shown = this.sides.map((side) => this.sources[side]);
      const maps = this.shownMaps();
      this.mapPanes.forEach((pane, i) => {
        pane.shown = [maps[i]];
        pane.box.querySelector(".chip").textContent = maps[i].name;
        pane.box.setAttribute("aria-label", maps[i].name);
      });
      this.thumbs.forEach((pane, i) => {
        pane.shown = [this.sources[i]];
        pane.box.classList.toggle("chosen", this.sides.includes(i));
      });
      this.pickers.forEach((picker, side) => (picker.value = this.sides[side]));
    }

    choose(side, index) {
      this.sides[side] = index;
      this.arrange();
      redraw();
    }

    makePanes(loaded) {
      const split = this.stagePane ? this.stagePane.split : 0.5;
      if (Math.max(...this.sides) >= loaded.length) this.sides = [0, Math.min(1, loaded.length - 1)];
      for (const pane of [this.stagePane, ...(this.mapPanes || []), ...(this.thumbs || [])]) panes.delete(pane);
      this.stagePane = new Pane(this, true);
      this.stagePane.split = split;
      this.stagePane.box.setAttribute("aria-label", "Two pictures and the divider between them");
      this.pickers = this.sides.map((_, side) => this.makePicker(loaded, side));
      this.stagePane.box.append(...this.pickers);
      this.mapPanes = this.shownMaps().map((map) => this.makeOther(map));
      // When there are more pictures than the stage shows, thumbnails of all of them are below it; a click on one moves
      // it to the left side.
      this.thumbs = this.pictureCount > 2 ? loaded.slice(0, this.pictureCount).map((source, i) => this.makeThumb(source, i)) : [];
      this.stagePane.box.classList.toggle("alone", this.mapPanes.length < 2);
      this.grid.replaceChildren(this.stagePane.box, ...this.mapPanes.map((pane) => pane.box));
      this.strip.replaceChildren(...this.thumbs.map((pane) => pane.box));
    }

    makeThumb(source, index) {
      const pane = this.makeOther(source);
      let start = null;
      pane.box.addEventListener("pointerdown", (event) => (start = [event.clientX, event.clientY]));
      pane.box.addEventListener("click", (event) => {
        const still = start && Math.hypot(event.clientX - start[0], event.clientY - start[1]) < 4;
        if (still && index !== this.sides[1]) this.choose(0, index);
      });
      return pane;
    }

    makeOther(source) {
      const pane = new Pane(this, false);
      pane.box.setAttribute("aria-label", source.name);
      pane.box.append(element("span", { className: "chip", textContent: source.name }));
      if (source instanceof ErrorMap) pane.box.append(this.makeLegend(source.content));
      return pane;
    }

    makePicker(loaded, side) {
      const picker = element("select", { className: side ? "chip right" : "chip" },
        ...loaded.map((source, i) => element("option", { value: i, textContent: source.name })));
      picker.setAttribute("aria-label", side ? "Picture on the right" : "Picture on the left");
      picker.value = this.sides[side];
      picker.addEventListener("change", () => this.choose(side, Number(picker.value)));
      return picker;
    }

    makeLegend({ low, high, logarithmic }) {
      const bar = element("canvas", { width: 256, height: 1 }), context = bar.getContext("2d");
      for (let i = 0; i < 256; ++i) {
        context.fillStyle = `rgb(${palette[3 * i]} ${palette[3 * i + 1]} ${palette[3 * i + 2]})`;
        context.fillRect(i, 0, 1, 1);
      }
      const mark = (value) => (logarithmic && value !== 1 ? `10${superscript(Math.round(Math.log10(value)))}` : decimal(value));
      return element("span", { className: "legend" }, mark(low), bar, mark(high));
    }

    // What the pixel under the pointer holds.
    read(position) {
      const inside = position && position.every((p) => p >= 0 && p < 1);
      if (!inside || !this.sources) return this.readout.replaceChildren();
      const { width, height } = this.sources[0], x = Math.floor(position[0] * width), y = Math.floor(position[1] * height);
      const part = (name, value) => element("span", {}, name, element("b", { textContent: value }));
      this.readout.replaceChildren(part("pixel", `${x}, ${y}`), ...this.sources.slice(0, this.pictureCount).concat(this.shownMaps()).map((s) => part(s.name, s.value(y * width + x))));
    }
  }

  // ---- tables

  function compareCells(a, b) {
    if (typeof a === "string" || typeof b === "string") return String(a).localeCompare(String(b), undefined, { numeric: true });
    return a - b;
  }

  function makeCell(value, { kind, unit } = {}) {
    if (typeof value === "string") return element("td", { className: "text", textContent: value });
    const shown = value === null ? "\u2013" : unit === "%" ? `${decimal(100 * value, 3)}\u2009%` : decimal(value);
    return element("td", { className: kind || "", textContent: shown, title: value === null ? "not a finite number" : String(value) });
  }

  function makeTable({ caption, columns, rows }) {
    const body = element("tbody"), lines = rows.map((cells) => ({ cells, line: element("tr", {}, ...cells.map((cell, i) => makeCell(cell, columns[i]))) }));
    body.append(...lines.map(({ line }) => line));
    const heads = columns.map(({ name, note, kind }, column) => {
      const button = element("button", { type: "button", textContent: name, title: note || "" });
      const head = element("th", { scope: "col", className: kind || "" }, button);
      button.addEventListener("click", () => {
        const descending = head.getAttribute("aria-sort") === "ascending";
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", descending ? "descending" : "ascending");
        // What is not a number stays last.
        const rank = ({ cells }) => (cells[column] === null ? 1 : 0), sign = descending ? -1 : 1;
        lines.sort((a, b) => rank(a) - rank(b) || sign * compareCells(a.cells[column], b.cells[column]));
        body.append(...lines.map(({ line }) => line));
      });
      return head;
    });
    const table = element("table", {}, element("caption", { textContent: caption }), element("thead", {}, element("tr", {}, ...heads)), body);
    return element("div", { className: "scroll", tabIndex: 0 }, table);
  }

  // ---- the page

  const isSite = data.sections.filter(({ name }) => name).length > 1;

  function makeSection({ name, heading, source, seconds, processor_seconds: spent, note, command, frames, tables, plots, skipped }) {
    const head = element("div", { className: "section-head" }, element("h2", { textContent: heading }));
    const time = seconds === undefined ? null : `${decimal(Math.round(seconds))} s, ${decimal(Math.round(spent))} s of processors`;
    const facts = [source, time].filter(Boolean);
    if (facts.length) head.append(element("p", { className: "note source", textContent: facts.join(" \u00b7 ") }));
    if (note) head.append(element("p", { className: "note", textContent: note }));
    if (command) head.append(element("p", { className: "note" }, element("code", { textContent: command })));
    const section = element("section", name ? { id: name, className: "experiment" } : {}, head);
    if (skipped) {
      const items = skipped.map(({ what, why }) => element("li", {}, element("b", { textContent: `Left out: ${what}` }), ` \u2013 ${why}`));
      section.append(element("ul", { className: "skipped" }, ...items));
    }
    if (frames) section.append(new Viewer(frames).box);
    for (const table of tables || []) section.append(...(name ? [element("h3", { textContent: table.caption })] : []), makeTable(table));
    if (plots) {
      const figures = plots.map(({ caption, svg }) => {
        const figure = element("figure");
        figure.innerHTML = svg; // its text was escaped when it was drawn
        figure.prepend(element("figcaption", { textContent: caption }));
        return figure;
      });
      section.append(element("div", { className: "plots" }, ...figures));
    }
    return section;
  }

  // Links to the experiments of a report that has several.
  function makeContents() {
    const contents = byId("contents"), links = new Map();
    if (!isSite) return;
    document.body.classList.add("site");
    for (const { name, heading } of data.sections) {
      const link = element("a", { href: `#${name}` }, element("b", { textContent: name }), element("span", { textContent: heading }));
      links.set(name, link);
      contents.append(link);
    }
    const observer = new IntersectionObserver((entries) => {
      for (const entry of entries) {
        if (!entry.isIntersecting) continue;
        links.forEach((link, name) => link.classList.toggle("current", name === entry.target.id));
      }
    }, { rootMargin: "-20% 0px -70% 0px" });
    document.querySelectorAll("section.experiment").forEach((section) => observer.observe(section));
  }

  const themes = ["auto", "light", "dark"];
  function setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    byId("theme").textContent = `Theme: ${theme}`;
  }

  const stage = () => [...panes].find((pane) => pane.stage && pane.shown.length);
  byId("title").textContent = data.title;
  byId("version").textContent = `octalux ${data.version}`;
  byId("command").textContent = data.command;
  byId("exposure").addEventListener("input", (event) => expose(Number(event.target.value)));
  byId("unexpose").addEventListener("click", () => expose(0));
  byId("larger").addEventListener("click", () => zoomTo(view.zoom * 1.5));
  byId("smaller").addEventListener("click", () => zoomTo(view.zoom / 1.5));
  byId("fit").addEventListener("click", () => zoomTo(1));
  byId("exact").addEventListener("click", () => stage() && zoomTo(stage().exactZoom()));
  byId("theme").addEventListener("click", () => setTheme(themes[(themes.indexOf(document.documentElement.dataset.theme) + 1) % 3]));
  setTheme("auto");
  byId("sections").append(...data.sections.map(makeSection));
  makeContents();
  redraw();
})();
