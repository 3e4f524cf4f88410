// A stand-in for the station that speaks its interface, for developing and testing the
// page. Options: --port N, --drafts FILE (kept over a restart), --time-scale N, --token T.
import { createServer } from "node:http";
import { readFileSync, writeFileSync, existsSync } from "node:fs";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { WebSocketServer } from "ws";
import { COLUMNS, SimulatedFlight, toWords } from "./flight.js";
import { CIRCUIT, check, elevation, hashOf } from "./plan.js";

const option = (name, initial) => {
  const at = process.argv.indexOf(`--${name}`);
  return at < 0 ? initial : process.argv[at + 1];
};
const PORT = Number(option("port", 8461));
const TOKEN = option("token", "mock");
const SCALE = Number(option("time-scale", 1));
const DRAFTS = option("drafts", null);
const DIST = fileURLToPath(new URL("../dist", import.meta.url));
const PERIOD_MS = 25;
const TYPES = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".json": "application/json" };
const CSP = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

const flight = new SimulatedFlight(CIRCUIT, { hash: BigInt(`0x${hashOf(CIRCUIT)}`) });
const started = Date.now() / 1000;
let vehicle = { hash: hashOf(CIRCUIT), uploaded_utc_s: started, plan: CIRCUIT };
const drafts = new Map(DRAFTS && existsSync(DRAFTS) ? JSON.parse(readFileSync(DRAFTS, "utf8")) : []);
if (drafts.size === 0) drafts.set("circuit", { name: "circuit", revision: 1, hash: hashOf(CIRCUIT), plan: CIRCUIT, changed_utc_s: started });
const keep = () => DRAFTS && writeFileSync(DRAFTS, JSON.stringify([...drafts]));
const numbers = new Set();
const live = new Set();
const watching = new Set();

/** Flights flown at once, for the list, the replay and the comparison. */
const flights = new Map();
for (const [index, wind] of [[0, [-3, 4]], [1, [2, -6]]]) {
  const one = new SimulatedFlight(CIRCUIT, { wind, seed: index + 7, hash: flight.hash });
  const rows = [];
  one.event("standby", 1);
  for (let n = 0; n < 40 * 900 && !(n > 200 && one.state === 0); n += 1) {
    if (n === 80) one.command("engage");
    one.step(0.025);
    if (n % 4 === 0) rows.push({ ...one.row(n * 25e6), time_s: one.time_s });
  }
  const start_utc_s = started - 86400 * (index + 1);
  const file = `${new Date(start_utc_s * 1000).toISOString().replaceAll(":", "-")}-mock-0${index + 1}.mcap`;
  flights.set(file, { file, rows, events: one.events, start_utc_s, faults: index === 1 ? ["altimeter excluded for 3 s"] : [] });
}

function thumbnail(rows) {
  const points = rows.filter((_, index) => index % 40 === 0).map((row) => [row.estimated_longitude_rad * 0.707, row.estimated_latitude_rad]);
  const west = Math.min(...points.map((p) => p[0])), south = Math.min(...points.map((p) => p[1]));
  const size = Math.max(Math.max(...points.map((p) => p[0])) - west, Math.max(...points.map((p) => p[1])) - south) || 1;
  return points.map(([x, y]) => [(x - west) / size, (y - south) / size]);
}

const summary = ({ file, rows, start_utc_s, faults }) => ({
  file, instance: "mock", start_utc_s, duration_s: rows.at(-1).time_s, distance_m: rows.reduce((sum, row) => sum + Math.hypot(row.estimated_north_mps, row.estimated_east_mps) * 0.1, 0),
  whole: faults.length === 0, faults, bytes: rows.length * 9000, thumbnail: thumbnail(rows),
});

