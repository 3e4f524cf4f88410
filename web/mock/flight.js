// A simulated flight along a plan, for developing and testing the page without the
// station: kinematics alone, columns with the names of a recording.

const EARTH_M = 6371008.8;
const RAD = Math.PI / 180;
const G = 9.80665;
const NEVER = -(2n ** 63n);

const MODES = ["none", "hold", "timed pattern", "plan", "loiter", "go to", "return", "takeoff", "land", "go around", "glide"];
const STATES = ["standby", "engaged", "failsafe", "stopped"];
const CONTINGENCIES = ["none", "position lost", "commander lost", "fence", "battery low", "engine out", "terrain"];
const FLAGS = [
  "attitude is missing", "heading is missing", "body rates are missing", "specific force is missing",
  "airspeed is missing", "altitude is missing", "the simulator's time jumped", "the simulator is paused",
  "too slow", "bank or pitch beyond 60°, or a spin", "the simulator's time has stopped",
  "the engage switch is silent", "navigation is settling",
];

const f = (name, unit = "") => ({ name, unit, kind: "f64" });
const u = (name, unit = "") => ({ name, unit, kind: "u64" });
const taken = (name) => ({ name: `${name}_taken_ns`, unit: "ns", kind: "i64" });
const named = (name, names) => ({ name, unit: "", kind: "enum", names });

export const COLUMNS = [
  u("tick"), { name: "scheduled_ns", unit: "ns", kind: "i64" }, { name: "woke_ns", unit: "ns", kind: "i64" }, u("missed"), f("dt_s", "s"),
  ...["sensors", "estimate", "guide", "control", "actuators", "total"].map((stage) => u(`${stage}_time_ns`, "ns")),
  f("pitch_rad", "rad"), f("roll_rad", "rad"), taken("attitude"), f("heading_rad", "rad"), taken("heading"),
  f("airspeed_mps", "m/s"), taken("airspeed"), f("altitude_m", "m"), taken("altitude"),
  f("latitude_rad", "rad"), f("longitude_rad", "rad"), f("position_altitude_m", "m"), taken("position"),
  taken("body_rates"), taken("gnss"), f("gnss_horizontal_accuracy_m", "m"), f("battery_voltage_v", "V"), f("battery_charge"), taken("battery"),
  f("weight_on_wheels"), taken("weight_on_wheels"), { name: "engage_switch", unit: "", kind: "enum", names: ["off", "on"] }, taken("engage_switch"),
  ...["roll", "pitch", "heading"].map((one) => f(`estimated_${one}_rad`, "rad")),
  f("estimated_airspeed_mps", "m/s"), f("estimated_true_airspeed_mps", "m/s"), f("estimated_altitude_m", "m"), f("estimated_climb_rate_mps", "m/s"),
  f("estimated_side_force_mps2", "m/s²"), f("estimated_load_factor"), f("estimated_latitude_rad", "rad"), f("estimated_longitude_rad", "rad"),
  f("estimated_north_mps", "m/s"), f("estimated_east_mps", "m/s"), f("estimated_wind_north_mps", "m/s"), f("estimated_wind_east_mps", "m/s"),
  f("estimated_position_uncertainty_m", "m"), f("estimated_reading_age_s", "s"), f("estimated_reading_jitter_s", "s"),
  f("desired_airspeed_mps", "m/s"), f("desired_heading_rad", "rad"), f("desired_altitude_m", "m"), f("desired_roll_rad", "rad"),
  f("desired_climb_rate_mps", "m/s"), f("desired_pitch_rad", "rad"), named("desired_guidance_mode", MODES), u("desired_guidance_item"),
  f("desired_guidance_elapsed_s", "s"), f("desired_altimeter_setting_pa", "Pa"), f("desired_course_rad", "rad"), f("desired_cross_track_m", "m"),
  f("desired_to_go_m", "m"), u("desired_plan_hash"), u("desired_plan_uploaded_unix_s", "s"), named("desired_contingency", CONTINGENCIES),
  ...["throttle", "elevator", "aileron", "rudder"].map((one) => f(`commanded_${one}`)),
  u("sensor_faults"), u("actuator_faults"), u("records_dropped"), u("overruns"), u("page_faults"), u("early_wake_ns", "ns"),
  named("state", STATES), { name: "engage_inhibits", unit: "", kind: "flags", names: FLAGS }, { name: "faults", unit: "", kind: "flags", names: FLAGS },
];

