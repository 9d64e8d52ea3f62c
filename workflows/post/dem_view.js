// dem_view.js: the page of dem-view: spheres and bonds by ray casting in a parallel projection, cuts, colours, and values under
// the pointer.
(function () {
"use strict";

// viridis of matplotlib, in the figures' order from light to dark and without the darkest twelfth, and coolwarm; in eight steps.
const RISING = ["#fde725", "#a2da37", "#51c569", "#22a785", "#24868e", "#31668e", "#404387", "#482475"];
const SIGNED = ["#3b4cc0", "#6788ee", "#9abbff", "#c9d7f0", "#edd1c2", "#f7a889", "#e26952", "#b40426"];
const PLAIN = { particles: "#8fb0cc", bonds: "#d8a25e" }, PALE = "#c3ccd4"; // PALE: of what stands beside what is coloured
const LINE = "#0072b2", ACCENT = "#d55e00";
const STICK = 0.35;          // drawn over true radius of bonds that are shown alone, so that they do not hide each other
const SLOW = 45, FAST = 24;  // ms a frame, between which the detail of moving pictures stays
const COARSE = 0.35;         // lowest resolution of moving pictures; below this detail bodies are left out
const SAMPLES = 16;          // of which one is left at the least, of spheres four, and these are drawn larger

// ---- blocks of numbers --------------------------------------------------------------------------------------------------------
async function unpacked(text, Type) {
  const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const size = Type.BYTES_PER_ELEMENT, count = planes.length / size, whole = new Uint8Array(planes.length);
  for (let plane = 0; plane < size; ++plane)
    for (let k = 0; k < count; ++k) whole[k * size + plane] = planes[plane * count + k];
  return new Type(whole.buffer);
}

// Column after column of differences become rows of sums.
function summed(steps, columns) {
  const count = steps.length / columns, rows = new steps.constructor(steps.length), sum = new steps.constructor(1);
  for (let column = 0; column < columns; ++column) {
    sum[0] = 0;
    for (let k = 0; k < count; ++k) rows[k * columns + column] = sum[0] += steps[column * count + k];
  }
  return rows;
}

// ---- colours and words --------------------------------------------------------------------------------------------------------
const rgb = hex => [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16));
const hexOf = parts => "#" + parts.map(part => Math.round(part).toString(16).padStart(2, "0")).join("");

function colourAt(stops, share) {
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1), left = Math.min(Math.floor(place), stops.length - 2);
  const [a, b] = [rgb(stops[left]), rgb(stops[left + 1])];
  return hexOf(a.map((part, k) => part + (place - left) * (b[k] - part)));
}

function colourMap(stops) {
  const data = new Uint8Array(256 * 4);
  for (let k = 0; k < 256; ++k) data.set([...rgb(typeof stops === "string" ? stops : colourAt(stops, k / 255)), 255], 4 * k);
  const texture = new THREE.DataTexture(data, 256, 1, THREE.RGBAFormat);
  texture.needsUpdate = true;
  return texture;
}

const grouped = value => Math.round(value).toLocaleString("en-US");
function shown(value, digits = 3) {
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size >= 6 || size < -4) return value.toExponential(digits - 1).replace("-", "\u2212");
  const fixed = value.toFixed(Math.max(0, digits - 1 - size));
  return (size >= 4 ? grouped(value) : fixed).replace("-", "\u2212");
}
const plain = (value, digits) => value.toLocaleString("en-US", { minimumFractionDigits: digits, maximumFractionDigits: digits })
  .replace("-", "\u2212");
const withUnit = (text, unit) => unit ? `${text} ${unit}` : text;
const named = quantity => quantity.unit ? `${quantity.label}, ${quantity.unit}` : quantity.label;
const capital = word => word[0].toUpperCase() + word.slice(1);

// ---- shaders ------------------------------------------------------------------------------------------------------------------
// Along a ray towards the eye a body is seen from front down to back (z in view space); slab keeps what lies between two planes
// across n, given by how far they are, along n, from where z is zero. Sticks measure z from their start: of numbers as large as the
// distance of the eye, small differences vanish.
const CASTING = `
  uniform vec3 cutNormal; uniform float cutLow, cutHigh, near, far;
  varying vec2 ray; varying vec3 tint; varying vec2 depthOf;
  bool slab(vec3 n, float low, float high, inout float front, inout float back, inout vec3 normal) {
    if (abs(n.z) < 1e-5) return low <= 0.0 && high >= 0.0;
    float a = low / n.z, b = high / n.z;
    if (max(a, b) < front) { front = max(a, b); normal = n * sign(n.z); }
    back = max(back, min(a, b));
    return front > back;
  }
  void finish(float front, float back, vec3 normal, float behind) {
    float whole = front;
    float here = dot(cutNormal.xy, ray);
    if (!slab(cutNormal, cutLow - here, cutHigh - here, front, back, normal)) discard;
    float bright = 0.48 + 0.56 * max(dot(normal, normalize(vec3(-0.45, 0.55, 0.70))), 0.0);
    float away = 0.72 + 0.28 * clamp((front - far) / (near - far), 0.0, 1.0);
    vec3 face = mix(tint, vec3(1.0), 0.25) * (0.85 + 0.15 * away);
    gl_FragColor = vec4(front < whole ? face : tint * bright * away + 0.06 * pow(bright, 8.0), 1.0);
    gl_FragDepthEXT = 0.5 + 0.5 * (depthOf.x * (front - behind) + depthOf.y);
  }`;
