package fcc.android.app

import android.content.ComponentName
import android.content.pm.PackageManager
import android.content.pm.ServiceInfo
import fcc.android.FlightService
import fcc.android.RecordingProvider
import fcc.android.ReleaseService
import fcc.android.screens.MainActivity
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.annotation.Config

/** Robolectric does not check what a service in the foreground needs; Android ends the app. */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class ManifestTest {
    private val app = RuntimeEnvironment.getApplication()
    private val permissions =
        app.packageManager.getPackageInfo("fcc.android", PackageManager.GET_PERMISSIONS).requestedPermissions.toSet()

    /** Android's "Foreground service types are required": each type, its permission, and what it is for. */
    @Config(sdk = [34, 35])
    @Test
    fun `the service's types have their permissions`() {
        val service = app.packageManager.getServiceInfo(ComponentName(app, FlightService::class.java), 0)
        assertEquals(
            ServiceInfo.FOREGROUND_SERVICE_TYPE_LOCATION or ServiceInfo.FOREGROUND_SERVICE_TYPE_CONNECTED_DEVICE,
            service.foregroundServiceType,
        )
        assertFalse(service.exported)
        val needed = listOf(
            "FOREGROUND_SERVICE",
            "FOREGROUND_SERVICE_LOCATION",
            "ACCESS_COARSE_LOCATION",
            "ACCESS_FINE_LOCATION",
            "FOREGROUND_SERVICE_CONNECTED_DEVICE",
            // One of a list, for a connected device.
            "CHANGE_WIFI_MULTICAST_STATE",
            "WAKE_LOCK",
            "POST_NOTIFICATIONS",
            "INTERNET",
        )
        assertEquals(emptyList<String>(), needed.filter { "android.permission.$it" !in permissions })
    }

    @Test
    fun `what releases the controls is in a process of its own`() {
        val service = app.packageManager.getServiceInfo(ComponentName(app, ReleaseService::class.java), 0)
        assertEquals("fcc.android:release", service.processName)
        assertFalse(service.exported)
    }

    @Test
    fun `nothing is asked for that an autopilot has no use for`() {
        val allowed = Regex("INTERNET|WAKE_LOCK|POST_NOTIFICATIONS|(FOREGROUND_SERVICE|ACCESS_|CHANGE_WIFI_).*")
        assertEquals(emptyList<String>(), permissions.map { it.substringAfterLast('.') }.filterNot(allowed::matches))
        assertFalse("android.permission.ACCESS_BACKGROUND_LOCATION" in permissions)
    }

    @Test
    fun `other apps start the activity, and read only what is shared with them`() {
        val manager = app.packageManager
        assertTrue(manager.getActivityInfo(ComponentName(app, MainActivity::class.java), 0).exported)
        val provider = manager.getProviderInfo(ComponentName(app, RecordingProvider::class.java), 0)
        assertFalse(provider.exported)
        assertTrue(provider.grantUriPermissions)
        assertEquals(28, app.applicationInfo.minSdkVersion)
    }
}