function data(one, query) {
  const names = ["time_s", ...(query.get("columns") ?? "").split(",").filter((name) => name && name !== "time_s")];
  const points = Number(query.get("points") ?? one.rows.length);
  const every = Math.max(1, Math.ceil(one.rows.length / points));
  const rows = one.rows.filter((_, index) => index % every === 0);
  const columns = names.map((name) => COLUMNS.find((column) => column.name === name) ?? { name, unit: "s", kind: "f64" });
  const header = Buffer.from(JSON.stringify({ columns, rows: rows.length, start_utc_s: one.start_utc_s }));
  const begin = Math.ceil((4 + header.length) / 8) * 8;
  const buffer = Buffer.alloc(begin + names.length * rows.length * 8);
  buffer.writeUInt32LE(header.length, 0);
  header.copy(buffer, 4);
  names.forEach((name, column) => rows.forEach((row, index) => buffer.writeDoubleLE(Number(row[name] ?? NaN), begin + (column * rows.length + index) * 8)));
  return buffer;
}

class Answer extends Error {
  constructor(status, body) {
    super();
    Object.assign(this, { status, body });
  }
}
const need = (value) => value ?? (() => { throw new Answer(404, { error: "there is no such thing: look at the list" }); })();

function envelope(body) {
  if (!(body.deadline_ms_utc > Date.now())) throw new Answer(409, { refused: "the command is late" });
  if (numbers.has(body.number)) throw new Answer(409, { refused: "the command was sent before" });
  numbers.add(body.number);
}

