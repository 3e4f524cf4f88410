package fcc.android

import android.app.Service
import android.content.Intent
import android.os.Binder
import android.os.Handler
import android.os.IBinder
import android.os.Looper
import android.os.Parcel
import android.os.ParcelFileDescriptor
import kotlin.concurrent.thread

/**
 * In a process of its own: it waits at the end of a pipe for the end of the app's main
 * process, and releases the controls that are held then.
 *
 * It is started, and not only bound, so that the system lets it go on for a while after
 * the main process has ended. A *force stop* ends both.
 */
class ReleaseService : Service() {
    private val main = Handler(Looper.getMainLooper())
    private var served = 0

    private val binder = object : Binder() {
        override fun onTransact(code: Int, data: Parcel, reply: Parcel?, flags: Int): Boolean {
            if (code != PIPE) return super.onTransact(code, data, reply, flags)
            val pipe = data.readFileDescriptor() ?: return false
            main.post { serve(pipe) }
            return true
        }
    }

    private fun serve(pipe: ParcelFileDescriptor) {
        served += 1
        thread(name = "release") {
            Native.loaded().helpRelease(pipe.detachFd(), Recordings.folder(this).path)
            main.post {
                served -= 1
                if (served == 0) stopSelf()
            }
        }
    }

    override fun onStartCommand(intent: Intent?, flags: Int, startId: Int) = START_NOT_STICKY

    override fun onBind(intent: Intent?): IBinder = binder

    internal companion object {
        /** A pipe's end to read from follows. */
        const val PIPE = IBinder.FIRST_CALL_TRANSACTION
    }
}
