package fcc.android

import android.os.Handler
import android.os.HandlerThread
import android.os.Looper

/**
 * Reads a state regularly in a thread of its own, and hands it to the thread that draws:
 * never more than one at a time.
 */
class StatePoller<T>(private val everyMs: Long, private val read: () -> T, private val show: (T) -> Unit) {
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
            val state = read()
            main.post {
                if (thread === of) {
                    show(state)
                    handler.postDelayed({ poll(of, handler) }, everyMs)
                }
            }
        }
    }
}