const ROUTES = [
  ["GET", /^\/status$/, ({ authorized }) => ({
    software: "0.1.0 (mock)", writable: authorized, configured: ["mock"],
    daemons: [{ instance: "mock", plant: "simulated aircraft", software: "0.1.0", rate_hz: 40, process_id: 1, guidance_mode: "plan", plan_upload: "flight",
      setpoints: [{ name: "airspeed_mps", unit: "m/s", lowest: 34, highest: 65 }, { name: "heading_rad", unit: "rad", lowest: 0, highest: 6.2832 }, { name: "altitude_m", unit: "m", lowest: -500, highest: 4000 }],
      aircraft: { stall_mps: 28, min_mps: 33, max_mps: 65, never_exceed_mps: 72 } }],
  })],
  ["GET", /^\/live\/mock\/columns$/, () => ({ columns: COLUMNS })],
  ["GET", /^\/live\/mock\/plan$/, () => vehicle],
  ["POST", /^\/live\/mock\/command$/, ({ body }) => {
    envelope(body);
    const refused = flight.command(body.command);
    if (refused) throw new Answer(409, { refused });
    return { carried_out: flight.tick };
  }],
  ["POST", /^\/live\/mock\/plan$/, ({ body }) => {
    envelope(body);
    const draft = need(drafts.get(body.draft));
    if (draft.revision !== body.revision) throw new Answer(409, { refused: `revision ${body.revision} is not the newest` });
    const errors = check(draft.plan).problems.filter((problem) => problem.level === "error");
    if (errors.length > 0) throw new Answer(409, { refused: `item ${errors[0].item}: ${errors[0].message}` });
    vehicle = { hash: draft.hash, uploaded_utc_s: Date.now() / 1000, plan: draft.plan };
    flight.load(draft.plan, BigInt(`0x${draft.hash}`));
    flight.event(`plan ${draft.hash} is flown`, 20);
    return { hash: draft.hash };
  }],
  ["GET", /^\/drafts$/, () => [...drafts.values()].map(({ plan, ...rest }) => ({ ...rest, items: plan.items.length }))],
  ["GET", /^\/drafts\/([^/]+)$/, ({ match }) => need(drafts.get(match[1]))],
  ["PUT", /^\/drafts\/([^/]+)$/, ({ match, body }) => {
    const old = drafts.get(match[1]);
    if ((old?.revision ?? 0) !== (body.based_on ?? 0)) throw new Answer(409, need(old));
    const draft = { name: match[1], revision: (old?.revision ?? 0) + 1, hash: hashOf(body.plan), plan: body.plan, changed_utc_s: Date.now() / 1000 };
    drafts.set(draft.name, draft);
    keep();
    for (const socket of watching) socket.send(JSON.stringify({ name: draft.name, revision: draft.revision }));
    return draft;
  }],
  ["DELETE", /^\/drafts\/([^/]+)$/, ({ match }) => { drafts.delete(match[1]); keep(); return null; }],
  ["POST", /^\/plan\/check$/, ({ body }) => check(body.plan)],
  ["POST", /^\/plan\/import$/, ({ body }) => {
    try {
      return { plan: JSON.parse(body.text).items ? JSON.parse(body.text) : CIRCUIT };
    } catch {
      throw new Answer(400, { problems: [{ item: null, field: null, message: `${body.name} is no plan: expected JSON`, level: "error" }] });
    }
  }],
  ["POST", /^\/plan\/export$/, ({ body }) => Buffer.from(JSON.stringify(body.plan, null, 2))],
  ["GET", /^\/flights$/, () => [...flights.values()].map(summary)],
  ["GET", /^\/flights\/([^/]+)\/data$/, ({ match, query }) => data(need(flights.get(match[1])), query)],
  ["GET", /^\/flights\/([^/]+)\/events$/, ({ match }) => need(flights.get(match[1])).events],
  ["GET", /^\/flights\/([^/]+)\/plan$/, () => ({ hash: hashOf(CIRCUIT), uploaded_utc_s: started, plan: CIRCUIT })],
  ["GET", /^\/flights\/([^/]+)\/aircraft$/, () => ({ stall_mps: 28, min_mps: 33, max_mps: 65, never_exceed_mps: 72 })],
  ["GET", /^\/flights\/([^/]+)\/download$/, () => Buffer.from("mock")],
  ["GET", /^\/flights\/([^/]+)\/report$/, () => Buffer.from("a report")],
  ["GET", /^\/flights\/([^/]+)\/compare\/([^/]+)$/, () => [
    { what: "cross-track RMS", a: 2.1, b: 3.4, unit: "m", sentence: "The second flight is 1.3 m farther off its path, in 2.6 m/s more wind." },
    { what: "altitude RMS", a: 2.4, b: 2.2, unit: "m", sentence: "Both flights hold their altitude within 0.2 m of each other." },
    { what: "lateness p99", a: 0.05, b: 0.05, unit: "µs", sentence: "The loop is as punctual in both flights." },
  ]],
  ["DELETE", /^\/flights\/([^/]+)$/, ({ match }) => { need(flights.get(match[1])); flights.delete(match[1]); return null; }],
  ["GET", /^\/calibration$/, () => ({ kind: "", percent: 0, now: "", lines: [], found: "", exit_code: null })],
  ["GET", /^\/doctor$/, () => [
    { name: "real-time priority", state: "good", found: "SCHED_FIFO 80", advice: null },
    { name: "memory lock", state: "good", found: "allowed", advice: null },
    { name: "CPU frequency", state: "warning", found: "governor is 'schedutil'", advice: "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor" },
    { name: "isolated CPU", state: "warning", found: "none", advice: "add isolcpus=3 to /boot/firmware/cmdline.txt and restart" },
  ]],
  ["GET", /^\/terrain$/, ({ query }) => {
    const n = Math.min(256, Number(query.get("n") ?? 64));
    const [south, west, north, east] = ["south", "west", "north", "east"].map((name) => Number(query.get(name)));
    const elevations = [];
    for (let row = 0; row < n; row += 1)
      for (let column = 0; column < n; column += 1)
        elevations.push(Math.round(elevation(north - ((north - south) * (row + 0.5)) / n, west + ((east - west) * (column + 0.5)) / n)));
    return { n, elevations_m: elevations };
  }],
  ["GET", /^\/map$/, () => ({ pmtiles: null, attribution: "Coast lines: Natural Earth" })],
  // Of the tests alone: sets what the simulated daemon shows.
  ["POST", /^\/mock$/, ({ body }) => {
    if (body.event) flight.event(body.event, 20);
    if (body.inhibits !== undefined) flight.inhibits = BigInt(body.inhibits);
    if (body.pose) Object.assign(flight, { frozen: body.pose });
    if (body.stop !== undefined) flight.stopped = body.stop;
    if (body.end) for (const socket of live) socket.terminate();
    return {};
  }],
];