export const toWords = (row) => {
  const buffer = Buffer.alloc(COLUMNS.length * 8);
  COLUMNS.forEach((column, index) => {
    const value = row[column.name] ?? 0;
    if (column.kind === "f64") buffer.writeDoubleLE(Number(value), index * 8);
    else if (column.kind === "i64") buffer.writeBigInt64LE(typeof value === "bigint" ? value : BigInt(Math.round(value)), index * 8);
    else buffer.writeBigUInt64LE(typeof value === "bigint" ? value : BigInt(Math.round(value)), index * 8);
  });
  return buffer;
};

const wrap = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

/** A repeatable sequence in place of chance. */
function randomOf(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 4294967296 - 0.5;
  };
}

export class SimulatedFlight {
  constructor(plan, { wind = [-3, 4], seed = 1, hash = 0n } = {}) {
    this.random = randomOf(seed);
    this.wind = wind;
    this.events = [];
    this.tick = 0;
    this.time_s = 0;
    this.state = 0;
    this.mode = 0;
    this.battery = 1;
    this.noise = { speed: 0, roll: 0 };
    this.set = { airspeed_mps: 45, heading_rad: 0, altitude_m: 250 };
    this.load(plan, hash);
    const home = plan.home;
    this.home = home;
    Object.assign(this, { north: 0, east: 0, altitude: home.altitude_m, speed: 0, heading: 0, roll: 0, pitch: 0, climb: 0, item: 0, elapsed: 0 });
  }

  load(plan, hash) {
    this.plan = plan;
    this.hash = hash;
    this.uploaded = Math.floor(Date.now() / 1000);
  }

  offset(place) {
    return [(place.latitude_deg - this.home.place.latitude_deg) * RAD * EARTH_M,
      (place.longitude_deg - this.home.place.longitude_deg) * RAD * EARTH_M * Math.cos(this.home.place.latitude_deg * RAD)];
  }

  event(text, code) {
    this.events.push({ tick: this.tick, time_s: this.time_s, text, code });
  }

  enter(mode, item = 0) {
    if (mode !== this.mode) this.event(`mode: ${MODES[mode]}, was ${MODES[this.mode]}`, 18);
    this.mode = mode;
    this.item = item;
    this.elapsed = 0;
  }

  command(command) {
    if (command === "engage") {
      if (this.state === 1) return "it is engaged already";
      this.state = 1;
      this.event("standby -> engaged", 1);
      this.resume = 0;
      if (this.altitude < this.home.altitude_m + 5) this.enter(7, 1);
      else this.next(0);
      return null;
    }
    if (this.state !== 1) return "it is not engaged: engage first";
    if (command === "disengage") {
      this.state = 0;
      this.event("engaged -> standby", 1);
      this.enter(0);
    } else if (command === "pause") {
      this.resume = this.item;
      this.circle = [this.north, this.east];
      this.enter(4);
    } else if (command === "resume") {
      this.enter(3, this.resume || 1);
    } else if (command === "return") {
      this.circle = [0, 0];
      this.enter(6);
    } else if (command === "land") {
      this.enter(8, this.plan.items.length);
    } else if (command.go_to) {
      this.resume = this.item;
      this.circle = this.offset(command.go_to);
      this.set.altitude_m = command.go_to.altitude_m;
      this.enter(5);
    } else if (command.set) {
      Object.assign(this.set, command.set);
      if (this.mode !== 1) this.enter(1);
    } else return "there is no such command";
    this.event(`command: ${typeof command === "string" ? command : Object.keys(command)[0]}`, 2);
    return null;
  }

  next(from) {
    let item = from;
    while (item < this.plan.items.length) {
      const one = this.plan.items[item];
      item += 1;
      if (one.kind === "change-speed") this.set.airspeed_mps = one.speed?.["airspeed-mps"] ?? this.set.airspeed_mps;
      else if (one.place) return this.enter(one.kind === "land" ? 8 : 3, item);
    }
    this.circle = [this.north, this.east];
    this.enter(4);
    this.event("the plan is flown to its end: circling", 20);
  }

