package fcc.android

import android.content.ComponentName
import android.content.Context
import android.content.Intent
import android.content.ServiceConnection
import android.os.IBinder
import android.os.Parcel
import android.os.ParcelFileDescriptor
import android.os.RemoteException
import java.io.IOException

/**
 * Connects this process, for as long as it lives, with [ReleaseService], which its
 * flights tell what they hold; again, if the system has ended that process.
 */
object ReleaseLink : ServiceConnection {
    private var isBound = false

    /** Begins; without effect the second time. Of an app in the foreground. */
    fun open(app: Context) {
        if (isBound) return
        val service = Intent(app, ReleaseService::class.java)
        try {
            app.startService(service)
        } catch (_: IllegalStateException) {
            // In the background: bound, it lives as long as this process.
        }
        isBound = app.bindService(service, this, Context.BIND_AUTO_CREATE or Context.BIND_IMPORTANT)
    }

    override fun onServiceConnected(name: ComponentName, service: IBinder) {
        try {
            val native = Native.loaded()
            val (read, write) = ParcelFileDescriptor.createPipe()
            val data = Parcel.obtain()
            read.use {
                data.writeFileDescriptor(it.fileDescriptor)
                service.transact(ReleaseService.PIPE, data, null, IBinder.FLAG_ONEWAY)
            }
            data.recycle()
            native.tellHelper(write.detachFd())
        } catch (_: LibraryException) {
            // So nothing flies.
        } catch (_: IOException) {
            // The flight says that it has none.
        } catch (_: RemoteException) {
            // It has ended: the system starts it again.
        }
    }

    override fun onServiceDisconnected(name: ComponentName) = Unit
}
