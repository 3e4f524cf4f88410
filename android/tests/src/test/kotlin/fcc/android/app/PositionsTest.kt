package fcc.android.app

import android.Manifest
import android.location.Location
import android.location.LocationManager
import fcc.android.Reading
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNull
import org.junit.Assert.assertTrue
import org.junit.Before
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config

/** Positions of the location service, through to the loop. */
@RunWith(RobolectricTestRunner::class)
@Config(sdk = [34, 35])
class PositionsTest {
    @get:Rule
    val phone = Phone()
    private val manager get() = phone.app.getSystemService(LocationManager::class.java)

    @Before
    fun hasReceiver() = shadowOf(manager).setProviderEnabled(LocationManager.GPS_PROVIDER, true)

    /** On the clock of the machine: Robolectric's own is another one. */
    private fun give(altitudeM: Double?) = shadowOf(manager).simulateLocation(
        Location(LocationManager.GPS_PROVIDER).apply {
            latitude = 48.1
            longitude = 11.5
            altitudeM?.let { mslAltitudeMeters = it }
            altitude = 600.0
            speed = 0f
            accuracy = 4f
            time = System.currentTimeMillis()
            elapsedRealtimeNanos = System.nanoTime()
        },
    )

    private fun fix(): Reading? = phone.tick()?.readings?.find { it.name == "satellite navigation" }

    private fun begin() {
        phone.start(BY_PHONE)
        phone.eventually("the sensors are read") { phone.tick()?.rollRad != null }
    }

    @Test
    fun `a position with its altitude above mean sea level reaches the loop`() {
        shadowOf(phone.app).grantPermissions(Manifest.permission.ACCESS_FINE_LOCATION)
        begin()
        phone.eventually("it arrives") {
            give(altitudeM = 553.0)
            fix() != null
        }
        assertTrue(fix()!!.ageMs < 5_000.0)
    }

    @Test
    fun `without an altitude above mean sea level it is not used`() {
        shadowOf(phone.app).grantPermissions(Manifest.permission.ACCESS_FINE_LOCATION)
        begin()
        repeat(20) {
            give(altitudeM = null)
            phone.pass(100)
        }
        assertNull(fix())
    }

    @Test
    fun `nothing is asked for without the permission`() {
        shadowOf(phone.app).denyPermissions(Manifest.permission.ACCESS_FINE_LOCATION)
        begin()
        assertEquals(emptyList<Any>(), shadowOf(manager).getLegacyLocationRequests(LocationManager.GPS_PROVIDER))
        assertNull(fix())
    }

    private companion object {
        /** Without barometer: the altitude is the receiver's. */
        const val BY_PHONE = """
            actuator = []
            [navigation]
            method = "kalman"
            longest_delay_ms = 500
            magnetic_field_ut = [21.1, 0.0, 45.3]
            [realtime]
            lock_memory = false
            [[sensor]]
            kind = "phone"
            barometer = false
        """
    }
}
