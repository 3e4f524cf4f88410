package fcc.android

import java.io.File
import org.json.JSONArray
import org.json.JSONObject

/**
 * A guided calibration of the sensors of a configuration: it begins at once, and when all
 * is there it stores what was found where flights use it. [kind] is one of [offered].
 *
 * @throws FccException if it cannot begin.
 */
class Calibration(config: String, recordings: File, kind: String, packageName: String = "fcc.android") : AutoCloseable {
    private val handle = Native.loaded().calibrate(config, recordings.path, packageName, kind)

    /** What is to be done next, and how far it is. */
    fun state() = CalibrationState(JSONObject(Native.calibration(handle)))

    /** Gives it up, if it is not complete; without effect the second time. */
    override fun close() = Native.endCalibration(handle)

    companion object {
        /**
         * What a configuration has sensors for, in the order in which it is best done.
         *
         * @throws FccException if the configuration or what was found before is wrong.
         */
        fun offered(config: String, recordings: File): List<CalibrationOffer> =
            JSONArray(Native.loaded().calibrations(config, recordings.path)).objects()
                .map { CalibrationOffer(it.getString("kind"), it.text("found")) }
    }
}

/** A kind of calibration, and what was found of it before. */
data class CalibrationOffer(val kind: String, val found: String?)

/** The state of a calibration; see android/README.md. */
class CalibrationState(state: JSONObject) {
    val kind: String = state.getString("kind")
    val beforehand: String = state.getString("beforehand")

    /** Empty before the first reading. */
    val next: String = state.getString("next")

    /** 0 to 1. */
    val progress = state.getDouble("progress")
    val isAtRest = state.getBoolean("at_rest")
    val held = state.texts("held")
    val missing = state.texts("missing")
    val covered = state.number("covered")

    /** What was found and stored, or why nothing was; neither while it goes on. */
    val found = state.text("found")
    val refused = state.text("refused")

    /** Whether it goes on. */
    val isRunning get() = found == null && refused == null
}
