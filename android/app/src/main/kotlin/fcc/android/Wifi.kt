package fcc.android

import android.content.Context
import android.net.wifi.WifiManager
import android.provider.Settings

/** The way to a simulator or a servo board. */
object Wifi {
    /** Whether airplane mode has switched it off; it can be switched on again in that mode. */
    fun isOffInAirplaneMode(context: Context): Boolean {
        val isInAirplaneMode = Settings.Global.getInt(context.contentResolver, Settings.Global.AIRPLANE_MODE_ON, 0) != 0
        val wifi = context.applicationContext.getSystemService(WifiManager::class.java)
        return isInAirplaneMode && wifi?.isWifiEnabled != true
    }
}