  /** Bearing to fly, and what is left. */
  target() {
    const item = this.plan.items[this.item - 1];
    const place = item?.place;
    const to = this.mode === 3 || this.mode === 7 || this.mode === 8 ? (place ? this.offset(place) : [1e5, 0]) : (this.circle ?? [0, 0]);
    const away = [to[0] - this.north, to[1] - this.east];
    const left = Math.hypot(...away);
    if (this.mode >= 4 && this.mode <= 6 && left < 900) {
      const outward = Math.atan2(-away[1], -away[0]);
      return { bearing: outward + Math.PI / 2 + clamp((left - 600) / 500, -1, 1), left };
    }
    return { bearing: Math.atan2(away[1], away[0]), left };
  }

  step(dt) {
    this.tick += 1;
    this.time_s += dt;
    this.elapsed += dt;
    this.noise.speed += (-this.noise.speed * 0.5 + this.random() * 3) * dt;
    this.noise.roll += (-this.noise.roll * 0.8 + this.random() * 0.5) * dt;
    this.battery = Math.max(0, this.battery - dt / 5000);
    const ground = this.home.altitude_m;
    const onGround = this.altitude <= ground + 0.3;
    const { bearing, left } = this.target();
    let wanted = this.set.altitude_m;
    let speed = this.state === 1 ? this.set.airspeed_mps : 0;
    let heading = this.mode === 1 ? this.set.heading_rad : bearing;
    const item = this.plan.items[this.item - 1];
    if (this.mode === 3 || this.mode === 7) {
      const above = item?.altitude?.above === "sea-level" ? 0 : this.home.altitude_m;
      if (item?.altitude) wanted = item.altitude.m + above;
    }
    if (this.mode === 6) wanted = ground + 150;
    if (this.mode === 8) {
      wanted = ground + Math.max(0, Math.min(left, 6000) * 0.06 - 20);
      speed = onGround ? 0 : 36;
    }
    if (this.mode === 7 && onGround) heading = this.heading;
    const drift = Math.asin(clamp((this.wind[1] * Math.cos(heading) - this.wind[0] * Math.sin(heading)) / Math.max(20, this.speed), -0.5, 0.5));
    const steer = this.mode === 1 ? 0 : -drift;
    const error = wrap(heading + steer - this.heading);
    this.desired_roll = onGround ? 0 : clamp(error * 1.4, -0.5, 0.5);
    this.roll += clamp(this.desired_roll - this.roll, -0.6 * dt, 0.6 * dt) + (onGround ? 0 : this.noise.roll * dt);
    if (this.speed > 5) this.heading = (this.heading + (G * Math.tan(this.roll)) / Math.max(20, this.speed) * dt + 2 * Math.PI) % (2 * Math.PI);
    this.speed = Math.max(0, this.speed + clamp(speed - this.speed, -2.5 * dt, 2 * dt) + (onGround ? 0 : this.noise.speed * dt));
    this.desired_climb = this.state === 1 && this.speed > 28 ? clamp((wanted - this.altitude) * 0.3, -4, 4.5) : 0;
    this.climb += clamp(this.desired_climb - this.climb, -2 * dt, 2 * dt);
    if (onGround && this.climb < 0) this.climb = 0;
    this.altitude = Math.max(ground, this.altitude + this.climb * dt);
    this.pitch = onGround && this.speed < 28 ? 0 : Math.asin(clamp(this.climb / Math.max(20, this.speed), -0.4, 0.4)) + 0.035;
    this.vn = this.speed * Math.cos(this.heading) + (onGround ? 0 : this.wind[0]);
    this.ve = this.speed * Math.sin(this.heading) + (onGround ? 0 : this.wind[1]);
    this.north += this.vn * dt;
    this.east += this.ve * dt;
    this.wanted = { altitude: wanted, heading: (heading + 2 * Math.PI) % (2 * Math.PI), speed, left, bearing };
    if (this.state !== 1) return;
    if (this.mode === 7 && this.altitude > ground + 60) {
      this.event("item 1 of the plan is reached: take-off", 20);
      this.next(1);
    } else if (this.mode === 3 && left < 250) {
      this.event(`item ${this.item} of the plan is reached: ${item.kind}`, 20);
      this.next(this.item);
    } else if (this.mode === 8 && onGround && this.speed < 1) {
      this.event("landed, and stands", 20);
      this.state = 0;
      this.event("engaged -> standby", 1);
      this.enter(0);
    }
  }

