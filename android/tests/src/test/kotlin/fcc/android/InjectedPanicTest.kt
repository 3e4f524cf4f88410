package fcc.android

import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Test

/** With the library that has faults on request, and FCCD_PANIC_AT_S = 0.5. */
class InjectedPanicTest {
    @Test
    fun `a panic in a native method is an exception, and the flight goes on`() {
        FlightComputer(BUILT_IN, folder()).use { computer ->
            computer.start()
            val thrown = assertThrows(InternalException::class.java) {
                computer.request("panic")
            }
            assertTrue(thrown.message, thrown.message!!.endsWith("injected panic"))
            assertTrue(computer.json().getBoolean("flying"))
            eventually("it ticks") { (computer.now()?.getLong("tick") ?: 0) > 10 }
        }
    }

    @Test
    fun `a panic in the loop releases the controls and ends the flight, not the process`() {
        val heard = Heard()
        FlightComputer(BUILT_IN, folder(), heard).use { computer ->
            computer.start()
            eventually("ready") { computer.now()?.getJSONArray("engage_inhibits")?.length() == 0 }
            computer.engage()
            val ending = heard.ending()!!
            assertTrue(ending, "injected panic" in ending)
            val end = computer.json()
            assertFalse(end.getBoolean("flying"))
            assertFalse(end.getJSONObject("performance_hints").getBoolean("session"))
            val outcome = end.getJSONObject("outcome")
            assertTrue(outcome.getBoolean("released"))
            assertEquals(0, outcome.getJSONObject("recording").getLong("not_recorded"))
            // And again.
            computer.start()
            computer.stop()
        }
    }
}
