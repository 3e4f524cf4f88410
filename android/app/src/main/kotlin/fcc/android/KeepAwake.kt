package fcc.android

import android.annotation.SuppressLint
import android.content.Context
import android.net.wifi.WifiManager
import android.os.Build
import android.os.PowerManager

/**
 * Keeps processor and Wi-Fi awake in flight: without it a phone's sensors stop with
 * the screen, Wi-Fi saves power by delaying packets, and X-Plane's beacon, which is
 * multicast, is not received.
 */
class KeepAwake(context: Context) {
    private val processor = context.getSystemService(PowerManager::class.java)
        .newWakeLock(PowerManager.PARTIAL_WAKE_LOCK, "fcc:flight")
    private val wifi = context.applicationContext.getSystemService(WifiManager::class.java)
    private val fast = wifi?.createWifiLock(wifiMode(), "fcc:flight")
    private val multicast = wifi?.createMulticastLock("fcc:flight")

    /** Until it is released: a flight takes as long as it takes. */
    @SuppressLint("WakelockTimeout")
    fun acquire() {
        processor.setReferenceCounted(false)
        processor.acquire()
        fast?.setReferenceCounted(false)
        fast?.acquire()
        multicast?.setReferenceCounted(false)
        multicast?.acquire()
    }

    /** Without effect if it is not held. */
    fun release() {
        if (processor.isHeld) processor.release()
        if (fast?.isHeld == true) fast.release()
        if (multicast?.isHeld == true) multicast.release()
    }

    private fun wifiMode() = if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.Q) {
        WifiManager.WIFI_MODE_FULL_LOW_LATENCY
    } else {
        @Suppress("DEPRECATION")
        WifiManager.WIFI_MODE_FULL_HIGH_PERF
    }
}