  row(now_ns) {
    const latitude = this.home.place.latitude_deg * RAD + this.north / EARTH_M;
    const longitude = this.home.place.longitude_deg * RAD + this.east / EARTH_M / Math.cos(this.home.place.latitude_deg * RAD);
    const jitter = () => Math.round(20 + Math.abs(this.random()) * 60);
    const row = {
      tick: this.tick, scheduled_ns: now_ns, woke_ns: now_ns + jitter(), missed: 0, dt_s: 0.025,
      sensors_time_ns: 9000 + jitter() * 20, estimate_time_ns: 2600 + jitter() * 5, guide_time_ns: 1800 + jitter() * 4,
      control_time_ns: 2300 + jitter() * 4, actuators_time_ns: 6100 + jitter() * 15, total_time_ns: 24000 + jitter() * 50,
      pitch_rad: this.pitch, roll_rad: this.roll, heading_rad: this.heading, airspeed_mps: this.speed, altitude_m: this.altitude,
      latitude_rad: latitude, longitude_rad: longitude, position_altitude_m: this.altitude, gnss_horizontal_accuracy_m: 1.4,
      battery_voltage_v: 22 + 3 * this.battery, battery_charge: this.battery, weight_on_wheels: this.altitude <= this.home.altitude_m + 0.3 ? 1 : 0, engage_switch: 1,
      estimated_roll_rad: this.roll, estimated_pitch_rad: this.pitch, estimated_heading_rad: this.heading, estimated_airspeed_mps: this.speed,
      estimated_true_airspeed_mps: this.speed * 1.01, estimated_altitude_m: this.altitude, estimated_climb_rate_mps: this.climb,
      estimated_side_force_mps2: this.random() * 0.3, estimated_load_factor: 1 / Math.cos(this.roll), estimated_latitude_rad: latitude, estimated_longitude_rad: longitude,
      estimated_north_mps: this.vn ?? 0, estimated_east_mps: this.ve ?? 0, estimated_wind_north_mps: this.wind[0], estimated_wind_east_mps: this.wind[1],
      estimated_position_uncertainty_m: 1.6, estimated_reading_age_s: 0.004, estimated_reading_jitter_s: 0.001,
      desired_airspeed_mps: this.wanted?.speed ?? 0, desired_heading_rad: this.wanted?.heading ?? 0, desired_altitude_m: this.wanted?.altitude ?? this.altitude,
      desired_roll_rad: this.desired_roll ?? 0, desired_climb_rate_mps: this.desired_climb ?? 0, desired_pitch_rad: this.pitch,
      desired_guidance_mode: this.mode, desired_guidance_item: this.item, desired_guidance_elapsed_s: this.elapsed, desired_altimeter_setting_pa: 101325,
      desired_course_rad: wrap(this.wanted?.bearing ?? 0), desired_cross_track_m: this.noise.speed * 2, desired_to_go_m: this.wanted?.left ?? 0,
      desired_plan_hash: this.hash, desired_plan_uploaded_unix_s: this.uploaded, desired_contingency: 0,
      commanded_throttle: this.state === 1 ? 0.65 : 0, commanded_elevator: this.pitch, commanded_aileron: (this.desired_roll ?? 0) - this.roll, commanded_rudder: 0,
      early_wake_ns: 120000, state: this.state, engage_inhibits: this.inhibits ?? 0n, faults: 0n,
    };
    for (const one of ["attitude", "heading", "airspeed", "altitude", "position", "body_rates", "battery", "weight_on_wheels", "engage_switch"])
      row[`${one}_taken_ns`] = this.silent?.has(one) ? row[`${one}_taken_ns`] ?? NEVER : now_ns - 4e6;
    row.gnss_taken_ns = now_ns - 12e7;
    return row;
  }
}
