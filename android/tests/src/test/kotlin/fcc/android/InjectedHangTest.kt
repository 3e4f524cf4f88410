package fcc.android

import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Test

/** With the library that has faults on request, and FCCD_HANG_AT_S = 0.5. */
class InjectedHangTest {
    @Test
    fun `of a loop that hangs the watchdog releases the controls, and nothing flies in the process again`() {
        XPlanePeer().use { xPlane ->
            val config = """
                [x-plane]
                simulator = "${xPlane.address}"
                [engage]
                command_needs_switch = false
                [guidance]
                mode = "hold"
                [realtime]
                lock_memory = false
            """.trimIndent()
            val heard = Heard()
            FlightComputer(config, folder(), heard).use { computer ->
                computer.start()
                eventually("nothing inhibits engaging", 40) {
                    computer.now()?.getJSONArray("engage_inhibits")?.length() == 0
                }
                computer.engage()
                eventually("X-Plane's controls are taken") { xPlane.isOverridden }
                assertTrue(heard.ending()!!, "hung" in computer.json().getString("ending"))
                eventually("they are released") { !xPlane.isOverridden }
                val end = computer.json()
                assertTrue(end.getBoolean("hung"))
                assertFalse(end.getBoolean("flying"))
                assertFalse(end.getJSONObject("performance_hints").getBoolean("session"))
                val outcome = end.getJSONObject("outcome")
                assertTrue(outcome.getBoolean("released"))
                assertEquals(0, outcome.getJSONObject("recording").getLong("not_recorded"))
                val refused = assertThrows(FlightException::class.java) { computer.start() }
                assertTrue(refused.message, "hangs in this process" in refused.message!!)
                // Nor by another one, which an app makes for each flight.
                FlightComputer(config, folder(), heard).use { another ->
                    assertTrue(another.json().getBoolean("hung"))
                    assertThrows(FlightException::class.java) { another.start() }
                }
            }
        }
    }
}