const PLACING = `
  attribute float value;
  uniform vec3 low, extent; uniform sampler2D map; uniform float scale;
  varying vec2 ray; varying vec3 tint; varying vec2 depthOf;
  vec3 seen(vec3 place) { return (modelViewMatrix * vec4(low + place * extent, 1.0)).xyz; }
  void put(vec3 place) {
    ray = place.xy;
    tint = texture2D(map, vec2((value * 255.0 + 0.5) / 256.0, 0.5)).rgb;
    depthOf = vec2(projectionMatrix[2][2], projectionMatrix[3][2]);
    gl_Position = projectionMatrix * vec4(place, 1.0);
  }`;
const SPHERES = {
  vertexShader: PLACING + `
    attribute vec3 place; attribute float size;
    varying vec3 centre; varying float radius;
    void main() {
      centre = seen(place);
      radius = size * scale;
      put(centre + radius * vec3(position.xy, 1.0));
    }`,
  fragmentShader: CASTING + `
    varying vec3 centre; varying float radius;
    void main() {
      vec2 across = ray - centre.xy;
      float square = radius * radius - dot(across, across);
      if (square < 0.0) discard;
      float half_ = sqrt(square);
      finish(centre.z + half_, centre.z - half_, vec3(across, half_) / radius, 0.0);
    }`
};
const STICKS = {
  vertexShader: PLACING + `
    attribute vec3 from, to; attribute float size;
    varying vec3 start, along; varying float radius, reach;
    void main() {
      start = seen(from);
      vec3 end = seen(to);
      radius = size * scale;
      reach = distance(start, end);
      along = (end - start) / max(reach, 1e-9);
      vec3 middle = 0.5 * (start + end);
      vec2 ahead = length(along.xy) > 1e-6 ? normalize(along.xy) : vec2(1.0, 0.0);
      float half_ = 0.5 * reach * length(along.xy) + radius;
      put(middle + vec3(position.x * half_ * ahead + position.y * radius * vec2(-ahead.y, ahead.x), radius + 0.5 * reach));
    }`,
  fragmentShader: CASTING + `
    varying vec3 start, along; varying float radius, reach;
    void main() {
      vec3 open = vec3(ray - start.xy, 0.0);
      vec3 o = open - along * dot(open, along), d = vec3(0.0, 0.0, 1.0) - along * along.z;
      float a = dot(d, d), b = dot(o, d), c = dot(o, o) - radius * radius;
      float front = 1e9, back = -1e9;
      vec3 normal = vec3(0.0, 0.0, 1.0);
      if (a > 1e-6) {
        float root = b * b - a * c;
        if (root < 0.0) discard;
        root = sqrt(root);
        front = (-b + root) / a;
        back = (-b - root) / a;
        normal = (o + front * d) / radius;
      } else if (c > 0.0) discard;
      float here = dot(along, open);
      if (!slab(along, -here, reach - here, front, back, normal)) discard;
      finish(front + start.z, back + start.z, normal, 0.01 * radius); // in a cut through both, spheres are in front
    }`
};

// A square facing the eye for each body, all in one call: instances of four corners each are far slower where no GPU draws them.
function squares(shaders, map, cut) {
  const uniforms = { low: { value: new THREE.Vector3() }, extent: { value: new THREE.Vector3() }, map: { value: map },
                     scale: { value: 1 }, ...cut };
  const material = new THREE.ShaderMaterial({ ...shaders, uniforms, extensions: { fragDepth: true } });
  const mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
  mesh.frustumCulled = false;
  return mesh;
}

// A row of values for each body, as an attribute of its four corners.
function ofCorners(values, columns) {
  const corners = new values.constructor(4 * values.length);
  for (let k = 0; k < values.length; k += columns)
    for (let corner = 0; corner < 4; ++corner)
      for (let column = 0; column < columns; ++column) corners[4 * k + corner * columns + column] = values[k + column];
  return new THREE.BufferAttribute(corners, columns, !(values instanceof Float32Array));
}

function setBodies(mesh, arrays, count) {
  const geometry = new THREE.BufferGeometry(), corner = new Int8Array(8 * count);
  for (let k = 0; k < count; ++k) corner.set([-1, -1, 1, -1, 1, 1, -1, 1], 8 * k);
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(6 * count), 1));
  geometry.setAttribute("position", new THREE.BufferAttribute(corner, 2));
  for (const [name, [values, columns]] of Object.entries(arrays)) geometry.setAttribute(name, ofCorners(values, columns));
  geometry.setAttribute("value", ofCorners(new Uint8Array(count), 1));
  mesh.geometry.dispose();
  mesh.geometry = geometry;
}

// Draws only the bodies for which shows(k) is true; every beginning of their order holds an even sample of all.
function chooseBodies(mesh, count, shows) {
  const { index } = mesh.geometry, values = index.array;
  let at = 0;
  for (let first = 0; first < SAMPLES; ++first)
    for (let k = first; k < count; k += SAMPLES) {
      if (!shows(k)) continue;
      for (const corner of [0, 1, 2, 0, 2, 3]) values[at++] = 4 * k + corner;
    }
  index.updateRange = { offset: 0, count: at };
  index.needsUpdate = true;
  mesh.chosen = at / 6;
}

