package fcc.android

import android.content.ActivityNotFoundException
import android.content.Context
import android.content.Intent
import android.net.Uri
import android.os.PowerManager
import android.provider.Settings

/** What the system and vendors do to apps to save power. */
object Battery {
    /** Whether the system limits this app while its screens are not in front. */
    fun isLimited(context: Context) =
        !context.getSystemService(PowerManager::class.java).isIgnoringBatteryOptimizations(context.packageName)

    /** Whether the user, or a battery that is nearly empty, has the phone save power. */
    fun isSaving(context: Context) = context.getSystemService(PowerManager::class.java).isPowerSaveMode

    /** Opens the system's list of apps that are not limited, or this app's page. */
    fun openSettings(context: Context) = open(context, Intent(Settings.ACTION_IGNORE_BATTERY_OPTIMIZATION_SETTINGS))

    /** Opens this app's page in the system's settings: its permissions. */
    fun openAppSettings(context: Context) = open(context, appPage(context))

    private fun open(context: Context, intent: Intent) {
        for (candidate in listOf(intent, appPage(context), Intent(Settings.ACTION_SETTINGS))) {
            try {
                return context.startActivity(candidate)
            } catch (_: ActivityNotFoundException) {
                // Some vendors leave pages out.
            }
        }
    }

    private fun appPage(context: Context) =
        Intent(Settings.ACTION_APPLICATION_DETAILS_SETTINGS, Uri.fromParts("package", context.packageName, null))
}
