package fcc.android

import android.os.Handler
import android.os.Looper
import java.util.concurrent.ExecutorService
import java.util.concurrent.Executors

/**
 * Commands of the screens, away from the thread that draws: a command waits for the
 * tick that carries it out.
 */
object Commands {
    private val main = Handler(Looper.getMainLooper())
    private val inTheirOrder = threadOf("commands")

    /** Waits for no other command. */
    private val disengaging = threadOf("disengage")

    /** Engages; [refused] is called with the reason if it may not. */
    fun engage(refused: (String) -> Unit) = send(inTheirOrder, refused) { Flight.engage() }

    /** Disengages. */
    fun disengage(refused: (String) -> Unit) = send(disengaging, refused) { Flight.disengage() }

    /** Changes a set point. */
    fun set(name: String, value: Double, refused: (String) -> Unit) =
        send(inTheirOrder, refused) { Flight.set(name, value) }

    private fun send(by: ExecutorService, refused: (String) -> Unit, command: () -> Unit) {
        by.execute {
            try {
                command()
            } catch (error: FccException) {
                main.post { refused(error.message.orEmpty()) }
            }
        }
    }

    private fun threadOf(name: String) = Executors.newSingleThreadExecutor { Thread(it, name) }
}
