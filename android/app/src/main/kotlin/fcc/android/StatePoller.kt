package fcc.android

import android.os.Handler
import android.os.HandlerThread
import android.os.Looper

/**
 * Reads the flight's state regularly in a thread of its own, and hands it to the
 * thread that draws: never more than one at a time.
 */
class StatePoller(private val everyMs: Long, private val show: (FlightState) -> Unit) {
    private val main = Handler(Looper.getMainLooper())
    private var thread: HandlerThread? = null

    /** Begins, if it does not run. */
    fun start() {
        if (thread != null) return
        val thread = HandlerThread("state").also { it.start() }
        this.thread = thread
        poll(thread, Handler(thread.looper))
    }

    /** Ends; nothing is shown after it, if the thread that draws calls it. */
    fun stop() {
        thread?.quit()
        thread = null
    }

    private fun poll(of: HandlerThread, handler: Handler) {
        handler.post {
            val state = Flight.state()
            main.post {
                if (thread === of) {
                    show(state)
                    handler.postDelayed({ poll(of, handler) }, everyMs)
                }
            }
        }
    }
}
