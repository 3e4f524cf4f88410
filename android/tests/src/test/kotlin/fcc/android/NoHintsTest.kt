package fcc.android

import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Test

/** Without the fake libandroid: nothing has the functions of performance hints. */
class NoHintsTest {
    @Test
    fun `a system without performance hints is flown on, and says so`() {
        FlightComputer(BUILT_IN, folder()).use { computer ->
            computer.start()
            eventually("nothing inhibits engaging", 40) {
                computer.now()?.getJSONArray("engage_inhibits")?.length() == 0
            }
            computer.engage()
            assertFalse(computer.hints()!!.getBoolean("session"))
            assertEquals(
                "not offered by this system, only by Android 13 and newer",
                computer.hints()!!.getString("why"),
            )
        }
    }
}