// ---- which spheres lie too deep to be seen: further than reach below the next cell of a coarse grid that is nearly empty ------
function deepOnes(state, places, radii, mean, reach) {
  const width = 3 * mean;
  const extent = state.high.map((high, k) => high - state.low[k]);
  const cells = extent.map(side => Math.max(1, Math.ceil(side / width)) + 2), [nx, ny, nz] = cells;
  const solid = new Float32Array(nx * ny * nz), cell = new Int32Array(radii.length);
  for (let k = 0; k < radii.length; ++k) {
    const at = axis => 1 + Math.min(cells[axis] - 3, Math.floor(places[3 * k + axis] / 65535 * extent[axis] / width));
    cell[k] = (at(0) * ny + at(1)) * nz + at(2);
    solid[cell[k]] += 4.19 * radii[k] ** 3;
  }
  const deep = Uint8Array.from(solid, volume => volume < 0.2 * width ** 3 ? 0 : 255);
  for (let layer = 1; layer < 255; ++layer) {
    let found = false;
    for (let x = 1; x < nx - 1; ++x) for (let y = 1; y < ny - 1; ++y) for (let z = 1; z < nz - 1; ++z) {
      const k = (x * ny + y) * nz + z;
      if (deep[k] < layer) continue;
      found = true;
      if (Math.min(deep[k - 1], deep[k + 1], deep[k - nz], deep[k + nz], deep[k - ny * nz], deep[k + ny * nz]) === layer - 1)
        deep[k] = layer;
    }
    if (!found) break;
  }
  const last = Math.ceil(reach / width) + 1;
  return cell.map(at => deep[at] > last);
}

