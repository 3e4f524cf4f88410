package fcc.android

import android.os.Handler
import android.os.Looper
import java.util.concurrent.ConcurrentHashMap
import java.util.concurrent.Executors

/**
 * Commands of the screens, away from the thread that draws: a command waits for the
 * tick that carries it out. One that waits for its turn is replaced by a newer one of
 * its kind: touches that are faster than the loop do nothing later.
 */
object Commands {
    private val main = Handler(Looper.getMainLooper())
    private val inTheirOrder = Turns("commands")

    /** Waits for no other command. */
    private val disengaging = Turns("disengage")

    /** Engages; [refused] is called with the reason if it may not. */
    fun engage(refused: (String) -> Unit) = inTheirOrder.send("engage", refused) { Flight.engage() }

    /** Disengages. */
    fun disengage(refused: (String) -> Unit) = disengaging.send("disengage", refused) { Flight.disengage() }

    /** Changes a set point. */
    fun set(name: String, value: Double, refused: (String) -> Unit) =
        inTheirOrder.send(name, refused) { Flight.set(name, value) }

    private class Turns(name: String) {
        private val worker = Executors.newSingleThreadExecutor { Thread(it, name) }
        private val waiting = ConcurrentHashMap<String, () -> Unit>()

        fun send(kind: String, refused: (String) -> Unit, command: () -> Unit) {
            val isAlone = waiting.put(kind, { act(refused, command) }) == null
            if (isAlone) worker.execute { waiting.remove(kind)?.invoke() }
        }

        private fun act(refused: (String) -> Unit, command: () -> Unit) = try {
            command()
        } catch (error: FccException) {
            main.post { refused(error.message.orEmpty()) }
            Unit
        }
    }
}
