package fcc.android

import java.io.File
import java.util.concurrent.atomic.AtomicBoolean
import kotlin.concurrent.thread
import org.json.JSONObject

/**
 * The flight of this process. It belongs to [FlightService] and outlives every
 * screen; the screens read its state and send commands.
 */
object Flight {
    @Volatile
    private var computer: FlightComputer? = null

    /** Why the last flight did not begin. */
    @Volatile
    private var refusal: String? = null

    @Volatile
    var phase = Phase.IDLE
        internal set

    private val isLeftLookedFor = AtomicBoolean()

    /**
     * Releases what an earlier process that was killed has left held, once in a process,
     * until a flight begins, which does it itself; [became] is what the user is told, in
     * another thread.
     */
    fun releaseLeft(recordings: File, became: (String) -> Unit) {
        if (isLeftLookedFor.getAndSet(true)) return
        thread(name = "release-left") {
            try {
                Native.loaded().releaseLeft(recordings.path).takeIf { it.isNotEmpty() }?.let(became)
            } catch (_: FccException) {
                // Whoever starts a flight is told.
            }
        }
    }

    /** The state now. Not for the thread that draws. */
    fun state(): FlightState {
        val phase = phase
        refusal?.let { return FlightState(phase, JSONObject().put("ending", it)) }
        val computer = computer ?: return FlightState(phase)
        return try {
            FlightState(phase, JSONObject(computer.state()))
        } catch (_: ClosedException) {
            // Another flight begins.
            FlightState(phase)
        }
    }

    /** Engages. */
    fun engage() = flown().engage()

    /** Disengages, and releases the controls. */
    fun disengage() = flown().disengage()

    /** Changes a set point, by its name in android/README.md. */
    fun set(name: String, value: Double) = flown().set(mapOf(name to value))

    /** For [FlightComputer.position]: the flight, if there is one. */
    internal fun ifFlying(): FlightComputer? = computer?.takeIf { phase == Phase.FLYING }

    /**
     * Begins a flight; returns when its loop runs.
     *
     * @throws FccException if it cannot.
     */
    internal fun begin(config: String, recordings: File, listener: Listener) {
        computer?.close()
        computer = null
        refusal = null
        val next = FlightComputer(config, recordings, listener)
        computer = next
        next.start()
    }

    /** The flight did not begin; what the user is told. */
    internal fun refuse(why: String) {
        refusal = why
    }

    /** Ends the flight; returns when the controls are released. */
    internal fun end() {
        computer?.stop()
    }

    private fun flown(): FlightComputer =
        computer?.takeIf { phase == Phase.FLYING } ?: throw CommandException("nothing flies: start first")
}
