package fcc.android

import org.json.JSONArray
import org.json.JSONObject

/** What a flight does as a whole. */
enum class Phase {
    /** Nothing flies. */
    IDLE,

    /** It is being assembled. */
    BEGINNING,

    /** Its loop runs. */
    FLYING,

    /** Its controls are being released, its recording finished. */
    ENDING,
}

/** The state of the flight for the screens: what android/README.md describes as JSON. */
class FlightState(val phase: Phase, state: JSONObject = JSONObject()) {
    /** Why the last flight did not begin, or why it ended. */
    val ending = state.text("ending")
    val sources = state.texts("sources")
    val actuators = state.texts("actuators")
    val remarks = state.texts("remarks")
    val now = state.optJSONObject("now")?.let(::Tick)
    val granted = state.optJSONObject("granted")?.let(::Granted)
    val performanceHints = state.optJSONObject("performance_hints")?.let(::PerformanceHints)
    val timing = state.optJSONObject("timing")?.let(::Timing)
    val recording = state.optJSONObject("recording")?.let(::RecordingProgress)
    val sensors = state.objects("sensors").map(::SensorHealth)

    /** The newest events, oldest first. */
    val reports = state.objects("reports").map { it.getString("text") }
}

/** The newest tick of the loop; what was never measured is null. */
class Tick(now: JSONObject) {
    val timeS = now.getDouble("time_s")

    /** `standby`, `engaged`, `failsafe` or `stopped`. */
    val state: String = now.getString("state")
    val mode: String = now.getString("mode")
    val engageInhibits = now.texts("engage_inhibits")
    val faults = now.texts("faults")
    val readings = now.objects("readings").map(::Reading)
    val rollRad = now.number("roll_rad")
    val pitchRad = now.number("pitch_rad")
    val headingRad = now.number("heading_rad")
    val airspeedMps = now.number("airspeed_mps")
    val altitudeM = now.number("altitude_m")
    val altitudeReference: String = now.getString("altitude_reference")
    val desired = now.optJSONObject("desired")?.let(::Desired)
    val latenessUs = now.number("lateness_us") ?: 0.0
    val missed = now.getLong("missed")
    val overruns = now.getLong("overruns")

    /** Whether nothing arrives, from whatever source: of all readings none is of this second. */
    val isSilent get() = timeS > SILENT_S && readings.all { it.ageMs > SILENT_S * 1e3 }

    /** Whether the autopilot moves the controls, or holds them. */
    val hasControl get() = state == "engaged" || state == "failsafe"
}

/** `failsafe.sensor_max_age_ms`, and when the library calls a receiver silent. */
private const val OLD_MS = 250.0
private const val OLD_FIX_MS = 3_000.0

/** Simulators, boards and phones give something some times in a second. */
private const val SILENT_S = 1.0

/** Set points, the altitude above the same as that of the tick. */
class Desired(desired: JSONObject) {
    val headingRad = desired.getDouble("heading_rad")
    val airspeedMps = desired.getDouble("airspeed_mps")
    val altitudeM = desired.getDouble("altitude_m")
}

/** A reading, and from which of the sources it is. */
class Reading(reading: JSONObject) {
    val name: String = reading.getString("name")
    val source = reading.getInt("source")
    val ageMs = reading.getDouble("age_ms")

    /** Older than the loop permits by default; receivers give a position a second. */
    val isOld get() = ageMs > if (name == "satellite navigation") OLD_FIX_MS else OLD_MS
}

/** What the kernel granted the loop's thread. */
class Granted(granted: JSONObject) {
    val policy: String = granted.optString("policy")
    val nice = granted.optInt("nice")
}

/** Performance hints for the loop's thread. */
class PerformanceHints(hints: JSONObject) {
    /** Whether there is a session. */
    val session = hints.getBoolean("session")

    /** Why there is none. */
    val why = hints.text("why")

    /** How long the system was told that a tick may take. */
    val targetUs = hints.getDouble("target_us")
}

/** The statistics of the loop's timing, of a flight or a recording. */
class Timing(timing: JSONObject) {
    private val period = timing.getJSONObject("period_ms")
    private val lateness = timing.getJSONObject("lateness_us")
    val rateHz = timing.getDouble("rate_hz")
    val timer: String = timing.getString("timer")
    val ticks = timing.getLong("ticks")
    val missed = timing.getLong("missed")
    val meanMs = period.number("mean") ?: 0.0
    val medianMs = period.number("median") ?: 0.0
    val minMs = period.number("min") ?: 0.0
    val maxMs = period.number("max") ?: 0.0

    /** The part of the periods within 2 % of the nominal one. */
    val within2Percent = period.number("within_2_percent") ?: 0.0
    val latenessP50Us = lateness.number("p50") ?: 0.0
    val latenessP99Us = lateness.number("p99") ?: 0.0
    val latenessMaxUs = lateness.number("max") ?: 0.0
}

/** How far the recorder is. */
class RecordingProgress(recording: JSONObject) {
    /** The path of what is written now. */
    val file = recording.text("file")
    val bytes = recording.getLong("bytes")
    val notRecorded = recording.getLong("not_recorded")
    val stopped = recording.text("stopped")
}

/** A sensor of the phone. */
class SensorHealth(sensor: JSONObject) {
    val kind: String = sensor.getString("kind")
    val name: String = sensor.getString("name")
    val isUncalibrated = sensor.getBoolean("is_uncalibrated")
    val askedHz = sensor.number("asked_hz")
    val measuredHz = sensor.number("measured_hz")
    val clock = sensor.text("clock")
    val accuracy = sensor.text("accuracy")
    val ageMs = sensor.number("age_ms")
    val trouble = sensor.text("trouble")

    /** Whether it gives less than half of what it was asked for. */
    val isSlow get() = measuredHz != null && askedHz != null && measuredHz < askedHz / 2
}

internal fun JSONObject.number(name: String): Double? = if (isNull(name)) null else getDouble(name)

internal fun JSONObject.text(name: String): String? = if (isNull(name)) null else getString(name)

internal fun JSONObject.texts(name: String): List<String> =
    optJSONArray(name)?.let { array -> List(array.length()) { array.getString(it) } } ?: emptyList()

internal fun JSONObject.objects(name: String): List<JSONObject> =
    optJSONArray(name)?.objects() ?: emptyList()

internal fun JSONArray.objects(): List<JSONObject> = List(length()) { getJSONObject(it) }
