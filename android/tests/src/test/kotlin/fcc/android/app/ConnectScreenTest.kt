package fcc.android.app

import android.net.wifi.WifiManager
import android.os.PowerManager
import android.provider.Settings
import android.view.View
import fcc.android.R
import fcc.android.screens.MainActivity
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Before
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config

@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class ConnectScreenTest {
    @get:Rule
    val phone = Phone()
    private val controller by lazy { Robolectric.buildActivity(MainActivity::class.java).setup() }
    private val activity get() = controller.get()
    private val power get() = shadowOf(phone.app.getSystemService(PowerManager::class.java))

    @Before
    fun open() = activity.open(MainActivity.CONNECT)

    @After
    fun close() {
        controller.close()
    }

    private fun words(id: Int) = activity.findViewById<View>(id).allWords()

    @Test
    fun `what arrives is shown with its ages`() {
        phone.fly()
        phone.eventually("readings") { "airspeed" in words(R.id.readings) }
        phone.eventually("recorded") {
            words(R.id.flown).any { it.startsWith("Recording: ") }
        }
        assertTrue("Reads built-in aircraft. Controls built-in aircraft." in words(R.id.flown))
        assertTrue("Performance hints: ticks of at most 1.3 ms." in words(R.id.flown))
    }

    private fun says(id: Int, start: String) = words(id).any { it.startsWith(start) }

    @Test
    fun `the battery saver is mentioned while it is on`() {
        assertTrue(!says(R.id.battery, SAVER))
        power.setIsPowerSaveMode(true)
        phone.eventually("it is mentioned") { says(R.id.battery, SAVER) }
        power.setIsPowerSaveMode(false)
        phone.eventually("it is not any more") { !says(R.id.battery, SAVER) }
    }

    @Test
    fun `battery optimisation is explained, with the way to the setting, until the app is exempt`() {
        assertTrue(says(R.id.battery, "The system may limit this app"))
        activity.touch(R.id.open_battery_settings)
        val opened = shadowOf(activity).nextStartedActivity.action
        assertEquals(Settings.ACTION_IGNORE_BATTERY_OPTIMIZATION_SETTINGS, opened)
        power.setIgnoringBatteryOptimizations("fcc.android", true)
        phone.eventually("it is exempt") { says(R.id.battery, "The system does not limit this app") }
    }

    @Test
    fun `airplane mode is mentioned in flight, unless Wi-Fi is on`() {
        phone.fly()
        setWifi(false)
        assertTrue(!says(R.id.flown, AIRPLANE))
        Settings.Global.putInt(phone.app.contentResolver, Settings.Global.AIRPLANE_MODE_ON, 1)
        phone.eventually("it is mentioned") { says(R.id.flown, AIRPLANE) }
        setWifi(true)
        phone.eventually("it is not any more") { !says(R.id.flown, AIRPLANE) }
    }

    private fun setWifi(isOn: Boolean) {
        @Suppress("DEPRECATION")
        phone.app.getSystemService(WifiManager::class.java).isWifiEnabled = isOn
    }

    private companion object {
        const val SAVER = "The battery saver is on"
        const val AIRPLANE = "Airplane mode is on, and Wi-Fi off"
    }
}
