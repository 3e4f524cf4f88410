package fcc.android.app

import android.Manifest
import android.content.ComponentName
import android.content.pm.ServiceInfo
import fcc.android.Flight
import fcc.android.FlightService
import fcc.android.Phase
import fcc.android.ReleaseService
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertNull
import org.junit.Assert.assertTrue
import org.junit.Rule
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config
import org.robolectric.shadows.ShadowPowerManager

@RunWith(RobolectricTestRunner::class)
@Config(sdk = [28, 34, 35])
class FlightServiceTest {
    @get:Rule
    val phone = Phone()

    @Test
    fun `it flies, its notification says it, and its stop action ends it with a whole recording`() {
        phone.fly()
        phone.eventually("the notification is up to date") { phone.notificationWords() == "Standby / Ready to engage" }
        val lock = ShadowPowerManager.getLatestWakeLock()
        assertTrue(lock.isHeld)
        Flight.engage()
        phone.eventually("the notification says it") { phone.notificationWords() == "Engaged / hold" }

        val actions = phone.notification()!!.actions
        assertEquals(listOf("End flight"), actions.map { it.title.toString() })
        actions.single().actionIntent.send()
        phone.eventually("it has ended") { Flight.phase == Phase.IDLE }
        phone.eventually("its service, too") { phone.service == null }
        assertFalse(lock.isHeld)
        val recording = phone.recordings.list().single()
        assertEquals("whole", recording.wholeness)
        assertEquals(0, recording.notRecorded)
        val report = phone.recordings.report(recording.file)
        assertEquals(recording.ticks, report.timing!!.ticks)
        assertEquals(40.0, report.timing!!.rateHz, 0.0)
        assertTrue(report.events.any { "standby → engaged" in it })
    }

    @Test
    fun `with a flight the process begins that releases if this one is killed`() {
        phone.fly()
        val release = ComponentName(phone.app, ReleaseService::class.java)
        assertTrue(phone.started.any { it.component == release })
    }

    @Test
    fun `a second start changes nothing`() {
        phone.fly()
        val before = phone.tick()!!.tick()
        phone.start(FLOWN)
        phone.start("wrong")
        phone.eventually("it goes on") { phone.tick()!!.tick() > before + 1.0 }
        assertEquals(1, phone.recordings.list().size)
    }

    private fun fcc.android.Tick.tick() = timeS

    @Test
    fun `started anew by the system it ends itself, and nothing flies`() {
        phone.deliver(null)
        assertNotNull(phone.service)
        phone.eventually("it has ended") { phone.service == null }
        assertEquals(Phase.IDLE, Flight.phase)
        assertEquals(emptyList<String>(), phone.recordings.list().map { it.file.name })
    }

    @Test
    fun `stopped with nothing in flight it ends itself`() {
        FlightService.stop(phone.app)
        phone.pass()
        phone.eventually("it has ended") { phone.service == null }
    }

    @Test
    fun `destroyed in flight it ends the flight with a whole recording`() {
        phone.fly()
        phone.destroyService()
        phone.eventually("it has ended") { Flight.phase == Phase.IDLE }
        assertEquals("whole", phone.recordings.list().single().wholeness)
        // And again.
        phone.fly()
    }

    @Test
    fun `what cannot be flown is said, and the service ends`() {
        phone.start("[built-in]\n[loop]\nrate_hz = -1\n")
        phone.eventually("the reason is there") { "loop.rate_hz" in Flight.state().ending.orEmpty() }
        phone.eventually("it has ended") { phone.service == null && Flight.phase == Phase.IDLE }
        phone.fly()
        assertNull(Flight.state().ending)
    }

    /** As of a phone that permits no more while the app is not in front. */
    @Test
    fun `a service that is refused in flight hides no flight`() {
        phone.fly()
        val shadow = shadowOf(phone.service!!.get())
        shadow.setThrowInStartForeground(IllegalStateException("not allowed"))
        phone.start(FLOWN)
        phone.pass(100)
        shadow.setThrowInStartForeground(null)
        assertTrue(phone.isIn("standby"))
        assertNull(Flight.state().ending)
        Flight.engage()
        phone.eventually("engaged") { phone.isIn("engaged") }
    }

    @Test
    fun `a service that ends while an earlier one ends its flight ends nothing else`() {
        phone.fly()
        phone.destroyService()
        repeat(20) {
            phone.deliver(null)
            phone.destroyService()
        }
        phone.eventually("it has ended") { Flight.phase == Phase.IDLE }
        phone.fly()
        val since = phone.tick()!!.timeS
        phone.eventually("it flies on") { phone.tick()?.let { it.timeS > since + 1.0 } == true }
        assertEquals(Phase.FLYING, Flight.phase)
    }

    /** Without it positions end when the screen goes off. */
    @Config(sdk = [34, 35])
    @Test
    fun `a configuration that is saved in flight does not change the service's types`() {
        shadowOf(phone.app).grantPermissions(Manifest.permission.ACCESS_FINE_LOCATION)
        phone.start("actuator = []\n[navigation]\nmethod = \"kalman\"\n[[sensor]]\nkind = \"phone\"\n")
        phone.eventually("it flies") { phone.tick() != null }
        val types = phone.service!!.get().foregroundServiceType
        assertEquals(ServiceInfo.FOREGROUND_SERVICE_TYPE_LOCATION, types and ServiceInfo.FOREGROUND_SERVICE_TYPE_LOCATION)
        phone.start(FLOWN)
        phone.pass(100)
        assertEquals(types, phone.service!!.get().foregroundServiceType)
    }

    @Config(sdk = [34, 35])
    @Test
    fun `a location is a type of the service only where it is permitted and used`() {
        fun types(config: String): Int {
            phone.start(config)
            phone.pass()
            val types = phone.service!!.get().foregroundServiceType
            phone.eventually("it has begun or not") { Flight.phase != Phase.BEGINNING }
            phone.endFlight()
            return types
        }
        val connected = ServiceInfo.FOREGROUND_SERVICE_TYPE_CONNECTED_DEVICE
        val byPhone = "actuator = []\n[navigation]\nmethod = \"kalman\"\n[[sensor]]\nkind = \"phone\"\n"
        shadowOf(phone.app).denyPermissions(Manifest.permission.ACCESS_FINE_LOCATION)
        assertEquals(connected, types(byPhone))
        shadowOf(phone.app).grantPermissions(Manifest.permission.ACCESS_FINE_LOCATION)
        assertEquals(connected, types(FLOWN))
        assertEquals(connected or ServiceInfo.FOREGROUND_SERVICE_TYPE_LOCATION, types(byPhone))
    }
}
