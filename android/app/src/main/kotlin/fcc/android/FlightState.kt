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

/** The state of the flight for the screens: what docs/android.md describes as JSON. */
data class FlightState(
    val phase: Phase,
    /** Why the last flight did not begin, or why it ended. */
    val ending: String? = null,
    val sources: List<String> = emptyList(),
    val actuators: List<String> = emptyList(),
    val remarks: List<String> = emptyList(),
    val now: Tick? = null,
    val granted: Granted? = null,
    val timing: Timing? = null,
    val recording: RecordingProgress? = null,
    val sensors: List<SensorHealth> = emptyList(),
    /** The newest events, oldest first. */
    val reports: List<String> = emptyList(),
) {
    companion object {
        /** From the library's JSON. */
        fun of(phase: Phase, json: String): FlightState {
            val state = JSONObject(json)
            return FlightState(
                phase = phase,
                ending = state.text("ending"),
                sources = state.texts("sources"),
                actuators = state.texts("actuators"),
                remarks = state.texts("remarks"),
                now = state.optJSONObject("now")?.let(Tick::of),
                granted = state.optJSONObject("granted")?.let(Granted::of),
                timing = state.optJSONObject("timing")?.let(Timing::of),
                recording = state.optJSONObject("recording")?.let(RecordingProgress::of),
                sensors = state.objects("sensors").map(SensorHealth::of),
                reports = state.objects("reports").map { it.getString("text") },
            )
        }
    }
}

/** The newest tick of the loop; what was never measured is null. */
data class Tick(
    val timeS: Double,
    /** `standby`, `engaged`, `failsafe` or `stopped`. */
    val state: String,
    val mode: String,
    val engageInhibits: List<String>,
    val faults: List<String>,
    val readings: List<Reading>,
    val rollRad: Double?,
    val pitchRad: Double?,
    val headingRad: Double?,
    val airspeedMps: Double?,
    val altitudeM: Double?,
    val altitudeReference: String,
    val climbRateMps: Double,
    val desired: Desired?,
    val latenessUs: Double,
    val missed: Long,
    val overruns: Long,
) {
    /** Whether the autopilot moves the controls, or holds them. */
    val hasControl get() = state == "engaged" || state == "failsafe"

    companion object {
        fun of(now: JSONObject) = Tick(
            timeS = now.getDouble("time_s"),
            state = now.getString("state"),
            mode = now.getString("mode"),
            engageInhibits = now.texts("engage_inhibits"),
            faults = now.texts("faults"),
            readings = now.objects("readings").map(Reading::of),
            rollRad = now.number("roll_rad"),
            pitchRad = now.number("pitch_rad"),
            headingRad = now.number("heading_rad"),
            airspeedMps = now.number("airspeed_mps"),
            altitudeM = now.number("altitude_m"),
            altitudeReference = now.getString("altitude_reference"),
            climbRateMps = now.number("climb_rate_mps") ?: 0.0,
            desired = now.optJSONObject("desired")?.let(Desired::of),
            latenessUs = now.number("lateness_us") ?: 0.0,
            missed = now.getLong("missed"),
            overruns = now.getLong("overruns"),
        )
    }
}

/** Set points, the altitude above the same as that of the tick. */
data class Desired(val headingRad: Double, val airspeedMps: Double, val altitudeM: Double) {
    companion object {
        fun of(desired: JSONObject) = Desired(
            headingRad = desired.getDouble("heading_rad"),
            airspeedMps = desired.getDouble("airspeed_mps"),
            altitudeM = desired.getDouble("altitude_m"),
        )
    }
}

/** A reading, and from which of the sources it is. */
data class Reading(val name: String, val source: Int, val ageMs: Double) {
    companion object {
        fun of(reading: JSONObject) = Reading(
            name = reading.getString("name"),
            source = reading.getInt("source"),
            ageMs = reading.getDouble("age_ms"),
        )
    }
}

/** What the kernel granted the loop's thread. */
data class Granted(val policy: String, val nice: Int, val memoryLocked: Boolean) {
    companion object {
        fun of(granted: JSONObject) = Granted(
            policy = granted.optString("policy"),
            nice = granted.optInt("nice"),
            memoryLocked = granted.optBoolean("memory_locked"),
        )
    }
}

/** The statistics of the loop's timing, of a flight or a recording. */
data class Timing(
    val rateHz: Double,
    val timer: String,
    val ticks: Long,
    val missed: Long,
    val meanMs: Double,
    val medianMs: Double,
    val minMs: Double,
    val maxMs: Double,
    /** The part of the periods within 2 % of the nominal one. */
    val within2Percent: Double,
    val latenessP50Us: Double,
    val latenessP99Us: Double,
    val latenessMaxUs: Double,
) {
    companion object {
        fun of(timing: JSONObject): Timing {
            val period = timing.getJSONObject("period_ms")
            val lateness = timing.getJSONObject("lateness_us")
            return Timing(
                rateHz = timing.getDouble("rate_hz"),
                timer = timing.getString("timer"),
                ticks = timing.getLong("ticks"),
                missed = timing.getLong("missed"),
                meanMs = period.number("mean") ?: 0.0,
                medianMs = period.number("median") ?: 0.0,
                minMs = period.number("min") ?: 0.0,
                maxMs = period.number("max") ?: 0.0,
                within2Percent = period.number("within_2_percent") ?: 0.0,
                latenessP50Us = lateness.number("p50") ?: 0.0,
                latenessP99Us = lateness.number("p99") ?: 0.0,
                latenessMaxUs = lateness.number("max") ?: 0.0,
            )
        }
    }
}

/** How far the recorder is. */
data class RecordingProgress(val bytes: Long, val notRecorded: Long, val stopped: String?) {
    companion object {
        fun of(recording: JSONObject) = RecordingProgress(
            bytes = recording.getLong("bytes"),
            notRecorded = recording.getLong("not_recorded"),
            stopped = recording.text("stopped"),
        )
    }
}

/** A sensor of the phone. */
data class SensorHealth(
    val kind: String,
    val name: String,
    val isUncalibrated: Boolean,
    val askedHz: Double?,
    val measuredHz: Double?,
    val clock: String?,
    val accuracy: String?,
    val ageMs: Double?,
    val trouble: String?,
) {
    companion object {
        fun of(sensor: JSONObject) = SensorHealth(
            kind = sensor.getString("kind"),
            name = sensor.getString("name"),
            isUncalibrated = sensor.getBoolean("is_uncalibrated"),
            askedHz = sensor.number("asked_hz"),
            measuredHz = sensor.number("measured_hz"),
            clock = sensor.text("clock"),
            accuracy = sensor.text("accuracy"),
            ageMs = sensor.number("age_ms"),
            trouble = sensor.text("trouble"),
        )
    }
}

internal fun JSONObject.number(name: String): Double? = if (isNull(name)) null else getDouble(name)

internal fun JSONObject.text(name: String): String? = if (isNull(name)) null else getString(name)

internal fun JSONObject.texts(name: String): List<String> =
    optJSONArray(name)?.let { array -> List(array.length()) { array.getString(it) } } ?: emptyList()

internal fun JSONObject.objects(name: String): List<JSONObject> =
    optJSONArray(name)?.objects() ?: emptyList()

internal fun JSONArray.objects(): List<JSONObject> = List(length()) { getJSONObject(it) }
