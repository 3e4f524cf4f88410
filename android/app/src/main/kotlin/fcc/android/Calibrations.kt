package fcc.android

import android.content.Context
import java.util.concurrent.Executors

/**
 * The calibration of this process, if there is one: it outlives an activity that is made
 * anew when the phone is turned, and ends before a flight begins.
 */
object Calibrations {
    private val worker = Executors.newSingleThreadExecutor { Thread(it, "calibrations") }

    @Volatile
    private var running: Calibration? = null

    @Volatile
    private var offered = emptyList<CalibrationOffer>()

    @Volatile
    private var problem: String? = null

    /** Whether the one that goes on may find what is not [offered] yet. */
    private var wasRunning = false

    /** What there is to be shown; nothing is offered while one goes on, or something flies. */
    data class Shown(val state: CalibrationState?, val offered: List<CalibrationOffer>, val problem: String?)

    /** The state now. */
    fun shown(context: Context): Shown {
        val state = try {
            running?.state()
        } catch (_: ClosedException) {
            // It has been ended meanwhile.
            null
        }
        val isRunning = state?.isRunning == true
        if (wasRunning && !isRunning) look(context)
        wasRunning = isRunning
        val isIdle = !isRunning && Flight.phase == Phase.IDLE
        return Shown(state, if (isIdle) offered else emptyList(), problem)
    }

    /** Reads what is offered by the configuration that is saved. */
    fun look(context: Context) = inTurn {
        offered = emptyList()
        offered = Calibration.offered(Configuration(context).text(), Recordings.folder(context))
    }

    /** Begins one, in place of any other. */
    fun begin(context: Context, kind: String) = inTurn {
        close()
        if (Flight.phase == Phase.IDLE) {
            running = Calibration(Configuration(context).text(), Recordings.folder(context), kind)
        }
    }

    /** Gives up the one that goes on, or forgets the one that has ended. */
    fun end() = inTurn(::close)

    private fun inTurn(work: () -> Unit) = worker.execute {
        problem = try {
            work()
            null
        } catch (error: FccException) {
            error.message
        }
    }

    private fun close() {
        running?.close()
        running = null
    }
}