// ---- plots with values under the pointer --------------------------------------------------------------------------------------
function element(name, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

function ticks(low, high, wanted = 6) {
  const raw = (high - low) / wanted, unit = 10 ** Math.floor(Math.log10(raw));
  const step = unit * [1, 2, 5, 10].find(each => each * unit >= raw * 0.999), found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) found.push(k * step + 0);
  return { found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

// what: { x, y: labels; low, high: ranges [x, y] where they are given; bars: [{low, high, count, colour, text}];
// series: [{name, x, y, low, high: of a band, colour, line, dashes, points, current, text: of each point}];
// chosen: function of a series and a point }
function drawPlot(holder, what) {
  const [width, height, left, right, top, bottom] = [520, what.height || 190, 78, 14, 12, 42];
  const svg = element("svg", { viewBox: `0 0 ${width} ${height}` }), series = what.series || [], bars = what.bars || [];
  const all = axis => series.flatMap(each => each[axis]).filter(value => value !== null);
  const xs = bars.length ? [bars[0].low, bars[bars.length - 1].high] : all("x");
  const ys = bars.length ? [0, ...bars.map(bar => bar.count)] : all("y");
  let [[x0, x1], [y0, y1]] = [xs, ys].map(values => [Math.min(...values), Math.max(...values)]);
  if (!bars.length) {
    [x0, x1] = [x0 - 0.03 * (x1 - x0 || 1), x1 + 0.05 * (x1 - x0 || 1)];
    [y0, y1] = [y0 - 0.08 * (y1 - y0 || 1), y1 + 0.08 * (y1 - y0 || 1)];
  }
  if (what.low) [x0, y0] = what.low.map((value, k) => value === null ? [x0, y0][k] : value);
  const atX = x => left + (x - x0) / (x1 - x0 || 1) * (width - left - right);
  const atY = y => height - bottom - (y - y0) / (y1 - y0 || 1) * (height - top - bottom);
  for (const bar of bars) {
    const x = atX(bar.low), wide = atX(bar.high) - x, fill = bar.colour;
    svg.append(element("rect", { x, width: Math.max(wide - 0.6, 0.5), y: atY(bar.count), height: atY(0) - atY(bar.count), fill }),
               element("rect", { x, width: wide + 0.3, y: atY(0) + 1.5, height: 7, fill }));
  }
  const lift = bars.length ? 9 : 0;
  svg.append(element("path", { class: "axis", d: `M${left} ${top} V${height - bottom} H${width - right}` }));
  const across = ticks(x0, x1, what.wanted || 6), up = ticks(y0, y1, 4);
  for (const x of across.found)
    svg.append(element("path", { class: "axis", d: `M${atX(x)} ${height - bottom + lift} v4` }),
               element("text", { x: atX(x), y: height - bottom + lift + 16, "text-anchor": "middle" },
                       plain(x, across.digits)));
  for (const y of up.found)
    svg.append(element("path", { class: "axis", d: `M${left} ${atY(y)} h-4` }),
               element("text", { x: left - 7, y: atY(y) + 4, "text-anchor": "end" },
                       plain(y, up.digits)));
  svg.append(element("text", { x: (left + width - right) / 2, y: height - 3, "text-anchor": "middle" }, what.x),
             element("text", { x: 0, y: 0, "text-anchor": "middle",
                               transform: `translate(11 ${(top + height - bottom) / 2}) rotate(-90)` }, what.y));
  const spots = [];
  for (const each of series) {
    const there = each.x.map((x, k) => [x, each.y[k], k]).filter(([x, y]) => x !== null && y !== null);
    if (each.low) {
      const edge = values => each.x.map((x, k) => `${atX(x).toFixed(2)} ${atY(values[k]).toFixed(2)}`);
      const outline = [...edge(each.low), ...edge(each.high).reverse()];
      svg.append(element("path", { fill: each.colour, opacity: 0.15, d: `M${outline.join("L")}Z` }));
    }
    // Where x goes back a new piece begins: several runs in one page.
    const pieces = there.map(([x, y], k) => `${k && x >= there[k - 1][0] ? "L" : "M"}${atX(x).toFixed(2)} ${atY(y).toFixed(2)}`);
    if (each.line)
      svg.append(element("path", { fill: "none", stroke: each.colour, "stroke-width": 1.6, "stroke-dasharray": each.dashes || "",
                                   d: pieces.join("") }));
    for (const [x, y, k] of there) {
      if (each.points) svg.append(element("circle", { cx: atX(x), cy: atY(y), r: k === each.current ? 6 : 4, fill: each.colour,
                                                      stroke: "white", "stroke-width": 1 }));
      spots.push({ x: atX(x), y: atY(y), each, k });
    }
  }
  series.filter(each => each.name && series.length > 1).forEach((each, row) => svg.append(
    each.points ? element("circle", { cx: left + 22, cy: top + 16 * row + 5, r: 4, fill: each.colour })
                : element("path", { stroke: each.colour, "stroke-width": 1.6, "stroke-dasharray": each.dashes || "",
                                    d: `M${left + 12} ${top + 16 * row + 5} h20` }),
    element("text", { x: left + 40, y: top + 16 * row + 9 }, each.name)));
  const mark = element("circle", { r: 7, fill: "none", stroke: "#1c2733", "stroke-width": 1.2, visibility: "hidden" });
  const tip = document.createElement("output");
  tip.className = "tip";
  tip.hidden = true;
  svg.append(mark);
  holder.replaceChildren(svg, tip);
  const under = event => {
    const frame = svg.getBoundingClientRect(), scale = width / frame.width;
    const x = (event.clientX - frame.left) * scale, y = (event.clientY - frame.top) * scale;
    if (bars.length) return { bar: bars.find(bar => x >= atX(bar.low) && x < atX(bar.high)) };
    const near = spots.map(spot => [Math.hypot(spot.x - x, spot.y - y), spot]).sort((a, b) => a[0] - b[0])[0];
    return near && near[0] < 40 ? near[1] : {};
  };
  svg.addEventListener("pointermove", event => {
    const { bar, each, k, x, y } = under(event);
    tip.hidden = !bar && !each;
    mark.setAttribute("visibility", each ? "visible" : "hidden");
    if (tip.hidden) return;
    if (each) { mark.setAttribute("cx", x); mark.setAttribute("cy", y); }
    tip.textContent = bar ? bar.text : each.text[k];
    placeTip(tip, holder, event);
  });
  svg.addEventListener("pointerleave", () => { tip.hidden = true; mark.setAttribute("visibility", "hidden"); });
  if (what.chosen) svg.addEventListener("click", event => { const { each, k } = under(event); if (each) what.chosen(each, k); });
}

function placeTip(tip, holder, event) {
  const frame = holder.getBoundingClientRect(), x = event.clientX - frame.left, y = event.clientY - frame.top;
  tip.style.left = `${Math.max(0, Math.min(x + 14, frame.width - tip.offsetWidth - 4))}px`;
  tip.style.top = `${y + 18 + tip.offsetHeight > frame.height ? Math.max(0, y - 10 - tip.offsetHeight) : y + 18}px`;
}

// ---- the view -----------------------------------------------------------------------------------------------------------------
class View {
  constructor(root, header, context) {
    this.root = root;
    this.header = header;
    this.loaded = new Map();
    this.at = name => root.querySelector(`[name=${name}]`);
    this.canvas = root.querySelector("canvas");
    this.tip = root.querySelector(".scene .tip");
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, context, antialias: false });
    this.renderer.setClearColor(0xffffff);
    this.maps = { particles: colourMap(PLAIN.particles), bonds: colourMap(PLAIN.bonds), pale: colourMap(PALE),
                  rising: colourMap(RISING), signed: colourMap(SIGNED) };
    this.cut = { cutNormal: { value: new THREE.Vector3(0, 0, 1) }, cutLow: { value: -1e9 }, cutHigh: { value: 1e9 },
                 near: { value: 1 }, far: { value: -1 } };
    this.meshes = { particles: squares(SPHERES, this.maps.particles, this.cut),
                    bonds: squares(STICKS, this.maps.bonds, this.cut) };
    this.frame = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(1, 1, 1)),
                                        new THREE.LineBasicMaterial({ color: 0x8a99a6 }));
    this.scene = new THREE.Scene();
    this.scene.add(this.meshes.particles, this.meshes.bonds, this.frame);
    this.size = Math.max(...header.states.map(state => Math.hypot(...state.high.map((high, k) => high - state.low[k]))));
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 8 * this.size);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    Object.assign(this.controls, { screenSpacePanning: true, enableKeys: false, rotateSpeed: 0.8, minZoom: 0.3, maxZoom: 60 });
    this.detail = 1;
    this.lastChange = -1e9;
    this.number = 0;
    this.fillSelects();
    this.listen();
    this.lookFrom(Math.sin(0.56) * Math.cos(0.42), -Math.cos(0.56) * Math.cos(0.42), Math.sin(0.42));
  }

  // ---- controls of the page ----
  fillSelects() {
    const select = this.at("colour"), states = this.header.states;
    select.append(new Option("nothing", ""));
    for (const [kind, found] of Object.entries(this.header.quantities)) {
      const group = document.createElement("optgroup");
      group.label = kind;
      for (const [name, quantity] of Object.entries(found)) group.append(new Option(quantity.label, `${kind}.${name}`));
      if (group.children.length) select.append(group);
    }
    select.value = "particles.coordination";
    this.at("state").max = states.length - 1;
    if (states.every(state => !state.bonds.count)) this.at("show").disabled = this.at("sticks").disabled = true;
    this.showing("particles");
  }

  showing(kind) {
    this.at("show").value = kind;
    this.at("spheres").value = kind === "bonds" ? 0 : 1;
    this.at("sticks").value = { particles: 0, bonds: STICK, both: 1 }[kind];
  }

  listen() {
    const on = (name, action) => this.at(name).addEventListener("input", action);
    on("state", () => this.showState(Number(this.at("state").value)));
    on("colour", () => {
      const [kind] = this.at("colour").value.split(".");
      if (kind && Number(this.at(kind === "bonds" ? "sticks" : "spheres").value) === 0) this.showing(kind);
      this.recolour();
    });
    on("show", () => {
      const show = this.at("show").value;
      this.showing(show);
      const [kind] = this.at("colour").value.split("."), other = show === "bonds" ? "bonds.radius" : "particles.coordination";
      if (kind && show !== "both" && kind !== show) this.at("colour").value = other;
      this.recolour();
    });
    for (const name of ["spheres", "sticks", "at", "thick"]) on(name, () => this.changed());
    on("axis", () => this.cutAlong(this.at("axis").value));
    this.at("reset").addEventListener("click", () => this.reset());
    this.controls.addEventListener("change", () => this.changed());
    this.canvas.addEventListener("keydown", event => this.key(event));
    this.canvas.addEventListener("pointermove", event => { this.pointer = event.buttons ? null : event; this.wake(); });
    this.canvas.addEventListener("pointerdown", () => { this.pointer = null; this.tip.hidden = true; this.canvas.focus(); });
    this.canvas.addEventListener("pointerleave", () => { this.pointer = null; this.tip.hidden = true; });
    new ResizeObserver(() => this.resize()).observe(this.canvas.parentElement);
  }

  key(event) {
    const state = this.number + { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const looks = { x: [1, 0, 0], y: [0, -1, 0], z: [0, -1e-3, 1] }[event.key];
    if (this.header.states[state]) { this.at("state").value = state; this.showState(state); }
    else if (looks) this.lookFrom(...looks);
    else if (event.key === "c") this.cutAlong({ "": "1", 1: "0", 0: "2", 2: "" }[this.at("axis").value]);
    else if (event.key === "0") this.reset();
    else return;
    event.preventDefault();
  }

  reset() {
    this.cutAlong("");
    this.at("at").value = 0.5;
    this.at("thick").value = 1;
    this.camera.zoom = 1;
    this.lookFrom(Math.sin(0.56) * Math.cos(0.42), -Math.cos(0.56) * Math.cos(0.42), Math.sin(0.42));
  }

  cutAlong(axis) {
    this.at("axis").value = axis;
    const eye = this.camera.position.clone().sub(this.controls.target).toArray();
    this.keepsLow = axis === "" || eye[Number(axis)] > 0; // the face of the cut looks at the eye
    this.changed();
  }

  lookFrom(x, y, z) {
    this.controls.target.set(0, 0, 0);
    this.camera.position.set(x, y, z).normalize().multiplyScalar(4 * this.size);
    this.controls.update();
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width) return;
    this.camera.updateMatrixWorld();
    const corners = this.header.states.flatMap(state => this.corners(state));
    const across = Math.max(...corners.map(([x]) => Math.abs(x))), up = Math.max(...corners.map(([, y]) => Math.abs(y)));
    const half = 1.12 * Math.max(across * height / width, up);
    Object.assign(this.camera, { left: -half * width / height, right: half * width / height, top: half, bottom: -half });
    this.camera.updateProjectionMatrix();
    this.changed();
  }

  // Corners of what a state fills, as the eye sees them.
  corners(state) {
    const view = this.camera.matrixWorldInverse.getInverse(this.camera.matrixWorld), corners = [];
    for (const x of [state.low[0], state.high[0]]) for (const y of [state.low[1], state.high[1]])
      for (const z of [state.low[2], state.high[2]]) corners.push(new THREE.Vector3(x, y, z).applyMatrix4(view).toArray());
    return corners;
  }

  // ---- states and colours ----
  block(number, Type, columns = 0) {
    const key = `${number} ${Type.name} ${columns}`;
    if (!this.loaded.has(key)) this.loaded.set(key, unpacked(this.header.blocks[number], Type)
      .then(values => columns ? summed(values, columns) : values));
    return this.loaded.get(key);
  }

  async showState(number) {
    const state = this.header.states[this.number = number];
    this.at("said").textContent = this.words(state);
    const [places, sizes, first, second] = await Promise.all([
      this.block(state.position, Uint16Array, 3), this.block(state.radius, Uint16Array),
      this.block(state.bonds.first, Int32Array, 1), this.block(state.bonds.second, Int32Array)]);
    const radiusOf = state.bonds.colours.radius;
    const widths = radiusOf === undefined ? new Uint8Array(0) : await this.block(radiusOf, Uint8Array);
    if (this.number !== number) return; // the slider has moved on
    const radii = Float32Array.from(sizes, size => size / 65535 * state.radius_scale);
    const count = widths.length && state.bonds.count, from = new Uint16Array(3 * count), to = new Uint16Array(3 * count);
    for (let k = 0; k < count; ++k) {
      const i = 3 * first[k], j = i + 3 * second[k];
      for (let axis = 0; axis < 3; ++axis) { from[3 * k + axis] = places[i + axis]; to[3 * k + axis] = places[j + axis]; }
    }
    this.state = state;
    this.arrays = { places, radii, first, second, widths, from, to, count };
    setBodies(this.meshes.particles, { place: [places, 3], size: [radii, 1] }, state.count);
    setBodies(this.meshes.bonds, { from: [from, 3], to: [to, 3], size: [widths, 1] }, count);
    for (const mesh of Object.values(this.meshes)) {
      mesh.material.uniforms.low.value.fromArray(state.low);
      mesh.material.uniforms.extent.value.fromArray(state.high.map((high, k) => high - state.low[k]));
    }
    this.frame.scale.fromArray(state.box);
    // Between spheres of volume fraction f one sees 4R(1 - f)/(3f) far on average; what lies several times as deep is not drawn.
    const mean = radii.reduce((sum, radius) => sum + radius, 0) / radii.length, solid = Math.min(state.density || 0.5, 0.95);
    this.reach = mean * (3 + 16 / 3 * (1 - solid) / solid);
    this.deep = deepOnes(state, places, radii, mean, this.reach);
    this.chosen = "";
    await this.recolour();
  }

  words(state) {
    const parts = [`${this.number + 1} of ${this.header.states.length}`];
    if (state.density !== null) parts.push(`relative density ${state.density.toFixed(3)}`);
    parts.push(`${shown(state.time)} s`, `${grouped(state.count)} particles`);
    const through = state.bonds.crossing ? `, ${grouped(state.bonds.crossing)} more through periodic faces` : "";
    if (state.bonds.count) parts.push(`${grouped(state.bonds.count)} ${state.bonds.word}s${through}`);
    if (state.enlarged > 1) parts.push(`bending shown ${grouped(state.enlarged)} times enlarged`);
    return parts.join(" \u00b7 ");
  }

  async recolour() {
    if (!this.state) return; // chosen before the first state is there, which is coloured when it comes
    const { state } = this, asked = this.at("colour").value, [kind, name] = asked.split("."), levels = {};
    for (const [each, mesh] of Object.entries(this.meshes)) {
      const target = each === "bonds" ? state.bonds : state;
      const block = each === kind ? target.colours[name] : undefined;
      levels[each] = block === undefined ? null : await this.block(block, Uint8Array);
      if (this.state !== state || this.at("colour").value !== asked) return; // another choice was made meanwhile
      const { value } = mesh.geometry.attributes;
      (levels[each] || []).forEach((level, k) => value.array.fill(level, 4 * k, 4 * k + 4));
      value.needsUpdate = true;
      const quantity = levels[each] && this.header.quantities[kind][name];
      mesh.material.uniforms.map.value = this.maps[quantity ? (quantity.signed ? "signed" : "rising") : kind ? "pale" : each];
    }
    this.drawHistogram(kind && this.header.quantities[kind][name], kind, kind && levels[kind]);
    this.drawStates();
    this.changed();
  }

  valueOf(quantity, level) { return quantity.low + level / 255 * (quantity.high - quantity.low); }

  saidValue(quantity, level) {
    const value = this.valueOf(quantity, level);
    const beyond = quantity.cut && level === 255 ? "\u2265 " : quantity.cut && quantity.low < 0 && level === 0 ? "\u2264 " : "";
    return beyond + withUnit(quantity.whole ? grouped(value) : shown(value), quantity.unit);
  }

  // ---- plots ----
  drawHistogram(quantity, kind, levels) {
    const holder = this.plot("histogram");
    if (!levels) {
      holder.textContent = quantity ? `This state has no ${quantity.label.split(",")[0].toLowerCase()} of ${kind}.` : "";
      return;
    }
    const stops = quantity.signed ? SIGNED : RISING, span = quantity.high - quantity.low;
    const bins = quantity.whole && span <= 40 ? Math.round(span) + 1 : 51, counts = new Array(bins).fill(0);
    for (const level of levels) ++counts[Math.min(bins - 1, quantity.whole && span <= 40 ? Math.round(level / 255 * span)
                                                                                          : Math.floor(level / 255 * bins))];
    const wide = quantity.whole && span <= 40 ? 1 : span / bins, start = quantity.low - (wide === 1 && quantity.whole ? 0.5 : 0);
    const bars = counts.map((count, k) => {
      const low = start + k * wide, high = low + wide, middle = (low + high) / 2;
      const range = wide === 1 && quantity.whole ? shown(middle) : `${shown(low)} to ${shown(high)}`;
      return { low, high, count, colour: colourAt(stops, (middle - quantity.low) / span),
               text: `${withUnit(range, quantity.unit)}: ${grouped(count)} ${kind}, ${shown(100 * count / levels.length)} %` };
    });
    drawPlot(holder, { x: named(quantity), y: `Number of ${kind}`, bars });
  }

  drawStates() {
    const { states } = this.header, known = states.filter(state => state.density !== null);
    if (new Set(known.map(state => state.time)).size < 2) return;
    drawPlot(this.plot("states"), {
      x: "Time, s", y: "Relative density",
      series: [{ x: states.map(state => state.time), y: states.map(state => state.density), line: true, points: true, colour: LINE,
                 current: this.number, text: states.map(state => `relative density ${state.density && state.density.toFixed(3)}\n` +
                   `${shown(state.time)} s\ncoordination number ${shown(state.coordination)}`) }],
      chosen: (series, k) => { this.at("state").value = k; this.showState(k); }
    });
  }

  plot(name) {
    const plots = this.root.querySelector(".plots");
    let holder = plots.querySelector(`[data-plot=${name}]`);
    if (!holder) {
      plots.append(holder = document.createElement("div"));
      Object.assign(holder, { className: "dem-plot" }).dataset.plot = name;
    }
    return holder;
  }

  // ---- drawing: coarser and with fewer bodies while something moves and a frame takes long, twice as fine at rest ----
  changed() {
    this.lastChange = performance.now();
    this.dirty = true;
    this.wake();
  }

  wake() {
    if (!this.awake) this.awake = requestAnimationFrame(now => this.tick(now));
  }

  tick(now) {
    this.awake = 0;
    if (!this.state) return;
    const moving = performance.now() - this.lastChange < 160;
    if (this.dirty || moving) {
      if (this.dirty && this.drawnAt) {
        const took = now - this.drawnAt;
        if (took > SLOW) this.detail = Math.max(COARSE / SAMPLES, (took > 4 * SLOW ? 0.5 : 0.8) * this.detail);
        if (took < FAST) this.detail = Math.min(1, 1.08 * this.detail);
      }
      this.drawnAt = this.dirty ? now : 0;
      if (this.dirty) this.draw(this.detail);
      this.dirty = false;
      this.fine = false;
      this.wake();
    } else if (!this.fine) {
      this.fine = true;
      this.drawnAt = 0;
      this.draw(this.detail < 0.7 ? 1 : 2);
    }
    if (this.pointer && this.fine) this.pick(this.pointer);
  }

  placeCut() {
    const view = this.camera.matrixWorldInverse.getInverse(this.camera.matrixWorld);
    const { state, cut } = this, axis = this.at("axis").value;
    cut.cutNormal.value.set(0, 0, 1);
    [cut.cutLow.value, cut.cutHigh.value] = [-1e9, 1e9];
    if (axis !== "") {
      const column = view.elements.slice(4 * axis, 4 * axis + 3), shift = view.elements.slice(12, 15);
      const offset = column.reduce((sum, part, k) => sum + part * shift[k], 0), range = state.high[axis] - state.low[axis];
      const here = state.low[axis] + Number(this.at("at").value) * range, thick = Number(this.at("thick").value);
      const reach = thick === 1 ? 1e9 : thick * range;
      cut.cutNormal.value.fromArray(column);
      const [low, high] = this.keepsLow ? [here - reach, here] : [here, here + reach];
      [cut.cutLow.value, cut.cutHigh.value] = [low + offset, high + offset];
      this.choose(Number(axis), low, high);
    } else this.choose(0, -1e9, 1e9);
    const depths = this.corners(state).map(corner => corner[2]);
    [cut.near.value, cut.far.value] = [Math.max(...depths), Math.min(...depths)];
  }

  // What lies between two planes across an axis, without the spheres that others hide.
  choose(axis, low, high) {
    const hides = Number(this.at("spheres").value) === 1, wanted = [axis, low, high, hides].join(" ");
    if (wanted === this.chosen) return;
    this.chosen = wanted;
    const { state, arrays, reach, deep } = this, { places, radii, from, to, widths } = arrays;
    const along = values => k => state.low[axis] + values[3 * k + axis] / 65535 * (state.high[axis] - state.low[axis]);
    const [middle, start, end] = [places, from, to].map(along);
    chooseBodies(this.meshes.particles, state.count, k => {
      const s = middle(k);
      return s + radii[k] > low && s - radii[k] < high && !(hides && deep[k] && s - low > reach && high - s > reach);
    });
    const scale = arrays.count ? this.header.quantities.bonds.radius.high / 255 : 0;
    chooseBodies(this.meshes.bonds, arrays.count, k => {
      const a = start(k), b = end(k), radius = scale * widths[k];
      return radius > 0 && Math.max(a, b) + radius > low && Math.min(a, b) - radius < high;
    });
  }

  draw(detail) {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!this.state || !width) return;
    this.camera.updateMatrixWorld();
    this.placeCut();
    const spheres = Number(this.at("spheres").value), sticks = Number(this.at("sticks").value), { particles, bonds } = this.meshes;
    particles.visible = spheres > 0;
    bonds.visible = sticks > 0 && this.arrays.count > 0;
    bonds.material.uniforms.scale.value = sticks * (this.arrays.count ? this.header.quantities.bonds.radius.high : 0);
    const share = Math.min(1, detail / COARSE), ofSpheres = Math.max(share, 4 / SAMPLES);
    particles.geometry.setDrawRange(0, 6 * Math.ceil(particles.chosen * ofSpheres));
    bonds.geometry.setDrawRange(0, 6 * Math.ceil(bonds.chosen * share));
    particles.material.uniforms.scale.value = spheres / Math.cbrt(ofSpheres);
    this.renderer.setPixelRatio(Math.min(Math.max(detail, COARSE) * window.devicePixelRatio, 3));
    this.renderer.setSize(width, height, false);
    this.renderer.render(this.scene, this.camera);
    this.drawRuler(width);
    this.drawTriad();
  }

  drawRuler(width) {
    const one = (this.camera.right - this.camera.left) / this.camera.zoom / width, wanted = one * width / 6;
    const unit = 10 ** Math.floor(Math.log10(wanted)), length = unit * [5, 2, 1].find(each => each * unit <= wanted);
    const ruler = this.root.querySelector(".ruler");
    ruler.style.width = `${length / one}px`;
    ruler.textContent = `${length.toLocaleString("en-US", { maximumSignificantDigits: 3 })} ${this.header.unit}`;
  }

  drawTriad() {
    const view = this.camera.matrixWorldInverse.elements, triad = this.root.querySelector(".triad");
    triad.replaceChildren(...[0, 1, 2].flatMap(axis => {
      const [x, y] = [view[4 * axis] * 20, -view[4 * axis + 1] * 20];
      return [element("path", { d: `M0 0L${x} ${y}`, stroke: "#5b6b7a", "stroke-width": 1.5 }),
              element("text", { x: 1.35 * x, y: 1.35 * y }, "xyz"[axis])];
    }));
  }

  // ---- values under the pointer ----
  // The front of a body between two depths along the ray, after the cut; nothing where it is cut away.
  frontOf(front, back, x, y) {
    const { cutNormal, cutLow, cutHigh } = this.cut, n = cutNormal.value, here = n.x * x + n.y * y;
    if (Math.abs(n.z) < 1e-5) return here >= cutLow.value && here <= cutHigh.value ? front : -Infinity;
    const a = (cutLow.value - here) / n.z, b = (cutHigh.value - here) / n.z;
    const top = Math.min(front, Math.max(a, b));
    return top > Math.max(back, Math.min(a, b)) ? top : -Infinity;
  }

  // Places of u16 triples as the eye sees them.
  seen(places) {
    const { low, high } = this.state, e = this.camera.matrixWorldInverse.elements;
    const step = high.map((each, k) => (each - low[k]) / 65535);
    return k => {
      const at = axis => low[axis] + step[axis] * places[3 * k + axis], x = at(0), y = at(1), z = at(2);
      const along = row => e[row] * x + e[4 + row] * y + e[8 + row] * z + e[12 + row];
      return [along(0), along(1), along(2)];
    };
  }

  pickedSphere(x, y, scale) {
    const { places, radii } = this.arrays, seen = this.seen(places), best = { front: -Infinity };
    for (let k = 0; k < radii.length; ++k) {
      const [cx, cy, cz] = seen(k), radius = scale * radii[k], square = radius * radius - (x - cx) ** 2 - (y - cy) ** 2;
      if (square < 0) continue;
      const half = Math.sqrt(square), front = this.frontOf(cz + half, cz - half, x, y);
      if (front > best.front) Object.assign(best, { front, particle: k });
    }
    return best;
  }

  pickedStick(x, y, scale, best) {
    const { from, to, widths, count } = this.arrays, [start, end] = [this.seen(from), this.seen(to)];
    for (let k = 0; k < count; ++k) {
      const a = start(k), b = end(k), along = [b[0] - a[0], b[1] - a[1]], square = along[0] ** 2 + along[1] ** 2;
      const t = square ? Math.min(1, Math.max(0, ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / square)) : 0;
      const radius = scale * widths[k] / 255, off = Math.hypot(x - a[0] - t * along[0], y - a[1] - t * along[1]);
      if (off > radius) continue;
      const middle = a[2] + t * (b[2] - a[2]), half = Math.sqrt(radius * radius - off * off);
      const front = this.frontOf(middle + half, middle - half, x, y);
      if (front > best.front) Object.assign(best, { front, bond: k });
    }
    return best;
  }

  async pick(event) {
    this.pointer = null;
    if (!this.state) return;
    const frame = this.canvas.getBoundingClientRect(), { camera, state } = this;
    const x = (camera.left + (event.clientX - frame.left) / frame.width * (camera.right - camera.left)) / camera.zoom;
    const y = (camera.top - (event.clientY - frame.top) / frame.height * (camera.top - camera.bottom)) / camera.zoom;
    const { particles, bonds } = this.meshes;
    const best = particles.visible ? this.pickedSphere(x, y, particles.material.uniforms.scale.value) : { front: -Infinity };
    if (bonds.visible) this.pickedStick(x, y, bonds.material.uniforms.scale.value, best);
    this.tip.hidden = best.front === -Infinity;
    if (this.tip.hidden) return;
    const ids = await this.block(state.ids, Int32Array), isBond = best.bond !== undefined, k = isBond ? best.bond : best.particle;
    const { first, second } = this.arrays, kind = isBond ? "bonds" : "particles", colours = (isBond ? state.bonds : state).colours;
    const lines = [`Particle ${ids[k]}`];
    if (isBond) lines[0] = `${capital(state.bonds.word)} of particles ${ids[first[k]]} and ${ids[first[k] + second[k]]}`;
    for (const [name, quantity] of Object.entries(this.header.quantities[kind])) {
      if (!(name in colours)) continue;
      const levels = await this.block(colours[name], Uint8Array);
      lines.push(`${quantity.label.split(/[:,]/)[0]}: ${this.saidValue(quantity, levels[k])}`);
    }
    this.tip.textContent = lines.join("\n");
    placeTip(this.tip, this.canvas.parentElement, event);
  }
}

// ---- the page: where the view cannot be shown, what stands in its place stays -------------------------------------------------
async function start(root) {
  const context = window.DecompressionStream && root.querySelector("canvas").getContext("webgl2");
  if (!context || !window.THREE) return;
  const header = JSON.parse(root.querySelector("script[type='application/json']").textContent);
  root.querySelector(".screen").hidden = false;
  const view = root.view = new View(root, header, context);
  await view.showState(0);
  root.querySelector(".fallback").hidden = true;
  for (const plot of header.plots) {
    const picture = document.querySelector(`[data-picture="${plot.picture}"]`), holder = document.createElement("div");
    if (!picture) continue;
    holder.className = "dem-plot";
    picture.after(holder);
    drawPlot(holder, plot);
    picture.classList.add("dem-view-replaced");
  }
}

document.querySelectorAll(".dem-view").forEach(root => start(root));
})();
