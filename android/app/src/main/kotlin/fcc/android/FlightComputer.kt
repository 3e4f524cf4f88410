package fcc.android

import java.io.File
import org.json.JSONObject

/**
 * A flight control computer: one configuration, flown any number of times.
 *
 * [config] is the text that `fccd` reads from its file; [recordings] replaces its
 * `recording.folder`; [packageName] is the app's, to which Android gives the phone's
 * sensors. All methods may be called from any thread. Of [start],
 * [stop], [close] and the commands each may wait, and none is for the thread that
 * draws.
 *
 * @throws ConfigException if the configuration cannot be flown.
 */
class FlightComputer(
    config: String,
    recordings: File,
    listener: Listener? = null,
    packageName: String = "fcc.android",
) : AutoCloseable {
    private val handle = Native.loaded().create(config, recordings.path, packageName, listener)

    /**
     * Begins a flight; returns when its loop runs.
     *
     * @throws FlightException if it flies already, or cannot.
     */
    fun start() = Native.start(handle)

    /**
     * Ends the flight, if there is one; returns when the controls are released and
     * the recording is finished: within some seconds if the plant does not answer.
     */
    fun stop() = Native.stop(handle)

    /** The state now, as JSON: see android/README.md. Never waits for the loop. */
    fun state(): String = Native.state(handle)

    /**
     * Engages; the tick that did.
     *
     * @throws CommandException with the reasons if it may not engage.
     */
    fun engage(): Long = Native.command(handle, "\"Engage\"")

    /** Disengages and releases the controls; the tick that did. */
    fun disengage(): Long = Native.command(handle, "\"Disengage\"")

    /**
     * Changes set points, by the names that android/README.md lists; the tick that
     * did.
     *
     * @throws CommandException if one is unknown or out of its limits, or if it is
     * not engaged.
     */
    fun set(setpoints: Map<String, Double>): Long {
        // JSON has neither NaN nor infinity.
        setpoints.entries.find { !it.value.isFinite() }?.let { (name, value) ->
            throw CommandException("$name is $value, which is no command: give a number")
        }
        val pairs = setpoints.entries.joinToString(",") { (name, value) -> "[${JSONObject.quote(name)},$value]" }
        return Native.command(handle, "{\"Set\":[$pairs]}")
    }

    /**
     * Hands a position of the location service in, for a flight with a sensor of the
     * kind `phone`; without effect otherwise. The names are those of
     * `android.location.Location`; NaN is what it does not know. [altitudeM] is above
     * mean sea level, and [bearingDeg] may be NaN only while it stands.
     */
    @Suppress("LongParameterList")
    fun position(
        elapsedRealtimeNs: Long,
        latitudeDeg: Double,
        longitudeDeg: Double,
        altitudeM: Double,
        speedMps: Double,
        bearingDeg: Double = Double.NaN,
        horizontalAccuracyM: Double = Double.NaN,
        verticalAccuracyM: Double = Double.NaN,
        speedAccuracyMps: Double = Double.NaN,
    ) = Native.position(
        handle,
        elapsedRealtimeNs,
        latitudeDeg,
        longitudeDeg,
        altitudeM,
        speedMps,
        bearingDeg,
        horizontalAccuracyM,
        verticalAccuracyM,
        speedAccuracyMps,
    )

    /** The recordings in the folder, oldest first, as JSON: as `fccd list --json` prints them. */
    fun recordings(): String = Native.recordings(handle)

    /** Ends the flight, and frees what is native; without effect the second time. */
    override fun close() = Native.close(handle)

    companion object {
        /**
         * A report on a recording, as JSON: as `fccd report --json` prints it. Reads the
         * whole file.
         *
         * @throws RecordingException if it is no recording of a flight, or cannot be read.
         */
        fun report(recording: File): String = Native.loaded().report(recording.path)
    }
}