async function serve(request, response) {
  const url = new URL(request.url, `http://${request.headers.host}`);
  const send = (status, body, type = "application/json") => {
    response.writeHead(status, { "content-type": type, "content-security-policy": CSP, "cache-control": "no-store", "x-content-type-options": "nosniff" });
    response.end(body);
  };
  if (!url.pathname.startsWith("/api/")) {
    const path = join(DIST, normalize(url.pathname === "/" ? "/index.html" : url.pathname));
    if (!path.startsWith(DIST) || !existsSync(path)) return send(404, "not found", "text/plain");
    return send(200, readFileSync(path), TYPES[extname(path)] ?? "application/octet-stream");
  }
  const authorized = request.headers.authorization === `Bearer ${TOKEN}`;
  const path = url.pathname.slice(4);
  for (const [method, pattern, answer] of ROUTES) {
    const match = pattern.exec(path)?.map(decodeURIComponent);
    if (!match || method !== request.method) continue;
    try {
      const text = [];
      for await (const chunk of request) text.push(chunk);
      const reads = path.startsWith("/plan/");
      if (method !== "GET" && !reads && !authorized) throw new Answer(401, { error: "the token is missing: open the link that the station prints" });
      const body = text.length > 0 ? JSON.parse(Buffer.concat(text).toString()) : {};
      const result = await answer({ match, query: url.searchParams, body, authorized });
      if (result === null && method === "DELETE") return send(204, "");
      return Buffer.isBuffer(result) ? send(200, result, path.endsWith("/report") ? "text/html" : "application/octet-stream") : send(200, JSON.stringify(result));
    } catch (error) {
      if (error instanceof Answer) return send(error.status, JSON.stringify(error.body));
      return send(500, JSON.stringify({ error: String(error) }));
    }
  }
  send(404, JSON.stringify({ error: `there is no ${request.method} ${path}` }));
}

const sockets = new WebSocketServer({ noServer: true });
const server = createServer(serve);
server.on("upgrade", (request, socket, head) => {
  const path = new URL(request.url, "http://localhost").pathname;
  sockets.handleUpgrade(request, socket, head, (client) => {
    const group = path === "/api/drafts" ? watching : live;
    group.add(client);
    client.on("close", () => group.delete(client));
    if (group === live) {
      client.send(JSON.stringify({ hello: { columns: COLUMNS, rate_hz: 40, run_started_utc_s: started } }));
      for (const event of flight.events.slice(-64)) client.send(JSON.stringify({ event }));
    }
  });
});

const counts = [4000, 2600, 900, 310, 60, 12, 3, 1, 0, 0, 0, 0, 0, 0];
let told = 0;
let due = performance.now();
function tick() {
  if (!flight.stopped) {
    for (let n = 0; n < SCALE; n += 1) flight.step(PERIOD_MS / 1000);
    const now_ns = Math.round(performance.now() * 1e6);
    const words = toWords({ ...flight.row(now_ns), ...flight.frozen });
    for (const client of live) if (client.bufferedAmount < words.length) client.send(words);
  }
  while (told < flight.events.length) {
    const event = JSON.stringify({ event: flight.events[told] });
    for (const client of live) client.send(event);
    told += 1;
  }
  if (flight.tick % 40 < SCALE) {
    counts[0] += 30;
    counts[1] += 9;
    counts[2] += 1;
    const status = { time_s: flight.time_s, ticks: flight.tick, missed: 0, lateness_p50_us: 0.02, lateness_p99_us: 0.41, lateness_p99_9_us: 3.2, lateness_max_us: 61.4, lateness_counts: counts,
      recorder: "recording", recording: "2026-11-28T07-02-25.959Z-mock-03.mcap", recorded: flight.tick, not_recorded: 0, recording_bytes: flight.tick * 900, watchers: 2, load: [0.34, 0.41, 0.38], processors: 4,
      temperature_c: 51.5, memory_available_bytes: 1.42e9, disk_available_bytes: 11.2e9, station: { clients: live.size, cpu_percent: 1.2, memory_bytes: 14e6 } };
    for (const client of live) client.send(JSON.stringify({ status }));
  }
  due += PERIOD_MS;
  setTimeout(tick, Math.max(0, due - performance.now()));
}
server.listen(PORT, "127.0.0.1", () => console.log(`http://127.0.0.1:${PORT}/#token=${TOKEN}`));
tick();
